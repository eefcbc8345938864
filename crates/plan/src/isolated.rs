//! Points that lie apart from all others: stray returns of a scanner, birds over a terrain.
//!
//! Statistical removal after Rusu et al., Towards 3D Point Cloud Based Object Maps for Household
//! Environments (2008), section 4: a point is dropped whose mean distance to its neighbours is over the
//! mean of all points' by more than so many standard deviations, and at least twice that mean: on even
//! points deviations are so small that corners would go.

use crate::PlanError;
use crate::neighborhoods::{BATCH, at_most, in_batches, length, vectors};
use points::{Cloud, NeighborSearch, ObjectPoints, PointSet, Watch};
use rayon::prelude::*;
use std::cmp::Ordering::{Equal, Less};

/// Which points of a set are not isolated. Points at one position count once, and share their fate.
///
/// Once points are gone, others may have lost the neighbours that kept them: rounds follow each other,
/// with the limit of the first, until all that is left is near. From the second on, only points that lost
/// a neighbour look for another, in the tree of the first, from which the dropped are removed.
///
/// # Errors
/// Points that f32 cannot bear; an interruption.
pub(crate) fn near_points(
    set: &PointSet,
    neighbors: u32,
    deviations: f64,
    watch: &dyn Watch,
) -> Result<Vec<bool>, PlanError> {
    watch.stage("looking for isolated points", set.len() as u64);
    let object = ObjectPoints::new(&set.positions, &set.file_index);
    let cloud = Cloud::distinct(&[object])?;
    let mut around = Around::new(&cloud, neighbors, watch)?;
    // Added up in the order of the file, whatever the order in memory.
    let distances = || cloud.order.iter().map(|&slot| around.distances[slot as usize]);
    let count = cloud.points.len() as f64;
    let mean = distances().sum::<f64>() / count;
    let deviation = (distances().map(|d| (d - mean).powi(2)).sum::<f64>() / count).sqrt();
    let limit = (mean + deviations * deviation).max(2.0 * mean);
    around.drop_beyond(limit, watch)?;
    Ok((0..set.len()).map(|i| !around.is_dropped[cloud.slot(0, i) as usize]).collect())
}

/// How far from its neighbours each point is, by slot.
struct Around<'a> {
    search: NeighborSearch<'a>,
    cloud: &'a Cloud,
    k: usize,
    /// k entries a point.
    lists: Vec<u32>,
    /// The mean over those.
    distances: Vec<f64>,
    is_dropped: Vec<bool>,
}

impl<'a> Around<'a> {
    fn new(cloud: &'a Cloud, neighbors: u32, watch: &dyn Watch) -> Result<Self, PlanError> {
        let count = cloud.points.len();
        let mut around = Self {
            search: NeighborSearch::new(&cloud.points, 0),
            cloud,
            k: at_most(neighbors as usize, count),
            lists: Vec::new(),
            distances: Vec::with_capacity(count),
            is_dropped: vec![false; count],
        };
        around.lists.reserve_exact(count * around.k);
        in_batches(count, watch, |batch| {
            let k = around.k;
            let lists = around.search.nearest(batch.clone(), k);
            let means =
                lists.par_chunks(k).zip(batch).map(|(list, at)| mean_distance(cloud, at, list));
            around.distances.par_extend(means);
            around.lists.extend(lists);
        })?;
        Ok(around)
    }

    /// Drops points beyond a limit until none is. What would leave none is not done.
    fn drop_beyond(&mut self, limit: f64, watch: &dyn Watch) -> Result<(), PlanError> {
        let all = 0..self.cloud.points.len() as u32;
        let mut far: Vec<u32> =
            all.into_par_iter().filter(|&at| self.is_beyond(at, limit)).collect();
        let mut left = self.cloud.points.len();
        // Each round drops a smaller share than the one before.
        let share =
            |count: usize| 1.0 - (count as f64).ln() / (self.cloud.points.len() as f64).ln();
        watch.stage("dropping isolated points", 1000);
        let mut done = 0;
        while !far.is_empty() && far.len() < left {
            done = done.max((1000.0 * share(far.len())) as u64);
            watch.done(done);
            left -= far.len();
            self.search.remove(&far);
            for &at in &far {
                self.is_dropped[at as usize] = true;
            }
            let lost = self.points_that_lost_any();
            far.clear();
            for some in lost.chunks(BATCH) {
                if watch.interrupted() {
                    return Err(PlanError::Interrupted);
                }
                self.look_again(some);
                far.extend(some.iter().filter(|&&at| self.is_beyond(at, limit)));
            }
        }
        Ok(())
    }

