//! What the nearest neighbours of a set's points say of them: which lie on the boundary.

use crate::PlanError;
use kernels::layout::Point;
use points::{Cloud, NeighborSearch, ObjectPoints, Watch};
use rayon::prelude::*;

/// Neighbours that tell whether a point is on the boundary: of so many at random around a point inside, all
/// are on one side of a plane through it once in four million times (Wendel 1962).
const BOUNDARY_NEIGHBORS: usize = 32;
/// Neighbours count as on one side up to this share of their distance beyond the plane.
const ONE_SIDE: f64 = 0.22;
/// Turns of the plane away from the neighbour that is farthest beyond it.
const TURNS: usize = 24;
/// Points whose neighbours are listed between two looks at the watcher.
pub(crate) const BATCH: usize = 1 << 15;

/// Calls `each` with batch after batch of `count` places; reports to the watcher how many are done, and ends
/// where it asks for that.
pub(crate) fn in_batches(
    count: usize,
    watch: &dyn Watch,
    mut each: impl FnMut(std::ops::Range<usize>),
) -> Result<(), PlanError> {
    for first in (0..count).step_by(BATCH) {
        if watch.interrupted() {
            return Err(PlanError::Interrupted);
        }
        let batch = first..count.min(first + BATCH);
        each(batch.clone());
        watch.done(batch.end as u64);
    }
    Ok(())
}

/// Neighbours that each of `count` points can have, if so many are asked for.
pub(crate) fn at_most(neighbors: usize, count: usize) -> usize {
    neighbors.min(count.saturating_sub(1)).max(1)
}

/// Vectors from a point to others of a list, in f64 from the f32 differences.
pub(crate) fn vectors<'a>(
    points: &'a [Point],
    at: usize,
    list: &'a [u32],
) -> impl Iterator<Item = [f64; 3]> + 'a {
    let center = points[at].position;
    let listed = list.iter().filter_map(|&other| points.get(other as usize));
    listed.map(move |other| [0, 1, 2].map(|axis| f64::from(other.position[axis] - center[axis])))
}

pub(crate) fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// What `of` makes of the vectors from each point to its nearest others, by slot of the cloud of distinct points.
fn of_each<T: Copy + Send>(
    positions: &[[f64; 3]],
    neighbors: usize,
    watch: &dyn Watch,
    of: impl Fn(&[[f64; 3]]) -> T + Sync,
) -> Result<(Cloud, Vec<T>), PlanError> {
    let file_index: Vec<u32> = (0..positions.len() as u32).collect();
    let cloud = Cloud::distinct(&[ObjectPoints::new(positions, &file_index)])?;
    let points = cloud.points.as_slice();
    let k = at_most(neighbors, points.len());
    let search = NeighborSearch::new(points, 0);
    let mut by_slot = Vec::with_capacity(points.len());
    in_batches(points.len(), watch, |batch| {
        let lists = search.nearest(batch.clone(), k);
        let of_list = |others: &mut Vec<[f64; 3]>, (list, slot): (&[u32], usize)| {
            others.clear();
            others.extend(vectors(points, slot, list));
            of(others)
        };
        by_slot.par_extend(lists.par_chunks(k).zip(batch).map_init(Vec::new, of_list));
    })?;
    Ok((cloud, by_slot))
}

/// Which points have a plane through them that has all their neighbours on one side.
pub(crate) fn open_points(
    positions: &[[f64; 3]],
    watch: &dyn Watch,
) -> Result<Vec<bool>, PlanError> {
    watch.stage("finding boundary points", positions.len() as u64);
    let (cloud, by_slot) = of_each(positions, BOUNDARY_NEIGHBORS, watch, is_open)?;
    Ok((0..positions.len()).map(|i| by_slot[cloud.slot(0, i) as usize]).collect())
}

/// Begins with the plane across the mean of all directions, and turns it.
fn is_open(others: &[[f64; 3]]) -> bool {
    let unit = |v: [f64; 3]| {
        let length = length(v);
        (length > 0.0).then(|| v.map(|x| x / length))
    };
    let directions: Vec<[f64; 3]> = others.iter().filter_map(|&y| unit(y)).collect();
    let mean = [0, 1, 2].map(|axis| directions.iter().map(|y| y[axis]).sum::<f64>());
    let mut outwards = unit(mean.map(|x| -x));
    for _ in 0..TURNS {
        let Some(out) = outwards else { return false };
        let beyond = |y: &[f64; 3]| (0..3).map(|axis| y[axis] * out[axis]).sum::<f64>();
        let Some(worst) = directions.iter().max_by(|a, b| beyond(a).total_cmp(&beyond(b))) else {
            return true;
        };
        if beyond(worst) <= ONE_SIDE {
            return true;
        }
        outwards = unit([0, 1, 2].map(|axis| out[axis] - 0.3 * worst[axis]));
    }
    false
}
