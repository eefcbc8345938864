//! Which kernels a picture will ask for, as far as the plan tells.

use crate::RenderError;
use crate::marks::Marks;
use crate::renderer::{Renderer, longest_list, needed, wave_rays};
use crate::stages::{drawing_of, marching_of};
use crate::state::RayLoop;
use crate::structure;
use gpu::{Device, Kernel};
use kernels::layout::SCENE_LIT;
use kernels::spirv::{self, Marching, Module, Searching, Start};
use plan::{CENTER, Plan, RaysFrom, StructureKind};
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
        let traces = |module| Kernel::new(device, module, Some(plan.constants()));
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
    let through = |from, start| {
        let kind = plan.structures(from).into_iter().next().unwrap_or(StructureKind::Grid);
        (kind, structure::modules(kind, device, (start, rays)))
    };
    let (again, of_again) = through(RaysFrom::Camera, Start::Camera);
    let of_tiles = tiles.iter().map(|tile| through(RaysFrom::Tile(tile), Start::Camera));
    // One that is made for each tile, where any tile takes it.
    let of_tile = of_tiles.into_iter().find(|(_, modules)| !modules.tile.is_empty());
    let (kind, of_tile) = of_tile.unwrap_or_else(|| through(RaysFrom::Camera, Start::Camera));
    let camera_trace = of_tile.at_once;
    let may_end = |sample| {
        form == RayLoop::Queue && plan.looks_through_centers(sample) && plan.meets_surfaces_alone()
    };
    let at_once = may_end(0) && camera_trace.is_some();
    let of_centers = plan.takes_centers() && may_end(CENTER);
    let mut first: Vec<_> = camera_trace.into_iter().filter(|_| at_once || of_centers).collect();
    if !at_once {
        first.push(spirv::camera_rays(rays));
        first.extend(of_tile.trace);
        if kind != again && plan.refines() {
            first.extend(of_again.trace);
        }
    }
    let any_points = !plan.cloud.points.is_empty();
    let needed = Needed { lists: needed.lists && any_points, ..needed };
    let mut build = modules_of_shapes(&plan.shapes);
    build.extend(modules_of_structures(needed));

    let mut then = Vec::new();
    if any_points {
        then.extend(of_tile.tile);
    }
    let any_surface = any_points || plan.volumes.any_isosurface() || plan.volumes.any_cloud();
    let any_lit = any_surface && plan.scene_bits() & SCENE_LIT != 0;
    let is_lit = any_lit && !plan.lights.is_empty();
    let scatters = any_surface && plan.scatters();
    let points_lit = plan.volumes.any_lit() && !plan.lamps().is_empty();
    let mut when = |asked: bool, modules: &[&'static Module]| {
        then.extend(modules.iter().filter(|_| asked));
    };
    when(scatters || !at_once, &[spirv::surface_hit(rays), spirv::classify(rays)]);
    when(scatters, &[spirv::scatter(rays)]);
    when(is_lit && !plan.lamps().is_empty(), &[spirv::shadow_rays(rays)]);
    let by_background = plan.lights[plan.lamps().len()..].iter().map(|light| light.kind);
    for kind in by_background.filter(|_| is_lit) {
        when(true, &[spirv::sky_rays(drawing_of(kind), rays)]);
    }
    when(is_lit, &[spirv::shade(rays)]);
    when(is_lit && plan.light_passes, &[spirv::shadow_media(rays)]);
    when(points_lit, &[spirv::point_rays(rays), spirv::point_lights(rays)]);
    let passes = (is_lit || points_lit) && plan.light_passes;
    when(passes, &[spirv::shadow_meet(rays), spirv::shadow_go_on(rays)]);
    let (_, from_surfaces) = through(RaysFrom::Surface, Start::Surface);
    when(is_lit || scatters || points_lit, from_surfaces.trace.as_slice());
    when(!plan.lights.is_empty() || plan.scatters(), &Marks::modules());
    let marched = plan.volumes.any_marched();
    when(marched, &[spirv::march(marching_of(plan), rays)]);
    when(marched && (is_lit || points_lit), &[spirv::march(Marching::Shadows, rays)]);
    let isosurfaces = plan.volumes.any_isosurface();
    when(isosurfaces, &[spirv::isosurface(Searching::Wave, rays)]);
    for (of, passes) in [(Searching::Shadows, false), (Searching::Passing, true)] {
        let any = (0..plan.lights.len() as u32).any(|at| plan.passes_isosurfaces(at) == passes);
        when(isosurfaces && is_lit && any, &[spirv::isosurface(of, rays)]);
    }
    when(plan.refines(), &[spirv::refine(rays)]);
    when(plan.samples > 1, &[spirv::accumulate()]);
    [first, build, then]
}
