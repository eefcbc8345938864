//! The pass `fit_polynomials`.

use super::line;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{
    FIT_NEIGHBORS, FIT_OUTCOMES, FIT_POINTS, FIT_POLYNOMIALS, FIT_RIMS, FIT_SIZES, FitParams,
};
use kernels::spirv;
use std::sync::Arc;

/// What the pass works on.
pub(crate) struct FitPolynomialsIo<'a> {
    pub points: &'a Buffer,
    pub neighbors: &'a Buffer,
    pub polynomials: &'a Buffer,
    pub outcomes: &'a Buffer,
    /// h by slot, where it is smoothed; otherwise anything.
    pub sizes: &'a Buffer,
    /// One a point of the batch, where rims are asked for; otherwise anything.
    pub rims: &'a Buffer,
}

/// The local polynomial of each point of one batch (method, section 1).
pub(crate) struct FitPolynomials {
    kernel: Kernel,
}

impl FitPolynomials {
    pub const NAME: &'static str = "fit_polynomials";

    pub fn new(device: &Arc<Device>) -> Result<Self, GpuError> {
        let bindings = [
            (FIT_POINTS, Binding::StorageBuffer),
            (FIT_NEIGHBORS, Binding::StorageBuffer),
            (FIT_POLYNOMIALS, Binding::StorageBuffer),
            (FIT_OUTCOMES, Binding::StorageBuffer),
            (FIT_SIZES, Binding::StorageBuffer),
            (FIT_RIMS, Binding::StorageBuffer),
        ];
        let params = size_of::<FitParams>();
        let kernel = Kernel::new(device, Self::NAME, &spirv::fit_polynomials(), &bindings, params)?;
        Ok(Self { kernel })
    }

    /// Records one batch.
    pub fn record(&self, rec: &mut Recorder, io: FitPolynomialsIo<'_>, params: &FitParams) {
        rec.pass(Self::NAME, &self.kernel)
            .buffer(FIT_POINTS, io.points)
            .buffer(FIT_NEIGHBORS, io.neighbors)
            .buffer(FIT_POLYNOMIALS, io.polynomials)
            .buffer(FIT_OUTCOMES, io.outcomes)
            .buffer(FIT_SIZES, io.sizes)
            .buffer(FIT_RIMS, io.rims)
            .push(params)
            .dispatch(line(params.point_count));
    }
}
