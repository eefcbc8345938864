//! What volumes do to the rays of a frame.

use crate::RenderError;
use crate::frame::{Frame, Wave};
use crate::renderer::Renderer;
use crate::stats::Traced;
use gpu::Bindings;
use kernels::layout::{
    self, LIT_RAYS, MarchParams, PATHS, PointLightParams, VOLUME_EMITS, WaveParams,
};
use kernels::spirv::{self, Marching, Searching};
use plan::{CENTER, Plan};
use points::device::line;

/// What volumes do to the rays of a plan's waves.
pub(crate) fn marching_of(plan: &Plan) -> Marching {
    match (plan.follows_paths(), plan.volumes.any_lit()) {
        (true, _) => Marching::Scattered,
        (false, true) => Marching::Lit,
        (false, false) => Marching::Wave,
    }
}

impl Frame<'_> {
    /// The way of a wave's rays through the volumes of the scene, if it has any. Where only the first surface is asked for,
    /// they are marched through where a channel shows something of them.
    pub fn march_through_volumes(
        &mut self,
        wave: &Wave,
        ends_at_first: bool,
    ) -> Result<(), RenderError> {
        if ends_at_first && !self.plan.wants_along() {
            return Ok(());
        }
        let is_center = wave.sample == CENTER || !self.plan.takes_centers();
        // It is asked for how far along the viewing axis light is lost.
        let wants_depth = is_center && self.plan.wants_volume_depth();
        let forward = if wants_depth { wave.params.forward } else { [0.0; 3] };
        let of = match ends_at_first {
            true if self.plan.follows_paths() => Marching::Wave,
            _ => marching_of(&self.plan),
        };
        let own = self.renderer.rays.state.in_place();
        let own = own.buffer(PATHS, self.renderer.buffers.wave.paths());
        self.march(&wave.params, of, &own, (forward, wants_depth))
    }

    /// The way of shadow rays.
    pub fn shadow_march(&mut self, ray_count: u32) -> Result<(), RenderError> {
        let own = self.with_shadow_media(self.renderer.rays.shadows.in_place());
        let params = WaveParams { ray_count, ..WaveParams::default() };
        self.march(&params, Marching::Shadows, &own, ([0.0; 3], false))
    }

    fn march(
        &mut self,
        wave: &WaveParams,
        of: Marching,
        own: &Bindings,
        (forward, wants_depth): ([f32; 3], bool),
    ) -> Result<(), RenderError> {
        let ray_count = wave.ray_count;
        let Renderer { buffers, run, .. } = &mut *self.renderer;
        let any = self.plan.volumes.any_marched();
        let Some(volumes) = buffers.volumes.as_ref().filter(|_| any) else { return Ok(()) };
        let bytes = |size: usize| u64::from(ray_count) * size as u64;
        run.recorder.fill(&volumes.marches, 0, bytes(size_of::<layout::March>()), 0);
        if self.plan.volumes.any_lit() {
            let bytes = bytes(size_of::<layout::MarchLight>());
            run.recorder.fill(&volumes.march_lights, 0, bytes, 0);
        }
        if of == Marching::Scattered {
            let bytes = bytes(size_of::<layout::MarchScatter>());
            run.recorder.fill(&volumes.march_scatters, 0, bytes, 0);
        }
        let volume_count = self.plan.volumes.infos.len();
        run.recorder.fill(
            &volumes.blocks,
            0,
            bytes(size_of::<layout::VolumeBlock>() * volume_count),
            0,
        );
        let module = spirv::march(of, self.rays());
        self.until_none_lives(u32::MAX, None, |frame, _| {
            let wants_depth = u32::from(wants_depth);
            let params = MarchParams {
                forward,
                wants_depth,
                sample_index: wave.sample_index,
                seed: wave.seed,
                tile_width: wave.tile_size[0],
                tile_origin: wave.tile_origin,
                ..frame.march_params(ray_count)
            };
            frame.dispatch(module, own, &params, line(ray_count));
        })
        .map(|_| ())
    }

    /// Where a wave's rays first meet an isosurface, if the scene has any.
    pub fn meet_isosurfaces(&mut self, wave: &Wave) -> Result<(), RenderError> {
        let own = self.renderer.rays.state.in_place();
        let own = own.buffer(PATHS, self.renderer.buffers.wave.paths());
        self.isosurfaces(wave.params.ray_count, Searching::Wave, own)
    }

    /// Whether shadow rays meet one, or where those first do that go on through glass.
    pub fn shadow_isosurfaces(&mut self, ray_count: u32, of: Searching) -> Result<(), RenderError> {
        let own = self.with_shadow_media(self.renderer.rays.shadows.in_place());
        self.isosurfaces(ray_count, of, own)
    }

    fn isosurfaces(
        &mut self,
        ray_count: u32,
        of: Searching,
        own: Bindings,
    ) -> Result<(), RenderError> {
        let Renderer { buffers, run, .. } = &mut *self.renderer;
        let any = self.plan.volumes.any_isosurface();
        let Some(volumes) = buffers.volumes.as_ref().filter(|_| any) else { return Ok(()) };
        let bytes = u64::from(ray_count) * size_of::<layout::IsoSearch>() as u64;
        run.recorder.fill(&volumes.searches, 0, bytes, 0);
        let module = spirv::isosurface(of, self.rays());
        self.until_none_lives(u32::MAX, None, |frame, _| {
            let params = frame.march_params(ray_count);
            let params = MarchParams { work: params.work / 2, ..params }; // two loops a sample
            frame.dispatch(module, &own, &params, line(ray_count));
        })
        .map(|_| ())
    }

    /// How much of each light reaches the points of lit volumes, if the scene has any: past surfaces, but
    /// for that of the volume's own object, and through volumes.
    pub fn light_points(&mut self) -> Result<(), RenderError> {
        let plan = std::sync::Arc::clone(&self.plan);
        if !plan.volumes.any_lit() {
            return Ok(());
        }
        let rays = self.renderer.buffers.wave.shadow_rays();
        let all = (0u32..).zip(plan.volumes.point_ranges());
        for (volume, (_, range)) in all.filter(|(_, (info, _))| info.shading != VOLUME_EMITS) {
            for first in range.clone().step_by(rays) {
                let count = (range.end - first).min(rays) as u32;
                for light in 0..plan.lamps().len() as u32 {
                    let params = PointLightParams { first: first as u32, count, light, volume };
                    self.light_batch(&params)?;
                }
            }
        }
        Ok(())
    }

    /// The same for one light, and so many points as there are rays.
    fn light_batch(&mut self, params: &PointLightParams) -> Result<(), RenderError> {
        let (rays, invocations) = (self.rays(), line(params.count));
        let own = self.with_shadow_media(self.renderer.rays.shadows.updated());
        self.dispatch(spirv::point_rays(rays), &own, params, invocations);
        self.renderer.rays.shadows.passed();
        let object = self.plan.volumes.infos[params.volume as usize].object;
        let traced = Traced::PastObject(self.plan.passed_of(object, params.light));
        self.send_to_light(params.count, params.light, traced)?;
        let own = self.renderer.rays.shadows.in_place();
        self.dispatch(spirv::point_lights(rays), &own, params, invocations);
        self.submit(None)?;
        Ok(())
    }

    /// With where the media of shadow rays are.
    fn with_shadow_media(&self, own: Bindings) -> Bindings {
        let [paths, lit_rays] = self.renderer.buffers.wave.shadow_media(self.plan.light_passes);
        own.buffer(PATHS, paths).buffer(LIT_RAYS, lit_rays)
    }

    fn march_params(&self, ray_count: u32) -> MarchParams {
        MarchParams {
            ray_count,
            volume_count: self.plan.volumes.infos.len() as u32,
            step: self.plan.volumes.step,
            work: self.renderer.run.budget.work(),
            light_count: self.plan.lamps().len() as u32,
            ..MarchParams::default()
        }
    }
}
