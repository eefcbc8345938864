//! Neighbours in f64: a k-d tree over indices, split at the median of the longest side.

use std::ops::Range;

/// Points of a leaf: below this, looking at all is as fast as descending.
const LEAF: usize = 8;

/// Order of the points, and the splits of its halves: `splits[i]` belongs to the node whose middle
/// is `order[i]`.
#[derive(Debug, Clone)]
pub(super) struct KdTree {
    order: Vec<u32>,
    splits: Vec<u8>,
}

fn square_distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let d = [0, 1, 2].map(|axis| a[axis] - b[axis]);
    d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
}

impl KdTree {
    pub(super) fn new(points: &[[f64; 3]]) -> Self {
        let mut tree =
            Self { order: (0..points.len() as u32).collect(), splits: vec![0; points.len()] };
        split(points, &mut tree.order, &mut tree.splits);
        tree
    }

    /// Indices of all points within a distance, ascending, so that sums have one order.
    pub(super) fn within(&self, points: &[[f64; 3]], center: &[f64; 3], reach: f64) -> Vec<u32> {
        let mut found = Vec::new();
        self.visit(points, center, 0..self.order.len(), &mut |index, d2| {
            if d2 <= reach * reach {
                found.push(index);
            }
            reach
        });
        found.sort_unstable();
        found
    }

    /// The nearest point; ties go to the lower index.
    pub(super) fn nearest(&self, points: &[[f64; 3]], center: &[f64; 3]) -> Option<u32> {
        let mut best = (f64::INFINITY, u32::MAX);
        self.visit(points, center, 0..self.order.len(), &mut |index, d2| {
            if (d2, index) < best {
                best = (d2, index);
            }
            best.0.sqrt()
        });
        (best.1 != u32::MAX).then_some(best.1)
    }

    /// Shows `look` all points within the reach that it gave last, and maybe more; gives that reach.
    fn visit(
        &self,
        points: &[[f64; 3]],
        center: &[f64; 3],
        range: Range<usize>,
        look: &mut dyn FnMut(u32, f64) -> f64,
    ) -> f64 {
        let mut see = |at: usize| {
            let index = self.order[at];
            look(index, square_distance(&points[index as usize], center))
        };
        if range.len() <= LEAF {
            return range.fold(f64::INFINITY, |_, at| see(at));
        }
        let middle = range.start + range.len() / 2;
        see(middle);
        let axis = usize::from(self.splits[middle]);
        let offset = center[axis] - points[self.order[middle] as usize][axis];
        let (low, high) = (range.start..middle, middle + 1..range.end);
        let (near, far) = if offset < 0.0 { (low, high) } else { (high, low) };
        let reach = self.visit(points, center, near, look);
        // A hair more, since a reach may come from a root: `look` decides at the very edge.
        if offset.abs() > reach * (1.0 + 1e-15) {
            return reach;
        }
        self.visit(points, center, far, look)
    }
}

fn split(points: &[[f64; 3]], order: &mut [u32], splits: &mut [u8]) {
    if order.len() <= LEAF {
        return;
    }
    let extent = |axis: usize| {
        let all = || order.iter().map(|&i| points[i as usize][axis]);
        all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
    };
    let extents = [0, 1, 2].map(extent);
    let axis = (0..3).fold(0, |best, axis| if extents[axis] > extents[best] { axis } else { best });
    let middle = order.len() / 2;
    order.select_nth_unstable_by(middle, |&i, &j| {
        points[i as usize][axis].total_cmp(&points[j as usize][axis]).then(i.cmp(&j))
    });
    splits[middle] = axis as u8;
    let (low, high) = order.split_at_mut(middle);
    let (low_splits, high_splits) = splits.split_at_mut(middle);
    split(points, low, low_splits);
    split(points, &mut high[1..], &mut high_splits[1..]);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lattice points: equal distances and equal coordinates are the rule.
    #[test]
    fn neighbors_equal_a_search_of_all() {
        let points: Vec<[f64; 3]> =
            (0..700).map(|i| [i * 7 % 11, i * 5 % 13, i * 3 % 7].map(f64::from)).collect();
        let tree = KdTree::new(&points);
        for i in 0..100 {
            let center = [i * 3 % 23, i * 7 % 29, i * 11 % 13].map(|c| f64::from(c) * 0.5);
            for reach in [0.0, 1.0, 2.5, 5.0, f64::INFINITY] {
                let all: Vec<u32> = (0..700)
                    .filter(|&j| square_distance(&points[j as usize], &center) <= reach * reach)
                    .collect();
                assert_eq!(tree.within(&points, &center, reach), all);
            }
            let nearest = (0..700u32).min_by(|&p, &q| {
                let d2 = |j: u32| square_distance(&points[j as usize], &center);
                d2(p).total_cmp(&d2(q)).then(p.cmp(&q))
            });
            assert_eq!(tree.nearest(&points, &center), nearest);
        }
    }

    #[test]
    fn no_points_have_no_neighbors() {
        let tree = KdTree::new(&[]);
        assert_eq!(tree.nearest(&[], &[0.0; 3]), None);
        assert!(tree.within(&[], &[0.0; 3], f64::INFINITY).is_empty());
    }
}
