//! Twin of `shade`: what a lit surface scatters of the lights that reach it.

use super::PixelTrace;
use crate::camera_rays::Ray;
use crate::direction::{packed_direction, unpacked_direction};
use crate::film::{count_work, write_channels};
use crate::isosurface::blocks;
use crate::march::Along;
use crate::material::{Place, scattered};
use crate::media::Media;
use crate::path::Path;
use crate::real::{Real, V3};
use crate::surface_hit::Hit;
use crate::to_light::light_through;
use kernels::layout::{LIGHT_ENVIRONMENT, LIGHT_SKY, NONE};

impl<R: Real> PixelTrace<'_, R> {
    pub(super) fn shade(&mut self, ray: &Ray<R>, hit: &Hit<R>, object: u32, path: &Path<R>) {
        let info = &self.plan.objects[object as usize];
        let d = unpacked_direction(packed_direction(ray.direction));
        let place = Place { d, normal: hit.normal, info };
        let slot = ray.hit_slot;
        let mut light = V3::splat(R::of(0.0));
        for i in 0..self.plan.lights.len() as u32 {
            let towards = match self.plan.lights[i as usize].kind {
                LIGHT_SKY | LIGHT_ENVIRONMENT => self.sky_ray(i, hit, (&place, path), slot),
                _ => self.shadow_ray(i, hit, (&place, path), slot),
            };
            let Some((ray, arriving)) = towards else { continue };
            self.rays.shadow += 1;
            if let Some(arriving) = self.gathered(ray, arriving, i as usize, &path.media) {
                light = light + arriving;
            }
        }
        let albedo = || self.albedo_of(&place, object, slot, hit.position);
        let radiance = scattered(info, light, albedo);
        let mut seen = path.through_volumes(path.throughput * radiance);
        if path.scattered || path.indirect {
            seen = self.limited(path, seen);
        }
        write_channels(&mut self.film, path, path.emitted + seen);
    }

    /// What comes of a light along a shadow ray; `None`: nothing.
    fn gathered(
        &mut self,
        mut ray: Ray<R>,
        arriving: V3<R>,
        light: usize,
        media: &Media,
    ) -> Option<V3<R>> {
        if self.plan.light_passes {
            let (reference, scene) = (self.reference, (self.plan, self.levels, light));
            let account = |ray: &Ray<R>| count_work(&mut self.film, ray);
            return Some(light_through(
                reference,
                scene,
                ray,
                arriving,
                media.clone(),
                NONE,
                account,
            ));
        }
        self.trace(&mut ray, true);
        count_work(&mut self.film, &ray);
        if ray.hit_slot != NONE || blocks(&ray, ray.hit_t, &self.plan.volumes) {
            return None;
        }
        Some(match self.march(&ray, ray.hit_t, media, Along::Emitted) {
            Some(march) => arriving.times((-march.depth).exp_negative()),
            None => arriving,
        })
    }
}
