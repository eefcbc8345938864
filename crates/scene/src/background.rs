//! `[background]`: what rays that hit nothing see; and images that a scene names.

mod sky;

pub use sky::{Sky, SunPlace};

use crate::document::{Node, Origin};
use crate::error::Problem;
use crate::keys::Absent::{Value, Words};
use crate::keys::{Fault, Kind, LARGE, RADIANCE, Table, key, numbers};
use crate::read::{Reader, to_vector};
use crate::settings::quoted;
use crate::{Integrator, Scene};
use sky::SKY;
use std::fmt::{self, Write};
use std::path::{Path, PathBuf};

/// What rays that hit nothing see.
#[derive(Debug, Clone, PartialEq)]
pub struct Background {
    /// Radiance, each 0 to 1e15.
    pub color: [f64; 3],
    /// An equirectangular image instead.
    pub environment: Option<ImageFile>,
    /// How the environment is turned about the fixed x, y, z axes in that order, in degrees, each -1e6 to 1e6.
    pub rotate: [f64; 3],
    /// A clear sky instead.
    pub sky: Option<Sky>,
    /// Radiance straight down and straight up instead, each 0 to 1e15, with a smooth course between them.
    pub gradient: Option<[[f64; 3]; 2]>,
    /// Whether it lights the scene, which an integrator other than `direct` is needed for; `None`: wherever it can.
    pub lights: Option<bool>,
}

/// An image that the scene names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ImageFile {
    /// Resolved against the scene file's folder.
    pub path: PathBuf,
    /// As the scene file names it, for headers: it says nothing about the machine.
    pub as_written: String,
}

pub(crate) static BACKGROUND: Table = Table {
    header: "[background]",
    doc: "What rays that hit nothing see. With `render.integrator` \"sky\" or \"path\" it lights the scene.",
    whole: Some(background_is_one),
    keys: &[
        key("color", RADIANCE, Value("[0.0, 0.0, 0.0]"), "One radiance in every direction."),
        key(
            "environment",
            Kind::Text("the path of an image"),
            Words("none", "\"sky.exr\""),
            "An equirectangular image (EXR or HDR; PNG and JPEG are decoded from sRGB) instead of \
             `color`. Its top is the camera's `up` where that is an axis, so that the horizon is level; a \
             direction (x, y, z) is looked up as (x, y, z) for +y, (x, -y, -z) for -y, (x, z, -y) for +z, \
             (x, -z, y) for -z, (-y, x, z) for +x, (y, -x, z) for -x, and as for +y where `up` is no axis. In \
             what is looked up +y is the top row, -z the middle, +x right of that.",
        ),
        key(
            "rotate",
            Kind::Vector(numbers(-1e6, 1e6, "degrees")),
            Value("[0.0, 0.0, 0.0]"),
            "Turns the environment about the world's fixed axes x, then y, then z, right-handed, as \
             `transform.rotate` turns an object; an error without one. (A sky is turned by `sun` or `azimuth`.)",
        ),
        key(
            "sky",
            Kind::Table(&SKY),
            Words("none", "{}"),
            "A clear sky and its sun, instead of `color`.",
        ),
        key(
            "gradient",
            Kind::Vectors(numbers(0.0, LARGE, "W sr⁻¹ m⁻², linear RGB")),
            Words("none", "[[0.1, 0.1, 0.1], [0.4, 0.4, 0.4]]"),
            "The radiance straight down and that straight up, instead of `color`, where up is an environment's top. In a \
             direction that is h high, from -1 straight down to 1 straight up, it is down + (up - down) t² (3 - 2 t) with t = (1 + h) / 2.",
        ),
        key(
            "lights",
            Kind::Bool,
            Words("true with `render.integrator` \"sky\" or \"path\"", "false"),
            "Whether the background lights the scene. True is an error where `render.integrator` is \"direct\".",
        ),
    ],
};

