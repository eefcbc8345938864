//! Twin of `surface_hit`: where a ray that has ended met the polynomial it hit.

use crate::camera_rays::Ray;
use crate::polynomial::Polynomial;
use crate::real::{Real, V3};

/// Where a ray met a surface (`Hit` in `glsl/stages/rays.glsl`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit<R> {
    /// Centred scene space.
    pub position: V3<R>,
    /// Distance along the ray.
    pub t: R,
    /// Unit normal facing the ray's origin.
    pub normal: V3<R>,
}

/// The hit of a ray with the stored polynomial; `None` where it hit nothing.
#[must_use]
pub fn surface_hit<R: Real>(ray: &Ray<R>, polynomials: &[Polynomial<R>]) -> Option<Hit<R>> {
    let p = polynomials.get(ray.hit_slot as usize)?;
    let (y, normal) = p.surface_at(ray.origin, ray.direction, ray.hit_t);
    Some(Hit { position: p.center + y, t: ray.hit_t, normal })
}
