//! A tree of boxes over points along a curve, and searches for what is around one of them.

use super::{Gone, NEIGHBORS};
use rayon::prelude::*;

/// Boxes around eight points that follow each other on a curve, around eight of these, and so on: the tree of a
/// device's neighbour search, on the CPU. Made in a hundredth of the time of a k-d tree, for few searches.
pub(super) struct Boxes<'a> {
    points: &'a [[f32; 3]],
    /// Around points first.
    levels: Vec<Vec<Box3>>,
    /// The neighbour whose distance measures density: [`NEIGHBORS`], or fewer in a small set.
    pub neighbors: usize,
}

const FAN: usize = 8;

/// A box, by its lowest and highest corner.
pub(super) type Box3 = [[f32; 3]; 2];
pub(super) const EMPTY: Box3 = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];

pub(super) fn join([low, high]: Box3, [low_too, high_too]: Box3) -> Box3 {
    [
        [0, 1, 2].map(|axis| low[axis].min(low_too[axis])),
        [0, 1, 2].map(|axis| high[axis].max(high_too[axis])),
    ]
}

/// What is around a point.
pub(super) struct Around {
    /// Distance to the nearest other.
    pub nearest: f64,
    /// Distance to the [`NEIGHBORS`]-th nearest.
    pub farthest: f64,
    /// Which that is.
    pub last: u32,
    /// The nearest other.
    pub first: u32,
}

impl<'a> Boxes<'a> {
    pub(super) fn new(points: &'a [[f32; 3]]) -> Self {
        let mut levels: Vec<Vec<Box3>> = vec![
            points
                .par_chunks(FAN)
                .map(|few| few.iter().map(|&p| [p, p]).fold(EMPTY, join))
                .collect(),
        ];
        while let Some(below) = levels.last().filter(|below| below.len() > FAN) {
            let above = below.par_chunks(FAN).map(|few| few.iter().copied().fold(EMPTY, join));
            let above = above.collect();
            levels.push(above);
        }
        Self { points, levels, neighbors: NEIGHBORS.min(points.len().saturating_sub(2) / 2) }
    }

    /// What is around a point, of which it is known that enough others lie within `bound`.
    pub(super) fn around(&self, at: u32, gone: &Gone, bound: f64) -> Around {
        let found = self.nearby(at, gone, bound);
        let of =
            |entry: Option<&(f64, u32)>| entry.map_or((f64::INFINITY, at), |&(d, i)| (d.sqrt(), i));
        let ((nearest, first), (farthest, last)) = (of(found.first()), of(found.last()));
        Around { nearest, farthest, last, first }
    }

    /// The nearest others, nearest first, each with the square of its distance.
    pub(super) fn nearby(&self, at: u32, gone: &Gone, bound: f64) -> Vec<(f64, u32)> {
        let bound = bound * bound * (1.0 + 1e-9);
        let neighbors = self.neighbors;
        let center = self.points[at as usize];
        let top = self.levels.len() - 1;
        // Nearest first: (square, place on the curve).
        let mut found: Vec<(f64, u32)> = Vec::with_capacity(neighbors + 1);
        let mut stack: Vec<(f64, usize, usize)> = Vec::with_capacity(64);
        let push = |stack: &mut Vec<_>, level: usize, range: std::ops::Range<usize>| {
            let before = stack.len();
            stack.extend(
                range.map(|node| (square_to(center, &self.levels[level][node]), level, node)),
            );
            stack[before..].sort_unstable_by(|a: &(f64, usize, usize), b| b.0.total_cmp(&a.0));
        };
        push(&mut stack, top, 0..self.levels[top].len());
        while let Some((away, level, node)) = stack.pop() {
            let is_full = found.len() == neighbors;
            if away > bound || (is_full && found.last().is_some_and(|worst| away > worst.0)) {
                continue;
            }
            if level > 0 {
                let children = node * FAN..self.levels[level - 1].len().min((node + 1) * FAN);
                push(&mut stack, level - 1, children);
                continue;
            }
            for other in node * FAN..self.points.len().min((node + 1) * FAN) {
                if other == at as usize || gone.flags[other] {
                    continue;
                }
                let candidate = (square(center, self.points[other]), other as u32);
                let place = found.partition_point(|f| *f < candidate);
                if place < neighbors {
                    found.truncate(neighbors - 1);
                    found.insert(place, candidate);
                }
            }
        }
        found
    }
}

fn square_to(p: [f32; 3], [low, high]: &[[f32; 3]; 2]) -> f64 {
    let away = |axis: usize| {
        let p = f64::from(p[axis]);
        (f64::from(low[axis]) - p).max(p - f64::from(high[axis])).max(0.0)
    };
    [0, 1, 2].map(away).iter().map(|x| x * x).sum()
}

pub(super) fn square(a: [f32; 3], b: [f32; 3]) -> f64 {
    [0, 1, 2].map(|axis| (f64::from(b[axis]) - f64::from(a[axis])).powi(2)).iter().sum()
}
