//! What becomes of the rays of a wave, and the rays that those make which surfaces send on.

use crate::RenderError;
use crate::frame::{Frame, Wave};
use crate::renderer::Renderer;
use kernels::layout::{NEXT_PATHS, PATHS, WAVE_SHARES_PATH, WaveParams};
use kernels::spirv;
use points::device::line;

/// How many rays of a wave have come to what.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fates {
    /// Hits that light is asked for.
    pub lit: u32,
    /// Hits on surfaces that send rays on.
    pub scattering: u32,
    /// Rays of the next wave.
    pub next: u32,
}

impl Frame<'_> {
    /// What becomes of each ray of a wave.
    pub fn classify(&mut self, wave: &Wave) -> Result<Fates, RenderError> {
        let (rays, params) = (self.rays(), &wave.params);
        self.record_no_marks(params);
        let paths = self.renderer.buffers.wave.paths();
        let own = self.renderer.rays.state.in_place();
        let own = own.buffer(PATHS, paths).buffer(NEXT_PATHS, paths);
        self.dispatch(spirv::classify(rays), &own, params, line(params.ray_count));
        self.record_lists(params);
        self.submit(None)?;
        self.read_fates(params)
    }

    /// Makes the next wave. The wave's rays are those that hit what sends rays on.
    pub fn scatter(&mut self, params: &WaveParams) -> Result<(), RenderError> {
        if !self.plan.scatters() || params.ray_count == 0 {
            return Ok(());
        }
        let rays = self.rays();
        let wave = &self.renderer.buffers.wave;
        let shares = params.flags & WAVE_SHARES_PATH != 0;
        let own = self.renderer.rays.state.moved();
        let own = own.buffer(PATHS, wave.paths_or_shared(shares));
        let own = own.buffer(NEXT_PATHS, wave.next_paths());
        self.dispatch(spirv::scatter(rays), &own, params, line(params.ray_count));
        self.submit(None)?;
        self.renderer.rays.state.swap();
        self.renderer.buffers.wave.swap();
        Ok(())
    }

    /// Records that nothing is known yet of what becomes of a wave's rays.
    pub fn record_no_marks(&mut self, params: &WaveParams) {
        let Renderer { buffers, run, .. } = &mut *self.renderer;
        let (wave, rec) = (&buffers.wave, &mut run.recorder);
        if params.light_count > 0 {
            wave.lit.record_none(rec, params.ray_count);
        }
        if self.plan.scatters() {
            wave.scattering.record_none(rec, params.ray_count);
            wave.next.record_none(rec, params.ray_count);
        }
    }

    /// Records the lists of a wave's rays by what has become of them.
    pub fn record_lists(&mut self, params: &WaveParams) {
        let Renderer { buffers, run, .. } = &mut *self.renderer;
        let (wave, rec) = (&buffers.wave, &mut run.recorder);
        if params.light_count > 0 {
            wave.lit.record_list(rec, params.ray_count, None, &wave.lit_rays);
        }
        if self.plan.scatters() {
            wave.scattering.record_list(rec, params.ray_count, None, &wave.scattering_rays);
            wave.next.record_offsets(rec, params.ray_count);
        }
    }

    /// What [`Frame::record_lists`] has counted.
    pub fn read_fates(&self, params: &WaveParams) -> Result<Fates, RenderError> {
        let (wave, rays) = (&self.renderer.buffers.wave, params.ray_count);
        let lit = if params.light_count > 0 { wave.lit.read_total(rays)? } else { 0 };
        let [scattering, next] = match self.plan.scatters() {
            true => [wave.scattering.read_total(rays)?, wave.next.read_total(rays)?],
            false => [0; 2],
        };
        Ok(Fates { lit, scattering, next })
    }
}
