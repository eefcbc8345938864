//! `[[lights]]`.

use crate::keys::Absent::{Required, Value};
use crate::keys::{Fault, Kind, LARGE, POSITION, Table, key, key_of, numbers};
use crate::read::Reader;
use crate::whole::long_enough;
use std::fmt::{self, Write};

/// A light. Every surface blocks it fully, but for those between media of one index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// Light from infinitely far away.
    Directional {
        /// The way the light travels, any length from 1e-12; not normalised.
        direction: [f64; 3],
        /// On a surface that faces the light, W m⁻², each 0 to 1e15.
        irradiance: [f64; 3],
        /// Angle between opposite places of its rim in degrees, 0 to 179.9; 0 casts hard shadows.
        angle: f64,
    },
    /// Light from a point, equal in all directions.
    Point {
        /// World position, each -1e15 to 1e15.
        position: [f64; 3],
        /// Radiant intensity I, W sr⁻¹, each 0 to 1e15: irradiance is I/r².
        intensity: [f64; 3],
        /// Of the sphere that it is, 0 to 1e15; 0 casts hard shadows.
        radius: f64,
    },
    /// A point light in the camera's eye; where rays are parallel, light along the line of sight.
    Headlight {
        /// Irradiance on a surface that faces it at the distance of the target, W m⁻², each 0 to 1e15.
        at_target: [f64; 3],
    },
}

pub(crate) static LIGHTS: Table = Table {
    header: "[[lights]]",
    doc: "A light. A scene without lights is black wherever it is diffuse.",
    whole: Some(direction_has_a_length),
    keys: &[
        key(
            "kind",
            Kind::Choice(&["directional", "point", "headlight"]),
            Required("\"directional\""),
            "Light from infinitely far away, from a point, or from the camera's eye (along its line of sight \
             where rays are parallel), where no shadow is seen.",
        ),
        key_of(
            "directional",
            "direction",
            Kind::Direction,
            Required("[-0.4, -1.0, -0.3]"),
            "The way the light travels; any length.",
        ),
        key_of(
            "directional",
            "irradiance",
            Kind::Vector(numbers(0.0, LARGE, "W m⁻², linear RGB")),
            Required("[3.0, 3.0, 3.0]"),
            "On a surface that faces the light.",
        ),
        key_of(
            "directional",
            "angle",
            Kind::Number(numbers(0.0, 179.9, "degrees")),
            Value("0.0"),
            "Angle that the light's disc on the sky is wide; the sun's is 0.53. More than 0 makes \
             soft shadows, with `image.samples` over 1.",
        ),
        key_of("point", "position", POSITION, Required("[1.0, 2.0, 0.0]"), "In the world."),
        key_of(
            "point",
            "intensity",
            Kind::Vector(numbers(0.0, LARGE, "W sr⁻¹, linear RGB")),
            Required("[5.0, 5.0, 5.0]"),
            "Radiant intensity I; the irradiance at distance r is I/r².",
        ),
        key_of(
            "point",
            "radius",
            Kind::Number(numbers(0.0, LARGE, "scene units")),
            Value("0.0"),
            "Radius of the sphere that shines. More than 0 makes soft shadows, with `image.samples` \
             over 1. Nothing sees the sphere itself.",
        ),
        key_of(
            "headlight",
            "at_target",
            Kind::Vector(numbers(0.0, LARGE, "W m⁻², linear RGB")),
            Required("[1.0, 1.0, 1.0]"),
            "Irradiance on a surface that faces the light, as far away as the camera's target; at r times \
             that distance it is 1/r² of it.",
        ),
    ],
};

impl Light {
    pub(crate) fn read(table: &Reader<'_>) -> Self {
        match table.text("kind").as_str() {
            "point" => Self::Point {
                position: table.vector("position"),
                intensity: table.vector("intensity"),
                radius: table.number("radius"),
            },
            "headlight" => Self::Headlight { at_target: table.vector("at_target") },
            _ => Self::Directional {
                direction: table.vector("direction"),
                irradiance: table.vector("irradiance"),
                angle: table.number("angle"),
            },
        }
    }
}

pub(crate) fn write_light(out: &mut String, light: &Light) -> fmt::Result {
    writeln!(out, "\n[[lights]]")?;
    match light {
        Light::Directional { direction, irradiance, angle } => {
            writeln!(out, "kind = \"directional\"")?;
            writeln!(out, "direction = {direction:?}")?;
            writeln!(out, "irradiance = {irradiance:?}")?;
            writeln!(out, "angle = {angle:?}")
        }
        Light::Point { position, intensity, radius } => {
            writeln!(out, "kind = \"point\"")?;
            writeln!(out, "position = {position:?}")?;
            writeln!(out, "intensity = {intensity:?}")?;
            writeln!(out, "radius = {radius:?}")
        }
        Light::Headlight { at_target } => {
            writeln!(out, "kind = \"headlight\"")?;
            writeln!(out, "at_target = {at_target:?}")
        }
    }
}

/// The direction of a directional light is long enough to be normalised.
fn direction_has_a_length(light: &Reader<'_>) -> Result<(), Fault> {
    match light.text("kind").as_str() {
        "directional" => long_enough("direction", light.vector("direction")),
        _ => Ok(()),
    }
}
