//! Which kernels a picture will ask for, as far as the plan tells.

use crate::RenderError;
use crate::discs::Discs;
use crate::marks::Marks;
use crate::renderer::{Renderer, longest_list, needed, wave_rays};
use crate::stages::camera_trace_by_discs;
use crate::state::RayLoop;
use gpu::{Device, Kernel};
use kernels::layout::SCENE_LIT;
use kernels::spirv::{self, Marching, Module, Searching, Start, Way};
use plan::{CENTER, Plan};
use points::device::{Needed, modules_of_shapes, modules_of_structures};
use std::sync::Arc;

impl Renderer {
    /// The kernels that a renderer and a frame of a plan will ask for after the fits, in about that order. Meant to be
    /// [made ahead](Kernel::make_ahead) while the fits run; what is missing here, or asked for in another form since
    /// several grids come of the points, is made when it is needed.
    ///
    /// # Errors
    /// A device that is too small for a kernel.
    pub fn likely_kernels(device: &Arc<Device>, plan: &Plan) -> Result<Vec<Kernel>, RenderError> {
        let builds = |module| Kernel::new(device, module, None);
        let traces = |module| Kernel::new(device, module, Some(plan.scene_bits()));
        let [first, build, then] = likely_modules(device, plan);
        let first = first.into_iter().map(traces);
        let then = then.into_iter().map(traces);
        let all = first.chain(build.into_iter().map(builds)).chain(then);
        Ok(all.collect::<Result<_, _>>()?)
    }
}

/// Those of the first wave, of what is built, and of all else.
fn likely_modules(device: &Arc<Device>, plan: &Plan) -> [Vec<&'static Module>; 3] {
    let (ray_count, tiles) = (wave_rays(plan), plan.tiles());
    let needed = needed(plan, device, ray_count);
    let form = RayLoop::of(plan.ray_loop, device, longest_list(plan, ray_count, 0));
    let rays = form.rays();
    let by_discs = tiles.iter().any(|tile| plan.by_discs(tile));
    let camera_trace = match by_discs {
        true => camera_trace_by_discs(device),
        false => plan.camera_by_tree().then(|| spirv::camera_trace(Way::Tree)),
    };
    let may_end = |sample| {
        form == RayLoop::Queue && plan.looks_through_centers(sample) && plan.meets_surfaces_alone()
    };
    let at_once = may_end(0) && camera_trace.is_some();
    let of_centers = plan.takes_centers() && may_end(CENTER);
    let mut first: Vec<_> = camera_trace.into_iter().filter(|_| at_once || of_centers).collect();
    if !at_once {
        first.push(spirv::camera_rays(rays));
        if by_discs {
            first.push(spirv::disc_trace(rays));
        }
        if plan.camera_by_tree() && (!by_discs || plan.refines()) {
            first.push(spirv::tree_trace(Start::Camera));
        }
    }
    let any_points = !plan.cloud.points.is_empty();
    let needed = Needed { lists: needed.lists && any_points, ..needed };
    let mut build = modules_of_shapes(&plan.shapes);
    build.extend(modules_of_structures(needed));

    let mut then = Vec::new();
    if by_discs && any_points {
        then.extend(Discs::modules(rays));
    }
    let any_surface = any_points || plan.volumes.any_isosurface();
    let any_lit = any_surface && plan.scene_bits() & SCENE_LIT != 0;
    let is_lit = any_lit && !plan.lights.is_empty();
    let scatters = any_surface && plan.scatters();
    let points_lit = plan.volumes.any_lit() && !plan.lights.is_empty();
    let mut when = |asked: bool, modules: &[&'static Module]| {
        then.extend(modules.iter().filter(|_| asked));
    };
    when(scatters || !at_once, &[spirv::surface_hit(rays), spirv::classify(rays)]);
    when(scatters, &[spirv::scatter(rays)]);
    when(is_lit, &[spirv::shadow_rays(rays), spirv::shade(rays)]);
    when(is_lit && plan.light_passes, &[spirv::shadow_media(rays)]);
    when(points_lit, &[spirv::point_rays(rays), spirv::point_lights(rays)]);
    let passes = (is_lit || points_lit) && plan.light_passes;
    when(passes, &[spirv::shadow_meet(rays), spirv::shadow_go_on(rays)]);
    let leaves = (is_lit || scatters || points_lit) && plan.by_tree();
    when(leaves, &[spirv::tree_trace(Start::Surface)]);
    when(!plan.lights.is_empty() || plan.scatters(), &Marks::modules());
    let (marched, lit) = (plan.volumes.any_marched(), plan.volumes.any_lit());
    let marching = if lit { Marching::Lit } else { Marching::Wave };
    when(marched, &[spirv::march(marching, rays)]);
    when(marched && (is_lit || points_lit), &[spirv::march(Marching::Shadows, rays)]);
    let isosurfaces = plan.volumes.any_isosurface();
    when(isosurfaces, &[spirv::isosurface(Searching::Wave, rays)]);
    when(isosurfaces && is_lit, &[spirv::isosurface(Searching::Shadows, rays)]);
    when(plan.refines(), &[spirv::refine(rays)]);
    when(plan.samples > 1, &[spirv::accumulate()]);
    [first, build, then]
}
