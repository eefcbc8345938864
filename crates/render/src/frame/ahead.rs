//! Which kernels a picture will ask for, as far as the plan tells.

use super::{Passes, Renderer, longest_list, needed, wave_rays};
use crate::RenderError;
use crate::discs::Discs;
use crate::passes::{Accumulate, ListMarked};
use crate::state::RayLoop;
use gpu::{Device, Kernel};
use kernels::layout::SCENE_DIFFUSE;
use plan::{CENTER, Plan};
use points::device::{Needed, kernels_of_shapes, kernels_of_structures};
use std::sync::Arc;

impl Renderer {
    /// The kernels that a renderer and a frame of a plan will ask for after the fits, in about that order. Meant to be
    /// [made ahead](Kernel::make_ahead) while the fits run; what is missing here, or asked for in another form since
    /// several grids come of the points, is made when it is needed.
    ///
    /// # Errors
    /// A device that is too small for a kernel.
    pub fn likely_kernels(device: &Arc<Device>, plan: &Plan) -> Result<Vec<Kernel>, RenderError> {
        let (rays, tiles) = (wave_rays(plan), plan.tiles());
        let needed = needed(plan, device, rays);
        let form = RayLoop::of(plan.ray_loop, device, longest_list(plan, rays, 0));
        let passes = Passes::new(device, form, plan.scene_bits(), 0)?;
        let by_discs = tiles.iter().any(|tile| plan.by_discs(tile));
        let camera_trace = match by_discs {
            true => passes.camera_trace.by_discs,
            false => Some(passes.camera_trace.by_tree).filter(|_| plan.camera_by_tree()),
        };
        let may_end = |sample| {
            form == RayLoop::Queue
                && plan.looks_through_centers(sample)
                && plan.meets_surfaces_alone()
        };
        let at_once = may_end(0) && camera_trace.is_some();
        let of_centers = plan.takes_centers() && may_end(CENTER);
        let mut likely: Vec<Kernel> =
            camera_trace.into_iter().filter(|_| at_once || of_centers).collect();
        if !at_once {
            likely.push(passes.camera_rays.kernel);
            if by_discs {
                likely.push(passes.disc_trace.kernel);
            }
            if plan.camera_by_tree() && (!by_discs || plan.refines()) {
                likely.push(passes.tree_trace.from_camera);
            }
        }
        let any_points = !plan.cloud.points.is_empty();
        let needed = Needed { lists: needed.lists && any_points, ..needed };
        likely.extend(kernels_of_shapes(device, &plan.shapes)?);
        likely.extend(kernels_of_structures(device, needed)?);
        if by_discs && any_points {
            likely.extend(Discs::kernels(device, form)?);
        }
        let any_surface = any_points || plan.volumes.any_isosurface();
        let any_diffuse = any_surface && plan.scene_bits() & SCENE_DIFFUSE != 0;
        let is_lit = any_diffuse && !plan.lights.is_empty();
        let scatters = any_surface && plan.scatters();
        if scatters || !at_once {
            likely.extend([passes.surface_hit.kernel, passes.classify.kernel]);
        }
        if scatters {
            likely.push(passes.scatter.kernel);
        }
        if is_lit {
            likely.extend([passes.shadow_rays.kernel, passes.shade.kernel]);
        }
        if is_lit && plan.light_passes {
            likely.push(passes.light_passes.media);
        }
        let points_lit = plan.volumes.any_lit() && !plan.lights.is_empty();
        if points_lit {
            likely.extend([passes.point_light.rays, passes.point_light.lights]);
        }
        if (is_lit || points_lit) && plan.light_passes {
            likely.extend([passes.light_passes.meet, passes.light_passes.go_on]);
        }
        if (is_lit || scatters || points_lit) && plan.by_tree() {
            likely.push(passes.tree_trace.leaving);
        }
        if !plan.lights.is_empty() || plan.scatters() {
            let ListMarked { count, list, scan } = passes.list_marked;
            likely.extend([count, list].into_iter().chain(scan.kernels()));
        }
        if plan.volumes.any_marched() {
            let lit = plan.volumes.any_lit();
            likely.push(if lit { passes.march.lit } else { passes.march.wave });
            likely.extend((is_lit || points_lit).then_some(passes.march.shadows));
        }
        if plan.volumes.any_isosurface() {
            likely.push(passes.isosurface.wave);
            likely.extend(is_lit.then_some(passes.isosurface.shadows));
        }
        if plan.refines() {
            likely.push(passes.refine.refine);
        }
        if plan.samples > 1 {
            likely.push(Accumulate::new(device)?.kernel);
        }
        Ok(likely)
    }
}
