//! The pass `surface_hit`.

use super::{line, surface_lists};
use crate::state::{RayLoop, StoredRays, Touch};
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder, Texel};
use kernels::layout::{
    SHADE_OBJECTS, TRACE_CELLS, TRACE_HITS, TRACE_INFO, TRACE_LIVE, TRACE_POLYNOMIALS, TRACE_SLOTS,
    TraceParams,
};
use kernels::spirv;
use points::device::Surfaces;
use std::sync::Arc;

/// What the pass works on.
pub(crate) struct SurfaceHitIo<'a> {
    pub state: &'a StoredRays,
    pub surfaces: &'a Surfaces,
    pub objects: &'a Buffer,
    /// Zero before a tile's first time, where hits are refined.
    pub hits: &'a Buffer,
    /// Two u32, zero before: pending hits, and nothing.
    pub live: &'a Buffer,
}

/// Where each ray that has ended met the polynomial it hit.
pub(crate) struct SurfaceHit {
    pub kernel: Kernel,
}

impl SurfaceHit {
    pub const NAME: &'static str = "surface_hit";

    pub fn new(device: &Arc<Device>, form: RayLoop, scene: u32) -> Result<Self, GpuError> {
        let mut bindings = form.bindings(Touch::Reads);
        let buffers = [TRACE_INFO, TRACE_LIVE, TRACE_HITS];
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        bindings.push((SHADE_OBJECTS, form.read(Texel::Four)));
        bindings.extend(surface_lists(form));
        let params = size_of::<TraceParams>();
        let kernel = Kernel::specialized(
            device,
            Self::NAME,
            &form.module(spirv::surface_hit, spirv::surface_hit_queue),
            &bindings,
            params,
            Some(scene),
        )?;
        Ok(Self { kernel })
    }

    /// Records the hits of a tile whose rays have all ended.
    pub fn record(&self, rec: &mut Recorder, io: SurfaceHitIo<'_>, params: &TraceParams) {
        io.state
            .bind_read(rec.pass(Self::NAME, &self.kernel))
            .buffer(TRACE_INFO, &io.surfaces.grid_levels)
            .buffer(TRACE_CELLS, &io.surfaces.cells)
            .buffer(TRACE_SLOTS, &io.surfaces.slots)
            .buffer(TRACE_POLYNOMIALS, &io.surfaces.polynomials)
            .buffer(TRACE_LIVE, io.live)
            .buffer(SHADE_OBJECTS, io.objects)
            .buffer(TRACE_HITS, io.hits)
            .push(params)
            .dispatch(line(params.ray_count));
    }
}
