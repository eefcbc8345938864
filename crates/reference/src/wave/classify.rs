//! Twin of `classify`: what becomes of a ray that has met a surface, or nothing.

use super::PixelTrace;
use crate::camera_rays::Ray;
use crate::environment::background_at;
use crate::film::{leaves_out, write_alpha, write_channels};
use crate::material::{Fate, fate_at};
use crate::media::{Way, transmittance};
use crate::path::Path;
use crate::real::{NO_HIT, Real, V3};
use crate::surface_hit::Hit;
use kernels::layout::{WAVE_LOSSES, WAVE_VALUES};

impl<R: Real> PixelTrace<'_, R> {
    /// The fate of a ray at the surface that it has met, and which way it goes through; `None`: it has met none, and ends
    /// in the background. Takes the absorption on the way from the path's throughput.
    pub(super) fn classify(
        &mut self,
        ray: &Ray<R>,
        hit: Option<&(Hit<R>, u32)>,
        path: &mut Path<R>,
        from_camera: bool,
    ) -> Option<(Fate, Way)> {
        let objects = &self.plan.objects;
        if !path.media.is_empty() {
            let way = hit.map_or(R::of(NO_HIT), |(hit, _)| hit.t);
            // Of a ray that grazes glass of the air's index, the way out may not have been seen.
            let dims = |&medium: &u32| hit.is_some() || objects[medium as usize].ior != [1.0; 3];
            let medium = path.media.medium(objects).filter(dims);
            path.throughput = path.throughput * transmittance(medium, way, objects);
        }
        let Some((_, object)) = hit else {
            let left_out = leaves_out(self.params.transparent, from_camera, path.reflected);
            self.write_background(path, ray.direction, left_out);
            if from_camera {
                self.film.color[3] = path.depth.absorptance().to_f32();
            }
            return None;
        };
        let way = match self.reference.polynomials.get(ray.hit_slot as usize) {
            Some(hit) => hit.way_through(ray.origin, ray.direction, ray.hit_t),
            None => Way::Either,
        };
        Some((fate_at(*object, objects, (&path.media, way, path.channels)), way))
    }

    /// A path's end in the background, which lies in `direction`.
    pub(super) fn write_background(&mut self, path: &Path<R>, direction: V3<R>, left_out: bool) {
        let background = if left_out {
            V3::splat(R::of(0.0))
        } else {
            let images = self.albedos.images;
            let seen = background_at(images, &self.params.background, direction);
            path.through_volumes(path.throughput * seen)
        };
        write_channels(&mut self.film, path, path.emitted + background);
        write_alpha(&mut self.film, path);
    }

    /// What channels of volumes show of a later part of the camera's way, where no part before had anything. Depth goes on
    /// from the first surface.
    pub(super) fn show_later(&mut self, ray: &Ray<R>, along: impl FnOnce(&Self) -> R) {
        let (shows, shown) = (self.plan.shows_of_volumes(), self.film.along);
        if shows == WAVE_VALUES && shown == 0.0 {
            self.film.along = along(self).to_f32();
        } else if shows == WAVE_LOSSES && shown < 0.0 {
            let along = along(self);
            if along >= R::of(0.0) {
                let [x, y, z, depth] = self.film.position_depth;
                let since = ray.origin - V3::of_f32([x, y, z]);
                let before = R::of_f32(depth) + since.dot(V3::of_f32(self.params.forward));
                self.film.along = (before + along).to_f32();
            }
        }
    }
}
