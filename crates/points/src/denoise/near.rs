//! What is near the points of a set: candidates for eight points at a time, and the distance to the k-th of them.

use super::FAN;
use super::lanes::wide;
use rayon::prelude::*;

type Box3 = [[f32; 3]; 2];
const EMPTY: Box3 = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];

fn join([low, high]: Box3, [low_too, high_too]: Box3) -> Box3 {
    [
        [0, 1, 2].map(|axis| low[axis].min(low_too[axis])),
        [0, 1, 2].map(|axis| high[axis].max(high_too[axis])),
    ]
}

/// Points along a curve, in boxes of eight, in boxes of eight, and so on. Made in a hundredth of the time of a k-d
/// tree; eight points that follow each other share a search.
pub(super) struct Near<'a> {
    pub points: &'a [[f32; 3]],
    /// Around points first; the last is the root's children.
    levels: Vec<Vec<Box3>>,
}

/// What a thread keeps from search to search.
#[derive(Default)]
pub(super) struct Scratch {
    /// Places, ascending.
    pub places: Vec<u32>,
    position: [Vec<f32>; 3],
    /// Their squared distances from the point that was asked about last.
    pub squares: Vec<f32>,
    bits: Vec<u32>,
    stack: Vec<(u8, u32)>,
}

/// A radius with which nothing is lost to rounding.
const MARGIN: f32 = 1.0 + 1e-5;

impl<'a> Near<'a> {
    pub fn new(points: &'a [[f32; 3]]) -> Self {
        let around = |few: &[[f32; 3]]| few.iter().map(|&p| [p, p]).fold(EMPTY, join);
        let mut levels: Vec<Vec<Box3>> = vec![points.par_chunks(FAN).map(around).collect()];
        while let Some(below) = levels.last().filter(|below| below.len() > FAN) {
            let above = below.par_chunks(FAN).map(|few| few.iter().copied().fold(EMPTY, join));
            levels.push(above.collect());
        }
        Self { points, levels }
    }

    /// The places of a group: eight points that follow each other.
    pub fn group(&self, group: usize) -> std::ops::Range<usize> {
        group * FAN..self.points.len().min((group + 1) * FAN)
    }

    /// A squared radius within which the k nearest others of a point lie; `None` where there are fewer.
    pub fn bound(&self, at: usize, k: usize, scratch: &mut Scratch) -> Option<f32> {
        let count = self.points.len();
        if count <= k {
            return None;
        }
        let window = (2 * k).min(count);
        let first = at.saturating_sub(k).min(count - window);
        let around = &self.points[first..first + window.max(k + 1)];
        scratch.bits.clear();
        scratch.bits.extend(around.iter().map(|&p| square(p, self.points[at]).to_bits()));
        let (_, &mut farthest, _) = scratch.bits.select_nth_unstable(k);
        Some(f32::from_bits(farthest))
    }

    /// Lists what may lie within `radius` of any point of a group.
    pub fn gather(&self, group: usize, radius: f32, scratch: &mut Scratch) {
        self.list(self.levels[0][group], radius, scratch);
    }

    /// Lists what may lie within `radius` of a position.
    pub fn gather_around(&self, center: [f32; 3], radius: f32, scratch: &mut Scratch) {
        self.list([center; 2], radius, scratch);
    }

    fn list(&self, [low, high]: Box3, radius: f32, scratch: &mut Scratch) {
        let limit = radius * radius * MARGIN;
        scratch.places.clear();
        scratch.position.iter_mut().for_each(Vec::clear);
        scratch.stack.clear();
        let top = self.levels.len() - 1;
        let push = |stack: &mut Vec<(u8, u32)>, level: usize, range: std::ops::Range<usize>| {
            for node in range.rev() {
                let [node_low, node_high] = &self.levels[level][node];
                let away = |axis: usize| {
                    (node_low[axis] - high[axis]).max(low[axis] - node_high[axis]).max(0.0)
                };
                let [x, y, z] = [away(0), away(1), away(2)];
                if x * x + y * y + z * z <= limit {
                    stack.push((level as u8, node as u32));
                }
            }
        };
        push(&mut scratch.stack, top, 0..self.levels[top].len());
        while let Some((level, node)) = scratch.stack.pop() {
            let (level, node) = (level as usize, node as usize);
            if level > 0 {
                let children = node * FAN..self.levels[level - 1].len().min((node + 1) * FAN);
                push(&mut scratch.stack, level - 1, children);
                continue;
            }
            let places = self.group(node);
            scratch.places.extend(places.clone().map(|place| place as u32));
            for (axis, list) in scratch.position.iter_mut().enumerate() {
                list.extend(self.points[places.clone()].iter().map(|p| p[axis]));
            }
        }
    }

    /// The squared distance from a point to its k-th nearest other; `None` where fewer lie within `radius`, as far as
    /// is listed. All squared distances are in `scratch.squares` then.
    pub fn select(&self, at: usize, k: usize, radius: f32, scratch: &mut Scratch) -> Option<f32> {
        scratch.measure(self.points[at]);
        let limit = radius * radius * MARGIN;
        scratch.bits.clear();
        scratch.bits.extend(scratch.squares.iter().filter(|s| **s <= limit).map(|s| s.to_bits()));
        if scratch.bits.len() <= k {
            return None;
        }
        let (_, &mut farthest, _) = scratch.bits.select_nth_unstable(k);
        Some(f32::from_bits(farthest))
    }
}

impl Scratch {
    /// Squared distances of all that is listed from a point.
    pub fn measure(&mut self, center: [f32; 3]) {
        wide(|| self.measure_inlined(center));
    }

    #[inline(always)]
    fn measure_inlined(&mut self, center: [f32; 3]) {
        let [xs, ys, zs] = &self.position;
        self.squares.clear();
        self.squares.extend(xs.iter().zip(ys).zip(zs).map(|((x, y), z)| {
            let [x, y, z] = [x - center[0], y - center[1], z - center[2]];
            (x * x + y * y) + z * z
        }));
    }

    /// The n-th squared distance, from 0.
    pub fn nth(&mut self, n: usize) -> f32 {
        self.bits.clear();
        self.bits.extend(self.squares.iter().map(|square| square.to_bits()));
        f32::from_bits(*self.bits.select_nth_unstable(n).1)
    }

    /// Where in the lists those are that lie within a squared distance, and how far they are off along each axis.
    pub fn within(&self, limit: f32) -> impl Iterator<Item = (usize, f32)> {
        self.squares.iter().copied().enumerate().filter(move |(_, square)| *square <= limit)
    }

    /// Position of an entry of the lists.
    pub fn position(&self, entry: usize) -> [f32; 3] {
        [0, 1, 2].map(|axis| self.position[axis][entry])
    }
}

/// d² as every search of the project computes it.
pub(super) fn square(a: [f32; 3], b: [f32; 3]) -> f32 {
    let [x, y, z] = [0, 1, 2].map(|axis| a[axis] - b[axis]);
    (x * x + y * y) + z * z
}
