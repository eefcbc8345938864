//! The pass `accumulate`.

use super::over_pixels;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{AccumulateParams, FILM_SUMS, SHADE_FILM};
use kernels::spirv;
use std::sync::Arc;

/// Adds a sample of each pixel to the sum of those before it; after the last, the mean.
pub(crate) struct Accumulate {
    pub kernel: Kernel,
}

impl Accumulate {
    pub const NAME: &'static str = "accumulate";

    pub fn new(device: &Arc<Device>) -> Result<Self, GpuError> {
        let bindings = [SHADE_FILM, FILM_SUMS].map(|binding| (binding, Binding::StorageBuffer));
        let params = size_of::<AccumulateParams>();
        let kernel = Kernel::new(device, Self::NAME, &spirv::accumulate(), &bindings, params)?;
        Ok(Self { kernel })
    }

    /// Records one sample. After the last, `film` has the means.
    pub fn record(
        &self,
        rec: &mut Recorder,
        film: &Buffer,
        sums: &Buffer,
        params: &AccumulateParams,
    ) {
        rec.pass(Self::NAME, &self.kernel)
            .buffer(SHADE_FILM, film)
            .buffer(FILM_SUMS, sums)
            .push(params)
            .dispatch(over_pixels(params.tile_size));
    }
}
