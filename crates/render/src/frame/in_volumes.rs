//! What volumes do to the rays of a frame.

use super::{FrameStats, Renderer, Traced};
use crate::RenderError;
use crate::budget::Budget;
use crate::passes::{IsosurfaceIo, MarchIo, Marched, PointLightIo, Searching};
use kernels::layout::{self, MarchParams, PointLightParams, VOLUME_EMITS};
use plan::Plan;
use points::Watch;

impl Renderer {
    /// The way of a wave's rays, or of its shadow rays, through the volumes of the scene, if it has any. `depths` is the
    /// viewing axis, where it is asked for how far along it light is lost.
    pub(super) fn march(
        &mut self,
        plan: &Plan,
        ray_count: u32,
        (shadows, depths): (bool, Option<[f32; 3]>),
        stats: &mut FrameStats,
        watch: &dyn Watch,
    ) -> Result<(), RenderError> {
        let Some(volumes) = self.volumes.as_ref().filter(|_| plan.volumes.any_marched()) else {
            return Ok(());
        };
        let lights = plan.volumes.any_lit().then_some(&self.lights);
        let [shadow_paths, lit_rays] = self.wave.shadow_media(plan.light_passes);
        let io = MarchIo {
            state: if shadows { &self.shadows.current } else { &self.state.current },
            volumes,
            paths: if shadows { shadow_paths } else { self.wave.paths() },
            live: &self.live,
            marched: match shadows {
                false => Marched::Wave { hits: &self.hits, objects: &self.objects, lights },
                true => Marched::Shadows { lit_rays, light_sums: self.wave.light_sums() },
            },
        };
        let bytes = |size: usize| u64::from(ray_count) * size as u64;
        self.recorder.fill(&volumes.marches, 0, bytes(size_of::<layout::March>()), 0);
        if lights.is_some() {
            let bytes = bytes(size_of::<layout::MarchLight>());
            self.recorder.fill(&volumes.march_lights, 0, bytes, 0);
        }
        let mut left = [u32::MAX];
        while left != [0] {
            if watch.interrupted() {
                return Err(RenderError::Interrupted);
            }
            self.recorder.fill(&self.live, 0, 4, 0);
            let params = MarchParams {
                forward: depths.unwrap_or_default(),
                wants_depth: u32::from(depths.is_some()),
                ..march_params(plan, ray_count, self.budget)
            };
            self.passes.march.record(&mut self.recorder, io, &params);
            let passes = self.recorder.submit()?.passes;
            stats.add_kernels(&passes);
            self.live.read(0, &mut left)?;
            self.budget.passed(passes.iter().map(|pass| pass.1).sum(), left != [0]);
        }
        Ok(())
    }

    /// Where a wave's rays, or its shadow rays, first meet an isosurface, if the scene has any.
    pub(super) fn isosurfaces(
        &mut self,
        plan: &Plan,
        ray_count: u32,
        shadows: bool,
        stats: &mut FrameStats,
        watch: &dyn Watch,
    ) -> Result<(), RenderError> {
        let Some(volumes) = self.volumes.as_ref().filter(|_| plan.volumes.any_isosurface()) else {
            return Ok(());
        };
        let io = IsosurfaceIo {
            state: if shadows { &self.shadows.current } else { &self.state.current },
            volumes,
            paths: self.wave.paths(),
            live: &self.live,
            of: match shadows {
                false => Searching::Wave { hits: &self.hits },
                true => Searching::Shadows { light_sums: self.wave.light_sums() },
            },
        };
        let bytes = u64::from(ray_count) * size_of::<layout::IsoSearch>() as u64;
        self.recorder.fill(&volumes.searches, 0, bytes, 0);
        let mut left = [u32::MAX];
        while left != [0] {
            if watch.interrupted() {
                return Err(RenderError::Interrupted);
            }
            self.recorder.fill(&self.live, 0, 4, 0);
            let params = march_params(plan, ray_count, self.budget);
            self.passes.isosurface.record(&mut self.recorder, io, &params);
            let passes = self.recorder.submit()?.passes;
            stats.add_kernels(&passes);
            self.live.read(0, &mut left)?;
            self.budget.passed(passes.iter().map(|pass| pass.1).sum(), left != [0]);
        }
        Ok(())
    }

    /// How much of each light reaches the points of lit volumes, if the scene has any: past surfaces, but
    /// for that of the volume's own object, and through volumes.
    pub(super) fn light_points(
        &mut self,
        plan: &Plan,
        stats: &mut FrameStats,
        watch: &dyn Watch,
    ) -> Result<(), RenderError> {
        let rays = (self.wave.light_sums().bytes() / size_of::<layout::LightSum>() as u64) as usize;
        let all = (0u32..).zip(plan.volumes.point_ranges());
        for (volume, (_, range)) in all.filter(|(_, (info, _))| info.shading != VOLUME_EMITS) {
            for first in range.clone().step_by(rays) {
                let count = (range.end - first).min(rays) as u32;
                for light in 0..plan.lights.len() as u32 {
                    let params = PointLightParams { first: first as u32, count, light, volume };
                    self.light_batch(plan, &params, stats, watch)?;
                }
            }
        }
        Ok(())
    }

    /// The same for one light, and so many points as there are rays.
    fn light_batch(
        &mut self,
        plan: &Plan,
        params: &PointLightParams,
        stats: &mut FrameStats,
        watch: &dyn Watch,
    ) -> Result<(), RenderError> {
        self.record_point_light(plan, params, true);
        self.shadows.passed();
        let object = plan.volumes.infos[params.volume as usize].object;
        let traced = Traced::PastObject(plan.passed_of(object));
        self.send_to_light(plan, (params.count, params.light), traced, stats, watch)?;
        self.record_point_light(plan, params, false);
        stats.add_kernels(&self.recorder.submit()?.passes);
        Ok(())
    }

    /// The rays from points to a light, or, once they have ended, what came of them.
    fn record_point_light(&mut self, plan: &Plan, params: &PointLightParams, starts: bool) {
        let Some(volumes) = &self.volumes else { return };
        let [paths, lit_rays] = self.wave.shadow_media(plan.light_passes);
        let io = PointLightIo {
            shadows: &self.shadows,
            volumes,
            grid_levels: &self.surfaces.grid_levels,
            lights: &self.lights,
            paths,
            lit_rays,
            light_sums: self.wave.light_sums(),
        };
        let (pass, rec) = (&self.passes.point_light, &mut self.recorder);
        match starts {
            true => pass.record_rays(rec, io, params),
            false => pass.record_lights(rec, io, params),
        }
    }
}

fn march_params(plan: &Plan, ray_count: u32, budget: Budget) -> MarchParams {
    MarchParams {
        ray_count,
        volume_count: plan.volumes.infos.len() as u32,
        step: plan.volumes.step,
        work: budget.work() / 2, // two loops a sample
        light_count: plan.lights.len() as u32,
        forward: [0.0; 3],
        wants_depth: 0,
        pad: [0; 3],
    }
}
