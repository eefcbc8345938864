//! What becomes of the rays of one pixel. Each kernel of a wave has its twin in a file of its name below `wave/`, which is
//! declared and called here.
//!
//! The device goes wave by wave, with all rays of one generation at once; the twin follows one path
//! after the other. No ray of a pixel depends on another, so both give the same bits.

mod classify;
mod scatter;
mod shade;
mod shadow_rays;
mod sky_rays;

use crate::Reference;
use crate::albedo::Albedos;
use crate::camera_rays::Ray;
use crate::disc_bin::DiscLists;
use crate::disc_trace::disc_trace;
use crate::film::{count_work, write_first};
use crate::grid_trace::grid_trace;
use crate::isosurface::isosurface;
use crate::levels::Levels;
use crate::march::{Along, March, half_lost, is_whole, march};
use crate::media::Media;
use crate::path::Path;
use crate::real::{NO_HIT, Real, V3};
use crate::sampler::sample_1d;
use crate::sky::Sky;
use crate::surface_hit::Hit;
use crate::volume::Lighting;
use kernels::layout::{DISTANCES_A_CROSSING, FilmPixel, NONE, SAMPLE_DISTANCE, WaveParams};
use plan::{Plan, Rays};

/// What volumes have done to a ray before its end, where light goes from surface to surface.
struct Passed<R> {
    /// Sent to the pixel.
    sent: V3<R>,
    /// Optical depth.
    depth: R,
}

/// One pixel while its rays are followed.
pub(crate) struct PixelTrace<'a, R> {
    pub reference: &'a Reference<R>,
    pub plan: &'a Plan,
    pub levels: &'a Levels<R>,
    pub params: &'a WaveParams,
    pub albedos: &'a Albedos<'a, R>,
    /// In the full image.
    pub pixel: [u32; 2],
    pub film: FilmPixel,
    pub rays: Rays,
    /// The camera ray is not followed beyond the first surface.
    pub ends_at_first: bool,
}

