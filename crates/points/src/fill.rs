//! Points inside a surface, with scalars: a volume of whatever encloses one.
//!
//! The same surface gives the same points on every machine: places are drawn by number, from [`random`].

mod solid;

use crate::dimension::Dimension;
use crate::ply::PlyPoints;
use crate::set::PointSet;
use crate::strays::{Strays, rough_origin};
use crate::watch::Watch;
use rayon::prelude::*;
use solid::Solid;

/// A position.
type Vector = [f64; 3];

/// Places that are drawn, at most, for each that is to be inside: a box of which less than a ten-thousandth is inside
/// holds none.
const TRIES: u32 = 10_000;
/// Places that are looked at together.
const BLOCK: u32 = 1 << 16;
/// Part of the longest side that coordinates have to resolve; where 32 bits do not, 64 are written.
const RESOLVED: f64 = 1e-6;

/// Why there is nothing to write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NotFilled {
    /// The points enclose no inside.
    NoInside,
    /// The watcher asked for an end.
    Interrupted,
}

/// Points of a surface, and `count` inside it, with `boundary` (1 on the surface, 0 inside), `depth` (0 on the surface,
/// 1 at the deepest point) and `density` (whirls, 0 to 1). `reach` is half the width of holes that are closed, over the
/// longest side of the box around the points but for strays, which decide nothing.
///
/// # Errors
/// Where nothing is inside, or the watcher asked for an end.
pub fn filled(
    surface: &[Vector],
    count: u32,
    reach: f64,
    watch: &dyn Watch,
) -> Result<PlyPoints, NotFilled> {
    let bound = |axis: usize| {
        let along = || surface.iter().map(|p| p[axis]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    let longest = (0..3).map(bound).fold(0.0, f64::max);
    if !(longest > 0.0 && longest.is_finite()) {
        return Err(NotFilled::NoInside);
    }
    watch.stage("looking for the inside", surface.len() as u64);
    let strays = rough_origin(&[surface])
        .and_then(|origin| Strays::find_watched(surface, origin, watch, 0))
        .ok_or(NotFilled::Interrupted)?;
    // One stray point would make cells of the others too few for any inside.
    let positions = without(surface, &strays.places);
    let file_index = (0..positions.len() as u32).collect();
    let bulk = PointSet { positions, file_index, ..PointSet::default() };
    let [least, most] = strays.bulk;
    let longest = (0..3).map(|axis| most[axis] - least[axis]).fold(0.0, f64::max);
    if longest <= 0.0 {
        return Err(NotFilled::NoInside);
    }
    let solid = Solid::new(&bulk.positions, reach * longest);
    let fills_space = || Dimension::of(&bulk).is_volume();
    if !solid.has_inside() || !(solid.encloses() || fills_space()) {
        return Err(NotFilled::NoInside);
    }
    let inside = drawn(&solid, count, watch)?;
    let deepest = inside.iter().map(|&(_, depth)| depth).fold(0.0, f64::max);
    let depths =
        surface.iter().map(|_| 0.0).chain(inside.iter().map(|&(_, depth)| depth / deepest));
    let depths = rounded(depths);
    let positions: Vec<Vector> =
        surface.iter().copied().chain(inside.iter().map(|&(p, _)| p)).collect();
    let place = |p: &Vector| [0, 1, 2].map(|a| 4.0 * (p[a] - solid.low[a]) / longest);
    let density = rounded(positions.iter().map(|p| 0.5 + 0.5 * whirls(place(p))));
    let boundary = (0..positions.len()).map(|i| f64::from(u8::from(i < surface.len())));
    let boundary = rounded(boundary);
    let farthest = surface.as_flattened().iter().fold(0.0, |far: f64, x| x.abs().max(far));
    let double = farthest * f64::from(f32::EPSILON) > RESOLVED * longest;
    let attributes = vec![("boundary", boundary), ("depth", depths), ("density", density)];
    Ok(PlyPoints { positions, attributes, double, ..PlyPoints::default() })
}

/// The points but those at some places, which ascend.
fn without(points: &[Vector], places: &[u32]) -> Vec<Vector> {
    let mut left_out = places.iter().peekable();
    let kept = (0u32..).zip(points).filter(|(at, _)| left_out.next_if_eq(&at).is_none());
    kept.map(|(_, &p)| p).collect()
}

/// The first `count` places of the box that are inside, with their depths.
fn drawn(solid: &Solid, count: u32, watch: &dyn Watch) -> Result<Vec<(Vector, f64)>, NotFilled> {
    let tries = count.saturating_mul(TRIES);
    watch.stage("filling", count.into());
    let mut inside: Vec<(Vector, f64)> = Vec::new();
    let mut first = 0;
    while inside.len() < count as usize && first < tries {
        if watch.interrupted() {
            return Err(NotFilled::Interrupted);
        }
        let block = first..tries.min(first.saturating_add(BLOCK));
        first = block.end;
        let found = block.into_par_iter().filter_map(|number| {
            let p = random_point(solid.low, solid.high, number);
            Some((p, solid.depth(p)?))
        });
        inside.par_extend(found);
        watch.done(inside.len().min(count as usize) as u64);
    }
    inside.truncate(count as usize);
    if inside.len() < count as usize { Err(NotFilled::NoInside) } else { Ok(inside) }
}

/// A point of the box, the same for the same number.
#[must_use]
pub fn random_point(low: Vector, high: Vector, number: u32) -> Vector {
    [0, 1, 2].map(|axis| {
        let part = random(f64::from(number), 1000.0 + axis as f64);
        low[axis] + part * (high[axis] - low[axis])
    })
}

/// A number from 0 to 1 for a pair of whole numbers, which looks random and is the same everywhere.
#[must_use]
pub fn random(i: f64, j: f64) -> f64 {
    let [i, j] = [i, j].map(|x| x as i64 as u64);
    let mut bits = i.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ j.wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    bits = (bits ^ (bits >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 29)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// Smooth, from -1 to 1, with whirls of several sizes.
#[must_use]
pub fn whirls([x, y, z]: Vector) -> f64 {
    let wave = |k: f64, p: f64| {
        ((k * x + p).sin() + (k * y + 2.0 * p + (k * z).cos()).sin() + (k * z - p).cos()) / 3.0
    };
    0.6 * wave(3.1, 0.3) + 0.3 * wave(6.7, 1.9) + 0.1 * wave(13.0, 4.0)
}

fn rounded(values: impl Iterator<Item = f64>) -> Vec<f32> {
    values.map(|value| value as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Unwatched;

    /// Even points of a sphere about this center.
    fn sphere(center: Vector, radius: f64) -> Vec<Vector> {
        let count = 5000;
        let point = |i: u32| {
            let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let (sin, cos) = (f64::from(i) * 2.399_963_229_728_653).sin_cos();
            let out = (1.0 - y * y).sqrt();
            [out * cos, y, out * sin]
        };
        (0..count)
            .map(|i| {
                let p = point(i);
                [0, 1, 2].map(|axis| center[axis] + radius * p[axis])
            })
            .collect()
    }

    #[test]
    fn a_ball_is_filled_and_says_what_is_what() {
        let surface = sphere([0.0; 3], 2.0);
        let filled = filled(&surface, 3000, 0.06, &Unwatched).unwrap();
        assert_eq!(filled.positions.len(), 8000);
        assert_eq!(filled.positions[..5000], surface, "the surface first, as it was");
        let [boundary, depth, density] = [0, 1, 2].map(|i| &filled.attributes[i].1);
        assert_eq!(
            filled.attributes.iter().map(|a| a.0).collect::<Vec<_>>(),
            ["boundary", "depth", "density"]
        );
        for (at, p) in filled.positions.iter().enumerate() {
            let radius = p.iter().map(|x| x * x).sum::<f64>().sqrt();
            let skin = at < 5000;
            assert_eq!((boundary[at] == 1.0, depth[at] == 0.0), (skin, skin));
            assert!((0.0..=1.0).contains(&density[at]), "{}", density[at]);
            if !skin {
                // Two cells of a 144th of the diameter, and the deepest point is not quite the middle.
                assert!(radius < 2.06, "{p:?}");
                assert!((f64::from(depth[at]) - (1.0 - radius / 2.0)).abs() < 0.06, "{p:?}");
            }
        }
        assert!(!filled.double);
    }

    /// 32 bits have steps of half a metre at a northing of 4 000 000 metres.
    #[test]
    fn coordinates_far_out_are_written_in_64_bits() {
        let surface = sphere([500_000.0, 4_000_000.0, 100.0], 5.0);
        let filled = filled(&surface, 100, 0.06, &Unwatched).unwrap();
        assert!(filled.double);
        let bytes = crate::encode_ply("test", &filled);
        let set = crate::read_bytes(&bytes, "far.ply".as_ref(), &crate::ReadOptions::default());
        assert_eq!(set.unwrap().positions, filled.positions);
    }

    /// One return of the sky, or a row of zeros: the same points inside as without.
    #[test]
    fn a_stray_point_changes_nothing_inside() {
        let surface = sphere([0.0; 3], 2.0);
        let inside = filled(&surface, 500, 0.06, &Unwatched).unwrap();
        for stray in [[1e4, 2e4, 3e4], [-650_000.0, -4_900_000.0, 0.0], [0.0, 30.0, 0.0]] {
            let mut with = surface.clone();
            with.insert(77, stray);
            let found = filled(&with, 500, 0.06, &Unwatched).unwrap();
            assert_eq!(found.positions[5001..], inside.positions[5000..], "{stray:?}");
            assert_eq!(found.positions[77], stray);
        }
    }

    /// Points of a square, at heights.
    fn sheet(height: impl Fn(f64, f64, u32) -> f64) -> Vec<Vector> {
        let place = |i: u32| [i % 50, i / 50].map(|x| f64::from(x) / 24.5 - 1.0);
        (0..2500).map(|i| (place(i), i)).map(|([x, z], i)| [x, height(x, z, i), z]).collect()
    }

    #[test]
    fn what_encloses_nothing_is_not_filled() {
        let ball = sphere([0.0; 3], 1.0);
        let half = || ball.iter().filter(|p| p[1] < 0.0).copied();
        for surface in [
            sheet(|_, _, _| 0.0),
            sheet(|x, _, _| 0.1 * (3.0 * x).sin()),
            sheet(|x, z, _| 0.2 * (9.0 * x).sin() * (9.0 * z).sin()),
            sheet(|_, _, i| 0.05 * random(i.into(), 1.0)),
            half().collect(),
            vec![[0.0; 3], [1.0, 0.0, 0.0]],
            vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            vec![[1.0; 3]],
            Vec::new(),
            vec![[0.0; 3], [f64::INFINITY; 3]],
        ] {
            let found = filled(&surface, 10, 0.06, &Unwatched);
            assert!(found == Err(NotFilled::NoInside), "{} points", surface.len());
        }
    }
}
