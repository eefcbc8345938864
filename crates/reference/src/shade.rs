//! Twin of `shadow_rays` and `shade`: Lambert's law at a diffuse hit, with the lights that reach it.

use crate::camera_rays::Ray;
use crate::levels::Levels;
use crate::light::sample_light;
use crate::real::{Real, V3};
use crate::sampler::sample_2d;
use crate::surface_hit::Hit;
use kernels::layout::{Light, NONE, SAMPLE_LIGHT, WaveParams};

/// The ray from a hit towards a light and what it would bring; `None` where the light lies behind the
/// surface. `u` says towards which place on the light.
pub fn shadow_ray<R: Real>(
    light: &Light,
    u: [R; 2],
    hit: &Hit<R>,
    slot: u32,
    levels: &Levels<R>,
) -> Option<(Ray<R>, V3<R>)> {
    let zero = R::of(0.0);
    let sample = sample_light(light, hit.position, u);
    let arriving = sample.arriving.times(hit.normal.dot(sample.towards).max(zero));
    let arrives = arriving.0.iter().any(|&channel| channel > zero);
    arrives.then(|| {
        let mut ray = Ray::new(hit.position, sample.towards, levels, slot);
        ray.hit_t = sample.distance;
        (ray, arriving)
    })
}

/// The place on light i that a sample of a pixel of the full image asks for: its centre, unless there are
/// several samples.
pub fn place_on_light<R: Real>(params: &WaveParams, pixel: [u32; 2], i: u32) -> [R; 2] {
    if params.sample_index == NONE {
        return [R::of(0.5); 2];
    }
    sample_2d(pixel, params.sample_index, params.seed, SAMPLE_LIGHT + i)
}

/// The radiance that a diffuse surface scatters under this irradiance.
pub fn lambert<R: Real>(albedo: V3<R>, irradiance: V3<R>) -> V3<R> {
    albedo * irradiance.times(R::of(std::f64::consts::FRAC_1_PI))
}
