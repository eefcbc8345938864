//! `[objects.filter]`: which points of a file are taken.

use crate::keys::Absent::{Required, Value, Words};
use crate::keys::{Fault, Kind, LARGE, SHORT, Table, count, key, numbers, plain};
use crate::read::{Reader, to_number};
use crate::settings::quoted;
use std::fmt::{self, Write};

/// Which points of a file are taken. Conditions apply in the order of the fields. Coordinates and
/// lengths are the file's.
#[derive(Debug, Clone, PartialEq)]
pub struct PointFilter {
    /// The first point of the file and every n-th after it, from 1.
    pub every: u32,
    /// Lowest and highest corner of a box, each coordinate -1e15 to 1e15.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Attributes, or `x`, `y`, `z`, with their least and greatest values, -1e15 to 1e15.
    pub ranges: Vec<(String, [f64; 2])>,
    /// Values of `classification`, 0 to 255.
    pub classes: Option<Vec<u32>>,
    /// Cubes whose points become one.
    pub voxel: Option<VoxelEdge>,
}

/// The edge of the cubes that a filter makes points of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VoxelEdge {
    /// Twice the median distance of points to the nearest other one.
    Auto,
    /// 1e-12 to 1e15.
    Length(f64),
}

const FILE_POSITION: Kind = Kind::Vector(numbers(-LARGE, LARGE, "units of the file"));

pub(crate) static FILTER: Table = Table {
    header: "[objects.filter]",
    doc: "Which points of the file are taken. The conditions apply in this order while the file is \
          read; what is left out takes no memory. Coordinates and lengths are the file's. How many \
          points were kept, of how many, is said on the terminal, by `info` and in `--stats`.",
    whole: None,
    keys: &[
        key(
            "every",
            count(1, u32::MAX as i64, "points"),
            Value("1"),
            "The first point of the file and every n-th after it, whatever the other \
             conditions leave out.",
        ),
        key("box", Kind::Table(&FILTER_BOX), Words("everywhere", "{}"), FILTER_BOX.doc),
        key(
            "range",
            Kind::Ranges(numbers(-LARGE, LARGE, "")),
            Words("any", "{ intensity = [100, 2000], z = [0, 50] }"),
            "Least and greatest value of attributes, or of x, y and z; both are taken. `info` lists \
             the attributes of a file. What is no number is left out.",
        ),
        key(
            "classification",
            Kind::List { of: &Kind::Integer { min: 0, max: 255, unit: "" }, max: 256 },
            Words("any", "[2, 6]"),
            "Values of the attribute `classification` that are taken: of LAS, 2 is ground, 6 \
             buildings.",
        ),
        key(
            "voxel",
            Kind::Either(&[
                Kind::Choice(&["auto"]),
                Kind::Number(numbers(SHORT, LARGE, "units of the file")),
            ]),
            Words("none", "0.1"),
            "Edge of cubes, counted from the origin of the file's coordinates, in each of which the points \
             that meet all other conditions become one, their mean; a larger one leaves fewer points. `auto` \
             takes twice the median distance of points to the nearest other one, which thins what is denser \
             than the middle.",
        ),
    ],
};

pub(crate) static FILTER_BOX: Table = Table {
    header: "[objects.filter.box]",
    doc: "A box along the axes of the file's coordinates; its faces belong to it.",
    whole: Some(box_has_an_inside),
    keys: &[
        key("min", FILE_POSITION, Required("[0.0, 0.0, 0.0]"), "The lowest corner."),
        key("max", FILE_POSITION, Required("[10.0, 10.0, 5.0]"), "The highest corner."),
    ],
};

impl PointFilter {
    pub(crate) fn read(table: &Reader<'_>) -> Self {
        Self {
            every: table.count("every"),
            bounds: table.written("box").map(|_| {
                let corners = table.table("box", &FILTER_BOX);
                ["min", "max"].map(|corner| corners.vector(corner))
            }),
            ranges: table.written_ranges("range"),
            classes: table.written_counts("classification"),
            voxel: (table.written("voxel")).map(|_| {
                to_number(&table.value("voxel")).map_or(VoxelEdge::Auto, VoxelEdge::Length)
            }),
        }
    }
}

pub(crate) fn write_filter(out: &mut String, filter: &PointFilter) -> fmt::Result {
    writeln!(out, "\n[objects.filter]")?;
    writeln!(out, "every = {}", filter.every)?;
    if !filter.ranges.is_empty() {
        let range = |(name, range): &(String, [f64; 2])| format!("{} = {range:?}", quoted(name));
        let ranges: Vec<String> = filter.ranges.iter().map(range).collect();
        writeln!(out, "range = {{ {} }}", ranges.join(", "))?;
    }
    if let Some(classes) = &filter.classes {
        writeln!(out, "classification = {classes:?}")?;
    }
    match filter.voxel {
        Some(VoxelEdge::Length(edge)) => writeln!(out, "voxel = {edge:?}")?,
        Some(VoxelEdge::Auto) => writeln!(out, "voxel = \"auto\"")?,
        None => {}
    }
    if let Some([min, max]) = filter.bounds {
        writeln!(out, "\n[objects.filter.box]\nmin = {min:?}\nmax = {max:?}")?;
    }
    Ok(())
}

/// No corner of a box is beyond the other.
fn box_has_an_inside(table: &Reader<'_>) -> Result<(), Fault> {
    let (min, max) = (table.vector("min"), table.vector("max"));
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        if max[axis] < min[axis] {
            let message = format!(
                "found {} along {name}, expected at least min's, {}; raise it",
                plain(max[axis]),
                plain(min[axis])
            );
            return Err(("max", message));
        }
    }
    Ok(())
}
