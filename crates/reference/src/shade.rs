//! Twin of `shade`: Lambert's law at the hit, the background where there is none.

use crate::camera_rays::Ray;
use crate::light::sample_light;
use crate::real::{Real, V3};
use crate::sampler::sample_2d;
use crate::surface_hit::Hit;
use kernels::layout::{FilmPixel, Light, NONE, ObjectInfo, SAMPLE_LIGHT, ShadeParams};

/// What shading reads besides the ray.
#[derive(Debug, Clone, Copy)]
pub struct Shading<'a> {
    /// Camera axis, background, light count.
    pub params: &'a ShadeParams,
    /// One an object.
    pub objects: &'a [ObjectInfo],
    /// Three floats a point.
    pub colors: &'a [f32],
    /// All lights.
    pub lights: &'a [Light],
}

fn point_color<R: Real>(shading: &Shading<'_>, object: &ObjectInfo, slot: u32) -> V3<R> {
    if object.first_color == NONE {
        return V3::of_f32(object.albedo);
    }
    let at = (object.first_color + 3 * (slot - object.first_slot)) as usize;
    V3([0, 1, 2].map(|channel| R::of_f32(shading.colors[at + channel])))
}

/// What light i sends to a surface at x, by Lambert's law: from its centre, unless it is sampled.
fn irradiance<R: Real>(
    shading: &Shading<'_>,
    i: u32,
    pixel: [u32; 2],
    x: V3<R>,
    normal: V3<R>,
) -> V3<R> {
    let params = shading.params;
    let u = if params.sample_index == NONE {
        [R::of(0.5); 2]
    } else {
        let pixel = [0, 1].map(|axis| params.tile_origin[axis] + pixel[axis]);
        sample_2d(pixel, params.sample_index, params.seed, SAMPLE_LIGHT + i)
    };
    let light = sample_light(&shading.lights[i as usize], x, u);
    light.arriving.times(normal.dot(light.towards).max(R::of(0.0)))
}

/// What one pixel of the tile shows. `hit` comes with its object; `iterations` are those of its
/// refinement.
#[must_use]
pub fn shade<R: Real>(
    ray: &Ray<R>,
    hit: Option<(Hit<R>, u32)>,
    iterations: u32,
    pixel: [u32; 2],
    shading: &Shading<'_>,
) -> FilmPixel {
    let params = shading.params;
    let counts = [ray.tests, ray.cells, ray.hit_slot, iterations];
    let Some((hit, object)) = hit else {
        let [r, g, b] = if params.transparent != 0 { [0.0; 3] } else { params.background };
        return FilmPixel {
            color: [r, g, b, 0.0],
            position_depth: [0.0, 0.0, 0.0, f32::INFINITY],
            normal_object: [0.0, 0.0, 0.0, -1.0],
            counts,
        };
    };
    let Hit { position: x, normal, .. } = hit;
    let light = (0..params.light_count)
        .fold(V3::splat(R::of(0.0)), |sum, i| sum + irradiance(shading, i, pixel, x, normal));
    let color = point_color(shading, &shading.objects[object as usize], ray.hit_slot);
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
