//! Twin of `classify`, `shadow_rays`, `shade` and `scatter`: what becomes of the rays of one pixel.
//!
//! The device goes wave by wave, with all rays of one generation at once; the twin follows one path
//! after the other. No ray of a pixel depends on another, so both give the same bits.

use crate::Reference;
use crate::albedo::Albedos;
use crate::camera_rays::Ray;
use crate::disc_bin::DiscLists;
use crate::disc_trace::disc_trace;
use crate::environment::background_at;
use crate::grid_trace::grid_trace;
use crate::isosurface::{blocks, isosurface};
use crate::levels::Levels;
use crate::light_passes::light_through;
use crate::media::{Media, Way, ior_of, transmittance};
use crate::optics::{reflected, refraction};
use crate::real::{NO_HIT, Real, V3};
use crate::sampler::sample_1d;
use crate::shade::{lambert, place_on_light, shadow_ray};
use crate::surface_hit::Hit;
use crate::volume::{Lighting, March, half_lost, is_whole, march};
use kernels::layout::{
    CHANNELS_ALL, FilmPixel, MATERIAL_DIFFUSE, MATERIAL_GLASS, MOST_CROSSINGS, NONE,
    SAMPLE_FRESNEL, TRANSPARENT_GLASS, WAVE_LOSSES, WAVE_VALUES, WaveParams,
};
use plan::{Plan, Rays};

/// What a ray has behind it (`Path` in `glsl/shared/layout.glsl`).
#[derive(Debug, Clone)]
struct Path<R> {
    throughput: V3<R>,
    channels: u32,
    reflected: bool,
    bounces: u32,
    crossings: u32,
    media: Media,
    /// What volumes on its way have sent to the pixel.
    emitted: V3<R>,
    /// Optical depth of the volumes on its way so far, which is no part of the throughput.
    depth: R,
}

