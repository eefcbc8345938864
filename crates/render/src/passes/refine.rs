//! The passes `refine` and `resume`.

use super::line;
use crate::state::{RayLoop, StoredRays, Touch};
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder, Texel};
use kernels::layout::{
    REFINE_OFFSETS, REFINE_OUTCOMES, REFINE_POINTS, SHADE_OBJECTS, TRACE_HITS, TRACE_INFO,
    TRACE_LIVE, TRACE_POLYNOMIALS, TraceParams, WAVE_MARKS,
};
use kernels::spirv;
use points::device::{PointCells, Surfaces};
use std::sync::Arc;

/// What `refine` works on.
pub(crate) struct RefineIo<'a> {
    pub surfaces: &'a Surfaces,
    pub point_cells: &'a PointCells,
    pub state: &'a StoredRays,
    pub objects: &'a Buffer,
    pub hits: &'a Buffer,
    /// Two u32, zero before: hits pending still, hits rejected.
    pub live: &'a Buffer,
}

/// One iteration of each pending hit towards the point set surface (\[T\] §4), and the way on for
/// rays whose hit was refined away.
pub(crate) struct Refine {
    pub refine: Kernel,
    resume: Kernel,
}

impl Refine {
    pub const NAME: &'static str = "refine";
    pub const RESUME: &'static str = "resume";

    pub fn new(device: &Arc<Device>, form: RayLoop) -> Result<Self, GpuError> {
        let params = size_of::<TraceParams>();
        let mut bindings = form.bindings(Touch::Reads);
        let buffers = [TRACE_INFO, TRACE_LIVE, TRACE_HITS, REFINE_OFFSETS, REFINE_OUTCOMES];
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        bindings.push((TRACE_POLYNOMIALS, form.read(Texel::Four)));
        bindings.push((SHADE_OBJECTS, form.read(Texel::Four)));
        bindings.push((REFINE_POINTS, form.read(Texel::Four)));
        let module = form.module(spirv::refine, spirv::refine_queue);
        let refine = Kernel::new(device, Self::NAME, &module, &bindings, params)?;
        let mut bindings = form.bindings(Touch::Updates);
        let buffers = [TRACE_INFO, TRACE_HITS, WAVE_MARKS];
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        let resume = Kernel::new(
            device,
            Self::RESUME,
            &form.module(spirv::resume, spirv::resume_queue),
            &bindings,
            params,
        )?;
        Ok(Self { refine, resume })
    }

    /// Records one iteration.
    pub fn record(&self, rec: &mut Recorder, io: RefineIo<'_>, params: &TraceParams) {
        io.state
            .bind_read(rec.pass(Self::NAME, &self.refine))
            .buffer(TRACE_INFO, &io.surfaces.grid_levels)
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

    /// Records the way on of rejected rays, in place; `marks` are zero before.
    pub fn record_resume(
        &self,
        rec: &mut Recorder,
        surfaces: &Surfaces,
        state: &StoredRays,
        hits: &Buffer,
        marks: &Buffer,
        params: &TraceParams,
    ) {
        state
            .bind_in_place(rec.pass(Self::RESUME, &self.resume))
            .buffer(TRACE_INFO, &surfaces.grid_levels)
            .buffer(TRACE_HITS, hits)
            .buffer(WAVE_MARKS, marks)
            .push(params)
            .dispatch(line(params.ray_count));
    }
}
