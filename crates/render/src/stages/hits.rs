//! Hits of rays that have ended, and their refinement until no hit is pending.

use crate::RenderError;
use crate::frame::{Frame, Wave};
use kernels::layout::{Hit, MARKS, NONE, TraceParams};
use kernels::spirv;
use points::device::line;

impl Frame<'_> {
    /// Hits of all rays that have ended; refined, where an object asks for it, and rays whose hit was
    /// refined away traced on.
    pub fn settle_hits(&mut self, wave: &Wave) -> Result<(), RenderError> {
        let ray_count = wave.params.ray_count;
        // Rays that go on after a refinement are in no list of a screen tile.
        let (traced, through) = (wave.traced, self.structure_of(wave.traced));
        let params =
            TraceParams { ray_count, cells: 0, work: 0, any_hit: 0, listed: 0, passed: NONE };
        let refines = self.plan.refines();
        if refines {
            let bytes = u64::from(ray_count) * size_of::<Hit>() as u64;
            self.renderer.run.recorder.fill(&self.renderer.buffers.wave.hits, 0, bytes, 0);
        }
        let (rays, invocations) = (self.rays(), line(ray_count));
        loop {
            self.clear_live();
            let state = self.renderer.rays.state.in_place();
            self.dispatch(spirv::surface_hit(rays), &state, &params, invocations);
            if !refines {
                return Ok(()); // recorded; what follows submits it
            }
            self.submit(None)?;
            let [pending, _] = self.renderer.buffers.wave.read_live()?;
            let rejected = self.refine(pending, &params)?;
            if rejected == 0 {
                return Ok(());
            }
            let marks = &self.renderer.buffers.wave.live_marks;
            marks.record_none(&mut self.renderer.run.recorder, ray_count);
            let own = state.buffer(MARKS, &marks.bits);
            self.dispatch(spirv::resume(rays), &own, &params, invocations);
            self.trace_to_the_end([ray_count, rejected], traced, through)?;
        }
    }

    /// Iterations until no hit is pending; returns how many were rejected.
    fn refine(&mut self, pending: u32, params: &TraceParams) -> Result<u32, RenderError> {
        if self.renderer.surfaces.point_cells.is_none() {
            return Ok(0);
        }
        let rays = self.rays();
        self.until_none_lives(pending, None, |frame, _| {
            let state = frame.renderer.rays.state.in_place();
            frame.dispatch(spirv::refine(rays), &state, params, line(params.ray_count));
        })
    }
}
