//! The pass `disc_trace`.

use super::{Records, bind_state, over_pixels, state_bindings};
use crate::discs::DiscLists;
use crate::state::RayState;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{
    DiscTraceParams, STATE_IN, STATE_OUT, TRACE_CELLS, TRACE_KEYS, TRACE_LIVE, TRACE_POLYNOMIALS,
    TRACE_SLOTS, TraceParams,
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
    kernel: Kernel,
}

impl DiscTrace {
    pub const NAME: &'static str = "disc_trace";

    pub fn new(device: &Arc<Device>, records: Records) -> Result<Self, GpuError> {
        let (module, polynomials) = match records {
            Records::Texels => (spirv::disc_trace_texels(), Binding::UniformTexelBuffer),
            Records::Storage => (spirv::disc_trace(), Binding::StorageBuffer),
        };
        let mut bindings = state_bindings(STATE_IN).to_vec();
        bindings.extend(state_bindings(STATE_OUT));
        let buffers = [TRACE_CELLS, TRACE_SLOTS, TRACE_LIVE, TRACE_KEYS];
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        bindings.push((TRACE_POLYNOMIALS, polynomials));
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
        let pass = bind_state(pass, STATE_IN, &io.state.current);
        bind_state(pass, STATE_OUT, &io.state.next)
            .buffer(TRACE_CELLS, &io.lists.tiles)
            .buffer(TRACE_KEYS, &io.lists.pairs.keys)
            .buffer(TRACE_SLOTS, &io.lists.pairs.slots)
            .buffer(TRACE_POLYNOMIALS, &io.surfaces.polynomials)
            .buffer(TRACE_LIVE, io.live)
            .push(&params)
            .dispatch(over_pixels(tile_size));
    }
}
