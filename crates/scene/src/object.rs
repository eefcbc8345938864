//! `[[objects]]`: a point set with its place, and what its columns mean.

use crate::filter::{FILTER, write_filter};
use crate::keys::Absent::{self, Required, Value, Words};
use crate::keys::{Kind, POSITION, Table, key, numbers};
use crate::material::{MATERIAL, write_material};
use crate::read::Reader;
use crate::settings::quoted;
use crate::surface::{SURFACE, write_surface};
use crate::volume::keys::VOLUME;
use crate::volume::write_volume;
use crate::{Material, PointFilter, Surface, Transform, Volume};
use std::fmt::{self, Write};
use std::path::{Path, PathBuf};

/// One point set with its place, surface and material.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Name in messages and statistics; the stem of the point file unless the scene gives one.
    pub name: String,
    /// The point file, resolved against the scene file's folder.
    pub points: PathBuf,
    /// The point file as the scene file names it, for headers: it says nothing about the machine.
    pub points_as_written: String,
    /// Which points of the file are taken.
    pub filter: PointFilter,
    /// Which column of the file is what, over what the file says.
    pub columns: PointColumns,
    /// What x and y of the file are.
    pub units: Units,
    /// From the file's coordinates, of degrees from metres, to the world's.
    pub transform: Transform,
    /// How the surface is fitted.
    pub surface: Surface,
    /// How the surface scatters light.
    pub material: Material,
    /// A volume made of the points; `None`: the object is a pure surface.
    pub volume: Option<Volume>,
}

/// Which column of a point file is what.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PointColumns {
    /// `x`, `y`, `z`, `red`, …, or any name of an attribute, and the column.
    pub named: Vec<(String, PointColumn)>,
    /// Columns that are passed over, counted from 1.
    pub left_out: Vec<u32>,
}

/// A column of a point file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PointColumn {
    /// The one that the file calls so.
    Name(String),
    /// The one in this place, counted from 1.
    Number(u32),
}

/// What x and y of a point file are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Units {
    /// What the file says; lengths where it says nothing.
    #[default]
    Auto,
    /// Longitude and latitude in degrees.
    Degrees,
    /// Lengths, like z.
    Scene,
}

pub(crate) static OBJECTS: Table = Table {
    header: "[[objects]]",
    doc: "A point set with its place, surface and material. A scene has at least one. Its place \
          in the file, counted from 0, is its index in the picture's `object` channel.",
    whole: None,
    keys: &[
        key(
            "name",
            Kind::Text("a name"),
            Words("the point file's name without folder and extension", "\"knot\""),
            "Name in messages and statistics.",
        ),
        key(
            "points",
            Kind::Text("the path of a point file"),
            Required("\"points/knot.ply\""),
            "The point file, relative to the scene file's folder. `\"@ground\"`: no file but a ground, see A ground.",
        ),
        key(
            "units",
            Kind::Choice(&["auto", "degrees", "scene"]),
            Value("\"auto\""),
            "What x and y of the file are. `\"degrees\"`: longitude and latitude, which are projected to \
             metres east and north of a centre that all such objects of the scene share, before the \
             transform; z stays. `\"scene\"`: lengths, which stay as they are. `\"auto\"`: degrees where \
             the file says so, by the names of its columns or by its coordinate reference system.",
        ),
        key("transform", Kind::Table(&TRANSFORM), Absent::Table, TRANSFORM.doc),
        key("surface", Kind::Table(&SURFACE), Absent::Table, SURFACE.doc),
        key("material", Kind::Table(&MATERIAL), Absent::Table, MATERIAL.doc),
        key("volume", Kind::Table(&VOLUME), Words("a pure surface", "{}"), VOLUME.doc),
        key("filter", Kind::Table(&FILTER), Absent::Table, FILTER.doc),
        key(
            "columns",
            Kind::Columns,
            Words(
                "what the file calls them, or is taken to mean",
                "{ x = \"E\", y = \"N\", z = 3 }",
            ),
            "Which column of the file is what: `x`, `y`, `z`, `red`, `green`, `blue`, `nx`, `ny`, `nz`, \
             `intensity`, `classification`, or any other name for an attribute, each with the column's \
             name in the file or its number from 1. `_` lists the numbers of columns that are passed \
             over. See docs/point-files.md, Choosing columns.",
        ),
    ],
};

