//! A ray on its way to a light, past surfaces that light passes. The kernels that follow it there have their twins below
//! `to_light/`, declared and called here.

mod shadow_go_on;
mod shadow_media;
mod shadow_meet;

use crate::Reference;
use crate::camera_rays::Ray;
use crate::grid_trace::grid_trace;
use crate::isosurface::{blocks, isosurface};
use crate::levels::Levels;
use crate::march::{Along, march};
use crate::media::Media;
use crate::real::{Real, V3};
use plan::Plan;
use shadow_media::{ShadowPath, shadow_media};

/// What a shadow ray goes through.
#[derive(Clone, Copy)]
struct ToLight<'a, R> {
    reference: &'a Reference<R>,
    plan: &'a Plan,
    /// The light, by its number.
    light: usize,
    /// An object whose surface is not there, or `NONE`.
    passed: u32,
}

/// What of `arriving` comes to the start of a ray towards a light, which starts inside `media`. `account` sees each part
/// of its way. The light is the plan's of this number. `passed` is an object whose surface is not there, or `NONE`.
pub(crate) fn light_through<R: Real>(
    reference: &Reference<R>,
    (plan, levels, light): (&Plan, &Levels<R>, usize),
    mut ray: Ray<R>,
    mut arriving: V3<R>,
    media: Media,
    passed: u32,
    mut account: impl FnMut(&Ray<R>),
) -> V3<R> {
    let none = V3::splat(R::of(0.0));
    let to_light = ToLight { reference, plan, light, passed };
    let passes_isosurfaces = plan.passes_isosurfaces(light as u32);
    let mut path = shadow_media(&ray, media);
    loop {
        grid_trace(&mut ray, levels, &reference.lists, &reference.polynomials, false);
        account(&ray);
        let on_isosurface = if passes_isosurfaces {
            isosurface(&ray, ray.hit_t, &path.media, &plan.volumes)
        } else {
            None
        };
        if let Some((hit, slot)) = &on_isosurface {
            (ray.hit_t, ray.hit_slot) = (hit.t, *slot);
        }
        let on_isosurface = on_isosurface.map(|(hit, _)| hit);
        let Some(met) = to_light.shadow_meet(&mut ray, &mut path, &mut arriving, on_isosurface)
        else {
            return none;
        };
        if !passes_isosurfaces && blocks(&ray, ray.hit_t, &plan.volumes) {
            return none;
        }
        arriving = marched(plan, &ray, &path, arriving);
        let Some(met) = met else { return arriving };
        if !arriving.0.iter().any(|&channel| channel > R::of(0.0)) {
            return none;
        }
        match to_light.shadow_go_on(&ray, &mut path, met) {
            Some(next) => ray = next,
            None => return none,
        }
    }
}

/// What volumes on a part of the way leave.
fn marched<R: Real>(plan: &Plan, ray: &Ray<R>, path: &ShadowPath<R>, arriving: V3<R>) -> V3<R> {
    if !plan.volumes.any_marched() {
        return arriving;
    }
    let march = march(ray, ray.hit_t, &path.media, &plan.volumes, &plan.objects, Along::Emitted);
    arriving.times((-march.depth).exp_negative())
}
