//! The median distance of positions to the nearest other one, in f64 at any scale.
//!
//! Points that lie in one place are one position here. Up to 2¹⁷ positions, the median is over all
//! of them. Of more it is over a sample, but the neighbour of each is looked for among all points: the
//! tree of [`Distinct`]'s sample bounds how far away it is, and then all points go past
//! [`Nearest`] once more.

mod balls;
mod tree;

use crate::distinct::Distinct;
use balls::Balls;
use tree::Tree;

/// Positions whose neighbour is looked for, of more than the sample holds. The median of so many is off by
/// 1 % in the mean where distances are spread as those of random points are.
const QUERIES: usize = 1 << 13;

/// The median distance of positions to the nearest other one; `None` where there is a single position.
pub fn median_spacing(positions: &[[f64; 3]]) -> Option<f64> {
    let mut distinct = Distinct::new();
    positions.iter().for_each(|position| distinct.see(position));
    let mut nearest = Nearest::new(distinct);
    if nearest.needs_all() {
        positions.iter().for_each(|position| nearest.see(position));
    }
    nearest.median().map(|(median, _)| median)
}

/// Distances of positions to the nearest other one.
pub(crate) struct Nearest {
    balls: Balls,
    is_exact: bool,
}

impl Nearest {
    /// `distinct` has seen all points.
    pub(crate) fn new(distinct: Distinct) -> Self {
        let is_exact = distinct.sample_is_whole();
        let mut queries = distinct.sample();
        let tree = Tree::new(queries.clone());
        if is_exact {
            // In the order of the tree, so that neighbours find its nodes in the cache.
            queries.copy_from_slice(tree.positions());
        } else {
            queries.truncate(QUERIES);
        }
        let distances = tree.distances(&queries);
        Self { balls: Balls::new(queries, distances), is_exact }
    }

    /// Whether all points have to be [seen](Self::see) once more.
    pub(crate) fn needs_all(&self) -> bool {
        !self.is_exact
    }

    /// Takes the position of a point, whichever it is.
    pub(crate) fn see(&mut self, position: &[f64; 3]) {
        self.balls.see(position);
    }

    /// The median, and how many positions it is over if that is not all of them. `None` if there is a single
    /// position.
    pub(crate) fn median(self) -> Option<(f64, Option<u64>)> {
        let mut distances = self.balls.into_distances();
        // A single position has no other. No difference of two coordinates is farther than f64 reaches.
        if distances.len() < 2 {
            return None;
        }
        let of = (!self.is_exact).then_some(distances.len() as u64);
        let half = distances.len() / 2;
        let (below, &mut upper, _) = distances.select_nth_unstable_by(half, f64::total_cmp);
        let lower = below.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let odd = distances.len() % 2 == 1;
        let median = if odd { upper } else { lower + 0.5 * (upper - lower) };
        Some((median.min(f64::MAX), of))
    }
}

/// The distance of two positions. Neither squares that overflow nor those that vanish spoil it.
fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|axis| b[axis] - a[axis]);
    let square = x * x + y * y + z * z;
    if (1e-280..1e280).contains(&square) {
        return square.sqrt();
    }
    x.hypot(y).hypot(z)
}

#[cfg(test)]
mod tests;
