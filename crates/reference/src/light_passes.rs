//! Twin of `shadow_media`, `shadow_meet` and `shadow_go_on`: light past surfaces between media of one index.

use crate::Reference;
use crate::camera_rays::Ray;
use crate::grid_trace::grid_trace;
use crate::isosurface::blocks;
use crate::levels::Levels;
use crate::media::{Media, ior_of, transmittance};
use crate::real::{NO_HIT, Real, V3};
use crate::surface_hit::surface_hit;
use crate::volume::march;
use kernels::layout::{MATERIAL_GLASS, MOST_CROSSINGS, NONE, PASSED_NEAR};
use plan::Plan;

/// What of `arriving` comes to the start of a ray towards a light, which starts inside `media`. `account` sees each part
/// of its way. The light is the plan's of this number. `passed` is an object whose surface is not there, or `NONE`.
pub(crate) fn light_through<R: Real>(
    reference: &Reference<R>,
    (plan, levels, light): (&Plan, &Levels<R>, usize),
    mut ray: Ray<R>,
    mut arriving: V3<R>,
    mut media: Media,
    passed: u32,
    mut account: impl FnMut(&Ray<R>),
) -> V3<R> {
    let (zero, none) = (R::of(0.0), V3::splat(R::of(0.0)));
    let objects = &plan.objects;
    let mut left = ray.hit_t;
    for crossings in 0.. {
        grid_trace(&mut ray, levels, &reference.lists, &reference.polynomials, false);
        account(&ray);
        // The last part ends at the light: what that is not inside, the ray has left unseen, or was never in.
        if let Some(lamp) = plan.lamp_media[light].as_ref().filter(|_| ray.hit_slot == NONE) {
            media.retain(|object| lamp.contains(&object) || object == passed & !PASSED_NEAR);
        }
        // Infinitely far away, rays are outside of everything: of a grazing one, the way out was not seen.
        let is_finite = ray.hit_t < R::of(NO_HIT);
        let medium = media.medium(objects).filter(|&medium| medium != passed).filter(|_| is_finite);
        arriving = arriving * transmittance(medium, ray.hit_t, objects);
        let slot = ray.hit_slot;
        if slot != NONE {
            let polynomial = &reference.polynomials[slot as usize];
            let object = polynomial.object;
            if objects[object as usize].material != MATERIAL_GLASS || crossings >= MOST_CROSSINGS {
                return none;
            }
            let way = polynomial.way_through(ray.origin, ray.direction, ray.hit_t);
            let crossing = media.crossing(object, way, objects);
            let [before, after] =
                [crossing.before, crossing.after].map(|medium| ior_of(medium, objects));
            let equal = [0, 1, 2].map(|channel| before[channel] == after[channel]);
            if equal == [false; 3] {
                return none;
            }
            arriving =
                V3([0, 1, 2]
                    .map(|channel| if equal[channel] { arriving.0[channel] } else { zero }));
            ray.hit_slot = NONE;
            if !arriving.0.iter().any(|&channel| channel > zero) {
                return none;
            }
            if blocks(&ray, ray.hit_t, &plan.volumes) {
                return none;
            }
            arriving = marched(plan, &ray, &media, arriving);
            if !arriving.0.iter().any(|&channel| channel > zero) {
                return none;
            }
            media = media.through(object, way);
            ray.hit_slot = slot;
            let Some(hit) = surface_hit(&ray, &reference.polynomials) else { return none };
            left = if left < R::of(NO_HIT) { (left - ray.hit_t).max(zero) } else { left };
            let mut next = Ray::new(hit.position, ray.direction, levels, slot);
            (next.hit_t, next.passed) = (left, ray.passed);
            ray = next;
            continue;
        }
        if blocks(&ray, ray.hit_t, &plan.volumes) {
            return none;
        }
        return marched(plan, &ray, &media, arriving);
    }
    none
}

/// What volumes on a part of the way leave.
fn marched<R: Real>(plan: &Plan, ray: &Ray<R>, media: &Media, arriving: V3<R>) -> V3<R> {
    if !plan.volumes.any_marched() {
        return arriving;
    }
    let march = march(ray, ray.hit_t, media, &plan.volumes, &plan.objects, None);
    arriving.times((-march.depth).exp_negative())
}
