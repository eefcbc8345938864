//! Normals smoothed over the surface and not over its edges, and points moved after them.

use super::FAN;
use super::lanes::exp_negative;
use super::near::{Near, Scratch};
use rayon::prelude::*;

/// Rounds, and the neighbours of each.
pub(super) const ROUNDS: usize = 3;
const NEIGHBORS: usize = 24;
/// The width of the weights over the distance to the last neighbour.
const WIDTH: f32 = 0.6;
/// Normals that differ by less are those of one surface, in radians: 12 degrees at least, three times the expected
/// error, 30 degrees at most.
const LEAST: f32 = 12.0 / 180.0 * std::f32::consts::PI;
const MOST: f32 = 30.0 / 180.0 * std::f32::consts::PI;
const ERRORS: f32 = 3.0;

/// A point on its way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Oriented {
    pub position: [f32; 3],
    pub normal: [f32; 3],
    /// The expected error of the normal, in radians.
    pub error: f32,
    /// Whether the normal looks at the sensor that saw the point: then the other side of a thin thing is another surface.
    pub is_seen: bool,
}

impl Oriented {
    /// The cosine between normals, where each may look to either side; or, where both look at their sensors, as it is.
    fn cosine_to(&self, other: &Self, normal: [f32; 3]) -> [f32; 2] {
        let cosine = dot(other.normal, normal);
        let sign = if self.is_seen && other.is_seen { 1.0 } else { 1f32.copysign(cosine) };
        [cosine * sign, sign]
    }
}

/// 1 - cos(a) for a up to [`MOST`], within 1e-7.
fn one_minus_cosine(a: f32) -> f32 {
    let square = a * a;
    square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0)))
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

/// One round.
pub(super) fn filter(points: &mut Vec<Oriented>) {
    if points.len() <= NEIGHBORS {
        return;
    }
    let positions: Vec<[f32; 3]> = points.iter().map(|point| point.position).collect();
    let near = Near::new(&positions);
    let mut filtered = points.clone();
    let chunks = filtered.par_chunks_mut(FAN).enumerate();
    chunks.with_min_len(64).for_each_init(Scratch::default, |scratch, (group, filtered)| {
        let places = near.group(group);
        let bounds = places.clone().map(|at| near.bound(at, NEIGHBORS, scratch));
        let radius = bounds.flatten().fold(0.0, f32::max).sqrt();
        near.gather(group, radius, scratch);
        for (at, to) in places.zip(filtered) {
            if let Some(farthest) = near.select(at, NEIGHBORS, radius, scratch) {
                *to = filtered_point(points, at, farthest, scratch);
            }
        }
    });
    *points = filtered;
}

fn filtered_point(points: &[Oriented], at: usize, farthest: f32, scratch: &Scratch) -> Oriented {
    let own = points[at];
    let width = farthest * (WIDTH * WIDTH);
    if width <= 0.0 {
        return own;
    }
    let others = || {
        let near = scratch.within(farthest);
        near.map(|(entry, square)| (&points[scratch.places[entry] as usize], square / width))
    };
    let weight = |other: &Oriented, away: f32, cosine: f32| {
        let angle = (ERRORS * other.error.min(own.error)).clamp(LEAST, MOST);
        exp_negative(-away - (1.0 - cosine).max(0.0) / one_minus_cosine(angle))
    };
    let mut sum = [0.0; 3];
    for (other, away) in others() {
        let [cosine, sign] = own.cosine_to(other, own.normal);
        let weight = weight(other, away, cosine) * sign;
        sum = [0, 1, 2].map(|axis| sum[axis] + weight * other.normal[axis]);
    }
    let length = dot(sum, sum).sqrt();
    if length <= 0.0 {
        return own;
    }
    let normal = sum.map(|x| x / length);
    let (mut total, mut height) = (0.0, 0.0);
    for (other, away) in others() {
        let [cosine, sign] = own.cosine_to(other, normal);
        let weight = weight(other, away, cosine);
        let way = [0, 1, 2].map(|axis| other.position[axis] - own.position[axis]);
        total += weight;
        height += weight * dot(way, other.normal) * sign;
    }
    let height = height / total;
    let position = [0, 1, 2].map(|axis| own.position[axis] + height * normal[axis]);
    Oriented { position, normal, ..own }
}
