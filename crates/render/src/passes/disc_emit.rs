//! The pass `disc_emit`.

use crate::state::RayLoop;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder, Texel};
use kernels::layout::{
    DISC_KEYS, DISC_LEAVES, DISC_OFFSETS, DiscParams, LEAF_POINTS, TRACE_POLYNOMIALS,
};
use kernels::spirv;
use points::device::{Pairs, line};
use std::sync::Arc;

/// A pair for each screen tile that the discs of each leaf's points cover.
pub(crate) struct DiscEmit {
    pub kernel: Kernel,
}

impl DiscEmit {
    pub const NAME: &'static str = "disc_emit";

    pub fn new(device: &Arc<Device>, form: RayLoop) -> Result<Self, GpuError> {
        let bindings = [
            (TRACE_POLYNOMIALS, form.read(Texel::Four)),
            (DISC_OFFSETS, form.read(Texel::One)),
            (DISC_KEYS, Binding::StorageBuffer),
            (DISC_LEAVES, Binding::StorageBuffer),
        ];
        let module = form.module(spirv::disc_emit, spirv::disc_emit_queue);
        let params = size_of::<DiscParams>();
        let kernel = Kernel::new(device, Self::NAME, &module, &bindings, params)?;
        Ok(Self { kernel })
    }

    /// Records the pairs of all leaves; `offsets` are their counts, scanned.
    pub fn record(
        &self,
        rec: &mut Recorder,
        polynomials: &Buffer,
        offsets: &Buffer,
        pairs: &Pairs,
        params: &DiscParams,
    ) {
        rec.pass(Self::NAME, &self.kernel)
            .buffer(TRACE_POLYNOMIALS, polynomials)
            .buffer(DISC_OFFSETS, offsets)
            .buffer(DISC_KEYS, &pairs.keys)
            .buffer(DISC_LEAVES, &pairs.slots)
            .push(params)
            .dispatch(line(params.point_count.div_ceil(LEAF_POINTS)));
    }
}
