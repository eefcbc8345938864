//! What the twins of `grid_trace` and `disc_trace` share: up to 32 listed points are tested for the
//! nearest hit of a ray.
//!
//! The kernels write this loop out in both places: called as a function it costs lavapipe 1.25 times
//! the frame of the grid, and 1.4 times that of discs (docs/benchmarks.md).

use crate::camera_rays::Ray;
use crate::polynomial::Polynomial;
use crate::real::{NO_HIT, Real};

/// Points tested before any is solved: the test uses the nearest hit of before the batch.
pub(crate) const BATCH: usize = 32;

/// Tests the points of `batch`, at most [`BATCH`] slots.
pub(crate) fn test_batch<R: Real>(ray: &mut Ray<R>, batch: &[u32], polynomials: &[Polynomial<R>]) {
    let (o, d) = (ray.origin, ray.direction);
    ray.tests += batch.len() as u32;
    let nearest = ray.hit_t;
    for &slot in batch {
        let p = &polynomials[slot as usize];
        if !p.near_trust_ball(o, d, nearest) {
            continue;
        }
        let t = p.intersect(o, d);
        let first_of_equals = || {
            polynomials
                .get(ray.hit_slot as usize)
                .is_some_and(|hit| (p.object, p.index) < (hit.object, hit.index))
        };
        let nearer = t < ray.hit_t || (t == ray.hit_t && t < R::of(NO_HIT) && first_of_equals());
        if nearer && t > ray.after {
            ray.hit_t = t;
            ray.hit_slot = slot;
        }
    }
}
