//! Twin of `scatter`: the rays that go on from a surface.

use super::PixelTrace;
use crate::camera_rays::Ray;
use crate::film::leaves_out;
use crate::material::{Drawn, Fate, Place, Sent, lobe_density, sent_on, survival_of};
use crate::media::Way;
use crate::path::Path;
use crate::real::{Real, V3};
use crate::surface_hit::Hit;
use kernels::layout::MATERIAL_CLOUD;
use plan::materials::is_lit;

impl<R: Real> PixelTrace<'_, R> {
    /// Adds the rays that go on; writes what the background brings in the direction of those that may not.
    pub(super) fn scatter(
        &mut self,
        ray: &Ray<R>,
        hit: &Hit<R>,
        (object, way, fate): (u32, Way, &Fate),
        path: &Path<R>,
        rays: &mut Vec<(Ray<R>, Path<R>)>,
    ) {
        let objects = &self.plan.objects;
        let info = &objects[object as usize];
        let place = Place { d: ray.direction, normal: hit.normal, info };
        let follows_paths = self.plan.follows_paths();
        // The last ray looks for the background.
        let most = self.params.max_bounces + u32::from(follows_paths && fate.lit);
        let goes_on = fate.goes_on([path.bounces, path.crossings], most);
        let drawn = Drawn::at(self.params, self.pixel, path.bounces);
        let was_lit = fate.lit && !self.plan.lights.is_empty();
        // What volumes before a lit surface have sent is in the pixel with its light.
        let emitted = if was_lit { V3::splat(R::of(0.0)) } else { path.emitted };
        // The stack gives back the last first: the channels come in order.
        for i in (0..if fate.splits { 3 } else { 1 }).rev() {
            let channels = if fate.splits { 1 << i } else { path.channels };
            let sent = sent_on(&place, fate, channels, &drawn, objects);
            let mut next = Path {
                throughput: path.throughput * sent.weight,
                channels,
                reflected: path.reflected || sent.reflects,
                adds: path.adds || was_lit,
                scattered: path.scattered,
                indirect: path.indirect,
                share: path.share,
                bounces: path.bounces + u32::from(!fate.passes),
                crossings: path.crossings + u32::from(fate.passes),
                media: match sent.reflects {
                    true => path.media.clone(),
                    false => path.media.through(object, way),
                },
                emitted,
                depth: path.depth,
                has_volumes: path.has_volumes,
            };
            if follows_paths && !fate.passes {
                self.go_on(&mut next, path, (&place, object, ray.hit_slot, hit.position), &sent);
            }
            if !goes_on {
                let left_out = leaves_out(self.params.transparent, false, next.reflected);
                self.write_background(&next, sent.direction, left_out);
                continue;
            }
            if follows_paths && fate.lit {
                self.rays.scattered += 1;
            } else if sent.reflects {
                self.rays.reflected += 1;
            } else {
                self.rays.refracted += 1;
            }
            let next_ray = Ray::new(hit.position, sent.direction, ray.hit_slot);
            rays.push((next_ray, next));
        }
    }

    /// Of a path that light takes from surface to surface: what it is after a surface has sent it on, and the share of the
    /// background that it counts from now on; what it asks the lamps for, others do not find.
    fn go_on(
        &self,
        next: &mut Path<R>,
        path: &Path<R>,
        (place, object, slot, position): (&Place<'_, R>, u32, u32, V3<R>),
        sent: &Sent<R>,
    ) {
        let (zero, one) = (R::of(0.0), R::of(1.0));
        (next.scattered, next.indirect) = (false, path.indirect || path.scattered);
        next.share = one;
        if !is_lit(place.info) {
            return;
        }
        next.scattered = true;
        next.share = if self.plan.sky_lights() { one } else { zero };
        if !self.plan.environment_table.is_empty() {
            let own = lobe_density(place, sent.direction);
            let both = own + self.sky().density_of(sent.direction);
            next.share = if both > zero { own / both } else { zero };
        }
        let survival: R = survival_of(path.throughput, path.channels, path.bounces);
        let albedo = self.albedo_of(place, object, slot, position);
        next.throughput = next.throughput * albedo.over(survival);
    }

    /// The share of light that is scattered at a place: of a surface its albedo, of a cloud the colour there.
    pub(super) fn albedo_of(
        &self,
        place: &Place<'_, R>,
        object: u32,
        slot: u32,
        position: V3<R>,
    ) -> V3<R> {
        match place.info.material {
            MATERIAL_CLOUD => place.normal,
            _ => self.albedos.albedo_at(object, slot, position),
        }
    }
}
