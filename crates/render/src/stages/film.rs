//! The film: sums of samples, and the rays that are counted.

use crate::RenderError;
use crate::frame::{Frame, over_pixels};
use gpu::Bindings;
use kernels::layout::{AccumulateParams, FilmPixel};
use kernels::spirv;
use plan::{Rays, Window};

impl crate::tables::FilmBuffers {
    /// Of the largest tile.
    pub fn pixels(&self) -> usize {
        (self.film.bytes() / size_of::<FilmPixel>() as u64) as usize
    }
}

impl Frame<'_> {
    /// Records that the film holds this sample of the tile; after the last, it holds their mean.
    pub fn accumulate(&mut self, tile: &Window, sample: u32) {
        let samples = self.plan.samples;
        if samples == 1 {
            return;
        }
        let params = AccumulateParams { tile_size: tile.size, sample_index: sample, samples };
        self.dispatch(spirv::accumulate(), &Bindings::new(), &params, over_pixels(tile.size));
    }

    /// The rays of a sample of a tile.
    pub fn counted(&self, tile: &Window) -> Result<Rays, RenderError> {
        let [dark, reflected, scattered] = self.renderer.buffers.wave.read_tally()?;
        let refracted = self.asked.scattered - reflected - scattered;
        let (camera, shadow) = (tile.pixels() as u64, self.asked.lights - dark);
        Ok(Rays { camera, shadow, reflected, refracted, scattered })
    }
}
