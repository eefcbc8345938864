//! Twin of `glsl/shared/film.glsl`: what a ray brings back to its pixel.

use crate::camera_rays::Ray;
use crate::path::Path;
use crate::real::{Real, V3};
use crate::surface_hit::Hit;
use kernels::layout::{FilmPixel, TRANSPARENT_GLASS};

/// Whether a path that ends in the background leaves it out of a transparent picture.
pub(crate) fn leaves_out(transparent: u32, from_camera: bool, reflected: bool) -> bool {
    match transparent {
        0 => false,
        TRANSPARENT_GLASS => from_camera || !reflected,
        _ => from_camera,
    }
}

/// The channels that a path carries. Of a path with lit surfaces behind it they are added.
pub(crate) fn write_channels<R: Real>(film: &mut FilmPixel, path: &Path<R>, radiance: V3<R>) {
    for (channel, value) in radiance.to_f32().into_iter().enumerate() {
        if path.channels >> channel & 1 != 0 {
            let color = &mut film.color[channel];
            *color = if path.adds { *color + value } else { value };
        }
    }
}

/// The alpha of a path that ends in the background.
pub(crate) fn write_alpha<R: Real>(film: &mut FilmPixel, path: &Path<R>) {
    for (channel, value) in path.alpha().to_f32().into_iter().enumerate() {
        if path.channels >> channel & 1 != 0 {
            film.alpha[channel] = value;
        }
    }
}

pub(crate) fn count_work<R>(film: &mut FilmPixel, ray: &Ray<R>) {
    film.counts[0] = film.counts[0].wrapping_add(ray.tests);
    film.counts[1] = film.counts[1].wrapping_add(ray.cells);
}

/// What the camera's ray of a pixel saw, but for its colour: a hit, its object, and the iterations that took.
pub(crate) fn write_first<R: Real>(
    film: &mut FilmPixel,
    ray: &Ray<R>,
    hit: Option<&(Hit<R>, u32)>,
    iterations: u32,
    forward: V3<R>,
) {
    film.counts[2] = ray.hit_slot;
    film.counts[3] = iterations;
    film.position_depth = [0.0, 0.0, 0.0, f32::INFINITY];
    film.normal_object = [0.0, 0.0, 0.0, -1.0];
    if let Some((hit, object)) = hit {
        let depth = hit.t * ray.direction.dot(forward);
        let ([x, y, z], [nx, ny, nz]) = (hit.position.to_f32(), hit.normal.to_f32());
        film.position_depth = [x, y, z, depth.to_f32()];
        film.normal_object = [nx, ny, nz, *object as f32];
        film.color[3] = 1.0;
    }
    film.alpha = [1.0; 3];
}
