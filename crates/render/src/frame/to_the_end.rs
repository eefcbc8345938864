//! Passes until no ray of a wave lives, and until no hit is pending: the paper's loop (\[T\] §5).

use super::{FrameStats, Renderer, Traced};
use crate::RenderError;
use crate::passes::{DiscTraceIo, RefineIo, Start, SurfaceHitIo, TraceIo};
use kernels::layout::{Hit, NONE, TraceParams};
use plan::Plan;
use points::Watch;

/// Rays are listed where at least one of so many of the last pass has ended.
const ENDED_SHARE: u32 = 4;

impl Renderer {
    /// Passes until no ray lives: the paper's loop on the CPU. Of the wave's rays, `alive` are known to live
    /// at first. Once a quarter has ended, passes are over a list of the others.
    pub(super) fn trace_to_the_end(
        &mut self,
        plan: &Plan,
        [ray_count, mut alive]: [u32; 2],
        traced: Traced,
        stats: &mut FrameStats,
        watch: &dyn Watch,
    ) -> Result<(), RenderError> {
        let cells = if plan.cells_per_pass == 0 { u32::MAX } else { plan.cells_per_pass };
        let any_hit = u32::from(traced.to_light() && !plan.light_passes);
        let passed = match traced {
            Traced::PastObject(object) => object,
            _ => NONE,
        };
        let work = self.budget.work();
        let wave = TraceParams { ray_count, cells, work, any_hit, listed: 0, passed };
        let state = if traced.to_light() { &mut self.shadows } else { &mut self.state };
        let (surfaces, live, live_rays) = (&self.surfaces, &self.live, &mut self.live_rays);
        let (list_marked, live_marks) = (&self.passes.list_marked, &self.live_marks);
        let mut params = wave;
        let mut starts = true;
        let by_tree = match traced {
            Traced::ByDiscs(_) | Traced::Camera => plan.camera_by_tree(),
            Traced::Scattered | Traced::Shadows | Traced::PastObject(_) => plan.by_tree(),
        };
        while alive > 0 {
            if watch.interrupted() {
                return Err(RenderError::Interrupted);
            }
            self.recorder.fill(live, 0, 4, 0);
            params.work = self.budget.work();
            match (traced, self.discs.lists()) {
                (Traced::ByDiscs(tile_size), Some(lists)) => {
                    let io = DiscTraceIo { lists, surfaces, state, live };
                    self.passes.disc_trace.record(&mut self.recorder, io, tile_size, &params);
                }
                _ => {
                    if alive < params.ray_count - params.ray_count / ENDED_SHARE {
                        live_rays.swap(0, 1);
                        let from = (params.listed == 1).then_some(&live_rays[1]);
                        let (rec, rays) = (&mut self.recorder, params.ray_count);
                        list_marked.record(rec, live_marks, rays, from, &live_rays[0]);
                        let work = params.work;
                        params = TraceParams { ray_count: alive, listed: 1, work, ..wave };
                    }
                    let from = match traced {
                        Traced::ByDiscs(_) | Traced::Camera => Start::Camera,
                        Traced::Scattered | Traced::Shadows | Traced::PastObject(_) => {
                            Start::Surface
                        }
                    };
                    live_marks.record_none(&mut self.recorder, params.ray_count);
                    let live_rays = &live_rays[0];
                    let marks = &live_marks.bits;
                    let io = TraceIo { surfaces, state, live, marks, live_rays };
                    match &surfaces.tree {
                        Some(tree) if by_tree => {
                            let rec = &mut self.recorder;
                            self.passes.tree_trace.record(rec, io, tree, from, &params, starts);
                        }
                        _ => self.passes.grid_trace.record(&mut self.recorder, io, from, &params),
                    }
                    starts = false;
                }
            }
            let timings = self.recorder.submit()?;
            stats.add_kernels(&timings.passes);
            stats.traversal.add(traced, &timings.passes);
            if params.listed == 0 {
                state.passed();
            }
            stats.passes += 1;
            let mut left = [0];
            live.read(0, &mut left)?;
            [alive] = left;
            self.budget.passed(timings.passes.iter().map(|pass| pass.1).sum(), alive > 0);
            watch.done(stats.rays);
        }
        Ok(())
    }

    /// Hits of all rays that have ended; refined, where an object asks for it, and rays whose hit was
    /// refined away traced on.
    pub(super) fn settle_hits(
        &mut self,
        plan: &Plan,
        ray_count: u32,
        traced: Traced,
        stats: &mut FrameStats,
        watch: &dyn Watch,
    ) -> Result<(), RenderError> {
        let params =
            TraceParams { ray_count, cells: 0, work: 0, any_hit: 0, listed: 0, passed: NONE };
        if plan.refines() {
            let bytes = u64::from(ray_count) * size_of::<Hit>() as u64;
            self.recorder.fill(&self.hits, 0, bytes, 0);
        }
        loop {
            self.recorder.fill(&self.live, 0, 8, 0);
            let io = SurfaceHitIo {
                state: &self.state.current,
                surfaces: &self.surfaces,
                objects: &self.objects,
                hits: &self.hits,
                live: &self.live,
            };
            self.passes.surface_hit.record(&mut self.recorder, io, &params);
            if !plan.refines() {
                return Ok(()); // recorded; what follows submits it
            }
            let [pending, _] = self.submit_and_count(stats)?;
            let rejected = self.refine_hits(pending, &params, stats, watch)?;
            if rejected == 0 {
                return Ok(());
            }
            let (surfaces, state) = (&self.surfaces, &self.state.current);
            let (rec, hits) = (&mut self.recorder, &self.hits);
            self.live_marks.record_none(rec, ray_count);
            let marks = &self.live_marks.bits;
            self.passes.refine.record_resume(rec, surfaces, state, hits, marks, &params);
            self.trace_to_the_end(plan, [ray_count, rejected], traced, stats, watch)?;
        }
    }

    /// Iterations until no hit is pending; returns how many were rejected.
    fn refine_hits(
        &mut self,
        mut pending: u32,
        params: &TraceParams,
        stats: &mut FrameStats,
        watch: &dyn Watch,
    ) -> Result<u32, RenderError> {
        let mut all_rejected = 0;
        while pending > 0 {
            if watch.interrupted() {
                return Err(RenderError::Interrupted);
            }
            let Some(point_cells) = &self.surfaces.point_cells else { break };
            self.recorder.fill(&self.live, 0, 8, 0);
            let io = RefineIo {
                surfaces: &self.surfaces,
                point_cells,
                state: &self.state.current,
                objects: &self.objects,
                hits: &self.hits,
                live: &self.live,
            };
            self.passes.refine.record(&mut self.recorder, io, params);
            let [still_pending, rejected] = self.submit_and_count(stats)?;
            pending = still_pending;
            all_rejected += rejected;
        }
        Ok(all_rejected)
    }

    /// Runs what is recorded, and reads the two counters.
    pub(super) fn submit_and_count(
        &mut self,
        stats: &mut FrameStats,
    ) -> Result<[u32; 2], RenderError> {
        stats.add_kernels(&self.recorder.submit()?.passes);
        let mut counts = [0; 2];
        self.live.read(0, &mut counts)?;
        Ok(counts)
    }
}
