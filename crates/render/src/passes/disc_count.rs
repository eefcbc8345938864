//! The pass `disc_count`.

use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{DISC_OFFSETS, DISC_POLYNOMIALS, DiscParams};
use kernels::spirv;
use points::device::line;
use std::sync::Arc;

/// How many screen tiles the disc of each point covers (\[T\] §4).
pub(crate) struct DiscCount {
    kernel: Kernel,
}

impl DiscCount {
    pub const NAME: &'static str = "disc_count";

    pub fn new(device: &Arc<Device>) -> Result<Self, GpuError> {
        let bindings =
            [DISC_POLYNOMIALS, DISC_OFFSETS].map(|binding| (binding, Binding::StorageBuffer));
        let params = size_of::<DiscParams>();
        let kernel = Kernel::new(device, Self::NAME, &spirv::disc_count(), &bindings, params)?;
        Ok(Self { kernel })
    }

    /// Records the count of each point, by slot.
    pub fn record(
        &self,
        rec: &mut Recorder,
        polynomials: &Buffer,
        counts: &Buffer,
        params: &DiscParams,
    ) {
        rec.pass(Self::NAME, &self.kernel)
            .buffer(DISC_POLYNOMIALS, polynomials)
            .buffer(DISC_OFFSETS, counts)
            .push(params)
            .dispatch(line(params.point_count));
    }
}