impl<R: Real> Path<R> {
    /// What of a light comes through the volumes on the path.
    fn through_volumes(&self, has_volumes: bool, light: V3<R>) -> V3<R> {
        if has_volumes { light.times((-self.depth).exp_negative()) } else { light }
    }
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
        let path = Path {
            throughput: V3::splat(R::of(1.0)),
            channels: CHANNELS_ALL,
            reflected: false,
            bounces: 0,
            crossings: 0,
            media: Media::of(&self.plan.camera_media),
            emitted: V3::splat(R::of(0.0)),
            depth: R::of(0.0),
        };
        let mut rays = vec![(ray, path)];
        let mut discs = discs;
        let mut from_camera = true;
        while let Some((mut ray, path)) = rays.pop() {
            match discs.take() {
                Some(lists) => {
                    disc_trace(&mut ray, self.pixel, lists, &self.reference.polynomials);
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
            self.account(&ray, hit.as_ref(), iterations, from_camera);
            if self.ends_at_first {
                let end = hit.as_ref().map_or(R::of(NO_HIT), |(hit, _)| hit.t);
                let wants = self.plan.wants_along();
                let march = wants.then(|| self.march(&ray, end, &path.media, self.lighting()));
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

    /// Counts, and what the first surface is.
    fn account(&mut self, ray: &Ray<R>, hit: Option<&(Hit<R>, u32)>, iterations: u32, first: bool) {
        let film = &mut self.film;
        film.counts[0] = film.counts[0].wrapping_add(ray.tests);
        film.counts[1] = film.counts[1].wrapping_add(ray.cells);
        if !first {
            return;
        }
        film.counts[2] = ray.hit_slot;
        film.counts[3] = iterations;
        film.position_depth = [0.0, 0.0, 0.0, f32::INFINITY];
        film.normal_object = [0.0, 0.0, 0.0, -1.0];
        if let Some((hit, object)) = hit {
            let depth = hit.t * ray.direction.dot(V3::of_f32(self.params.forward));
            let ([x, y, z], [nx, ny, nz]) = (hit.position.to_f32(), hit.normal.to_f32());
            film.position_depth = [x, y, z, depth.to_f32()];
            film.normal_object = [nx, ny, nz, *object as f32];
            film.color[3] = 1.0;
        }
        film.alpha = [1.0; 3];
    }

    fn write(&mut self, channels: u32, radiance: V3<R>) {
        for (channel, value) in radiance.to_f32().into_iter().enumerate() {
            if channels >> channel & 1 != 0 {
                self.film.color[channel] = value;
            }
        }
    }

    /// A path's end in the background, which lies in `direction`.
    fn write_background(&mut self, path: &Path<R>, direction: V3<R>, from_camera: bool) {
        let refracted = !path.reflected;
        let left_out = match self.params.transparent {
            0 => false,
            TRANSPARENT_GLASS => from_camera || refracted,
            _ => from_camera,
        };
        let zero = V3::splat(R::of(0.0));
        let background = if left_out {
            zero
        } else {
            let seen = path.throughput * self.background(direction);
            path.through_volumes(self.has_volumes(), seen)
        };
        self.write(path.channels, path.emitted + background);
        let one = V3::splat(R::of(1.0));
        let alpha = match (refracted, self.has_volumes()) {
            (false, _) => one,
            (true, false) => one - path.throughput,
            (true, true) => {
                (one - path.throughput) + path.throughput.times(path.depth.absorptance())
            }
        }
        .to_f32();
        for (channel, value) in alpha.into_iter().enumerate() {
            if path.channels >> channel & 1 != 0 {
                self.film.alpha[channel] = value;
            }
        }
    }

    /// `classify`, and then what the ray's kind of surface asks for.
    fn interact(
        &mut self,
        ray: &Ray<R>,
        hit: Option<(Hit<R>, u32)>,
        mut path: Path<R>,
        from_camera: bool,
        rays: &mut Vec<(Ray<R>, Path<R>)>,
    ) {
        let end = hit.as_ref().map_or(R::of(NO_HIT), |(hit, _)| hit.t);
        if let Some(march) = self.march(ray, end, &path.media, self.lighting()) {
            let through = path.throughput.times((-path.depth).exp_negative());
            path.emitted = path.emitted + through * march.color;
            path.depth = path.depth + march.depth;
            if from_camera {
                self.film.along = self.along(ray, end, &path.media, &march).to_f32();
            } else if path.channels & 1 != 0 && !path.reflected {
                self.show_later(ray, end, &path.media, &march);
            }
        }
        let objects = &self.plan.objects;
        if !path.media.is_empty() {
            let way = hit.as_ref().map_or(R::of(NO_HIT), |(hit, _)| hit.t);
            // Of a ray that grazes glass of the air's index, the way out may not have been seen.
            let dims = |&medium: &u32| hit.is_some() || objects[medium as usize].ior != [1.0; 3];
            let medium = path.media.medium(objects).filter(dims);
            path.throughput = path.throughput * transmittance(medium, way, objects);
        }
        let Some((hit, object)) = hit else {
            self.write_background(&path, ray.direction, from_camera);
            if from_camera {
                self.film.color[3] = path.depth.absorptance().to_f32();
            }
            return;
        };
        if objects[object as usize].material == MATERIAL_DIFFUSE {
            let radiance = self.shade(&hit, object, ray.hit_slot, &path.media);
            let seen = path.through_volumes(self.has_volumes(), path.throughput * radiance);
            self.write(path.channels, path.emitted + seen);
        } else {
            self.scatter(ray, &hit, object, &path, rays);
        }
    }

    /// What the volumes of the scene do to a ray; `None` where there are none.
    fn march(
        &self,
        ray: &Ray<R>,
        end: R,
        media: &Media,
        lighting: Option<Lighting<'_, R>>,
    ) -> Option<March<R>> {
        let volumes = &self.plan.volumes;
        volumes.any_marched().then(|| march(ray, end, media, volumes, &self.plan.objects, lighting))
    }

    fn has_volumes(&self) -> bool {
        !self.plan.volumes.infos.is_empty()
    }

    /// What channels of volumes show of a camera ray.
    fn along(&self, ray: &Ray<R>, end: R, media: &Media, march: &March<R>) -> R {
        let volumes = &self.plan.volumes;
        if !self.plan.wants_volume_depth() || volumes.infos.iter().any(is_whole) {
            return march.along;
        }
        let t = half_lost(ray, end, media, volumes, march.depth);
        t.map_or(R::of(-1.0), |t| t * ray.direction.dot(V3::of_f32(self.params.forward)))
    }

    /// The same of a later part of the way, where no part before had anything. Depth goes on from the first surface.
    fn show_later(&mut self, ray: &Ray<R>, end: R, media: &Media, march: &March<R>) {
        let (shows, shown) = (self.plan.shows_of_volumes(), self.film.along);
        if shows == WAVE_VALUES && shown == 0.0 {
            self.film.along = self.along(ray, end, media, march).to_f32();
        } else if shows == WAVE_LOSSES && shown < 0.0 {
            let along = self.along(ray, end, media, march);
            if along >= R::of(0.0) {
                let [x, y, z, depth] = self.film.position_depth;
                let since = ray.origin - V3::of_f32([x, y, z]);
                let before = R::of_f32(depth) + since.dot(V3::of_f32(self.params.forward));
                self.film.along = (before + along).to_f32();
            }
        }
    }

    fn lighting(&self) -> Option<Lighting<'_, R>> {
        self.plan
            .volumes
            .any_lit()
            .then_some(Lighting { visible: &self.reference.visible, lights: &self.plan.lights })
    }

    fn background(&self, direction: V3<R>) -> V3<R> {
        background_at(self.albedos.images, &self.params.background, direction)
    }

    fn shade(&mut self, hit: &Hit<R>, object: u32, slot: u32, media: &Media) -> V3<R> {
        let mut irradiance = V3::splat(R::of(0.0));
        for (i, light) in (0..).zip(&self.plan.lights) {
            let u = place_on_light(self.params, self.pixel, i);
            let Some((mut ray, arriving)) = shadow_ray(light, u, hit, slot, self.levels) else {
                continue;
            };
            self.rays.shadow += 1;
            if self.plan.light_passes {
                let (reference, scene) = (self.reference, (self.plan, self.levels, i as usize));
                let account = |ray: &Ray<R>| self.account(ray, None, 0, false);
                irradiance = irradiance
                    + light_through(reference, scene, ray, arriving, media.clone(), NONE, account);
                continue;
            }
            self.trace(&mut ray, true);
            self.account(&ray, None, 0, false);
            if ray.hit_slot == NONE && !blocks(&ray, ray.hit_t, &self.plan.volumes) {
                let arriving = match self.march(&ray, ray.hit_t, media, None) {
                    Some(march) => arriving.times((-march.depth).exp_negative()),
                    None => arriving,
                };
                irradiance = irradiance + arriving;
            }
        }
        lambert(self.albedos.albedo_at(object, slot, hit.position), irradiance)
    }

    /// The number that decides between reflection and refraction; `None`: rays are refracted.
    fn chance(&self, bounce: u32) -> Option<R> {
        let params = self.params;
        let sample = if params.sample_index == NONE { 0 } else { params.sample_index };
        (params.fresnel != 0)
            .then(|| sample_1d(self.pixel, sample, params.seed, SAMPLE_FRESNEL + bounce))
    }

    fn scatter(
        &mut self,
        ray: &Ray<R>,
        hit: &Hit<R>,
        object: u32,
        path: &Path<R>,
        rays: &mut Vec<(Ray<R>, Path<R>)>,
    ) {
        let objects = &self.plan.objects;
        let info = &objects[object as usize];
        let (d, n) = (ray.direction, hit.normal);
        let way = match self.reference.polynomials.get(ray.hit_slot as usize) {
            Some(hit) => hit.way_through(ray.origin, ray.direction, ray.hit_t),
            None => Way::Either,
        };
        let crossing =
            (info.material == MATERIAL_GLASS).then(|| path.media.crossing(object, way, objects));
        let passes = crossing.is_some_and(|crossing| crossing.passes(path.channels, objects));
        let splits =
            !passes && crossing.is_some_and(|crossing| crossing.splits(path.channels, objects));
        let goes_on = if passes {
            path.crossings < MOST_CROSSINGS
        } else {
            path.bounces < self.params.max_bounces
        };
        let throughput = match crossing {
            Some(_) => path.throughput,
            None => path.throughput * V3::of_f32(info.albedo),
        };
        // The stack gives back the last first: the channels come in order.
        for i in (0..if splits { 3 } else { 1 }).rev() {
            let channels = if splits { 1 << i } else { path.channels };
            let (reflects, direction) = match crossing {
                None => (true, reflected(d, n)),
                Some(_) if passes => (false, d),
                Some(crossing) if crossing.passes(channels, objects) => (false, d),
                Some(crossing) => {
                    let channel = channels.trailing_zeros() as usize;
                    let [n1, n2] = [crossing.before, crossing.after]
                        .map(|medium| R::of_f32(ior_of(medium, objects)[channel]));
                    let bent = refraction(d, n, n1, n2);
                    let chance = self.chance(path.bounces);
                    let reflects = bent.total || chance.is_some_and(|u| u < bent.reflectance);
                    (reflects, if reflects { reflected(d, n) } else { bent.direction })
                }
            };
            let reflected = path.reflected || reflects;
            if !goes_on {
                let end = Path { throughput, channels, reflected, ..path.clone() };
                self.write_background(&end, direction, false);
                continue;
            }
            if reflects {
                self.rays.reflected += 1;
            } else {
                self.rays.refracted += 1;
            }
            let next = Path {
                throughput,
                channels,
                reflected,
                bounces: path.bounces + u32::from(!passes),
                crossings: path.crossings + u32::from(passes),
                media: if reflects { path.media.clone() } else { path.media.through(object, way) },
                emitted: path.emitted,
                depth: path.depth,
            };
            rays.push((Ray::new(hit.position, direction, self.levels, ray.hit_slot), next));
        }
    }
}
