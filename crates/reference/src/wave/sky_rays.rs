//! Twin of `sky_rays`: the ray from a lit hit towards the background.

use super::PixelTrace;
use crate::camera_rays::Ray;
use crate::environment::background_at;
use crate::material::{Place, lobe, lobe_density, lobe_direction};
use crate::path::Path;
use crate::real::{NO_HIT, Real, V3};
use crate::sampler::{sample_2d, shared_sample};
use crate::sky::DrawnDirection;
use crate::surface_hit::Hit;
use kernels::layout::{LIGHT_ENVIRONMENT, NONE};

impl<R: Real> PixelTrace<'_, R> {
    /// The ray towards the background, which is light i, and what it would bring; `None` where nothing of it is scattered.
    pub(super) fn sky_ray(
        &self,
        i: u32,
        hit: &Hit<R>,
        (place, path): (&Place<'_, R>, &Path<R>),
        slot: u32,
    ) -> Option<(Ray<R>, V3<R>)> {
        let zero = R::of(0.0);
        let index = if self.params.sample_index == NONE { 0 } else { self.params.sample_index };
        let (block, index) = shared_sample(self.pixel, index, self.params.sample_bits);
        let drawn = sample_2d(block, index, self.params.seed, self.dimension_of_light(i, path));
        let by_table = self.plan.lights[i as usize].kind == LIGHT_ENVIRONMENT;
        let DrawnDirection { towards, density } = if by_table {
            self.sky().draw(drawn)
        } else {
            let towards = lobe_direction(place, drawn);
            let any_table = !self.plan.environment_table.is_empty();
            let density = if any_table { self.sky().density_of(towards) } else { zero };
            DrawnDirection { towards, density }
        };
        let both = density + lobe_density(place, towards);
        let seen = background_at(self.albedos.images, &self.params.background, towards);
        let light = seen * lobe(place, towards);
        let arriving = if both > zero { light.over(both) } else { V3::splat(zero) };
        let arrives = arriving.0.iter().any(|&channel| channel > zero);
        arrives.then(|| {
            let mut ray = Ray::new(hit.position, towards, slot);
            ray.hit_t = R::of(NO_HIT);
            (ray, arriving)
        })
    }
}
