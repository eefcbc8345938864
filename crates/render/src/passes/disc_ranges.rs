//! The pass `disc_ranges`.

use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{DISC_KEYS, DISC_TILES, DiscParams};
use kernels::spirv;
use points::device::line;
use std::sync::Arc;

/// Where each screen tile's points begin and end in the sorted list of pairs.
pub(crate) struct DiscRanges {
    pub kernel: Kernel,
}

impl DiscRanges {
    pub const NAME: &'static str = "disc_ranges";

    pub fn new(device: &Arc<Device>) -> Result<Self, GpuError> {
        let bindings = [DISC_KEYS, DISC_TILES].map(|binding| (binding, Binding::StorageBuffer));
        let params = size_of::<DiscParams>();
        let kernel = Kernel::new(device, Self::NAME, &spirv::disc_ranges(), &bindings, params)?;
        Ok(Self { kernel })
    }

    /// Records the ranges of all screen tiles that hold points; `tiles` holds zeros before.
    pub fn record(&self, rec: &mut Recorder, keys: &Buffer, tiles: &Buffer, params: &DiscParams) {
        rec.pass(Self::NAME, &self.kernel)
            .buffer(DISC_KEYS, keys)
            .buffer(DISC_TILES, tiles)
            .push(params)
            .dispatch(line(params.pair_count));
    }
}
