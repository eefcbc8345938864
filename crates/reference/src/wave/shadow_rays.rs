//! Twin of `shadow_rays`: the ray from a lit hit towards a light.

use super::PixelTrace;
use crate::camera_rays::Ray;
use crate::light::sample_light;
use crate::material::{Place, lobe};
use crate::real::{Real, V3};
use crate::sampler::sample_2d;
use crate::surface_hit::Hit;
use kernels::layout::{NONE, SAMPLE_LIGHT, WaveParams};

impl<R: Real> PixelTrace<'_, R> {
    /// The ray towards light i and what it would bring; `None` where nothing of it is scattered.
    pub(super) fn shadow_ray(
        &self,
        i: u32,
        hit: &Hit<R>,
        place: &Place<'_, R>,
        slot: u32,
    ) -> Option<(Ray<R>, V3<R>)> {
        let zero = R::of(0.0);
        let u = place_on_light(self.params, self.pixel, i);
        let sample = sample_light(&self.plan.lights[i as usize], hit.position, u);
        let arriving = sample.arriving * lobe(place, sample.towards);
        let arrives = arriving.0.iter().any(|&channel| channel > zero);
        arrives.then(|| {
            let mut ray = Ray::new(hit.position, sample.towards, slot);
            ray.hit_t = sample.distance;
            (ray, arriving)
        })
    }
}

/// The place on light i that a sample of a pixel of the full image asks for: its centre, unless there are
/// several samples.
fn place_on_light<R: Real>(params: &WaveParams, pixel: [u32; 2], i: u32) -> [R; 2] {
    if params.sample_index == NONE {
        return [R::of(0.5); 2];
    }
    sample_2d(pixel, params.sample_index, params.seed, SAMPLE_LIGHT + i)
}
