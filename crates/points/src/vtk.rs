//! VTK files: the legacy format and the XML formats. Their points, and what is stored for points,
//! are read; cells are not.
//!
//! An array that comes with the points becomes an attribute under its name, one of several
//! components one each, `name_0` and so on. Normals are normals; arrays of three or four bytes a
//! point, or with the name of a colour, are the colour, the first of them. Both formats hold one
//! array behind the other, so files are gone through twice: first to find where the arrays are, then
//! to read all of them side by side.

mod ascii;
mod lattice;
mod legacy;
mod xml;

use crate::collect::Collector;
use crate::columns::{Array, Numbers, SideBySide};
use crate::error::PointsError;
use crate::field::{Field, Type};
use crate::meaning::{self, spread};
use crate::options::ReadOptions;
use crate::set::PointSet;
use std::path::Path;

pub(crate) use legacy::{read as read_legacy, sniff as sniff_legacy};
pub(crate) use xml::{read as read_xml, read_series, sniff as sniff_xml, sniff_series};

/// A file with more columns of numbers a point is taken for damaged.
const MAX_COLUMNS: usize = 1000;

const HELP: &str = "open it in ParaView and save it as VTU or VTP, or export it again";

/// What is known of an array before it is read.
#[derive(Debug, Clone, PartialEq)]
struct Described {
    name: String,
    /// Values a point.
    width: usize,
    kind: Type,
    role: Role,
}

/// What a file says that an array is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    Position,
    Normal,
    Color,
    /// Whatever its name says.
    Other,
}

/// The names of the numbers of a point.
fn names_of(arrays: &[Described]) -> Vec<String> {
    let mut has_color = false;
    let mut has_normal = arrays.iter().any(|array| array.role == Role::Normal);
    let mut names = Vec::new();
    for array in arrays {
        let bytes = array.kind == Type::U8 && matches!(array.width, 3 | 4);
        let mut spread_names = match array.role {
            Role::Position => spread("xyz", array.width),
            Role::Normal => spread("normals", array.width),
            Role::Color => spread("rgb", array.width),
            Role::Other if bytes => spread("rgb", array.width),
            Role::Other => spread(&array.name, array.width),
        };
        let is_color = spread_names.first().is_some_and(|name| name == "red");
        let is_normal = spread_names.first().is_some_and(|name| name == "nx");
        if (is_color && has_color) || (is_normal && has_normal && array.role != Role::Normal) {
            spread_names = (0..array.width).map(|i| format!("{}_{i}", array.name)).collect();
        }
        has_color |= is_color;
        has_normal |= is_normal;
        names.extend(spread_names);
    }
    names
}

/// Takes the points of one part of a file after the other.
struct Parts<'a> {
    path: &'a Path,
    options: &'a ReadOptions,
    /// For how many points memory is asked.
    expected: u64,
    collector: Option<Collector<'a>>,
}

impl<'a> Parts<'a> {
    /// `expected` must be bounded by what the file has bytes for.
    fn new(path: &'a Path, options: &'a ReadOptions, expected: u64) -> Self {
        Self { path, options, expected, collector: None }
    }

    /// Takes the points of a part. All parts must have the same arrays.
    fn take(
        &mut self,
        arrays: Vec<(Described, Box<dyn Numbers + '_>)>,
        points: u64,
    ) -> Result<(), PointsError> {
        let (described, arrays): (Vec<_>, Vec<_>) = arrays
            .into_iter()
            .map(|(described, numbers)| {
                let array = Array { name: described.name.clone(), width: described.width, numbers };
                (described, array)
            })
            .unzip();
        let table = SideBySide::new(arrays, points, self.path)?;
        let collector = match &mut self.collector {
            Some(collector) => collector,
            None => {
                let of_each = |array: &Described| std::iter::repeat_n(array.kind, array.width);
                let kinds: Vec<Type> = described.iter().flat_map(of_each).collect();
                let sample = table.sample(kinds.iter().map(|kind| kind.is_float()).collect());
                let fields = meaning::by_names(&names_of(&described), Some(&kinds), &sample);
                let mut collector = Collector::new(&fields, self.path, self.options)?;
                collector.expect(self.expected)?;
                self.collector.insert(collector)
            }
        };
        table.collect(collector)
    }

    fn finish(self, format: &str) -> Result<PointSet, PointsError> {
        match self.collector {
            Some(collector) => collector.finish(format),
            None => {
                let xyz = ["x", "y", "z"].map(|name| Field::new(name, Type::F32));
                Collector::new(&xyz, self.path, &ReadOptions::default())?.finish(format)
            }
        }
    }
}

#[cfg(test)]
mod tests;
