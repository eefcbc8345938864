//! Twin of `disc_trace`: the nearest hit of a camera ray among the points whose discs cover its
//! screen tile (\[T\] §4).

use crate::camera_rays::Ray;
use crate::disc::depth_rank;
use crate::disc_bin::DiscLists;
use crate::polynomial::Polynomial;
use crate::real::{NO_HIT, Real};
use kernels::layout::{DISC_TILE, NONE};

/// Points tested before any is solved: the test uses the nearest hit of before the batch.
const BATCH: usize = 32;

/// Follows the ray of one pixel of the full image until it ends.
pub fn disc_trace<R: Real>(
    ray: &mut Ray<R>,
    pixel: [u32; 2],
    lists: &DiscLists,
    polynomials: &[Polynomial<R>],
) {
    let (o, d) = (ray.origin, ray.direction);
    let [x, y] = [0, 1].map(|axis| (pixel[axis] - lists.origin[axis]) / DISC_TILE);
    let [first, end] = lists.tiles[(y * lists.across + x) as usize].map(|at| at as usize);
    let missed = std::mem::replace(&mut ray.cell, NONE) == NONE;
    let mut next = if missed { end } else { first };
    while next < end {
        let batch = &lists.slots[next..end.min(next + BATCH)];
        let nearest = ray.hit_t;
        for &slot in batch {
            let p = &polynomials[slot as usize];
            if p.near_trust_ball(o, d, nearest) {
                let t = p.intersect(o, d);
                let first_of_equals = || {
                    polynomials
                        .get(ray.hit_slot as usize)
                        .is_some_and(|hit| (p.object, p.index) < (hit.object, hit.index))
                };
                let nearer =
                    t < ray.hit_t || (t == ray.hit_t && t < R::of(NO_HIT) && first_of_equals());
                if nearer && t > ray.after {
                    ray.hit_t = t;
                    ray.hit_slot = slot;
                }
            }
        }
        next += batch.len();
        ray.tests += batch.len() as u32;
        let rank_mask = (1 << lists.ranks.bits) - 1;
        let rank = lists.keys.get(next).map_or(0, |key| key & rank_mask);
        if rank > depth_rank(&lists.ranks, ray.hit_t) {
            break;
        }
    }
}
