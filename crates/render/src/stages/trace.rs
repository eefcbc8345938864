//! Passes until no ray of a wave lives: the paper's loop (\[T\] §5).

use crate::RenderError;
use crate::frame::{Frame, Wave, over_pixels};
use crate::renderer::Renderer;
use crate::stats::Traced;
use gpu::Bindings;
use kernels::layout::{DiscTraceParams, LIVE_RAYS, MARKS, NONE, TraceParams, TreeTraceParams};
use kernels::spirv::{self, Start};
use points::device::line;

/// Rays are listed where at least one of so many of the last pass has ended.
const ENDED_SHARE: u32 = 4;

impl Frame<'_> {
    /// The rays of a wave to their nearest hits.
    pub fn trace(&mut self, wave: &Wave) -> Result<(), RenderError> {
        self.trace_to_the_end([wave.params.ray_count; 2], wave.traced)
    }

    /// Passes until no ray lives. Of the wave's rays, `alive` are known to live at first. Once a quarter has ended,
    /// passes are over a list of the others.
    pub fn trace_to_the_end(
        &mut self,
        [ray_count, alive]: [u32; 2],
        traced: Traced,
    ) -> Result<(), RenderError> {
        let cells = if self.plan.cells_per_pass == 0 { u32::MAX } else { self.plan.cells_per_pass };
        let any_hit = u32::from(traced.to_light() && !self.plan.light_passes);
        let passed = match traced {
            Traced::PastObject(object) => object,
            _ => NONE,
        };
        let mut params = TraceParams { ray_count, cells, work: 0, any_hit, listed: 0, passed };
        let mut starts = true;
        self.until_none_lives(alive, Some(traced), |frame, alive| {
            params.work = frame.renderer.run.budget.work();
            match traced {
                Traced::ByDiscs(tile_size) => frame.record_disc_trace(&params, tile_size),
                _ => {
                    if alive < params.ray_count - params.ray_count / ENDED_SHARE {
                        frame.list_live_rays(&params);
                        (params.ray_count, params.listed) = (alive, 1);
                    }
                    frame.record_trace(&params, traced, starts);
                    starts = false;
                }
            }
            if params.listed == 0 {
                frame.traced_rays(traced).passed();
            }
            frame.stats.passes += 1;
        })
        .map(|_| ())
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

    /// Records a pass through the tree or the grid.
    fn record_trace(&mut self, params: &TraceParams, traced: Traced, starts: bool) {
        let start = if traced.from_camera() { Start::Camera } else { Start::Surface };
        let by_tree =
            if traced.from_camera() { self.plan.camera_by_tree() } else { self.plan.by_tree() };
        let Renderer { surfaces, buffers, rays, run, bound, .. } = &mut *self.renderer;
        let wave = &buffers.wave;
        wave.live_marks.record_none(&mut run.recorder, params.ray_count);
        let state = if traced.to_light() { &rays.shadows } else { &rays.state };
        let listed = Bindings::new()
            .buffer(MARKS, &wave.live_marks.bits)
            .buffer(LIVE_RAYS, &wave.live_rays[0]);
        let invocations = line(params.ray_count);
        match &surfaces.tree {
            Some(tree) if by_tree => {
                let TraceParams { ray_count, work, any_hit, listed: is_listed, passed, .. } =
                    *params;
                let params = TreeTraceParams {
                    ray_count,
                    work,
                    any_hit,
                    listed: is_listed,
                    passed,
                    starts: u32::from(starts),
                    tree: tree.info,
                };
                let pass = run.recorder.pass(spirv::tree_trace(start));
                let pass = pass.bind(&state.in_place()).bind(&listed).bind(bound);
                pass.push(&params).dispatch(invocations);
            }
            _ => {
                // Listed rays stay where they are, and the others with them.
                let state = if params.listed == 0 { state.updated() } else { state.in_place() };
                let module = spirv::grid_trace(start, rays.form.rays());
                let pass = run.recorder.pass_specialized(module, Some(run.scene | run.skips));
                pass.bind(&state).bind(&listed).bind(bound).push(params).dispatch(invocations);
            }
        }
    }

    /// Records a pass through the lists of screen tiles.
    fn record_disc_trace(&mut self, params: &TraceParams, tile_size: [u32; 2]) {
        let Some(lists) = self.renderer.rays.discs.lists() else { return };
        let own = self.renderer.rays.state.updated().extended(&lists.bindings());
        let params = DiscTraceParams { ranks: lists.ranks, tile_size, work: params.work };
        let rays = self.rays();
        self.dispatch(spirv::disc_trace(rays), &own, &params, over_pixels(tile_size));
    }
}
