//! The pass `grid_trace`.

use super::{line, surface_lists};
use crate::state::{RayLoop, RayState, Touch};
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{
    LIVE_RAYS, TRACE_CELLS, TRACE_INFO, TRACE_LIVE, TRACE_POLYNOMIALS, TRACE_SLOTS, TraceParams,
    WAVE_MARKS,
};
use kernels::spirv;
use points::device::Surfaces;
use std::sync::Arc;

/// What the pass works on.
pub(crate) struct TraceIo<'a> {
    pub surfaces: &'a Surfaces,
    pub state: &'a RayState,
    /// One u32, zero before: how many rays have not ended.
    pub live: &'a Buffer,
    /// One bit a ray of the wave, zero before: those.
    pub marks: &'a Buffer,
    /// Those that have not ended, for passes over them alone.
    pub live_rays: &'a Buffer,
}

/// Where the rays of a wave start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Start {
    /// At the camera.
    Camera,
    /// On a surface, whose own sheet they do not meet again at once.
    Surface,
}

/// Lets each live ray cross up to K cells of the grid (\[T\] §5).
pub(crate) struct GridTrace {
    from_camera: Kernel,
    leaving: Kernel,
}

impl GridTrace {
    pub const NAME: &'static str = "grid_trace";

    pub fn new(device: &Arc<Device>, form: RayLoop, scene: u32) -> Result<Self, GpuError> {
        let modules = [
            form.module(spirv::grid_trace, spirv::grid_trace_queue),
            form.module(spirv::grid_trace_leaving, spirv::grid_trace_leaving_queue),
        ];
        let mut bindings = form.bindings(Touch::Updates);
        let buffers = [TRACE_INFO, TRACE_LIVE, LIVE_RAYS, WAVE_MARKS];
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        bindings.extend(surface_lists(form));
        let params = size_of::<TraceParams>();
        let kernel = |module: &[u32]| {
            Kernel::specialized(device, Self::NAME, module, &bindings, params, Some(scene))
        };
        Ok(Self { from_camera: kernel(&modules[0])?, leaving: kernel(&modules[1])? })
    }

    /// Records one pass; the caller then swaps the ray state, unless rays are listed.
    pub fn record(&self, rec: &mut Recorder, io: TraceIo<'_>, start: Start, params: &TraceParams) {
        let kernel = match start {
            Start::Camera => &self.from_camera,
            Start::Surface => &self.leaving,
        };
        let pass = rec.pass(Self::NAME, kernel);
        // Listed rays stay where they are, and the others with them.
        let pass = match params.listed {
            0 => io.state.bind_update(pass),
            _ => io.state.current.bind_in_place(pass),
        };
        pass.buffer(TRACE_INFO, &io.surfaces.grid_levels)
            .buffer(TRACE_CELLS, &io.surfaces.cells)
            .buffer(TRACE_SLOTS, &io.surfaces.slots)
            .buffer(TRACE_POLYNOMIALS, &io.surfaces.polynomials)
            .buffer(TRACE_LIVE, io.live)
            .buffer(LIVE_RAYS, io.live_rays)
            .buffer(WAVE_MARKS, io.marks)
            .push(params)
            .dispatch(line(params.ray_count));
    }
}
