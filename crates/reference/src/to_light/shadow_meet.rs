//! Twin of `shadow_meet`: what the surface that a shadow ray has met does to light.

use super::ToLight;
use super::shadow_media::ShadowPath;
use crate::camera_rays::Ray;
use crate::material::lets_light_pass;
use crate::media::{Way, transmittance};
use crate::real::{NO_HIT, Real, V3};
use kernels::layout::{MOST_CROSSINGS, NONE, PASSED_NEAR};

/// A surface that lets light through.
pub(super) struct Met {
    pub slot: u32,
    pub object: u32,
    pub way: Way,
}

impl<R: Real> ToLight<'_, R> {
    /// Takes from the light what the media on the way and the surface do. `None`: nothing is left; `Some(None)`: the ray
    /// has arrived. Of a ray that is let through, isosurfaces and volumes as far as that surface count: it has no hit.
    pub(super) fn shadow_meet(
        &self,
        ray: &mut Ray<R>,
        path: &mut ShadowPath<R>,
        arriving: &mut V3<R>,
    ) -> Option<Option<Met>> {
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
        let lets = lets_light_pass(object, objects, (&path.media, way));
        if lets == [false; 3] || path.crossings >= MOST_CROSSINGS {
            return None;
        }
        let zero = R::of(0.0);
        let of = |channel: usize| if lets[channel] { arriving.0[channel] } else { zero };
        *arriving = V3([0, 1, 2].map(of));
        ray.hit_slot = NONE;
        arriving.0.iter().any(|&channel| channel > zero).then_some(Some(Met { slot, object, way }))
    }
}
