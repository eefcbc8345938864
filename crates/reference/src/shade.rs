//! Twin of `shade`: Lambert's law at the hit, the background where there is none.

use crate::albedo::Albedos;
use crate::camera_rays::Ray;
use crate::environment::background_at;
use crate::real::{Real, V3};
use crate::surface_hit::Hit;
use kernels::layout::{FilmPixel, LIGHT_POINT, Light, ShadeParams};

/// What shading reads besides the ray.
#[derive(Debug, Clone, Copy)]
pub struct Shading<'a, R> {
    /// Camera axis, background, light count.
    pub params: &'a ShadeParams,
    /// Colours of surfaces, and the images.
    pub albedos: Albedos<'a, R>,
    /// All lights.
    pub lights: &'a [Light],
}

/// What one light sends to a surface at x, by Lambert's law.
fn irradiance<R: Real>(light: &Light, x: V3<R>, normal: V3<R>) -> V3<R> {
    let zero = R::of(0.0);
    let (vector, strength) = (V3::of_f32(light.vector), V3::of_f32(light.strength));
    if light.kind != LIGHT_POINT {
        return strength.times(normal.dot(vector).max(zero));
    }
    let towards = vector - x;
    let square = towards.dot(towards);
    if square <= zero {
        return V3::splat(zero);
    }
    let l = towards.over(square.sqrt());
    strength.over(square).times(normal.dot(l).max(zero))
}

/// What one pixel shows. `hit` comes with its object; `iterations` are those of its refinement.
#[must_use]
pub fn shade<R: Real>(
    ray: &Ray<R>,
    hit: Option<(Hit<R>, u32)>,
    iterations: u32,
    shading: &Shading<'_, R>,
) -> FilmPixel {
    let params = shading.params;
    let counts = [ray.tests, ray.cells, ray.hit_slot, iterations];
    let Some((hit, object)) = hit else {
        let behind = || background_at(shading.albedos.images, &params.background, ray.direction);
        let [r, g, b] = if params.transparent != 0 { [0.0; 3] } else { behind().to_f32() };
        return FilmPixel {
            color: [r, g, b, 0.0],
            position_depth: [0.0, 0.0, 0.0, f32::INFINITY],
            normal_object: [0.0, 0.0, 0.0, -1.0],
            counts,
        };
    };
    let Hit { position: x, normal, .. } = hit;
    let light = shading
        .lights
        .iter()
        .take(params.light_count as usize)
        .fold(V3::splat(R::of(0.0)), |sum, light| sum + irradiance(light, x, normal));
    let color = shading.albedos.albedo_at(object, ray.hit_slot, x);
    let [r, g, b] = (color * light.times(R::of(std::f64::consts::FRAC_1_PI))).to_f32();
    let [px, py, pz] = x.to_f32();
    let [nx, ny, nz] = normal.to_f32();
    let depth = hit.t * ray.direction.dot(V3::of_f32(params.forward));
    FilmPixel {
        color: [r, g, b, 1.0],
        position_depth: [px, py, pz, depth.to_f32()],
        normal_object: [nx, ny, nz, object as f32],
        counts,
    }
}
