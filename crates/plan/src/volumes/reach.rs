//! How far the points of a volume reach, by how far apart they are (docs/method.md, section 7).

use super::thinned;
use crate::PlanError;
use crate::neighborhoods::{at_most, in_batches, length, vectors};
use points::{Cloud, NeighborSearch, ObjectPoints, Watch};
use rayon::prelude::*;

/// Neighbours that the spacing of points is measured by.
pub(super) const NEIGHBORS: usize = 16;
/// A set is uneven where the 95th percentile of its points' reaches is over this many times the 5th.
const UNEVEN: f64 = 2.0;
const PERCENTILES: [f64; 2] = [0.05, 0.95];

/// How far the points of a volume reach, scene units.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Reach {
    /// All alike.
    Even(f64),
    /// Each its own, in the order of the positions.
    Own(Vec<f64>),
}

/// How far apart the points of a set are.
pub(super) struct Spacings {
    cloud: Cloud,
    /// By slot, the nearest others, fewer than asked for in small sets.
    lists: Vec<u32>,
    /// Length of each list.
    each: usize,
    /// By slot, the distance to the last of these.
    farthest: Vec<f64>,
}

impl Spacings {
    /// Looks for the 16 nearest others of each of the distinct points.
    pub(super) fn of(positions: &[[f64; 3]], watch: &dyn Watch) -> Result<Self, PlanError> {
        watch.stage("measuring the spacing of a volume", positions.len() as u64);
        let file_index: Vec<u32> = (0..positions.len() as u32).collect();
        let cloud = Cloud::distinct(&[ObjectPoints::new(positions, &file_index)])?;
        let points = cloud.points.as_slice();
        let each = at_most(NEIGHBORS, points.len());
        let search = NeighborSearch::new(points, 0);
        let (mut lists, mut farthest) = (Vec::new(), Vec::new());
        in_batches(points.len(), watch, |batch| {
            let part = search.nearest(batch.clone(), each);
            let of_list = |(list, slot): (&[u32], usize)| {
                vectors(points, slot, list).map(length).fold(0.0, f64::max)
            };
            farthest.par_extend(part.par_chunks(each).zip(batch).map(of_list));
            lists.extend(part);
        })?;
        Ok(Self { cloud, lists, each, farthest })
    }

    /// The mean distance to the 16th neighbour.
    pub(super) fn mean(&self) -> f64 {
        // Added up in the order of the file, whatever the order in memory.
        let all = self.cloud.order.iter().map(|&slot| self.farthest[slot as usize]);
        all.sum::<f64>() / self.farthest.len().max(1) as f64
    }

    /// The mean over each point's 16 neighbours of the distance to their 16th, in the order of the positions; where
    /// points of a volume lie along lines or in sheets, of a set thinned to what is as dense to all sides. And whether those
    /// of the distinct points differ much.
    pub(super) fn own(
        &self,
        positions: usize,
        is_volume: impl FnOnce() -> bool,
    ) -> (Vec<f64>, bool) {
        let plain = smoothed(&self.farthest, &self.lists, self.each);
        let by_slot =
            thinned::reaches(&self.cloud.points, &self.lists, self.each, plain, is_volume);
        let own = (0..positions).map(|i| by_slot[self.cloud.slot(0, i) as usize]).collect();
        (own, Self::is_uneven(&by_slot))
    }

    fn is_uneven(reaches: &[f64]) -> bool {
        let mut sorted = reaches.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let at = |part: f64| sorted.get((part * sorted.len() as f64) as usize).copied();
        let [Some(low), Some(high)] = PERCENTILES.map(at) else { return false };
        high > UNEVEN * low
    }
}

/// The mean of a value over the list of each point.
pub(super) fn smoothed(values: &[f64], lists: &[u32], each: usize) -> Vec<f64> {
    let mean = |(list, &own): (&[u32], &f64)| {
        let there = list.iter().filter_map(|&other| values.get(other as usize));
        let (sum, count) = there.fold((0.0, 0u32), |(sum, count), value| (sum + value, count + 1));
        if count > 0 { sum / f64::from(count) } else { own }
    };
    lists.par_chunks(each).zip(values).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use points::Unwatched;

    fn random(count: usize) -> impl Iterator<Item = [f64; 3]> {
        let mut seed = 9u64;
        let mut next = move || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / f64::from(1 << 24)
        };
        (0..count).map(move |_| [next(), next(), next()])
    }

    /// The formula, by looking at all pairs. Positions are f32 in memory, which moves distances by 1e-7 of the box.
    #[test]
    fn reaches_are_means_of_distances_to_the_sixteenth() {
        // Denser towards one corner.
        let set: Vec<[f64; 3]> = random(600).map(|p| p.map(|x| x * x)).collect();
        let distance = |a: [f64; 3], b: [f64; 3]| length([0, 1, 2].map(|axis| a[axis] - b[axis]));
        let nearest = |i: usize| {
            let mut others: Vec<usize> = (0..set.len()).filter(|&j| j != i).collect();
            others.sort_by(|&a, &b| distance(set[i], set[a]).total_cmp(&distance(set[i], set[b])));
            others.truncate(NEIGHBORS);
            others
        };
        let lists: Vec<Vec<usize>> = (0..set.len()).map(nearest).collect();
        let last = |i: usize| distance(set[i], set[lists[i][NEIGHBORS - 1]]);
        let (found, is_uneven) = Spacings::of(&set, &Unwatched).unwrap().own(set.len(), || false);
        for (i, list) in lists.iter().enumerate() {
            let expected = list.iter().map(|&j| last(j)).sum::<f64>() / NEIGHBORS as f64;
            assert!((found[i] - expected).abs() < 1e-6, "{i}: {} for {expected}", found[i]);
        }
        assert!(is_uneven);
    }

    /// Points at random have reaches alike but for chance, and are even; so is a lattice with borders.
    #[test]
    fn even_sets_are_even() {
        let random: Vec<[f64; 3]> = random(4000).collect();
        let lattice: Vec<[f64; 3]> =
            (0..3375).map(|i| [i % 15, i / 15 % 15, i / 225].map(f64::from)).collect();
        for set in [random, lattice] {
            let (_, is_uneven) = Spacings::of(&set, &Unwatched).unwrap().own(set.len(), || true);
            assert!(!is_uneven);
        }
        assert!(!Spacings::is_uneven(&[]));
    }

    /// Columns of nodes, 20 times closer along than across: 16 neighbours are all of one column, and reaches of theirs
    /// leave gaps between columns. A reach spans to the columns around, and not much farther.
    #[test]
    fn reaches_span_gaps_between_columns() {
        let set: Vec<[f64; 3]> = (0..10 * 10 * 200)
            .map(|i| [f64::from(i / 200 % 10), f64::from(i / 2000), 0.05 * f64::from(i % 200)])
            .collect();
        let spacings = Spacings::of(&set, &Unwatched).unwrap();
        let (plain, _) = spacings.own(set.len(), || false);
        let (spanning, _) = spacings.own(set.len(), || true);
        let inner: Vec<usize> =
            (0..set.len()).filter(|i| set[*i].iter().all(|x| (2.0..=7.0).contains(x))).collect();
        assert!(inner.iter().all(|&i| plain[i] < 0.45), "half of a column's 16 neighbours");
        for &i in &inner {
            assert!((1.0..2.5).contains(&spanning[i]), "{:?}: {}", set[i], spanning[i]);
        }
        // The same points as a skin keep theirs.
        assert_eq!(plain, spacings.own(set.len(), || false).0);
    }
}
