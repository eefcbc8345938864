//! Twin of `disc_trace`: the nearest hit of a camera ray among the points whose discs cover its
//! screen tile (\[T\] §4).

use crate::batch::{BATCH, test_batch};
use crate::camera_rays::Ray;
use crate::disc::depth_rank;
use crate::disc_bin::DiscLists;
use crate::levels::Levels;
use crate::polynomial::Polynomial;
use crate::real::Real;
use kernels::layout::{DISC_TILE, LEAF_BITS, LEAF_POINTS, NONE};

const LEAVES_AT_ONCE: usize = BATCH / LEAF_POINTS as usize;

/// The slots of a leaf that an entry of the list is about.
fn points_of(entry: u32) -> impl Iterator<Item = u32> {
    let first = (entry & ((1 << LEAF_BITS) - 1)) * LEAF_POINTS;
    (0..LEAF_POINTS)
        .filter(move |place| entry >> (LEAF_BITS + place) & 1 != 0)
        .map(move |place| first + place)
}

/// Follows the ray of one pixel of the full image until it ends.
pub fn disc_trace<R: Real>(
    ray: &mut Ray<R>,
    pixel: [u32; 2],
    (lists, levels): (&DiscLists, &Levels<R>),
    polynomials: &[Polynomial<R>],
) {
    let [x, y] = [0, 1].map(|axis| (pixel[axis] - lists.origin[axis]) / DISC_TILE);
    let [first, end] = lists.tiles[(y * lists.across + x) as usize].map(|at| at as usize);
    ray.cell = NONE;
    let missed = levels.enter(ray.origin, ray.direction, R::of(0.0)) == NONE;
    let mut next = if missed { end } else { first };
    while next < end {
        let leaves =
            &lists.leaves[next..end.min(next / LEAVES_AT_ONCE * LEAVES_AT_ONCE + LEAVES_AT_ONCE)];
        let batch: Vec<u32> = leaves.iter().flat_map(|&leaf| points_of(leaf)).collect();
        test_batch(ray, &batch, polynomials, None, None);
        next += leaves.len();
        let rank_mask = (1 << lists.ranks.bits) - 1;
        let rank = lists.keys.get(next).map_or(0, |key| key & rank_mask);
        if rank > depth_rank(&lists.ranks, ray.hit_t) {
            break;
        }
    }
}