    fn is_beyond(&self, at: u32, limit: f64) -> bool {
        // Not "greater": what is no number is far.
        !matches!(self.distances[at as usize].partial_cmp(&limit), Some(Less | Equal))
    }

    /// The points that are left but have a dropped one in their lists.
    fn points_that_lost_any(&self) -> Vec<u32> {
        let is_dropped = |&other: &u32| self.is_dropped.get(other as usize) == Some(&true);
        let lost = |(list, own): (&[u32], &bool)| !own && list.iter().any(is_dropped);
        let all = self.lists.par_chunks(self.k).zip(&self.is_dropped).with_min_len(1 << 10);
        all.enumerate().filter(|&(_, point)| lost(point)).map(|(at, _)| at as u32).collect()
    }

    fn look_again(&mut self, places: &[u32]) {
        let lists = self.search.nearest_of(places, self.k);
        for (&at, list) in places.iter().zip(lists.chunks(self.k)) {
            let at = at as usize;
            self.lists[at * self.k..][..self.k].copy_from_slice(list);
            self.distances[at] = mean_distance(self.cloud, at, list);
        }
    }
}

/// The mean distance of a point to its neighbours.
fn mean_distance(cloud: &Cloud, at: usize, list: &[u32]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for vector in vectors(&cloud.points, at, list) {
        sum += length(vector);
        count += 1.0;
    }
    sum / f64::max(count, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use points::{Attribute, Unwatched, Values};
    use std::sync::Mutex;

    /// The set that is left, and how many points are not; `None` where all are.
    fn without_isolated(
        set: &PointSet,
        neighbors: u32,
        deviations: f64,
        watch: &dyn Watch,
    ) -> Result<Option<(PointSet, u64)>, PlanError> {
        let keep = near_points(set, neighbors, deviations, watch)?;
        let dropped = keep.iter().filter(|keep| !**keep).count() as u64;
        Ok((dropped > 0).then(|| (set.filtered(|i| keep[i]), dropped)))
    }

    fn grid_and(strays: &[[f64; 3]]) -> PointSet {
        let mut positions: Vec<[f64; 3]> =
            (0..400).map(|i| [f64::from(i % 20), f64::from(i / 20), 0.0]).collect();
        positions.splice(100..100, strays.iter().copied());
        let file_index = (0..positions.len() as u32).collect();
        let colors = Some(positions.iter().map(|p| [p[2] as f32, 0.0, 0.0]).collect());
        let heights = positions.iter().map(|p| p[2]).collect();
        let height = Attribute { name: "height".to_owned(), values: Values::F64(heights) };
        PointSet { positions, file_index, colors, attributes: vec![height], ..PointSet::default() }
    }

    #[test]
    fn strays_go_with_their_colors_and_the_rest_keeps_its_indices() {
        let set = grid_and(&[[3.0, 3.0, 50.0], [100.0, 0.0, 7.0]]);
        let (kept, dropped) =
            without_isolated(&set, 16, 4.0, &Unwatched).expect("bearable").expect("strays");
        assert_eq!((kept.len(), dropped), (400, 2));
        assert_eq!(kept.file_index[99..102], [99, 102, 103]);
        assert!(kept.attribute("height").expect("heights").iter().all(|height| height == 0.0));
        assert!(kept.colors.expect("colours").iter().all(|color| color[0] == 0.0));
    }

    #[test]
    fn even_points_and_coinciding_ones_all_stay() {
        assert!(without_isolated(&grid_and(&[]), 16, 4.0, &Unwatched).expect("bearable").is_none());
        let same = PointSet {
            positions: vec![[1.0; 3]; 50],
            file_index: (0..50).collect(),
            ..PointSet::default()
        };
        assert!(without_isolated(&same, 16, 4.0, &Unwatched).expect("bearable").is_none());
        let one =
            PointSet { positions: vec![[1.0; 3]], file_index: vec![0], ..PointSet::default() };
        assert!(without_isolated(&one, 16, 4.0, &Unwatched).expect("bearable").is_none());
    }

    /// Densities over several orders of magnitude, with copies: chains of points that keep each other.
    fn uneven(seed: u32) -> PointSet {
        let mut state = u64::from(seed);
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f64 / (1u64 << 24) as f64
        };
        let mut positions: Vec<[f64; 3]> =
            (0..3_000).map(|_| [0; 3].map(|_| (6.0 * random()).exp() + 5e5)).collect();
        positions.extend_from_within(100..140);
        let file_index = (0..positions.len() as u32).map(|i| 3 * i).collect();
        PointSet { positions, file_index, ..PointSet::default() }
    }

    /// As docs/method.md has it: every round anew, with all that is left. Also how many rounds dropped any.
    fn round_by_round(set: &PointSet, neighbors: usize, deviations: f64) -> (Vec<u32>, usize) {
        let mut left = set.filtered(|_| true);
        let mut limit = None;
        for rounds in 0.. {
            let object = ObjectPoints::new(&left.positions, &left.file_index);
            let cloud = Cloud::distinct(&[object]).expect("bearable");
            let count = cloud.points.len();
            let k = neighbors.min(count - 1);
            let lists = NeighborSearch::new(&cloud.points, 0).nearest(0..count, k);
            let mean = |&slot: &u32| {
                let list = &lists[slot as usize * k..][..k];
                vectors(&cloud.points, slot as usize, list).map(length).sum::<f64>() / k as f64
            };
            let means: Vec<f64> = cloud.order.iter().map(mean).collect();
            let limit = *limit.get_or_insert_with(|| {
                let mean = means.iter().sum::<f64>() / means.len() as f64;
                let squares = means.iter().map(|d| (d - mean).powi(2)).sum::<f64>();
                (mean + deviations * (squares / means.len() as f64).sqrt()).max(2.0 * mean)
            });
            let near = means.iter().filter(|&&mean| mean <= limit).count();
            if near == count || near == 0 {
                return (left.file_index, rounds);
            }
            let mean_of = |i: usize| mean(&cloud.slot(0, i));
            left = left.filtered(|i| mean_of(i) <= limit);
        }
        unreachable!("rounds end");
    }

    #[test]
    fn rounds_drop_what_they_would_drop_with_everything_anew() {
        let mut most = 0;
        for (seed, [neighbors, deviations]) in
            [[16.0, 1.0], [16.0, 3.0], [4.0, 0.5], [40.0, 0.1]].into_iter().enumerate()
        {
            let set = uneven(seed as u32 + 1);
            let (expected, rounds) = round_by_round(&set, neighbors as usize, deviations);
            let (kept, dropped) = without_isolated(&set, neighbors as u32, deviations, &Unwatched)
                .expect("bearable")
                .expect("strays");
            assert_eq!(kept.file_index, expected, "{neighbors} neighbours, {deviations}");
            assert_eq!(dropped as usize, set.len() - expected.len());
            most = most.max(rounds);
        }
        assert!(most > 3, "only {most} rounds");
    }

    /// Notes the stages, and asks for an end in one of them.
    #[derive(Default)]
    struct Noted {
        stages: Mutex<Vec<(&'static str, u64, Vec<u64>)>>,
        ends_in: Option<&'static str>,
    }

    impl Watch for Noted {
        fn stage(&self, name: &'static str, total: u64) {
            self.stages.lock().expect("no panic").push((name, total, Vec::new()));
        }
        fn done(&self, units: u64) {
            self.stages.lock().expect("no panic").last_mut().expect("a stage").2.push(units);
        }
        fn interrupted(&self) -> bool {
            let stages = self.stages.lock().expect("no panic");
            stages.last().is_some_and(|stage| Some(stage.0) == self.ends_in)
        }
    }

    #[test]
    fn both_stages_move_and_can_be_ended() {
        let set = uneven(1);
        let watch = Noted::default();
        without_isolated(&set, 16, 1.0, &watch).expect("bearable").expect("strays");
        let stages = watch.stages.into_inner().expect("no panic");
        let names: Vec<&str> = stages.iter().map(|stage| stage.0).collect();
        assert_eq!(names, ["looking for isolated points", "dropping isolated points"]);
        for (name, total, done) in &stages {
            assert!(!done.is_empty() && done.is_sorted(), "{name}: {done:?}");
            assert!(done.iter().all(|units| units <= total), "{name}: {done:?} of {total}");
        }
        for name in names {
            let watch = Noted { ends_in: Some(name), ..Noted::default() };
            let ended = without_isolated(&set, 16, 1.0, &watch);
            assert!(matches!(ended, Err(PlanError::Interrupted)), "{name}");
        }
    }
}
