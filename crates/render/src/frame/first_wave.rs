//! The first wave of a tile: rays from the camera, and in one pass all of it where that can be.

use super::{Classes, FrameStats, Renderer, Traced, record_no_marks};
use crate::RenderError;
use crate::passes::{CameraRaysIo, CameraTrace, CameraTraceIo};
use crate::state::RayLoop;
use gpu::Timings;
use kernels::layout::WaveParams;
use plan::{Plan, Window};

impl Renderer {
    pub(super) fn start_rays(&mut self, plan: &Plan, tile: &Window, sample: u32) {
        let io = CameraRaysIo {
            grid_levels: &self.surfaces.grid_levels,
            filter: &self.filter,
            start: &self.camera_path,
            state: &self.state.current,
            paths: self.wave.paths(),
        };
        let params = plan.camera_of(tile, sample);
        self.passes.camera_rays.record(&mut self.recorder, io, &params);
    }

    /// The first wave in one pass, if screen tiles are listed or there is a tree, its rays meet nothing but surfaces, and
    /// all of them end within one pass's work.
    pub(super) fn trace_at_once(
        &mut self,
        plan: &Plan,
        tile: &Window,
        params: &WaveParams,
        stats: &mut FrameStats,
    ) -> Result<Option<Classes>, RenderError> {
        let may_end = self.form == RayLoop::Queue && self.ends_at_once;
        let centered = plan.looks_through_centers(params.sample_index);
        if !(may_end && centered && plan.meets_surfaces_alone()) {
            return Ok(None);
        }
        let way = match (self.discs.lists(), &self.surfaces.tree) {
            (Some(lists), _) if plan.by_discs(tile) => self.passes.camera_trace.discs(lists),
            (_, Some(tree)) if plan.camera_by_tree() => Some(self.passes.camera_trace.tree(tree)),
            _ => None,
        };
        let Some(way) = way else { return Ok(None) };
        let io = CameraTraceIo {
            way,
            surfaces: &self.surfaces,
            objects: &self.objects,
            images: &self.images,
            texels: &self.texels,
            film: &self.film,
            state: self.state.started(),
            hits: &self.hits,
            wave: &self.wave,
            live: &self.live,
        };
        let work = self.budget.work();
        let traced = plan.camera_trace_of(tile, &self.surfaces.grids, work);
        self.recorder.fill(&self.live, 0, 4, 0);
        record_no_marks(&mut self.recorder, &self.wave, plan, params);
        CameraTrace::record(&mut self.recorder, io, &traced);
        self.record_lists(plan, params);
        let timings = self.recorder.submit()?;
        stats.add_kernels(&timings.passes);
        stats.traversal.add(Traced::Camera, &timings.passes);
        stats.passes += 1;
        let mut left = [0];
        self.live.read(0, &mut left)?;
        self.budget.passed(timings.passes.iter().map(|pass| pass.1).sum(), left != [0]);
        if left == [0] {
            return Ok(Some(self.read_classes(plan, params)?));
        }
        self.ends_at_once = self.budget.work() > work; // with more, they may
        Ok(None)
    }

    /// Lists the points of each screen tile, if this tile is to be traced by discs; whether it is.
    pub(super) fn bin_discs(
        &mut self,
        plan: &Plan,
        tile: &Window,
        stats: &mut FrameStats,
    ) -> Result<bool, RenderError> {
        if !plan.by_discs(tile) {
            return Ok(false);
        }
        let mut timed = |timings: &Timings| stats.add_kernels(&timings.passes);
        let lists = self.discs.bin(&mut self.recorder, plan, tile, &self.surfaces, &mut timed)?;
        Ok(lists.is_some())
    }
}
