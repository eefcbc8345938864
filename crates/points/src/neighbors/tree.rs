//! The tree of boxes around points, and how it is built.

use kernels::layout::{NONE, Point};
use rayon::prelude::*;

/// Points of a block, and children of a node.
pub(super) const WIDTH: usize = 8;
/// Blocks of a part of the tree that one thread builds.
const PART: usize = 1 << 9;

/// The blocks, and the boxes around them.
#[derive(Debug)]
pub(super) struct Tree {
    pub blocks: Vec<Block>,
    /// The boxes of each level, eight a node: those around blocks first, the root's last.
    pub levels: Vec<Vec<Boxes>>,
}

/// Eight points, coordinate by coordinate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    position: [[f32; WIDTH]; 3],
    /// Places in the file; the largest number where there is no point, whose position is infinite.
    pub index: [u32; WIDTH],
    /// Places in memory; `NONE` where there is no point.
    pub place: [u32; WIDTH],
}

/// Boxes around eight blocks or nodes, coordinate by coordinate. Those around nothing are infinitely far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Boxes {
    low: [[f32; WIDTH]; 3],
    high: [[f32; WIDTH]; 3],
    /// Least place in the file of a point inside.
    pub least: [u32; WIDTH],
}

/// Points of a part of the tree that is being built.
#[derive(Debug, Clone, Copy)]
struct Entry {
    position: [f32; 3],
    place: u32,
}

impl Tree {
    pub fn new(points: &[Point]) -> Self {
        let entry = |(place, point): (u32, &Point)| Entry { position: point.position, place };
        let mut entries: Vec<Entry> = (0..).zip(points).map(entry).collect();
        let mut blocks = vec![Block::EMPTY; points.len().div_ceil(WIDTH)];
        if !points.is_empty() {
            build(points, &mut entries, &mut blocks);
        }
        let mut levels = vec![boxes_around(&blocks, Block::bounds)];
        while let Some(below) = levels.last().filter(|below| below.len() > 1) {
            levels.push(boxes_around(below, Boxes::bounds));
        }
        Self { blocks, levels }
    }

    /// Where each of `count` points lies, eight lanes a block.
    pub fn lanes(&self, count: usize) -> Vec<u32> {
        let mut lanes = vec![NONE; count];
        let places = self.blocks.iter().flat_map(|block| block.place);
        for (lane, place) in (0..).zip(places).filter(|(_, place)| *place != NONE) {
            lanes[place as usize] = lane;
        }
        lanes
    }

    /// Takes a point out of its block. The boxes stay, and hold what is left.
    pub fn remove(&mut self, lane: u32) {
        let (block, lane) = (lane as usize / WIDTH, lane as usize % WIDTH);
        let block = &mut self.blocks[block];
        for axis in &mut block.position {
            axis[lane] = f32::INFINITY;
        }
        block.index[lane] = u32::MAX;
        block.place[lane] = NONE;
    }
}

impl Block {
    const EMPTY: Self = Self {
        position: [[f32::INFINITY; WIDTH]; 3],
        index: [u32::MAX; WIDTH],
        place: [NONE; WIDTH],
    };

    fn new(points: &[Point], entries: &[Entry]) -> Self {
        let mut block = Self::EMPTY;
        for (lane, entry) in entries.iter().enumerate() {
            for axis in 0..3 {
                block.position[axis][lane] = entry.position[axis];
            }
            block.index[lane] = points[entry.place as usize].index;
            block.place[lane] = entry.place;
        }
        block
    }

    /// The box around its points, and the least place in the file.
    fn bounds(&self) -> ([f32; 3], [f32; 3], u32) {
        let [mut low, mut high] = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
        let mut least = u32::MAX;
        for lane in (0..WIDTH).filter(|&lane| self.place[lane] != NONE) {
            for axis in 0..3 {
                low[axis] = low[axis].min(self.position[axis][lane]);
                high[axis] = high[axis].max(self.position[axis][lane]);
            }
            least = least.min(self.index[lane]);
        }
        (low, high, least)
    }

