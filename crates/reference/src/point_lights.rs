//! Twin of `point_rays` and `point_lights`: how much of each light reaches the points of lit volumes.

use crate::Reference;
use crate::camera_rays::Ray;
use crate::grid_trace::grid_trace;
use crate::isosurface::blocks;
use crate::levels::Levels;
use crate::light::sample_light;
use crate::march::{Along, march};
use crate::media::Media;
use crate::real::{Real, V3};
use crate::to_light::light_through;
use crate::volume::may_be_seen;
use kernels::layout::{Light, NONE, VOLUME_EMITS, VOLUME_LIGHTS};
use plan::Plan;
use points::Watch;
use rayon::prelude::*;

/// Points that are lit between two looks at the watcher.
const BATCH: usize = 1 << 10;

/// The ray from a point of a volume to the middle of a light.
fn point_rays<R: Real>(light: &Light, x: V3<R>) -> Ray<R> {
    let sample = sample_light(light, x, [R::of(0.5); 2]);
    Ray { hit_t: sample.distance, ..Ray::new(x, sample.towards, NONE) }
}

/// Of each light, of the points of all volumes; none where no volume is lit. `None` where the watcher asked for an end.
pub fn point_lights<R: Real>(
    reference: &Reference<R>,
    plan: &Plan,
    watch: &dyn Watch,
) -> Option<Vec<[R; VOLUME_LIGHTS as usize]>> {
    let volumes = &plan.volumes;
    if !volumes.any_lit() {
        return Some(Vec::new());
    }
    watch.stage("lighting volumes", volumes.points.len() as u64);
    let levels = Levels::<R>::from(&reference.grids);
    let mut visible = vec![[R::of(0.0); VOLUME_LIGHTS as usize]; volumes.points.len()];
    for (info, range) in volumes.point_ranges().filter(|(info, _)| info.shading != VOLUME_EMITS) {
        let media = Media::of(&[info.object]);
        for first in range.clone().step_by(BATCH) {
            if watch.interrupted() {
                return None;
            }
            let batch = first..range.end.min(first + BATCH);
            let (points, end) = (&volumes.points[batch.clone()], batch.end);
            visible[batch].par_iter_mut().zip(points).for_each(|(of, point)| {
                let x = V3::of_f32(point.position);
                if !may_be_seen(info, volumes, x) {
                    return;
                }
                for (at, (of_light, light)) in of.iter_mut().zip(plan.lamps()).enumerate() {
                    let mut ray = point_rays(light, x);
                    ray.passed = plan.passed_of(info.object, at as u32);
                    if plan.light_passes {
                        let all = V3::splat(R::of(1.0));
                        let scene = (plan, &levels, at);
                        let [r, g, b] = light_through(
                            reference,
                            scene,
                            ray,
                            all,
                            media.clone(),
                            ray.passed,
                            |_| {},
                        )
                        .0;
                        let is_grey = r == g && g == b;
                        *of_light = if is_grey { r } else { ((r + g) + b) / R::of(3.0) };
                        continue;
                    }
                    grid_trace(&mut ray, &levels, &reference.lists, &reference.polynomials, true);
                    if ray.hit_slot == NONE && !blocks(&ray, ray.hit_t, volumes) {
                        let march =
                            march(&ray, ray.hit_t, &media, volumes, &plan.objects, Along::Emitted);
                        *of_light = (-march.depth).exp_negative();
                    }
                }
            });
            watch.done(end as u64);
        }
    }
    Some(visible)
}
