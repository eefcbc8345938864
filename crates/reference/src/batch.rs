//! What the twins of `grid_trace` and `disc_trace` share: up to 32 listed points are tested for the
//! nearest hit of a ray.
//!
//! The kernels write this loop out in both places: called as a function it costs lavapipe 1.25 times
//! the frame of the grid, and 1.4 times that of discs (docs/benchmarks.md).

use crate::camera_rays::Ray;
use crate::polynomial::{Polynomial, SHEET_REACH};
use crate::real::{NO_HIT, Real, V3};
use kernels::layout::{NONE, PASSED_NEAR};

/// Points tested before any is solved: the test uses the nearest hit of before the batch.
pub(crate) const BATCH: usize = 32;

/// The sheet that a ray starts on: its normal there, and its object.
pub(crate) type Sheet<R> = (V3<R>, u32);

/// Tests the points of `batch`, at most [`BATCH`] slots, those alone whose ball the ray enters `within`
/// a range of distances if one is given, for a ray that starts on `sheet` if on any.
pub(crate) fn test_batch<R: Real>(
    ray: &mut Ray<R>,
    batch: &[u32],
    polynomials: &[Polynomial<R>],
    within: Option<[R; 2]>,
    sheet: Option<Sheet<R>>,
) {
    let (o, d) = (ray.origin, ray.direction);
    ray.tests += batch.len() as u32;
    let nearest = ray.hit_t;
    for &slot in batch {
        let p = &polynomials[slot as usize];
        let near = p.near_trust_ball(o, d, nearest);
        if !near || within.is_some_and(|within| !p.entered_within(o, d, within)) {
            continue;
        }
        let own =
            sheet.is_some_and(|(normal, object)| p.object == object && p.same_sheet(o, normal));
        let is_sphere = p.is_sphere();
        let starts_near = ray.left == NONE && p.object == ray.passed ^ PASSED_NEAR;
        let skips = (own || starts_near) && !is_sphere;
        let from = if skips { R::of(SHEET_REACH) * p.trust } else { R::of(0.0) };
        let passed = p.object == ray.passed;
        let t = match slot == ray.left && is_sphere {
            _ if passed => R::of(NO_HIT),
            true => p.far_side(o, d),
            false => p.intersect(o, d, from),
        };
        let first_of_equals = || {
            polynomials
                .get(ray.hit_slot as usize)
                .is_none_or(|hit| (p.object, p.index) < (hit.object, hit.index))
        };
        let nearer = t < ray.hit_t || (t == ray.hit_t && t < R::of(NO_HIT) && first_of_equals());
        if nearer && t > ray.after {
            ray.hit_t = t;
            ray.hit_slot = slot;
        }
    }
}
