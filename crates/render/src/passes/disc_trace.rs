//! The pass `disc_trace`.

use super::{disc_lists, over_pixels};
use crate::discs::DiscLists;
use crate::state::{RayLoop, RayState, Touch};
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder, Texel};
use kernels::layout::{
    DISC_KEYS_IN, DISC_LEAVES_IN, DISC_RANGES_IN, DiscTraceParams, TRACE_LIVE, TRACE_POLYNOMIALS,
    TraceParams,
};
use kernels::spirv;
use points::device::Surfaces;
use std::sync::Arc;

/// What the pass works on.
pub(crate) struct DiscTraceIo<'a> {
    pub lists: &'a DiscLists,
    pub surfaces: &'a Surfaces,
    pub state: &'a RayState,
    /// One u32, zero before: how many rays have not ended.
    pub live: &'a Buffer,
}

/// The nearest hit of each camera ray among the points of its screen tile (\[T\] §4).
pub(crate) struct DiscTrace {
    pub kernel: Kernel,
}

impl DiscTrace {
    pub const NAME: &'static str = "disc_trace";

    pub fn new(device: &Arc<Device>, form: RayLoop) -> Result<Self, GpuError> {
        let module = form.module(spirv::disc_trace, spirv::disc_trace_queue);
        let mut bindings = form.bindings(Touch::Updates);
        bindings.push((TRACE_LIVE, Binding::StorageBuffer));
        bindings.push((TRACE_POLYNOMIALS, form.read(Texel::Four)));
        bindings.extend(disc_lists(form));
        let params = size_of::<DiscTraceParams>();
        let kernel = Kernel::new(device, Self::NAME, &module, &bindings, params)?;
        Ok(Self { kernel })
    }

    /// Records one pass over rays that `camera_rays` started; the caller then swaps the ray state.
    /// They cross no cells, so that K does not count.
    pub fn record(
        &self,
        rec: &mut Recorder,
        io: DiscTraceIo<'_>,
        tile_size: [u32; 2],
        params: &TraceParams,
    ) {
        let params = DiscTraceParams { ranks: io.lists.ranks, tile_size, work: params.work };
        let pass = rec.pass(Self::NAME, &self.kernel);
        io.state
            .bind_update(pass)
            .buffer(DISC_RANGES_IN, &io.lists.tiles)
            .buffer(DISC_KEYS_IN, &io.lists.pairs.keys)
            .buffer(DISC_LEAVES_IN, &io.lists.pairs.slots)
            .buffer(TRACE_POLYNOMIALS, &io.surfaces.polynomials)
            .buffer(TRACE_LIVE, io.live)
            .push(&params)
            .dispatch(over_pixels(tile_size));
    }
}
