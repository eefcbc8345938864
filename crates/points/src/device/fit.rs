//! The pass `fit_polynomials`.

use super::line;
use gpu::{Buffer, Recorder};
use kernels::layout::{
    FitOutcome, FitParams, NEIGHBORS, OUTCOMES, POINTS, POLYNOMIALS, Polynomial, RIMS, SIZES,
};
use kernels::spirv::{self, Lists, Module, Neighbors};

/// Neighbours that the faster kernel takes, at most.
const FEW: u32 = 16;

/// What the pass works on.
pub(crate) struct FitBuffers<'a> {
    pub points: &'a Buffer,
    pub neighbors: &'a Buffer,
    pub polynomials: &'a Buffer,
    pub outcomes: &'a Buffer,
    /// h by slot, where it is smoothed; otherwise anything.
    pub sizes: &'a Buffer,
    /// One a point of the batch, where rims are asked for; otherwise anything.
    pub rims: &'a Buffer,
}

/// What fits lists of so many entries: the local polynomial of each point of one batch (method, section 1).
pub(crate) fn fit_module(lists: Lists, neighbors: u32) -> &'static Module {
    spirv::fit_polynomials(match lists {
        Lists::Storage => Neighbors::Storage,
        Lists::Texels if neighbors > FEW => Neighbors::Texels,
        Lists::Texels => Neighbors::Few,
    })
}

/// Records one batch.
pub(crate) fn record_fits(
    rec: &mut Recorder,
    lists: Lists,
    io: FitBuffers<'_>,
    params: &FitParams,
) {
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
    rec.pass(fit_module(lists, params.neighbors))
        .buffer(POINTS, io.points)
        .buffer(NEIGHBORS, io.neighbors)
        .buffer_part(POLYNOMIALS, io.polynomials, polynomials[0], polynomials[1])
        .buffer_part(OUTCOMES, io.outcomes, outcomes[0], outcomes[1])
        .buffer_part(SIZES, io.sizes, sizes[0], sizes[1])
        .buffer(RIMS, io.rims)
        .push(params)
        .dispatch(line(params.point_count));
}
