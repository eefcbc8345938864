//! The sets that can be generated: one row each.

use crate::color::{oklch, srgb_bytes};
use crate::vector::{Vector, scale};
use crate::{figure, filling, implicit, room, sphere, terrain, tube};
use clap::ValueEnum;
use points::PlyPoints as Points;
use std::f64::consts::TAU;
use std::fmt::Write;

/// A set of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Set {
    /// The unit sphere.
    Sphere,
    /// A torus about the y axis, radii 1 and 0.4.
    Torus,
    /// A tube along a trefoil knot, coloured along its length.
    Trefoil,
    /// Rolling land within a ring of hills, coloured by height.
    Terrain,
    /// A hare that sits, about 1.5 high.
    Hare,
    /// A slab of 4 by 1 by 3 with rounded edges.
    Slab,
    /// A square of dunes, 8 by 8, level in the middle.
    Dunes,
    /// A flat square, 8 by 8.
    Floor,
    /// A cloud of smoke about 2 across, in whirls, with its `density`.
    Smoke,
    /// The hare with points inside of it, whose `skin` is 0, and a `density`.
    FilledHare,
    /// A jet that swirls and mixes, 3 long, on a grid that is finer towards its axis, with its `density`.
    Swirl,
    /// A stream around two pillars, 4 by 1.2 by 2, with its `speed`.
    Stream,
    /// A chain of blobs, about 2 across, at random places of a lattice, with its `density` of 0 to 255.
    Molecule,
    /// Particles of a drop that falls into a pool, with their `density` of 1.
    Splash,
    /// A room with things in it as two laser scanners find it, coloured.
    Room,
}

impl Set {
    /// Points where `--count` is not given.
    pub fn usual_count(self) -> u32 {
        match self {
            Self::Sphere => 4_000,
            Self::Torus => 20_000,
            Self::Trefoil => 36_000,
            Self::Terrain => 56_000,
            Self::Hare => 36_000,
            Self::Slab => 24_000,
            Self::Dunes => 40_000,
            Self::Floor => 6_000,
            Self::Room => 90_000,
            Self::Smoke => 40_000,
            Self::FilledHare => 44_000,
            Self::Swirl => 30_000,
            Self::Stream => 30_000,
            Self::Molecule => 24_000,
            Self::Splash => 36_000,
        }
    }

    fn name_and_help(self) -> (String, String) {
        let value = self.to_possible_value();
        let help = value.as_ref().and_then(|v| v.get_help()).map(ToString::to_string);
        (value.map(|v| v.get_name().to_owned()).unwrap_or_default(), help.unwrap_or_default())
    }

    /// What the PLY file says about itself.
    pub fn comment(self) -> String {
        let (name, help) = self.name_and_help();
        format!("generate-points {name}: {help}")
    }

    /// The points.
    pub fn points(self, count: u32) -> Points {
        let plain = |positions| Points { positions, ..Points::default() };
        match self {
            Self::Sphere => plain(sphere::fibonacci(count)),
            Self::Hare => {
                let [low, high] = figure::HARE_BOX;
                plain(implicit::even_points(figure::hare, low, high, count))
            }
            Self::Slab => {
                let [low, high] = figure::SLAB_BOX;
                plain(implicit::even_points(figure::slab, low, high, count))
            }
            Self::Dunes => plain(terrain::square(terrain::DUNES, terrain::dunes, count)),
            Self::Floor => plain(terrain::square(terrain::DUNES, |_, _| 0.0, count)),
            Self::Torus => {
                let ring = tube::even_points(|t| [t.cos(), 0.0, -t.sin()], 0.4, count);
                plain(ring.iter().map(|p| p.position).collect())
            }
            Self::Trefoil => {
                let knot = tube::even_points(trefoil, 0.175, count);
                Points {
                    positions: knot.iter().map(|p| p.position).collect(),
                    colors: knot.iter().map(|p| srgb_bytes(hue_circle(p.along))).collect(),
                    ..Points::default()
                }
            }
            Self::Terrain => coloured(terrain::points(count)),
            Self::Room => coloured(room::points(count)),
            Self::Smoke => filling::smoke(count),
            Self::FilledHare => filling::filled_hare(count),
            Self::Swirl => filling::swirl(count),
            Self::Stream => filling::stream(count),
            Self::Molecule => filling::molecule(count),
            Self::Splash => filling::splash(count),
        }
    }
}

fn coloured(points: Vec<(Vector, [f64; 3])>) -> Points {
    let (positions, colors): (Vec<_>, Vec<_>) = points.into_iter().unzip();
    Points { positions, colors: colors.into_iter().map(srgb_bytes).collect(), ..Points::default() }
}

/// The trefoil knot, about 2 across, its lobes in the plane of x and y, one lobe down.
fn trefoil(t: f64) -> Vector {
    let [x, y] = [t.sin() + 2.0 * (2.0 * t).sin(), t.cos() - 2.0 * (2.0 * t).cos()];
    scale(1.0 / 3.0, [x, y, -(3.0 * t).sin()])
}

/// All hues once, yellow (0.3 of a turn) the lightest, as in pigments.
fn hue_circle(along: f64) -> [f64; 3] {
    let yellowness = (TAU * (along - 0.3)).cos();
    oklch(0.70 + 0.08 * yellowness, 0.15, along)
}

/// One line a set: name, usual number of points, what it is.
pub fn listing() -> String {
    let mut lines = String::new();
    for &set in Set::value_variants() {
        let (name, help) = set.name_and_help();
        // Writing to a string cannot fail.
        let _ = writeln!(lines, "{name:<10} {:>7} points  {help}", set.usual_count());
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use points::encode_ply as encode;
    use std::path::Path;

    /// The committed files, byte for byte up to the platform's sine and cosine: one unit in the last
    /// place of a coordinate is at most 2e-6 at 30, the land's radius.
    #[test]
    fn committed_point_files_are_what_this_program_writes() {
        for &set in Set::value_variants().iter().filter(|&&set| set != Set::Torus) {
            let (name, _) = set.name_and_help();
            let path =
                Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenes/points/{name}.ply"));
            let committed = std::fs::read(&path).expect("the committed file");
            let points = set.points(set.usual_count());
            let fresh = encode(&set.comment(), &points);
            assert_eq!(committed.len(), fresh.len(), "{name}: length");
            let colors = if points.colors.is_empty() { 0 } else { 3 };
            let record = 12 + colors + 4 * points.attributes.len();
            let header = fresh.len() - record * points.positions.len();
            assert_eq!(committed[..header], fresh[..header], "{name}: header");
            let records = committed[header..].chunks(record).zip(fresh[header..].chunks(record));
            for (place, (old, new)) in records.enumerate() {
                let attributes = (0..points.attributes.len()).map(|i| 12 + colors + 4 * i);
                for at in [0, 4, 8].into_iter().chain(attributes) {
                    let value = |bytes: &[u8]| {
                        f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
                    };
                    let difference = (value(old) - value(new)).abs();
                    assert!(difference <= 4e-6, "{name}: point {place} differs by {difference}");
                }
                for (a, b) in old[12..12 + colors].iter().zip(&new[12..12 + colors]) {
                    assert!(a.abs_diff(*b) <= 1, "{name}: colour of point {place}");
                }
            }
        }
    }

    #[test]
    fn every_set_gives_as_many_points_as_asked_for() {
        for &set in Set::value_variants() {
            let points = set.points(100);
            assert_eq!(points.positions.len(), 100, "{set:?}");
            assert!(points.positions.iter().flatten().all(|x| x.is_finite()), "{set:?}");
        }
    }
}