impl<R: Real> PixelTrace<'_, R> {
    /// Follows a camera ray and all that come of it. By discs where they are given.
    pub fn run(&mut self, ray: Ray<R>, discs: Option<&DiscLists>) {
        // Where light goes from surface to surface, the throughput lacks what volumes take.
        let keeps_depths = !self.plan.volumes.infos.is_empty() && !self.plan.follows_paths();
        let camera = Path::of_camera(&self.plan.camera_media, keeps_depths);
        let mut rays = vec![(ray, Path { adds: self.plan.follows_paths(), ..camera })];
        let mut discs = discs;
        let mut from_camera = true;
        while let Some((mut ray, path)) = rays.pop() {
            match discs.take() {
                Some(lists) => {
                    disc_trace(
                        &mut ray,
                        self.pixel,
                        (lists, self.levels),
                        &self.reference.polynomials,
                    );
                }
                None => self.trace(&mut ray, false),
            }
            let (mut hit, mut iterations) = self.reference.settle(self.plan, self.levels, &mut ray);
            let end = hit.as_ref().map_or(R::of(NO_HIT), |(hit, _)| hit.t);
            if let Some((nearer, slot)) = isosurface(&ray, end, &path.media, &self.plan.volumes) {
                hit = Some((nearer, self.reference.polynomials[slot as usize].object));
                ray.hit_slot = slot;
                iterations = 0;
            }
            count_work(&mut self.film, &ray);
            if from_camera {
                let forward = V3::of_f32(self.params.forward);
                write_first(&mut self.film, &ray, hit.as_ref(), iterations, forward);
            }
            if self.ends_at_first {
                let end = hit.as_ref().map_or(R::of(NO_HIT), |(hit, _)| hit.t);
                let wants = self.plan.wants_along();
                let light =
                    if self.plan.follows_paths() { Along::Emitted } else { self.lighting() };
                let march = wants.then(|| self.march(&ray, end, &path.media, light));
                if let Some(march) = march.flatten() {
                    self.film.along = self.along(&ray, end, &path.media, &march).to_f32();
                }
                return;
            }
            self.interact(&ray, hit, path, from_camera, &mut rays);
            from_camera = false;
        }
    }

    fn trace(&self, ray: &mut Ray<R>, any_hit: bool) {
        let Reference { lists, polynomials, .. } = self.reference;
        grid_trace(ray, self.levels, lists, polynomials, any_hit);
    }

    /// What a ray meets on its way and at its end, and what comes of it.
    fn interact(
        &mut self,
        ray: &Ray<R>,
        mut hit: Option<(Hit<R>, u32)>,
        mut path: Path<R>,
        from_camera: bool,
        rays: &mut Vec<(Ray<R>, Path<R>)>,
    ) {
        let ray = &mut ray.clone();
        let end = hit.as_ref().map_or(R::of(NO_HIT), |(hit, _)| hit.t);
        let marched = self.march(ray, end, &path.media, self.light_along(&path));
        let mut passed = Passed { sent: V3::splat(R::of(0.0)), depth: R::of(0.0) };
        if let Some(march) = marched {
            let through = path.throughput.times((-path.depth).exp_negative());
            if self.plan.follows_paths() {
                passed = Passed { sent: path.throughput * march.color, depth: march.depth };
                if let Some(at) = march.scattered {
                    let position = ray.origin + ray.direction.times(at.t);
                    let met = Hit { position, t: at.t, normal: at.color };
                    hit = Some((met, self.reference.polynomials[at.slot as usize].object));
                    (ray.hit_slot, ray.hit_t) = (at.slot, at.t);
                    if from_camera {
                        self.film.color[3] = 1.0;
                    }
                }
            } else {
                path.emitted = path.emitted + through * march.color;
                path.depth = path.depth + march.depth;
            }
            if from_camera {
                self.film.along = self.along(ray, end, &path.media, &march).to_f32();
            } else if path.channels & 1 != 0 && !path.reflected {
                self.show_later(ray, |trace| trace.along(ray, end, &path.media, &march));
            }
        }
        let fate = self.classify(ray, hit.as_ref(), (&mut path, &passed), from_camera);
        let (Some((fate, way)), Some((hit, object))) = (fate, hit) else { return };
        if fate.lit {
            self.shade(ray, &hit, object, &path);
        }
        if fate.sends {
            self.scatter(ray, &hit, (object, way, &fate), &path, rays);
        }
    }

    /// What the volumes of the scene do to a ray; `None` where there are none.
    fn march(&self, ray: &Ray<R>, end: R, media: &Media, light: Along<'_, R>) -> Option<March<R>> {
        let volumes = &self.plan.volumes;
        volumes.any_marched().then(|| march(ray, end, media, volumes, &self.plan.objects, light))
    }

    /// What channels of volumes show of a camera ray.
    fn along(&self, ray: &Ray<R>, end: R, media: &Media, march: &March<R>) -> R {
        let volumes = &self.plan.volumes;
        if !self.plan.wants_volume_depth() || volumes.infos.iter().any(is_whole) {
            return march.along;
        }
        let t = half_lost(ray, end, media, volumes, self.lighting().lamps(), march.depth);
        t.map_or(R::of(-1.0), |t| t * ray.direction.dot(V3::of_f32(self.params.forward)))
    }

    /// Where the environment is bright.
    fn sky(&self) -> Sky<'_> {
        Sky {
            images: self.albedos.images,
            background: &self.params.background,
            table: &self.plan.environment_table,
        }
    }

    fn lighting(&self) -> Along<'_, R> {
        let (visible, lights) = (&self.reference.visible, self.plan.lamps());
        match self.plan.volumes.any_lit() {
            true => Along::OfLamps(Lighting { visible, lights }),
            false => Along::Emitted,
        }
    }

    /// The light that counts along a path's ray.
    fn light_along(&self, path: &Path<R>) -> Along<'_, R> {
        if !self.plan.follows_paths() {
            return self.lighting();
        }
        let WaveParams { sample_index, seed, .. } = *self.params;
        let index = if sample_index == NONE { 0 } else { sample_index };
        let dimension = SAMPLE_DISTANCE + path.bounces + DISTANCES_A_CROSSING * path.crossings;
        let drawn: R = sample_1d(self.pixel, index, seed, dimension);
        Along::Scattered(drawn.depth_of_chance())
    }
}
