//! The first wave of a tile: rays from the camera, and in one pass all of it where that can be.

use super::Fates;
use crate::RenderError;
use crate::frame::{Asked, Frame, Wave, over_pixels};
use crate::state::RayLoop;
use crate::stats::Traced;
use gpu::Timings;
use kernels::layout::{CameraTraceParams, PATHS, WAVE_SHARES_PATH, WaveParams};
use kernels::spirv::{self, Module, Way};
use plan::{Plan, Window};

/// Lanes that ask together (`glsl/shared/packet.glsl`).
const PACKET: u32 = 8;

/// What traces the first wave in one pass by the lists of screen tiles, where the device's subgroups are made of packets
/// of eight that can vote.
pub(crate) fn camera_trace_by_discs(device: &gpu::Device) -> Option<&'static Module> {
    let subgroup = device.limits().subgroup_size;
    let has_packets = subgroup != 0 && subgroup.is_multiple_of(PACKET);
    has_packets.then(|| spirv::camera_trace(Way::Discs))
}

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
        let by_discs = self.bin_discs(tile)?;
        let traced = if by_discs { Traced::ByDiscs(tile.size) } else { Traced::Camera };
        let fates = self.trace_at_once(tile, &params)?;
        match fates {
            Some(_) if ends_at_first => Ok(None),
            Some(fates) => {
                params.flags |= WAVE_SHARES_PATH;
                self.light_and_scatter(&Wave { params, traced, sample }, fates)
            }
            None => {
                self.start_rays(tile, sample);
                params.flags |= self.plan.shows_of_volumes();
                Ok(Some(Wave { params, traced, sample }))
            }
        }
    }

    fn start_rays(&mut self, tile: &Window, sample: u32) {
        let (rays, params) = (self.rays(), self.plan.camera_of(tile, sample));
        let own = self.renderer.rays.state.in_place();
        let own = own.buffer(PATHS, self.renderer.buffers.wave.paths());
        self.dispatch(spirv::camera_rays(rays), &own, &params, over_pixels(params.tile_size));
    }

    /// The first wave in one pass, if screen tiles are listed or there is a tree, its rays meet nothing but surfaces, and
    /// all of them end within one pass's work.
    fn trace_at_once(
        &mut self,
        tile: &Window,
        params: &WaveParams,
    ) -> Result<Option<Fates>, RenderError> {
        let may_end = self.renderer.rays.form == RayLoop::Queue && self.renderer.rays.end_at_once;
        let centered = self.plan.looks_through_centers(params.sample_index);
        if !(may_end && centered && self.plan.meets_surfaces_alone()) {
            return Ok(None);
        }
        let work = self.renderer.run.budget.work();
        let mut traced = self.plan.camera_trace_of(tile, &self.renderer.surfaces.grids, work);
        let Some((module, mut own)) = self.way_at_once(tile, &mut traced) else {
            return Ok(None);
        };
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

    /// What traces the first wave in one pass, and what it reads.
    fn way_at_once(
        &self,
        tile: &Window,
        params: &mut CameraTraceParams,
    ) -> Option<(&'static Module, gpu::Bindings)> {
        let plan: &Plan = &self.plan;
        match (self.renderer.rays.discs.lists(), &self.renderer.surfaces.tree) {
            (Some(lists), _) if plan.by_discs(tile) => {
                Some((camera_trace_by_discs(&self.renderer.run.device)?, lists.bindings()))
            }
            (_, Some(tree)) if plan.camera_by_tree() => {
                params.tree = tree.info;
                Some((spirv::camera_trace(Way::Tree), gpu::Bindings::new()))
            }
            _ => None,
        }
    }

    /// Lists the points of each screen tile, if this tile is to be traced by discs; whether it is.
    fn bin_discs(&mut self, tile: &Window) -> Result<bool, RenderError> {
        if !self.plan.by_discs(tile) {
            return Ok(false);
        }
        let Self { renderer, plan, stats, .. } = self;
        let mut timed = |timings: &Timings| stats.add(&timings.passes, None);
        let (discs, recorder) = (&mut renderer.rays.discs, &mut renderer.run.recorder);
        Ok(discs.bin(recorder, plan, tile, &renderer.surfaces, &mut timed)?.is_some())
    }
}
