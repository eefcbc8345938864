//! Twin of `shadow_rays`: the ray from a lit hit towards a light.

use super::PixelTrace;
use crate::camera_rays::Ray;
use crate::light::sample_light;
use crate::material::{Place, lobe};
use crate::path::Path;
use crate::real::{Real, V3};
use crate::sampler::{sample_2d, shared_sample};
use crate::surface_hit::Hit;
use kernels::layout::{NONE, SAMPLE_LIGHT, SAMPLES_A_BOUNCE};

impl<R: Real> PixelTrace<'_, R> {
    /// The ray towards light i and what it would bring; `None` where nothing of it is scattered.
    pub(super) fn shadow_ray(
        &self,
        i: u32,
        hit: &Hit<R>,
        (place, path): (&Place<'_, R>, &Path<R>),
        slot: u32,
    ) -> Option<(Ray<R>, V3<R>)> {
        let zero = R::of(0.0);
        let u = match self.params.sample_index {
            NONE => [R::of(0.5); 2], // of the light: its centre, unless it is sampled
            sample => {
                let shares = self.plan.sky_lights() || self.plan.follows_paths();
                let (pixel, index) = match shares {
                    true => shared_sample(self.pixel, sample, self.params.sample_bits),
                    false => (self.pixel, sample),
                };
                sample_2d(pixel, index, self.params.seed, self.dimension_of_light(i, path))
            }
        };
        let sample = sample_light(&self.plan.lights[i as usize], hit.position, u);
        let arriving = sample.arriving * lobe(place, sample.towards);
        let arrives = arriving.0.iter().any(|&channel| channel > zero);
        arrives.then(|| {
            let mut ray = Ray::new(hit.position, sample.towards, slot);
            ray.hit_t = sample.distance;
            (ray, arriving)
        })
    }

    /// Which of the numbers of a sample choose a place on light i. Where light goes from surface to surface, each bounce has
    /// its own.
    pub(super) fn dimension_of_light(&self, i: u32, path: &Path<R>) -> u32 {
        let bounce = if self.plan.follows_paths() { path.bounces } else { 0 };
        SAMPLE_LIGHT + i + SAMPLES_A_BOUNCE * bounce
    }
}
