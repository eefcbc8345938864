//! Twin of `shadow_go_on`: a shadow ray on the other side of a surface that lets it through.

use super::ToLight;
use super::shadow_media::ShadowPath;
use super::shadow_meet::Met;
use crate::camera_rays::Ray;
use crate::real::{NO_HIT, Real};
use crate::surface_hit::surface_hit;

impl<R: Real> ToLight<'_, R> {
    /// `None` where nothing is left of the surface.
    pub(super) fn shadow_go_on(
        &self,
        ray: &Ray<R>,
        path: &mut ShadowPath<R>,
        met: Met<R>,
    ) -> Option<Ray<R>> {
        path.media = path.media.through(met.object, met.way);
        path.crossings += 1;
        let mut ray = *ray;
        ray.hit_slot = met.slot;
        let of_points = || surface_hit(&ray, &self.reference.polynomials);
        let hit = met.on_isosurface.or_else(of_points)?;
        let left = path.left;
        let is_finite = left < R::of(NO_HIT);
        path.left = if is_finite { (left - ray.hit_t).max(R::of(0.0)) } else { left };
        let mut next = Ray::new(hit.position, ray.direction, met.slot);
        (next.hit_t, next.passed) = (path.left, ray.passed);
        Some(next)
    }
}
