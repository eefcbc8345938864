//! Several samples a pixel: their sum, until it is their mean.

use crate::passes::Accumulate;
use gpu::{Buffer, Device, GpuError, Recorder};
use kernels::layout::{AccumulateParams, FilmSum};
use plan::{Plan, Window};
use std::sync::Arc;

/// The sums of a tile's samples, and the pass that adds to them. With one sample a pixel there is
/// nothing to add, and nothing is held.
pub(crate) struct Samples {
    held: Option<(Accumulate, Buffer)>,
}

impl Samples {
    pub fn new(device: &Arc<Device>, plan: &Plan, tile_pixels: u64) -> Result<Self, GpuError> {
        if plan.samples == 1 {
            return Ok(Self { held: None });
        }
        let sums = Buffer::new(device, "film sums", tile_pixels * size_of::<FilmSum>() as u64)?;
        Ok(Self { held: Some((Accumulate::new(device)?, sums)) })
    }

    /// Records that `film` holds this sample of the tile; after the last, it holds their mean.
    pub fn record(
        &self,
        rec: &mut Recorder,
        film: &Buffer,
        plan: &Plan,
        tile: &Window,
        sample: u32,
    ) {
        let Some((accumulate, sums)) = &self.held else { return };
        let params =
            AccumulateParams { tile_size: tile.size, sample_index: sample, samples: plan.samples };
        accumulate.record(rec, film, sums, &params);
    }
}
