//! Passes until no ray of a wave lives: the paper's loop (\[T\] §5).

use crate::RenderError;
use crate::frame::{Frame, Wave};
use crate::renderer::Renderer;
use crate::stats::Traced;
use crate::structure::TracePass;
use gpu::Bindings;
use kernels::layout::{LIVE_RAYS, MARKS, TraceParams};
use kernels::spirv::Start;
use plan::{RaysFrom, StructureKind};

/// Rays are listed where at least one of so many of the last pass has ended.
const ENDED_SHARE: u32 = 4;

impl Frame<'_> {
    /// The rays of a wave to their nearest hits.
    pub fn trace(&mut self, wave: &Wave) -> Result<(), RenderError> {
        self.trace_to_the_end([wave.params.ray_count; 2], wave.traced, wave.through)
    }

    /// Passes until no ray lives. Of the wave's rays, `alive` are known to live at first. Once a quarter has ended,
    /// passes are over a list of the others.
    pub fn trace_to_the_end(
        &mut self,
        [ray_count, alive]: [u32; 2],
        traced: Traced,
        through: StructureKind,
    ) -> Result<(), RenderError> {
        let cells = if self.plan.cells_per_pass == 0 { u32::MAX } else { self.plan.cells_per_pass };
        let any_hit = u32::from(traced.to_light() && !self.plan.light_passes);
        let passed = traced.passed();
        let mut params = TraceParams { ray_count, cells, work: 0, any_hit, listed: 0, passed };
        self.until_none_lives(alive, Some(traced), |frame, alive| {
            params.work = frame.renderer.run.budget.work();
            if alive < params.ray_count - params.ray_count / ENDED_SHARE {
                frame.list_live_rays(&params);
                (params.ray_count, params.listed) = (alive, 1);
            }
            frame.record_trace(&params, traced, through);
            if params.listed == 0 {
                frame.traced_rays(traced).passed();
            }
            frame.stats.passes += 1;
        })
        .map(|_| ())
    }

    /// What rays go through that are not the camera's of a tile.
    pub fn structure_of(&self, traced: Traced) -> StructureKind {
        let from = if traced.is_from_camera() { RaysFrom::Camera } else { RaysFrom::Surface };
        self.renderer.structures.of(&self.plan, from)
    }

    fn traced_rays(&mut self, traced: Traced) -> &mut crate::state::RayState {
        let rays = &mut self.renderer.rays;
        if traced.to_light() { &mut rays.shadows } else { &mut rays.state }
    }

    /// Records the list of the rays that the last pass left.
    fn list_live_rays(&mut self, params: &TraceParams) {
        let Renderer { buffers, run, .. } = &mut *self.renderer;
        let wave = &mut buffers.wave;
        wave.live_rays.swap(0, 1);
        let from = (params.listed == 1).then_some(&wave.live_rays[1]);
        wave.live_marks.record_list(&mut run.recorder, params.ray_count, from, &wave.live_rays[0]);
    }

    /// Records a pass.
    fn record_trace(&mut self, params: &TraceParams, traced: Traced, through: StructureKind) {
        let Renderer { structures, buffers, rays, run, bound, .. } = &mut *self.renderer;
        let wave = &buffers.wave;
        wave.live_marks.record_none(&mut run.recorder, params.ray_count);
        let pass = TracePass {
            params,
            state: if traced.to_light() { &rays.shadows } else { &rays.state },
            listed: Bindings::new()
                .buffer(MARKS, &wave.live_marks.bits)
                .buffer(LIVE_RAYS, &wave.live_rays[0]),
            bound,
            start: if traced.is_from_camera() { Start::Camera } else { Start::Surface },
            rays: rays.form.rays(),
        };
        // What rays go through is one that the renderer has.
        let structure = structures.get(through);
        let structure = structure.unwrap_or_else(|| unreachable!("{through:?}: not built"));
        structure.trace(&mut run.recorder, &pass);
    }
}
