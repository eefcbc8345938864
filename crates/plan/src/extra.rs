//! Further channels of an EXR that are no diagnostics: what a picture measures of its scene, beside the
//! channels that it always has.
//!
//! As diagnostics, they are made on the CPU from what the kernels write for every pixel, so a picture is the
//! same with and without them.

use crate::Volumes;

/// The most channels that one name stands for.
const MOST: usize = 6;

/// What one name of `--channels` adds that is no diagnostic: one channel or several.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extra {
    /// The world position of the first surface in two floats a coordinate.
    World,
    /// Where half of the light is lost that volumes take.
    Volume,
    /// The scalar that a volume shows for a whole ray.
    Value,
}

impl Extra {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 3] = [Self::World, Self::Volume, Self::Value];

    /// Its name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::World => "world",
            Self::Volume => "volume",
            Self::Value => "value",
        }
    }

    /// The names of its channels in files, in the order of [`Extra::values`]. No diagnostic has one of them.
    #[must_use]
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::World => {
                &["world.X", "world.Y", "world.Z", "worldLow.X", "worldLow.Y", "worldLow.Z"]
            }
            Self::Volume => &["Zv"],
            Self::Value => &["value"],
        }
    }

    /// What its values mean, in half a sentence.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        match self {
            Self::World => {
                "world position of the first surface: world.X + worldLow.X and so on, added in double \
                 precision, or 0"
            }
            Self::Volume => {
                "Zv, depth along the viewing axis of the first place where volumes have taken half of the light \
                 that they take of the camera's ray, or +inf"
            }
            Self::Value => {
                "what a volume of mode integral, average or maximum shows: the integral, mean or greatest scalar \
                 on the camera's ray, or 0"
            }
        }
    }

    /// The one of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|extra| extra.name() == name)
    }

    /// The values of its channels at one pixel; those after its last channel mean nothing. `world` is where
    /// a surface was hit, if any was, and `along` what volumes show on the camera's ray.
    pub(crate) fn values(
        self,
        world: Option<[f64; 3]>,
        along: f32,
        volumes: &Volumes,
    ) -> [f32; MOST] {
        match self {
            Self::Volume if volumes.any_marched() && !volumes.is_whole() && along >= 0.0 => {
                [along; MOST]
            }
            Self::Volume => [f32::INFINITY; MOST],
            Self::Value if volumes.is_whole() => [along; MOST],
            Self::Value => [0.0; MOST],
            Self::World => {
                let Some(world) = world else { return [0.0; MOST] };
                let [x, y, z] = world.map(|at| at as f32);
                let low = |axis: usize, high: f32| (world[axis] - f64::from(high)) as f32;
                [x, y, z, low(0, x), low(1, y), low(2, z)]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Diagnostic;

    const STANDARD: [&str; 15] = [
        "R", "G", "B", "A", "AR", "AG", "AB", "Z", "P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z",
        "object",
    ];

    #[test]
    fn no_channel_is_named_twice() {
        let mut names: Vec<&str> = STANDARD.to_vec();
        names.extend(Diagnostic::ALL.map(Diagnostic::name));
        names.extend(Extra::ALL.iter().flat_map(|extra| extra.channels()));
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
        for extra in Extra::ALL {
            assert_eq!(Extra::named(extra.name()), Some(extra));
            assert!(extra.channels().len() <= MOST);
            assert_eq!(Diagnostic::named(extra.name()), None);
        }
    }

    /// Two floats have 24 bits each, and the sign of the second is one more: 2^-49 of the position is left. f64
    /// rounds the sum itself by 2^-53.
    #[test]
    fn two_floats_hold_a_position_to_two_to_the_minus_46() {
        let world = [4.123_456_789e5, 5.432_109_876_543e6, -6.378_137_000_1e6];
        let [x, y, z, dx, dy, dz] = Extra::World.values(Some(world), 0.0, &Volumes::default());
        for (axis, (high, low)) in [(x, dx), (y, dy), (z, dz)].into_iter().enumerate() {
            let error = (f64::from(high) + f64::from(low) - world[axis]).abs();
            assert!(error <= 2f64.powi(-46) * world[axis].abs(), "axis {axis}: {error}");
            assert_eq!(high, world[axis] as f32, "the first float is the nearest");
        }
        assert_eq!(Extra::World.values(None, 0.0, &Volumes::default()), [0.0; MOST]);
    }
}
