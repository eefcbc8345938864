//! Twin of `classify`: what becomes of a ray that has met a surface, or nothing.

use super::{Passed, PixelTrace};
use crate::camera_rays::Ray;
use crate::environment::{background_at, sun_at};
use crate::film::{leaves_out, write_alpha, write_channels};
use crate::light::met_of;
use crate::material::{Fate, fate_at, survival_of};
use crate::media::{Way, transmittance};
use crate::path::Path;
use crate::real::{NO_HIT, Real, V3};
use crate::sampler::sample_1d;
use crate::surface_hit::Hit;
use kernels::layout::{NONE, SAMPLE_SURVIVAL, WAVE_LOSSES, WAVE_VALUES, WaveParams};

impl<R: Real> PixelTrace<'_, R> {
    /// The fate of a ray at the surface that it has met, and which way it goes through; `None`: it has met none, and ends
    /// in the background. Takes the absorption on the way from the path's throughput.
    pub(super) fn classify(
        &mut self,
        ray: &Ray<R>,
        hit: Option<&(Hit<R>, u32)>,
        (path, passed): (&mut Path<R>, &Passed<R>),
        from_camera: bool,
    ) -> Option<(Fate, Way)> {
        let objects = &self.plan.objects;
        let follows_paths = self.plan.follows_paths();
        if follows_paths {
            path.throughput = path.throughput.times((-passed.depth).exp_negative());
        }
        if !path.media.is_empty() {
            let way = hit.map_or(R::of(NO_HIT), |(hit, _)| hit.t);
            // Of a ray that grazes glass of the air's index, the way out may not have been seen.
            let dims = |&medium: &u32| hit.is_some() || objects[medium as usize].ior != [1.0; 3];
            let medium = path.media.medium(objects).filter(dims);
            path.throughput = path.throughput * transmittance(medium, way, objects);
        }
        let left_out = leaves_out(self.params.transparent, from_camera, path.reflected);
        if follows_paths {
            self.write_end_of_way(path, ray, (hit.map(|(hit, _)| hit.t), left_out), passed.sent);
        }
        let Some((_, object)) = hit else {
            if !follows_paths {
                self.write_background(path, ray.direction, left_out);
            }
            if from_camera {
                let taken = if follows_paths { passed.depth } else { path.depth };
                self.film.color[3] = taken.absorptance().to_f32();
            }
            return None;
        };
        let way = match self.reference.polynomials.get(ray.hit_slot as usize) {
            Some(hit) => hit.way_through(ray.origin, ray.direction, ray.hit_t),
            None => Way::Either,
        };
        let fate = fate_at(*object, objects, (&path.media, way, path.channels));
        Some((if follows_paths { self.fate_of_path(fate, path) } else { fate }, way))
    }

    /// Where light goes from surface to surface: whether rays still go on from there.
    fn fate_of_path(&self, mut fate: Fate, path: &Path<R>) -> Fate {
        let WaveParams { max_bounces, sample_index, seed, .. } = *self.params;
        // Beyond the last bounce, a ray only looks for the background.
        if path.bounces > max_bounces && !fate.passes {
            return Fate { lit: false, sends: false, ..fate };
        }
        let scatters = fate.sends && fate.lit;
        let finds_nothing = path.bounces == max_bounces && !self.plan.sky_lights();
        let index = if sample_index == NONE { 0 } else { sample_index };
        let drawn: R = sample_1d(self.pixel, index, seed, SAMPLE_SURVIVAL + path.bounces);
        let dies = drawn >= survival_of(path.throughput, path.channels, path.bounces);
        fate.sends &= !(scatters && (finds_nothing || dies));
        fate
    }

    /// What a ray brings along its way, and where that does not end on a surface, from the background.
    fn write_end_of_way(
        &mut self,
        path: &Path<R>,
        ray: &Ray<R>,
        (hit_t, left_out): (Option<R>, bool),
        sent: V3<R>,
    ) {
        let zero = V3::splat(R::of(0.0));
        let (images, background) = (self.albedos.images, &self.params.background);
        let mut seen = background_at(images, background, ray.direction);
        if self.plan.shows_sun() && !path.scattered {
            seen = seen + sun_at(images, background.environment, ray.direction);
        }
        let is_seen = hit_t.is_none() && !left_out;
        let mut brought = if is_seen { path.throughput * seen.times(path.share) } else { zero };
        if !self.plan.volumes.infos.is_empty() {
            brought = brought + sent;
        }
        if self.plan.meets_lamps() && !path.scattered && path.bounces > 0 {
            let end = hit_t.unwrap_or(R::of(NO_HIT));
            let met = (self.plan.lights.iter())
                .fold(zero, |sum, light| sum + met_of(light, ray.origin, ray.direction, end));
            brought = brought + path.throughput * met;
        }
        if path.indirect {
            brought = self.limited(path, brought);
        }
        write_channels(&mut self.film, path, brought);
        if hit_t.is_none() {
            write_alpha(&mut self.film, path);
        }
    }

    /// Of light that has come over several surfaces, no more than is wanted.
    pub(super) fn limited(&self, path: &Path<R>, radiance: V3<R>) -> V3<R> {
        let most = radiance.largest_of(path.channels);
        match self.plan.clamp.map(R::of_f32) {
            Some(clamp) if most > clamp => radiance.times(clamp / most),
            _ => radiance,
        }
    }

    /// A path's end in the background, which lies in `direction`.
    pub(super) fn write_background(&mut self, path: &Path<R>, direction: V3<R>, left_out: bool) {
        let background = if left_out {
            V3::splat(R::of(0.0))
        } else {
            let images = self.albedos.images;
            let background = &self.params.background;
            let mut seen = background_at(images, background, direction);
            if self.plan.shows_sun() {
                seen = seen + sun_at(images, background.environment, direction);
            }
            path.through_volumes(path.throughput * seen)
        };
        let mut brought = path.emitted + background;
        if path.indirect {
            brought = self.limited(path, brought);
        }
        write_channels(&mut self.film, path, brought);
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
