//! Twin of `scatter`: the rays that go on from a surface.

use super::PixelTrace;
use crate::camera_rays::Ray;
use crate::film::leaves_out;
use crate::material::{Drawn, Fate, Place, sent_on};
use crate::media::Way;
use crate::path::Path;
use crate::real::{Real, V3};
use crate::surface_hit::Hit;

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
        let goes_on = fate.goes_on([path.bounces, path.crossings], self.params.max_bounces);
        let drawn = Drawn::at(self.params, self.pixel, path.bounces);
        let was_lit = fate.lit && !self.plan.lights.is_empty();
        // What volumes before a lit surface have sent is in the pixel with its light.
        let emitted = if was_lit { V3::splat(R::of(0.0)) } else { path.emitted };
        // The stack gives back the last first: the channels come in order.
        for i in (0..if fate.splits { 3 } else { 1 }).rev() {
            let channels = if fate.splits { 1 << i } else { path.channels };
            let sent = sent_on(&place, fate, channels, &drawn, objects);
            let next = Path {
                throughput: path.throughput * sent.weight,
                channels,
                reflected: path.reflected || sent.reflects,
                adds: path.adds || was_lit,
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
            if !goes_on {
                let left_out = leaves_out(self.params.transparent, false, next.reflected);
                self.write_background(&next, sent.direction, left_out);
                continue;
            }
            if sent.reflects {
                self.rays.reflected += 1;
            } else {
                self.rays.refracted += 1;
            }
            let next_ray = Ray::new(hit.position, sent.direction, ray.hit_slot);
            rays.push((next_ray, next));
        }
    }
}
