//! Where a diffuse surface takes its albedo from.

use crate::color_map::range_fits_scale;
use crate::document::Value;
use crate::keys::{Absent, Fault, Key, Kind, SHARE, key, numbers};
use crate::read::{Reader, to_vector};
use crate::settings::quoted;
use crate::{ColorMap, ImageFile, Scale};
use std::fmt::{self, Write};
use std::path::Path;

/// Where a diffuse surface takes its albedo from.
#[derive(Debug, Clone, PartialEq)]
pub enum Albedo {
    /// The points' own colours where they have them, else 0.8.
    Default,
    /// The points' own colours; a point set without is an error of the renderer's.
    Points,
    /// One colour, each 0 to 1.
    Color([f64; 3]),
    /// An attribute of the points, or `x`, `y` or `z` where they have none of that name.
    Attribute {
        /// Its name; a point set without it is an error of the renderer's.
        name: String,
        /// The colours that it is shown in.
        color_map: ColorMap,
        /// Values at the two ends of the map; the attribute's own where `None`.
        range: Option<[f64; 2]>,
        /// How values lie between these.
        scale: Scale,
    },
    /// An image.
    Texture {
        /// Which.
        file: ImageFile,
        /// How it lies; where `None`, by u and v if the points have them, else along y.
        axis: Option<TextureAxis>,
    },
}

/// How a texture lies on an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextureAxis {
    /// Projected along x over the bounding box of the points, in the file's coordinates.
    X,
    /// Along y.
    Y,
    /// Along z.
    Z,
    /// By the points' own u and v.
    Uv,
}

impl Albedo {
    pub(crate) fn read(table: &Reader<'_>, folder: &Path) -> Self {
        if let Some(file) = ImageFile::read(table, "texture", folder) {
            let axis =
                table.written("texture_axis").map(|_| match table.text("texture_axis").as_str() {
                    "x" => TextureAxis::X,
                    "z" => TextureAxis::Z,
                    "uv" => TextureAxis::Uv,
                    _ => TextureAxis::Y,
                });
            return Self::Texture { file, axis };
        }
        match table.written("albedo").map(|node| &node.value) {
            None => Self::Default,
            Some(Value::Text(text)) => match text.strip_prefix("attribute:") {
                Some(name) => Self::Attribute {
                    name: name.trim().to_owned(),
                    color_map: ColorMap::read(&table.text("color_map")),
                    range: table.written_range("value_range"),
                    scale: Scale::read(&table.text("scale")),
                },
                None => Self::Points,
            },
            Some(value) => to_vector(value)
                .map_or_else(|| table.unlike("an albedo", "albedo", value), Self::Color),
        }
    }
}

/// A material has an albedo or a texture, and what belongs to one of them only with that.
pub(super) fn albedo_is_one(material: &Reader<'_>) -> Result<(), Fault> {
    let has = |name: &str| material.written(name).is_some();
    if has("albedo") && has("texture") && material.text("kind") == "diffuse" {
        let message = "found both albedo and texture, expected one of them; remove one";
        return Err(("texture", message.into()));
    }
    if has("texture_axis") && !has("texture") {
        let message = "belongs to a texture, but there is none; add texture, or remove it";
        return Err(("texture_axis", message.into()));
    }
    let albedo = material.written("albedo").map(|node| &node.value);
    let of_attribute = matches!(albedo, Some(Value::Text(text)) if text != "points");
    range_fits_scale(material)?;
    for name in ["color_map", "value_range", "scale"] {
        if has(name) && !of_attribute {
            let message = "belongs to the albedo of an attribute, but there is none; write albedo = \
                           \"attribute:NAME\", or remove it";
            return Err((name, message.into()));
        }
    }
    Ok(())
}

pub(super) fn write(out: &mut String, albedo: &Albedo) -> fmt::Result {
    match albedo {
        // The default depends on the points, so it has no value to write.
        Albedo::Default => Ok(()),
        Albedo::Points => writeln!(out, "albedo = \"points\""),
        Albedo::Color(color) => writeln!(out, "albedo = {color:?}"),
        Albedo::Attribute { name, color_map, range, scale } => {
            writeln!(out, "albedo = {}", quoted(&format!("attribute:{name}")))?;
            writeln!(out, "color_map = \"{}\"", color_map.name())?;
            writeln!(out, "scale = \"{}\"", scale.name())?;
            match range {
                Some(range) => writeln!(out, "value_range = {range:?}"),
                None => Ok(()),
            }
        }
        Albedo::Texture { file, axis } => {
            writeln!(out, "texture = {}", quoted(&file.as_written))?;
            let axis = match axis {
                // The default depends on the points.
                None => return Ok(()),
                Some(TextureAxis::X) => "x",
                Some(TextureAxis::Y) => "y",
                Some(TextureAxis::Z) => "z",
                Some(TextureAxis::Uv) => "uv",
            };
            writeln!(out, "texture_axis = \"{axis}\"")
        }
    }
}

pub(super) const KEYS: &[Key] = &[
    key(
        "albedo",
        Kind::Either(&[
            Kind::Choice(&["points"]),
            Kind::Prefixed("attribute:", "the name of an attribute of the points"),
            SHARE,
        ]),
        Absent::Words("the points' own colours where they have them, else 0.8", "[0.8, 0.8, 0.8]"),
        "Diffuse: the share of light scattered back; `\"points\"` takes the points' own \
         colours, `\"attribute:NAME\"` shows an attribute (or x, y, z of the file) through \
         `color_map`.",
    ),
    key(
        "color_map",
        Kind::Choice(&ColorMap::NAMES),
        Absent::Value("\"viridis\""),
        "Colours of an attribute, from the lower end of `value_range` to the upper one.",
    ),
    key(
        "value_range",
        Kind::Pair(numbers(-1e300, 1e300, "in the attribute's unit")),
        Absent::Words("the attribute's own range", "[0.0, 1.0]"),
        "Values of an attribute at the two ends of `color_map`, also the greater one first; what lies beyond \
         has their colours.",
    ),
    key(
        "scale",
        Kind::Choice(&Scale::NAMES),
        Absent::Value("\"linear\""),
        "How values of an attribute lie between the ends of `value_range`: `log`, by their logarithms, for what \
         spans decades. Values of 0 or less have the colour of the lower end, and the attribute's own range \
         begins at its smallest positive value then.",
    ),
    key(
        "texture",
        Kind::Text("the path of an image"),
        Absent::Words("none", "\"grass.png\""),
        "Diffuse, instead of `albedo`: an image (PNG, JPEG, EXR, HDR) over the object; see \
         `texture_axis`.",
    ),
    key(
        "texture_axis",
        Kind::Choice(&["x", "y", "z", "uv"]),
        Absent::Words("`\"uv\"` where the points have u and v, else `\"y\"`", "\"y\""),
        "Projects `texture` along an axis over the bounding box of the points, in the file's \
         coordinates, before the transform. Seen from the positive axis: `\"y\"` has x to the right and z \
         downwards, `\"z\"` has x to the right and y upwards, `\"x\"` has -z to the right and y \
         upwards. `\"uv\"` takes the points' attributes u and v (or s and t, texture_u and \
         texture_v); v counts upwards from the bottom row.",
    ),
];
