//! Twin of `shadow_meet`: what the surface that a shadow ray has met does to light.

use super::ToLight;
use super::shadow_media::ShadowPath;
use crate::camera_rays::Ray;
use crate::material::light_passed;
use crate::media::{Way, transmittance};
use crate::real::{NO_HIT, Real, V3};
use crate::surface_hit::Hit;
use kernels::layout::{MOST_CROSSINGS, NONE, PASSED_NEAR};

/// A surface that lets light through.
pub(super) struct Met<R> {
    /// Where, if it is an isosurface.
    pub on_isosurface: Option<Hit<R>>,
    pub slot: u32,
    pub object: u32,
    pub way: Way,
}

impl<R: Real> ToLight<'_, R> {
    /// Takes from the light what the media on the way and the surface do. `None`: nothing is left; `Some(None)`: the ray
    /// has arrived. Of a ray that is let through, isosurfaces and volumes as far as that surface count: it has no hit.
    /// `on_isosurface` is the hit where it is one with an isosurface.
    pub(super) fn shadow_meet(
        &self,
        ray: &mut Ray<R>,
        path: &mut ShadowPath<R>,
        arriving: &mut V3<R>,
        on_isosurface: Option<Hit<R>>,
    ) -> Option<Option<Met<R>>> {
        let objects = &self.plan.objects;
        let slot = ray.hit_slot;
        // The last part ends at the light: what that is not inside, the ray has left unseen, or was never in.
        if let Some(lamp) = self.plan.lamp_media[self.light].as_ref().filter(|_| slot == NONE) {
            let passed = self.passed & !PASSED_NEAR;
            path.media.retain(|object| lamp.contains(&object) || object == passed);
        }
        // Infinitely far away, rays are outside everything: of a grazing one, the way out was not seen.
        let is_finite = ray.hit_t < R::of(NO_HIT);
        let medium = path.media.medium(objects).filter(|&medium| medium != self.passed);
        let medium = medium.filter(|_| is_finite);
        *arriving = *arriving * transmittance(medium, ray.hit_t, objects);
        if slot == NONE {
            return Some(None);
        }
        let polynomial = &self.reference.polynomials[slot as usize];
        let object = polynomial.object;
        let way = polynomial.way_through(ray.origin, ray.direction, ray.hit_t);
        let of_points = || polynomial.surface_at(ray.origin, ray.direction, ray.hit_t).1;
        let normal = on_isosurface.map_or_else(of_points, |hit| hit.normal);
        let tints = self.plan.tints(self.light as u32);
        let crossed = (&path.media, way);
        let share = light_passed(object, objects, crossed, [ray.direction, normal], tints);
        let zero = R::of(0.0);
        let any = |light: V3<R>| light.0.iter().any(|&channel| channel > zero);
        if !any(share) || path.crossings >= MOST_CROSSINGS {
            return None;
        }
        *arriving = *arriving * share;
        ray.hit_slot = NONE;
        any(*arriving).then_some(Some(Met { on_isosurface, slot, object, way }))
    }
}
