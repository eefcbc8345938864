//! The pass `fit_polynomials`.

use super::line;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder, Texel};
use kernels::layout::{
    FIT_NEIGHBORS, FIT_OUTCOMES, FIT_POINTS, FIT_POLYNOMIALS, FIT_RIMS, FIT_SIZES, FitOutcome,
    FitParams, Polynomial,
};
use kernels::spirv;
use std::sync::Arc;

/// Neighbours that the faster kernel takes, at most.
const FEW: u32 = 16;

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
    /// For lists of up to 16, and for others.
    kernels: [Kernel; 2],
}

impl FitPolynomials {
    pub const NAME: &'static str = "fit_polynomials";

    pub fn new(device: &Arc<Device>, texels: bool) -> Result<Self, GpuError> {
        let read =
            if texels { Binding::UniformTexelBuffer(Texel::Four) } else { Binding::StorageBuffer };
        let bindings = [
            (FIT_POINTS, read),
            (FIT_NEIGHBORS, read),
            (FIT_POLYNOMIALS, Binding::StorageBuffer),
            (FIT_OUTCOMES, Binding::StorageBuffer),
            (FIT_SIZES, Binding::StorageBuffer),
            (FIT_RIMS, Binding::StorageBuffer),
        ];
        let kernel = |module: &[u32]| {
            Kernel::new(device, Self::NAME, module, &bindings, size_of::<FitParams>())
        };
        let few =
            if texels { spirv::fit_polynomials_texels_few() } else { spirv::fit_polynomials() };
        let many = if texels { spirv::fit_polynomials_texels() } else { spirv::fit_polynomials() };
        Ok(Self { kernels: [kernel(&few)?, kernel(&many)?] })
    }

    /// What takes lists of so many entries.
    pub fn kernel(&self, neighbors: u32) -> &Kernel {
        &self.kernels[usize::from(neighbors > FEW)]
    }

    /// Records one batch.
    pub fn record(&self, rec: &mut Recorder, io: FitPolynomialsIo<'_>, params: &FitParams) {
        // Of a large scene, the buffers by slot are longer than a binding.
        let slots = [params.bound_from, params.first_slot + params.point_count];
        let part = |stride: usize| {
            let [first, end] = slots.map(|slot| u64::from(slot) * stride as u64);
            [first, end - first]
        };
        let polynomials = part(size_of::<Polynomial>());
        let outcomes = part(size_of::<FitOutcome>());
        let sizes =
            if params.feature_size < 0.0 { part(size_of::<f32>()) } else { [0, io.sizes.bytes()] };
        rec.pass(Self::NAME, self.kernel(params.neighbors))
            .buffer(FIT_POINTS, io.points)
            .buffer(FIT_NEIGHBORS, io.neighbors)
            .buffer_part(FIT_POLYNOMIALS, io.polynomials, polynomials[0], polynomials[1])
            .buffer_part(FIT_OUTCOMES, io.outcomes, outcomes[0], outcomes[1])
            .buffer_part(FIT_SIZES, io.sizes, sizes[0], sizes[1])
            .buffer(FIT_RIMS, io.rims)
            .push(params)
            .dispatch(line(params.point_count));
    }
}
