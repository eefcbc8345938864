//! The pass `disc_count`.

use crate::state::RayLoop;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder, Texel};
use kernels::layout::{DISC_OFFSETS, DiscParams, LEAF_POINTS, TRACE_POLYNOMIALS};
use kernels::spirv;
use points::device::line;
use std::sync::Arc;

/// How many screen tiles the discs of each leaf cover (\[T\] §4).
pub(crate) struct DiscCount {
    pub kernel: Kernel,
}

impl DiscCount {
    pub const NAME: &'static str = "disc_count";

    pub fn new(device: &Arc<Device>, form: RayLoop) -> Result<Self, GpuError> {
        let bindings =
            [(TRACE_POLYNOMIALS, form.read(Texel::Four)), (DISC_OFFSETS, Binding::StorageBuffer)];
        let module = form.module(spirv::disc_count, spirv::disc_count_queue);
        let params = size_of::<DiscParams>();
        let kernel = Kernel::new(device, Self::NAME, &module, &bindings, params)?;
        Ok(Self { kernel })
    }

    /// Records the count of each leaf.
    pub fn record(
        &self,
        rec: &mut Recorder,
        polynomials: &Buffer,
        counts: &Buffer,
        params: &DiscParams,
    ) {
        rec.pass(Self::NAME, &self.kernel)
            .buffer(TRACE_POLYNOMIALS, polynomials)
            .buffer(DISC_OFFSETS, counts)
            .push(params)
            .dispatch(line(params.point_count.div_ceil(LEAF_POINTS)));
    }
}
