//! Which kernels a picture will ask for, as far as the plan tells.

use super::{Passes, Renderer, longest_list, needed, wave_rays};
use crate::RenderError;
use crate::discs::Discs;
use crate::passes::{Accumulate, CameraTrace, ListMarked};
use crate::state::RayLoop;
use gpu::{Device, Kernel};
use plan::Plan;
use points::device::kernels_of_structures;
use std::sync::Arc;

impl Renderer {
    /// The kernels that a renderer and a frame of a plan will ask for after the fits, in about that order: those of
    /// surfaces. Meant to be [made ahead](Kernel::make_ahead) while the fits run; what is missing here, or asked for
    /// in another form since several grids come of the points, is made when it is needed.
    ///
    /// # Errors
    /// A device that is too small for a kernel.
    pub fn likely_kernels(device: &Arc<Device>, plan: &Plan) -> Result<Vec<Kernel>, RenderError> {
        let (rays, tiles) = (wave_rays(plan), plan.tiles());
        let needed = needed(plan, device, rays);
        let form = RayLoop::of(plan.ray_loop, device, longest_list(plan, rays, 0));
        let passes = Passes::new(device, form, plan.scene_bits(), 0)?;
        let by_discs = tiles.iter().any(|tile| plan.by_discs(tile));
        let at_once = form == RayLoop::Queue
            && plan.looks_through_centers()
            && plan.meets_surfaces_alone()
            && (by_discs || plan.camera_by_tree());
        let mut likely: Vec<Kernel> = Vec::new();
        match passes.camera_trace {
            CameraTrace { by_discs: Some(kernel), .. } if at_once && by_discs => {
                likely.push(kernel)
            }
            CameraTrace { by_tree, .. } if at_once => likely.push(by_tree),
            _ if plan.camera_by_tree() => likely.push(passes.tree_trace.from_camera),
            _ => {}
        }
        likely.extend(kernels_of_structures(device, needed)?);
        if by_discs {
            likely.extend(Discs::kernels(device, form)?);
        }
        if !at_once {
            likely.push(passes.camera_rays.kernel);
        }
        let (is_lit, scatters) = (!plan.lights.is_empty(), plan.scatters());
        if scatters || !at_once {
            likely.extend([passes.surface_hit.kernel, passes.classify.kernel]);
        }
        if scatters {
            likely.push(passes.scatter.kernel);
        }
        if is_lit {
            likely.extend([passes.shadow_rays.kernel, passes.shade.kernel]);
        }
        if (is_lit || scatters) && plan.by_tree() {
            likely.push(passes.tree_trace.leaving);
        }
        if is_lit || scatters {
            let ListMarked { count, list, .. } = passes.list_marked;
            likely.extend([count, list]);
        }
        if plan.samples > 1 {
            likely.push(Accumulate::new(device)?.kernel);
        }
        Ok(likely)
    }
}