impl Background {
    pub(crate) fn read(table: &Reader<'_>, folder: &Path) -> Self {
        Self {
            color: table.vector("color"),
            environment: ImageFile::read(table, "environment", folder),
            rotate: table.vector("rotate"),
            sky: table.written("sky").map(|_| Sky::read(&table.table("sky", &SKY))),
            gradient: table.written("gradient").map(|node| {
                let ends: Vec<_> = node.items().iter().map(|end| to_vector(&end.value)).collect();
                match ends.as_slice() {
                    [Some(down), Some(up)] => [*down, *up],
                    _ => table.unlike("two colours", "gradient", &node.value),
                }
            }),
            lights: table.written("lights").map(|_| table.flag("lights")),
        }
    }
}

/// Writes `[background]`.
pub(crate) fn write_background(out: &mut String, background: &Background) -> fmt::Result {
    writeln!(out, "[background]")?;
    match (&background.environment, background.sky, background.gradient) {
        (Some(image), ..) => {
            writeln!(out, "environment = {}", quoted(&image.as_written))?;
            writeln!(out, "rotate = {:?}", background.rotate)?;
        }
        (None, Some(_), _) => {}
        (None, None, Some(ends)) => writeln!(out, "gradient = {ends:?}")?,
        (None, None, None) => writeln!(out, "color = {:?}", background.color)?,
    }
    if let Some(lights) = background.lights {
        writeln!(out, "lights = {lights}")?;
    }
    background.sky.map_or(Ok(()), |sky| sky.write(out))
}

impl ImageFile {
    /// The image that a key names, if it is written.
    pub(crate) fn read(table: &Reader<'_>, name: &str, folder: &Path) -> Option<Self> {
        table.written(name)?;
        let as_written = table.text(name);
        Some(Self { path: folder.join(&as_written), as_written })
    }
}

impl Scene {
    /// Whether the background lights the scene.
    #[must_use]
    pub fn background_lights(&self) -> bool {
        self.render.integrator != Integrator::Direct && self.background.lights.unwrap_or(true)
    }
}

/// What is wrong with a background that is to light a scene in which light comes from lights only.
pub(crate) fn problem(document: &Node, scene: &Scene) -> Option<Problem> {
    let asked = scene.background.lights == Some(true);
    if !asked || scene.render.integrator != Integrator::Direct {
        return None;
    }
    let node = document.get("background").and_then(|table| table.get("lights"));
    Some(Problem {
        origin: node.map_or(document.origin, |node| node.origin),
        path: "background.lights".into(),
        message: "found true, expected false where render.integrator is \"direct\": light then comes from the lights \
                  only; set integrator = \"sky\" or \"path\", or remove the key"
            .into(),
    })
}

impl Default for Background {
    fn default() -> Self {
        Self::read(&Reader::defaults(&BACKGROUND), Path::new(""))
    }
}

/// What there can be instead of one colour.
const INSTEAD: [&str; 3] = ["environment", "sky", "gradient"];

/// The background is one thing. The colour that a point file rendered directly gets gives way.
fn background_is_one(background: &Reader<'_>) -> Result<(), Fault> {
    let is_asked_for = |name: &&str| {
        let node = background.written(name);
        node.is_some_and(|node| *name != "color" || node.origin != Origin::Given)
    };
    let mut found = std::iter::once("color").chain(INSTEAD).filter(is_asked_for);
    if let (Some(first), Some(second)) = (found.next(), found.next()) {
        let message = format!("found both {first} and {second}, expected one of them; remove one");
        return Err((second, message));
    }
    let turns = background.vector("rotate") != [0.0; 3];
    if !turns || background.written("environment").is_some() {
        return Ok(());
    }
    let advice = match background.written("sky") {
        Some(_) => "turn the sky by sky.azimuth or sky.sun, and remove rotate",
        None => "add environment, or remove rotate",
    };
    let message =
        format!("found angles, expected none without environment, which they turn; {advice}");
    Err(("rotate", message))
}
