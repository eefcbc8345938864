//! Light at the hits of a wave: shadow rays, past surfaces that let light through where there are some, and what surfaces
//! make of what arrives.

use crate::RenderError;
use crate::frame::Frame;
use crate::stats::Traced;
use kernels::layout::{
    LIGHT_ENVIRONMENT, LIGHT_SKY, MARKS, NONE, PATHS, ShadowParams, WAVE_SHARES_PATH, WaveParams,
};
use kernels::spirv::{self, Drawing, Searching};
use points::device::line;

/// How directions towards the background are drawn, which is a light of this kind.
pub(crate) fn drawing_of(kind: u32) -> Drawing {
    if kind == LIGHT_ENVIRONMENT { Drawing::Table } else { Drawing::Lobe }
}

impl Frame<'_> {
    /// Light after light, shadow rays from a wave's lit hits, and then what their surfaces make of it. The wave's rays
    /// are those hits.
    pub fn shade(&mut self, params: &WaveParams) -> Result<(), RenderError> {
        if params.ray_count == 0 || params.light_count == 0 {
            return Ok(());
        }
        let (rays, invocations) = (self.rays(), line(params.ray_count));
        let shares = params.flags & WAVE_SHARES_PATH != 0;
        let paths = self.renderer.buffers.wave.paths_or_shared(shares).clone();
        for light in 0..params.light_count {
            let params = WaveParams { light, ..*params };
            let own = self.renderer.rays.shadows.updated().buffer(PATHS, &paths);
            let module = match self.plan.lights[light as usize].kind {
                kind @ (LIGHT_SKY | LIGHT_ENVIRONMENT) => spirv::sky_rays(drawing_of(kind), rays),
                _ => spirv::shadow_rays(rays),
            };
            self.dispatch(module, &own, &params, invocations);
            self.renderer.rays.shadows.passed();
            if self.plan.light_passes {
                let own = self.renderer.rays.shadows.in_place().buffer(PATHS, &paths);
                self.dispatch(spirv::shadow_media(rays), &own, &params, invocations);
            }
            self.send_to_light(params.ray_count, light, Traced::Shadows)?;
        }
        let own = self.renderer.rays.shadows.in_place().buffer(PATHS, &paths);
        self.dispatch(spirv::shade(rays), &own, params, invocations);
        self.submit(None)?;
        Ok(())
    }

    /// Shadow rays that have been started, so many to this light or to what blocks them, and through the volumes on their way.
    pub fn send_to_light(
        &mut self,
        ray_count: u32,
        light: u32,
        traced: Traced,
    ) -> Result<(), RenderError> {
        let passed = traced.passed();
        let light_passes = self.plan.light_passes;
        let passes_isosurfaces = self.plan.passes_isosurfaces(light);
        let (lamp_count, lamp_media) = self.plan.lamp_media_of(light);
        let counts = u32::from(passed == NONE);
        let tints = u32::from(self.plan.tints(light));
        let params = ShadowParams { ray_count, passed, counts, lamp_count, tints, lamp_media };
        let (rays, invocations) = (self.rays(), line(ray_count));
        let through = self.structure_of(traced);
        let mut alive = ray_count;
        // Leg by leg, each traced to its end: what is left of the way after a surface that lets light pass.
        while alive > 0 {
            self.trace_to_the_end([ray_count, alive], traced, through)?;
            if passes_isosurfaces {
                self.shadow_isosurfaces(ray_count, Searching::Passing)?;
            }
            if light_passes {
                let own = self.renderer.rays.shadows.in_place();
                self.dispatch(spirv::shadow_meet(rays), &own, &params, invocations);
            }
            if !passes_isosurfaces {
                self.shadow_isosurfaces(ray_count, Searching::Shadows)?;
            }
            self.shadow_march(ray_count)?;
            if !light_passes {
                return Ok(());
            }
            self.clear_live();
            let marks = &self.renderer.buffers.wave.live_marks;
            marks.record_none(&mut self.renderer.run.recorder, ray_count);
            let own = self.renderer.rays.shadows.in_place().buffer(MARKS, &marks.bits);
            self.dispatch(spirv::shadow_go_on(rays), &own, &params, invocations);
            self.submit(None)?;
            [alive, _] = self.renderer.buffers.wave.read_live()?;
        }
        Ok(())
    }
}
