//! The passes `refine` and `resume`.

use super::{Records, bind_state, line, state_bindings};
use crate::state::StateImages;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{
    REFINE_OFFSETS, REFINE_OUTCOMES, REFINE_POINTS, SHADE_OBJECTS, STATE_IN, STATE_OUT, TRACE_HITS,
    TRACE_INFO, TRACE_LIVE, TRACE_POLYNOMIALS, TraceParams,
};
use kernels::spirv;
use points::device::{PointCells, Surfaces};
use std::sync::Arc;

/// What `refine` works on.
pub(crate) struct RefineIo<'a> {
    pub surfaces: &'a Surfaces,
    pub point_cells: &'a PointCells,
    pub state: &'a StateImages,
    pub objects: &'a Buffer,
    pub hits: &'a Buffer,
    /// Two u32, zero before: hits pending still, hits rejected.
    pub live: &'a Buffer,
}

/// One iteration of each pending hit towards the point set surface (\[T\] §4), and the way on for
/// rays whose hit was refined away.
pub(crate) struct Refine {
    refine: Kernel,
    resume: Kernel,
}

impl Refine {
    pub const NAME: &'static str = "refine";
    pub const RESUME: &'static str = "resume";

    pub fn new(device: &Arc<Device>, records: Records) -> Result<Self, GpuError> {
        let params = size_of::<TraceParams>();
        let mut bindings = state_bindings(STATE_IN).to_vec();
        let buffers = [
            TRACE_INFO,
            TRACE_POLYNOMIALS,
            TRACE_LIVE,
            SHADE_OBJECTS,
            TRACE_HITS,
            REFINE_OFFSETS,
            REFINE_OUTCOMES,
        ];
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        let (module, points) = match records {
            Records::Texels => (spirv::refine_texels(), Binding::UniformTexelBuffer),
            Records::Storage => (spirv::refine(), Binding::StorageBuffer),
        };
        bindings.push((REFINE_POINTS, points));
        let refine = Kernel::new(device, Self::NAME, &module, &bindings, params)?;
        let mut bindings = state_bindings(STATE_IN).to_vec();
        bindings.extend(state_bindings(STATE_OUT));
        let buffers = [TRACE_INFO, TRACE_HITS];
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        let resume = Kernel::new(device, Self::RESUME, &spirv::resume(), &bindings, params)?;
        Ok(Self { refine, resume })
    }

    /// Records one iteration.
    pub fn record(&self, rec: &mut Recorder, io: RefineIo<'_>, params: &TraceParams) {
        bind_state(rec.pass(Self::NAME, &self.refine), STATE_IN, io.state)
            .buffer(TRACE_INFO, &io.surfaces.grid_info)
            .buffer(TRACE_POLYNOMIALS, &io.surfaces.polynomials)
            .buffer(TRACE_LIVE, io.live)
            .buffer(SHADE_OBJECTS, io.objects)
            .buffer(TRACE_HITS, io.hits)
            .buffer(REFINE_OFFSETS, &io.point_cells.offsets)
            .buffer(REFINE_POINTS, &io.point_cells.points)
            .buffer(REFINE_OUTCOMES, &io.surfaces.outcome_buffer)
            .push(params)
            .dispatch(line(params.ray_count));
    }

    /// Records the way on of rejected rays, in place.
    pub fn record_resume(
        &self,
        rec: &mut Recorder,
        surfaces: &Surfaces,
        state: &StateImages,
        hits: &Buffer,
        params: &TraceParams,
    ) {
        let pass = bind_state(rec.pass(Self::RESUME, &self.resume), STATE_IN, state);
        bind_state(pass, STATE_OUT, state)
            .buffer(TRACE_INFO, &surfaces.grid_info)
            .buffer(TRACE_HITS, hits)
            .push(params)
            .dispatch(line(params.ray_count));
    }
}