pub(crate) static TRANSFORM: Table = Table {
    header: "[objects.transform]",
    doc: "From the file's coordinates (of degrees, from metres) to the world's: scale, then rotate, then translate.",
    whole: None,
    keys: &[
        key("scale", Kind::Number(numbers(1e-12, 1e12, "")), Value("1.0"), "One positive factor."),
        key(
            "rotate",
            Kind::Vector(numbers(-1e6, 1e6, "degrees")),
            Value("[0.0, 0.0, 0.0]"),
            "About the fixed axes x, then y, then z, right-handed.",
        ),
        key("translate", POSITION, Value("[0.0, 0.0, 0.0]"), "Added last."),
    ],
};

impl Object {
    pub(crate) fn read(table: &Reader<'_>, folder: &Path) -> Self {
        let written = table.text("points");
        let points: PathBuf = folder.join(&written);
        let name = match table.written("name") {
            Some(_) => table.text("name"),
            None => points.file_stem().map_or(written.clone(), |s| s.to_string_lossy().into()),
        };
        Self {
            name,
            points,
            points_as_written: written,
            filter: PointFilter::read(&table.table("filter", &FILTER)),
            columns: table.written_columns("columns"),
            units: match table.text("units").as_str() {
                "degrees" => Units::Degrees,
                "scene" => Units::Scene,
                _ => Units::Auto,
            },
            transform: Transform::read(&table.table("transform", &TRANSFORM)),
            surface: Surface::read(&table.table("surface", &SURFACE)),
            material: Material::read(&table.table("material", &MATERIAL), folder),
            volume: (table.written("volume"))
                .map(|_| Volume::read(&table.table("volume", &VOLUME))),
        }
    }
}

impl Transform {
    pub(crate) fn read(table: &Reader<'_>) -> Self {
        Self {
            scale: table.number("scale"),
            rotate: table.vector("rotate"),
            translate: table.vector("translate"),
        }
    }
}

impl Default for Transform {
    fn default() -> Self {
        Self::read(&Reader::defaults(&TRANSFORM))
    }
}

pub(crate) fn write_object(out: &mut String, object: &Object) -> fmt::Result {
    writeln!(out, "\n[[objects]]")?;
    writeln!(out, "name = {}", quoted(&object.name))?;
    writeln!(out, "points = {}", quoted(&object.points_as_written))?;
    let units = match object.units {
        Units::Auto => "auto",
        Units::Degrees => "degrees",
        Units::Scene => "scene",
    };
    writeln!(out, "units = \"{units}\"")?;
    write_filter(out, &object.filter)?;
    write_columns(out, &object.columns)?;
    writeln!(out, "\n[objects.transform]")?;
    writeln!(out, "scale = {:?}", object.transform.scale)?;
    writeln!(out, "rotate = {:?}", object.transform.rotate)?;
    writeln!(out, "translate = {:?}", object.transform.translate)?;
    write_surface(out, &object.surface)?;
    write_material(out, &object.material)?;
    match &object.volume {
        Some(volume) => write_volume(out, volume),
        None => Ok(()),
    }
}

fn write_columns(out: &mut String, columns: &PointColumns) -> fmt::Result {
    if *columns == PointColumns::default() {
        return Ok(());
    }
    writeln!(out, "\n[objects.columns]")?;
    for (name, column) in &columns.named {
        match column {
            PointColumn::Name(column) => writeln!(out, "{} = {}", quoted(name), quoted(column))?,
            PointColumn::Number(number) => writeln!(out, "{} = {number}", quoted(name))?,
        }
    }
    if columns.left_out.is_empty() { Ok(()) } else { writeln!(out, "_ = {:?}", columns.left_out) }
}