    /// d² of each of the points.
    pub fn distances(&self, p: [f32; 3]) -> [f32; WIDTH] {
        std::array::from_fn(|lane| {
            let [x, y, z] = [0, 1, 2].map(|axis| self.position[axis][lane] - p[axis]);
            (x * x + y * y) + z * z
        })
    }
}

impl Boxes {
    const EMPTY: Self = Self {
        low: [[f32::INFINITY; WIDTH]; 3],
        high: [[f32::NEG_INFINITY; WIDTH]; 3],
        least: [u32::MAX; WIDTH],
    };

    fn set(&mut self, lane: usize, (low, high, least): ([f32; 3], [f32; 3], u32)) {
        for axis in 0..3 {
            self.low[axis][lane] = low[axis];
            self.high[axis][lane] = high[axis];
        }
        self.least[lane] = least;
    }

    /// The box around all.
    fn bounds(&self) -> ([f32; 3], [f32; 3], u32) {
        (
            self.low.map(|low| low.into_iter().fold(f32::INFINITY, f32::min)),
            self.high.map(|high| high.into_iter().fold(f32::NEG_INFINITY, f32::max)),
            self.least.into_iter().fold(u32::MAX, u32::min),
        )
    }

    /// d² of what is nearest in each box.
    pub fn distances(&self, p: [f32; 3]) -> [f32; WIDTH] {
        std::array::from_fn(|lane| {
            // `f32::max` minds NaN, which takes three times as long.
            let greater = |a: f32, b: f32| if a > b { a } else { b };
            let [x, y, z] = [0, 1, 2].map(|axis| {
                greater(
                    greater(self.low[axis][lane] - p[axis], p[axis] - self.high[axis][lane]),
                    0.0,
                )
            });
            (x * x + y * y) + z * z
        })
    }
}

/// Sorts points into the blocks of a part of the tree: along the longest axis of the box around them, so that each of
/// two parts is whole nodes, until a part is one block, or lies in one place.
fn build(points: &[Point], entries: &mut [Entry], blocks: &mut [Block]) {
    let (low, high) = box_around(entries);
    if low == high && blocks.len() > 1 {
        entries.sort_unstable_by_key(|entry| points[entry.place as usize].index);
    }
    if low == high || blocks.len() == 1 {
        for (block, entries) in blocks.iter_mut().zip(entries.chunks(WIDTH)) {
            *block = Block::new(points, entries);
        }
        return;
    }
    let extent = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    let wider = if extent[1] > extent[0] { 1 } else { 0 };
    let axis = if extent[2] > extent[wider] { 2 } else { wider };
    // The largest node that is not the whole part.
    let mut node = 1;
    while node * WIDTH < blocks.len() {
        node *= WIDTH;
    }
    let left = node * (blocks.len().div_ceil(node) / 2);
    let half = left * WIDTH;
    entries.select_nth_unstable_by(half, |a, b| a.position[axis].total_cmp(&b.position[axis]));
    let (few, more) = entries.split_at_mut(half);
    let (left, right) = blocks.split_at_mut(left);
    if left.len() + right.len() > PART {
        rayon::join(|| build(points, few, left), || build(points, more, right));
    } else {
        build(points, few, left);
        build(points, more, right);
    }
}

/// Lowest and highest corner of the box around some points.
fn box_around(entries: &[Entry]) -> ([f32; 3], [f32; 3]) {
    let [mut low, mut high] = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    for entry in entries {
        for axis in 0..3 {
            let p = entry.position[axis];
            low[axis] = if p < low[axis] { p } else { low[axis] };
            high[axis] = if p > high[axis] { p } else { high[axis] };
        }
    }
    (low, high)
}

/// The boxes around blocks or nodes, eight by eight.
fn boxes_around<T: Sync>(
    all: &[T],
    bounds: impl Fn(&T) -> ([f32; 3], [f32; 3], u32) + Sync,
) -> Vec<Boxes> {
    all.par_chunks(WIDTH)
        .with_min_len(PART)
        .map(|some| {
            let mut boxes = Boxes::EMPTY;
            for (lane, one) in some.iter().enumerate() {
                boxes.set(lane, bounds(one));
            }
            boxes
        })
        .collect()
}
