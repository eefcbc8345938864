//! Shadow rays on their way to a light, past surfaces between media of one index where there are some.

use super::{FrameStats, Renderer, Traced};
use crate::RenderError;
use crate::passes::LightPassesIo;
use gpu::Buffer;
use kernels::layout::{NONE, ShadowParams, WaveParams};
use plan::Plan;
use points::Watch;

impl Renderer {
    /// Records what the rays from diffuse hits start inside, where they have to know.
    pub(super) fn record_shadow_media(&mut self, plan: &Plan, params: &WaveParams, paths: &Buffer) {
        if plan.light_passes {
            let wave = &self.wave;
            let buffers = [paths, wave.lit_rays(), wave.lit_hits(), wave.shadow_paths()];
            let (pass, rec) = (&self.passes.light_passes, &mut self.recorder);
            pass.record_media(rec, &self.shadows, buffers, params);
        }
    }

    /// Shadow rays that have been started, so many to this light or to what blocks them, and through the volumes on their way.
    pub(super) fn send_to_light(
        &mut self,
        plan: &Plan,
        (ray_count, light): (u32, u32),
        traced: Traced,
        stats: &mut FrameStats,
        watch: &dyn Watch,
    ) -> Result<(), RenderError> {
        let passed = match traced {
            Traced::PastObject(object) => object,
            _ => NONE,
        };
        let (lamp_count, lamp_media) = plan.lamp_media_of(light);
        let counts = u32::from(passed == NONE);
        let params = ShadowParams { ray_count, passed, counts, lamp_count, lamp_media };
        let [mut alive, mut going] = [ray_count; 2];
        while going > 0 {
            self.trace_to_the_end(plan, [ray_count, alive], traced, stats, watch)?;
            if plan.light_passes {
                self.record_light_passes(&params, true);
            }
            self.isosurfaces(plan, ray_count, true, stats, watch)?;
            self.march(plan, ray_count, (true, None), stats, watch)?;
            if !plan.light_passes {
                return Ok(());
            }
            self.recorder.fill(&self.live, 0, 8, 0);
            self.live_marks.record_none(&mut self.recorder, ray_count);
            self.record_light_passes(&params, false);
            [alive, going] = self.submit_and_count(stats)?;
        }
        Ok(())
    }

    /// Records what rays have met, or the way on of those that it lets through.
    fn record_light_passes(&mut self, params: &ShadowParams, meets: bool) {
        let io = LightPassesIo {
            state: &self.shadows.current,
            surfaces: &self.surfaces,
            objects: &self.objects,
            film: &self.film,
            light_sums: self.wave.light_sums(),
            shadow_paths: self.wave.shadow_paths(),
            live: &self.live,
            marks: &self.live_marks.bits,
        };
        let (pass, rec) = (&self.passes.light_passes, &mut self.recorder);
        match meets {
            true => pass.record_meet(rec, io, params),
            false => pass.record_go_on(rec, io, params),
        }
    }
}
