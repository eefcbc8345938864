//! Normals smoothed over the surface and not over its edges, and points moved after them.

use super::FAN;
use super::lanes::{LANES, Lanes, exp_negative, sum, wide};
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

/// 1 - cos(a) for a up to [`MOST`], within 1e-7.
fn one_minus_cosine(a: f32) -> f32 {
    let square = a * a;
    square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0)))
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
    chunks.with_min_len(64).for_each_init(
        Default::default,
        |(scratch, around): &mut (Scratch, Around), (group, filtered)| {
            let places = near.group(group);
            let bounds = places.clone().map(|at| near.bound(at, NEIGHBORS, scratch));
            let radius = bounds.flatten().fold(0.0, f32::max).sqrt();
            near.gather(group, radius, scratch);
            for (at, to) in places.zip(filtered) {
                if let Some(farthest) = near.select(at, NEIGHBORS, radius, scratch) {
                    *to = filtered_point(points, at, farthest, scratch, around);
                }
            }
        },
    );
    *points = filtered;
}

/// What is around a point, eight side by side.
#[derive(Default)]
struct Around {
    normal: [Vec<Lanes>; 3],
    /// From the point to each.
    way: [Vec<Lanes>; 3],
    /// The exponent of the distance's weight; of what fills up a lane, one whose weight is nothing.
    away: Vec<Lanes>,
    /// 1 / (1 - cos α).
    sharpness: Vec<Lanes>,
    /// 1 where both normals look at their sensors, else 0.
    seen: Vec<Lanes>,
    count: usize,
}

/// An exponent that leaves nothing.
const NOTHING: f32 = -1e9;

impl Around {
    fn clear(&mut self) {
        self.count = 0;
        let lists = self.normal.iter_mut().chain(&mut self.way);
        lists.chain([&mut self.away, &mut self.sharpness, &mut self.seen]).for_each(Vec::clear);
    }

    fn push(&mut self, own: &Oriented, other: &Oriented, away: f32) {
        let lane = self.count % LANES;
        if lane == 0 {
            let lists = self.normal.iter_mut().chain(&mut self.way);
            lists.chain([&mut self.sharpness, &mut self.seen]).for_each(|l| l.push([0.0; LANES]));
            self.away.push([NOTHING; LANES]);
        }
        let at = self.away.len() - 1;
        for axis in 0..3 {
            self.normal[axis][at][lane] = other.normal[axis];
            self.way[axis][at][lane] = other.position[axis] - own.position[axis];
        }
        let angle = (ERRORS * other.error.min(own.error)).clamp(LEAST, MOST);
        self.away[at][lane] = -away;
        self.sharpness[at][lane] = 1.0 / one_minus_cosine(angle);
        self.seen[at][lane] = if own.is_seen && other.is_seen { 1.0 } else { 0.0 };
        self.count += 1;
    }

    /// Sums over what is around, by weights about a normal: of normals turned to its side, of heights above the planes
    /// there, and of weights.
    #[inline(always)]
    fn sums(&self, about: [f32; 3]) -> [f32; 5] {
        let mut sums = [[0.0; LANES]; 5];
        let [nx, ny, nz] = &self.normal;
        let [x, y, z] = &self.way;
        for at in 0..self.away.len() {
            for i in 0..LANES {
                let n = [nx[at][i], ny[at][i], nz[at][i]];
                let cosine = (n[0] * about[0] + n[1] * about[1]) + n[2] * about[2];
                // To either side, or, where both look at their sensors, as it is.
                let turned = if cosine < 0.0 { -1.0 } else { 1.0 };
                let sign = if self.seen[at][i] > 0.0 { 1.0 } else { turned };
                let off = 1.0 - cosine * sign;
                let off = if off > 0.0 { off } else { 0.0 };
                let weight = exp_negative(self.away[at][i] - off * self.sharpness[at][i]);
                let height = (x[at][i] * n[0] + y[at][i] * n[1]) + z[at][i] * n[2];
                let signed = weight * sign;
                sums[0][i] += signed * n[0];
                sums[1][i] += signed * n[1];
                sums[2][i] += signed * n[2];
                sums[3][i] += signed * height;
                sums[4][i] += weight;
            }
        }
        sums.map(|lanes| sum(&lanes))
    }
}

fn filtered_point(
    points: &[Oriented],
    at: usize,
    farthest: f32,
    scratch: &Scratch,
    around: &mut Around,
) -> Oriented {
    let own = points[at];
    let width = farthest * (WIDTH * WIDTH);
    if width <= 0.0 {
        return own;
    }
    around.clear();
    for (entry, square) in scratch.within(farthest) {
        around.push(&own, &points[scratch.places[entry] as usize], square / width);
    }
    let [x, y, z, ..] = wide(|| around.sums(own.normal));
    let length = ((x * x + y * y) + z * z).sqrt();
    if length <= 0.0 {
        return own;
    }
    let normal = [x / length, y / length, z / length];
    let [.., height, total] = wide(|| around.sums(normal));
    let height = height / total;
    let position = [0, 1, 2].map(|axis| own.position[axis] + height * normal[axis]);
    Oriented { position, normal, ..own }
}
