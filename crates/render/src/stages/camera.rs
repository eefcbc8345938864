//! The first wave of a tile: rays from the camera, and in one pass all of it where that can be.

use super::Fates;
use crate::RenderError;
use crate::frame::{Asked, Frame, Wave, over_pixels};
use crate::renderer::Renderer;
use crate::state::RayLoop;
use crate::stats::Traced;
use gpu::Timings;
use kernels::layout::{PATHS, WAVE_SHARES_PATH, WaveParams};
use kernels::spirv;
use plan::{StructureKind, Window};

impl Frame<'_> {
    /// The wave from the camera, if it is not over already; then the wave that came of it.
    pub fn start_wave(
        &mut self,
        tile: &Window,
        sample: u32,
        ends_at_first: bool,
    ) -> Result<Option<Wave>, RenderError> {
        let mut params = self.plan.wave_of(tile, sample);
        self.asked = Asked::default();
        let tally = &self.renderer.buffers.wave.tally;
        self.renderer.run.recorder.fill(tally, 0, tally.bytes(), 0);
        let (traced, through) = (Traced::Camera, self.structure_for(tile)?);
        let fates = self.trace_at_once(tile, &params, through)?;
        match fates {
            Some(_) if ends_at_first => Ok(None),
            Some(fates) => {
                params.flags |= WAVE_SHARES_PATH;
                self.light_and_scatter(&Wave { params, traced, through, sample }, fates)
            }
            None => {
                self.start_rays(tile, sample);
                params.flags |= self.plan.shows_of_volumes();
                Ok(Some(Wave { params, traced, through, sample }))
            }
        }
    }

    fn start_rays(&mut self, tile: &Window, sample: u32) {
        let (rays, params) = (self.rays(), self.plan.camera_of(tile, sample));
        let own = self.renderer.rays.state.in_place();
        let own = own.buffer(PATHS, self.renderer.buffers.wave.paths());
        self.dispatch(spirv::camera_rays(rays), &own, &params, over_pixels(params.tile_size));
    }

    /// The first wave in one pass, if its structure has a kernel for that, its rays meet nothing but surfaces, and all of
    /// them end within one pass's work.
    fn trace_at_once(
        &mut self,
        tile: &Window,
        params: &WaveParams,
        through: StructureKind,
    ) -> Result<Option<Fates>, RenderError> {
        let may_end = self.renderer.rays.form == RayLoop::Queue && self.renderer.rays.end_at_once;
        let centered = self.plan.looks_through_centers(params.sample_index);
        if !(may_end && centered && self.plan.meets_surfaces_alone()) {
            return Ok(None);
        }
        let work = self.renderer.run.budget.work();
        let mut traced = self.plan.camera_trace_of(tile, &self.renderer.surfaces.grids, work);
        let Renderer { structures, run, .. } = &*self.renderer;
        let structure = structures.get(through);
        let module = structure.and_then(|it| it.at_once(&run.device, &mut traced));
        let Some((module, mut own)) = module else { return Ok(None) };
        own = own.extended(&self.renderer.rays.state.updated());
        self.clear_live();
        self.record_no_marks(params);
        self.dispatch(module, &own, &traced, over_pixels(traced.tile_size));
        self.record_lists(params);
        let milliseconds = self.submit(Some(Traced::Camera))?;
        self.stats.passes += 1;
        let [left, _] = self.renderer.buffers.wave.read_live()?;
        self.renderer.run.budget.passed(milliseconds, left != 0);
        if left == 0 {
            return Ok(Some(self.read_fates(params)?));
        }
        // With more work, they may.
        self.renderer.rays.end_at_once = self.renderer.run.budget.work() > work;
        Ok(None)
    }

    /// What the camera's rays of a tile go through, made ready for it.
    fn structure_for(&mut self, tile: &Window) -> Result<StructureKind, RenderError> {
        let Self { renderer, plan, stats, .. } = self;
        let mut timed = |timings: &Timings| stats.add(&timings.passes, None);
        let Renderer { structures, run, surfaces, .. } = &mut **renderer;
        structures.for_tile(&mut run.recorder, (plan, tile, surfaces), &mut timed)
    }
}
