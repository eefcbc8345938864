//! `[background.sky]`: a clear sky and its sun.

use crate::document::Value;
use crate::keys::Absent::{Value as Default, Words};
use crate::keys::{Fault, Kind, SHARE, Table, key, numbers};
use crate::read::{Reader, to_number, to_vector};
use crate::whole::long_enough;
use std::fmt::{self, Write};

/// A clear sky and its sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sky {
    /// Where the sun is.
    pub sun: SunPlace,
    /// Angle between opposite places of the sun's rim in degrees, 0 to 20; 0 casts hard shadows. Its irradiance is the
    /// same whatever the angle.
    pub sun_angle: f64,
    /// How hazy the air is, 1 to 10.
    pub turbidity: f64,
    /// Albedo of the ground, each 0 to 1.
    pub ground: [f64; 3],
}

/// Where the sun of a sky is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SunPlace {
    /// In this direction of the world, any length from 1e-12.
    Towards([f64; 3]),
    /// Seen from the ground.
    Angles {
        /// Above the horizon, in degrees, 0 to 90.
        elevation: f64,
        /// From the middle of the panorama to the right, in degrees, -360 to 360.
        azimuth: f64,
    },
}

pub(super) static SKY: Table = Table {
    header: "[background.sky]",
    doc: "A clear sky over a ground, by Hošek and Wilkie's model, instead of `color`. Its top is where an environment's \
          is, see `environment` above. Its radiance is in W sr⁻¹ m⁻² nm⁻¹, a mean over wavelengths weighted as the eye \
          does: around noon the sky is about 0.1, and a white surface in the sun 0.5. What is seen is the sky without the \
          sun's disc. Where the background lights the scene, the sun does so too.",
    whole: Some(sun_is_in_one_place),
    keys: &[
        key(
            "sun",
            Kind::Direction,
            Words("given by elevation and azimuth", "[0.5, 1.0, 0.6]"),
            "The direction in the world towards the sun, instead of `elevation` and `azimuth`; any length, at or above \
             the horizon.",
        ),
        key(
            "elevation",
            Kind::Number(numbers(0.0, 90.0, "degrees")),
            Default("45.0"),
            "How high the sun is over the horizon.",
        ),
        key(
            "azimuth",
            Kind::Number(numbers(-360.0, 360.0, "degrees")),
            Default("135.0"),
            "Where the sun is along the horizon: clockwise as seen from above, from the direction that is the middle of \
             an environment's image (-z where +y is up, +y where +z is). 90 is to the right of it.",
        ),
        key(
            "sun_angle",
            Kind::Number(numbers(0.0, 20.0, "degrees")),
            Default("0.53"),
            "How wide the sun's disc is, which sets how soft shadows are; 0 casts hard ones. A surface is lit as \
             brightly by a wide sun as by a narrow one.",
        ),
        key(
            "turbidity",
            Kind::Number(numbers(1.0, 10.0, "")),
            Default("3.0"),
            "How hazy the air is: 2 is very clear, 3 a clear day, 6 a warm and moist one, 10 haze.",
        ),
        key(
            "ground",
            Kind::Either(&[Kind::Number(numbers(0.0, 1.0, "")), SHARE]),
            Default("0.2"),
            "Albedo of the ground below the horizon, one number or one a channel. It brightens the sky too.",
        ),
    ],
};

impl Sky {
    pub(super) fn read(table: &Reader<'_>) -> Self {
        let ground = table.value("ground");
        Self {
            sun: match table.written("sun") {
                Some(_) => SunPlace::Towards(table.vector("sun")),
                None => SunPlace::Angles {
                    elevation: table.number("elevation"),
                    azimuth: table.number("azimuth"),
                },
            },
            sun_angle: table.number("sun_angle"),
            turbidity: table.number("turbidity"),
            ground: match (to_number(&ground), to_vector(&ground)) {
                (Some(grey), _) => [grey; 3],
                (_, Some(color)) => color,
                _ => table.unlike("an albedo", "ground", &Value::Date),
            },
        }
    }

    pub(super) fn write(&self, out: &mut String) -> fmt::Result {
        writeln!(out, "\n[background.sky]")?;
        match self.sun {
            SunPlace::Towards(sun) => writeln!(out, "sun = {sun:?}")?,
            SunPlace::Angles { elevation, azimuth } => {
                writeln!(out, "elevation = {elevation:?}")?;
                writeln!(out, "azimuth = {azimuth:?}")?;
            }
        }
        writeln!(out, "sun_angle = {:?}", self.sun_angle)?;
        writeln!(out, "turbidity = {:?}", self.turbidity)?;
        writeln!(out, "ground = {:?}", self.ground)
    }
}

impl std::default::Default for Sky {
    fn default() -> Self {
        Self::read(&Reader::defaults(&SKY))
    }
}

/// The sun is in a direction or at two angles, and a direction has a length.
fn sun_is_in_one_place(sky: &Reader<'_>) -> Result<(), Fault> {
    if sky.written("sun").is_none() {
        return Ok(());
    }
    for name in ["elevation", "azimuth"] {
        if sky.written(name).is_some() {
            let message = format!(
                "found both sun and {name}, expected sun, or elevation and azimuth; remove one"
            );
            return Err((name, message));
        }
    }
    long_enough("sun", sky.vector("sun"))
}
