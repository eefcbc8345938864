//! The pass `disc_emit`.

use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{DISC_KEYS, DISC_OFFSETS, DISC_POLYNOMIALS, DISC_SLOTS, DiscParams};
use kernels::spirv;
use points::device::{Pairs, line};
use std::sync::Arc;

/// A pair for each screen tile that each point's disc covers.
pub(crate) struct DiscEmit {
    kernel: Kernel,
}

impl DiscEmit {
    pub const NAME: &'static str = "disc_emit";

    pub fn new(device: &Arc<Device>) -> Result<Self, GpuError> {
        let bindings = [DISC_POLYNOMIALS, DISC_OFFSETS, DISC_KEYS, DISC_SLOTS]
            .map(|binding| (binding, Binding::StorageBuffer));
        let params = size_of::<DiscParams>();
        let kernel = Kernel::new(device, Self::NAME, &spirv::disc_emit(), &bindings, params)?;
        Ok(Self { kernel })
    }

    /// Records the pairs of all points; `offsets` are their counts, scanned.
    pub fn record(
        &self,
        rec: &mut Recorder,
        polynomials: &Buffer,
        offsets: &Buffer,
        pairs: &Pairs,
        params: &DiscParams,
    ) {
        rec.pass(Self::NAME, &self.kernel)
            .buffer(DISC_POLYNOMIALS, polynomials)
            .buffer(DISC_OFFSETS, offsets)
            .buffer(DISC_KEYS, &pairs.keys)
            .buffer(DISC_SLOTS, &pairs.slots)
            .push(params)
            .dispatch(line(params.pair_count));
    }
}
