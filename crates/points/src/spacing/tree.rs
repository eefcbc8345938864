//! A k-d tree in f64, of positions of which no two are equal.

use super::distance;
use rayon::prelude::*;

/// Positions of a leaf at most.
const LEAF: usize = 8;

/// A balanced tree without pointers: the node of a range of positions is its middle one, with what is lower along
/// the node's axis before it, and what is higher after it.
pub(super) struct Tree {
    positions: Vec<[f64; 3]>,
    /// Of each position that is a node.
    axes: Vec<u8>,
}

impl Tree {
    pub(super) fn new(mut positions: Vec<[f64; 3]>) -> Self {
        let mut axes = vec![0; positions.len()];
        build(&mut positions, &mut axes);
        Self { positions, axes }
    }

    /// The positions, neighbours mostly near each other.
    pub(super) fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// Of each query the distance to the nearest position that is not at the same place; infinite if there is none.
    pub(super) fn distances(&self, queries: &[[f64; 3]]) -> Vec<f64> {
        let nearest = |query| self.nearest(query, 0..self.positions.len(), f64::INFINITY);
        queries.par_iter().with_min_len(1 << 10).map(nearest).collect()
    }

    fn nearest(&self, query: &[f64; 3], range: std::ops::Range<usize>, mut best: f64) -> f64 {
        let look_at = |position: &[f64; 3], best: f64| {
            let found = distance(query, position);
            if found < best && position != query { found } else { best }
        };
        if range.len() <= LEAF {
            return self.positions[range].iter().fold(best, |best, p| look_at(p, best));
        }
        let middle = range.start + range.len() / 2;
        let node = &self.positions[middle];
        best = look_at(node, best);
        let axis = usize::from(self.axes[middle]);
        let offset = query[axis] - node[axis];
        let (lower, upper) = (range.start..middle, middle + 1..range.end);
        let (near, far) = if offset < 0.0 { (lower, upper) } else { (upper, lower) };
        best = self.nearest(query, near, best);
        if offset.abs() < best { self.nearest(query, far, best) } else { best }
    }
}

fn build(positions: &mut [[f64; 3]], axes: &mut [u8]) {
    if positions.len() <= LEAF {
        return;
    }
    let extent = |axis: usize| {
        let (low, high) =
            positions.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
                (low.min(p[axis]), high.max(p[axis]))
            });
        // Halves, so that no difference overflows.
        0.5 * high - 0.5 * low
    };
    let extents = [0, 1, 2].map(extent);
    let axis =
        (1..3).fold(0, |widest, axis| if extents[axis] > extents[widest] { axis } else { widest });
    let middle = positions.len() / 2;
    positions.select_nth_unstable_by(middle, |a, b| a[axis].total_cmp(&b[axis]));
    axes[middle] = axis as u8;
    let (lower, upper) = positions.split_at_mut(middle);
    let (lower_axes, upper_axes) = axes.split_at_mut(middle);
    rayon::join(|| build(lower, lower_axes), || build(&mut upper[1..], &mut upper_axes[1..]));
}
