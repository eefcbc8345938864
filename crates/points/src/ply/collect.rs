//! Vertices into a point set: which property is what, and where its values go.

use crate::ply::header::{Element, Kind, Type};
use crate::read::PointsError;
use crate::set::{Attribute, ColorEncoding, PointSet, Values};
use std::collections::TryReserveError;
use std::path::Path;

/// Names that exporters give to the three properties of a colour.
const COLOR: [[&str; 3]; 3] =
    [["red", "green", "blue"], ["r", "g", "b"], ["diffuse_red", "diffuse_green", "diffuse_blue"]];
/// Names that exporters give to the three properties of a normal.
const NORMAL: [[&str; 3]; 2] = [["nx", "ny", "nz"], ["normal_x", "normal_y", "normal_z"]];

/// Takes vertices one by one.
pub(super) struct Collector<'a> {
    path: &'a Path,
    /// Places of x, y, z among the properties.
    position: [usize; 3],
    color: Option<Color>,
    normal: Option<[usize; 3]>,
    /// Places of the attributes, in the order of `set.attributes`.
    attributes: Vec<usize>,
    set: PointSet,
}

/// Where colours are, and how they become linear.
struct Color {
    places: [usize; 3],
    encoding: ColorEncoding,
    /// The linear value of each stored integer.
    table: Vec<f32>,
}

impl<'a> Collector<'a> {
    /// Decides what each property is. Fails if there is no position.
    pub(super) fn new(vertices: &Element, path: &'a Path) -> Result<Self, PointsError> {
        let position = triple(vertices, ["x", "y", "z"]).map_err(|axis| {
            let names: Vec<_> =
                vertices.properties.iter().map(|p| format!("'{}'", p.name)).collect();
            PointsError::Missing {
                path: path.into(),
                missing: format!("number '{axis}'"),
                place: format!(
                    "among the properties of '{}' ({})",
                    vertices.name,
                    names.join(", ")
                ),
                help: "export positions as the properties x, y and z",
            }
        })?;
        let color = COLOR.into_iter().find_map(|names| Color::find(vertices, names));
        let normal = NORMAL.into_iter().find_map(|names| triple(vertices, names).ok());

        let taken = |place: &usize| {
            position.contains(place)
                || color.as_ref().is_some_and(|color| color.places.contains(place))
                || normal.is_some_and(|normal| normal.contains(place))
        };
        let mut places = Vec::new();
        let mut attributes = Vec::new();
        for (place, property) in vertices.properties.iter().enumerate() {
            let Kind::Number(kind) = property.kind else { continue };
            if taken(&place) {
                continue;
            }
            let values = match kind {
                Type::I32 | Type::U32 | Type::F64 => Values::F64(Vec::new()),
                _ => Values::F32(Vec::new()),
            };
            places.push(place);
            attributes.push(Attribute { name: property.name.clone(), values });
        }
        let set = PointSet {
            positions: Vec::new(),
            file_index: Vec::new(),
            colors: color.is_some().then(Vec::new),
            color_encoding: color.as_ref().map(|color| color.encoding),
            normals: normal.is_some().then(Vec::new),
            attributes,
            non_finite: 0,
            format: String::new(),
        };
        Ok(Self { path, position, color, normal, attributes: places, set })
    }

    /// Asks for memory for this many points at once, so that too little of it is an error.
    pub(super) fn reserve(&mut self, points: usize) -> Result<(), PointsError> {
        let set = &mut self.set;
        let mut ask = || -> Result<(), TryReserveError> {
            set.positions.try_reserve_exact(points)?;
            set.file_index.try_reserve_exact(points)?;
            if let Some(colors) = &mut set.colors {
                colors.try_reserve_exact(points)?;
            }
            if let Some(normals) = &mut set.normals {
                normals.try_reserve_exact(points)?;
            }
            for attribute in &mut set.attributes {
                match &mut attribute.values {
                    Values::F32(values) => values.try_reserve_exact(points)?,
                    Values::F64(values) => values.try_reserve_exact(points)?,
                }
            }
            Ok(())
        };
        ask()
            .map_err(|_| PointsError::OutOfMemory { path: self.path.into(), points: points as u64 })
    }

    /// Takes the vertex at `index` of the file, one value a property.
    pub(super) fn push(&mut self, index: u32, row: &[f64]) {
        let set = &mut self.set;
        let position = self.position.map(|place| row[place]);
        if !position.iter().all(|coordinate| coordinate.is_finite()) {
            set.non_finite += 1;
            return;
        }
        set.positions.push(position);
        set.file_index.push(index);
        if let (Some(colors), Some(color)) = (&mut set.colors, &self.color) {
            colors.push(color.places.map(|place| color.linear(row[place])));
        }
        if let (Some(normals), Some(normal)) = (&mut set.normals, self.normal) {
            normals.push(normal.map(|place| row[place] as f32));
        }
        for (attribute, &place) in set.attributes.iter_mut().zip(&self.attributes) {
            match &mut attribute.values {
                Values::F32(values) => values.push(row[place] as f32),
                Values::F64(values) => values.push(row[place]),
            }
        }
    }

    /// The set, which must not be empty. `in_file` is the number of vertices in the file.
    pub(super) fn finish(self, in_file: u64, format: &str) -> Result<PointSet, PointsError> {
        let mut set = self.set;
        if set.positions.is_empty() {
            let non_finite = set.non_finite;
            return Err(PointsError::NoPoints { path: self.path.into(), in_file, non_finite });
        }
        set.format = format.to_owned();
        Ok(set)
    }
}

impl Color {
    /// The colour of these names, if all three are numbers of one type.
    fn find(vertices: &Element, names: [&str; 3]) -> Option<Self> {
        let places = triple(vertices, names).ok()?;
        let [kind, others @ ..] = places.map(|place| vertices.properties[place].kind);
        let Kind::Number(kind) = kind else { return None };
        if others.iter().any(|&other| other != Kind::Number(kind)) {
            return None;
        }
        let (encoding, entries) = match kind {
            Type::F32 | Type::F64 => (ColorEncoding::Linear, 0),
            Type::I16 | Type::U16 => (ColorEncoding::Srgb16, 1 << 16),
            // Integers of 32 bits hold bytes: exporters that write them do so for want of uchar.
            Type::I8 | Type::U8 | Type::I32 | Type::U32 => (ColorEncoding::Srgb8, 1 << 8),
        };
        let table = (0..entries).map(|stored| encoding.decode(f64::from(stored))).collect();
        Some(Self { places, encoding, table })
    }

    fn linear(&self, stored: f64) -> f32 {
        match self.table.last() {
            // Negative numbers become 0 in the cast.
            Some(&brightest) => *self.table.get(stored as usize).unwrap_or(&brightest),
            None => stored as f32,
        }
    }
}

/// Places of three numbers; fails with the first name that is none. A name in other letter case
/// does where the exact one is missing.
fn triple<'n>(vertices: &Element, names: [&'n str; 3]) -> Result<[usize; 3], &'n str> {
    let find = |name: &'n str| {
        let place = |fits: &dyn Fn(&str) -> bool| {
            vertices
                .properties
                .iter()
                .position(|p| fits(&p.name) && matches!(p.kind, Kind::Number(_)))
        };
        place(&|other| other == name)
            .or_else(|| place(&|other| other.eq_ignore_ascii_case(name)))
            .ok_or(name)
    };
    let [x, y, z] = names;
    Ok([find(x)?, find(y)?, find(z)?])
}
