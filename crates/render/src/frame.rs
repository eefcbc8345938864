//! One frame: tile after tile, sample after sample, wave after wave, stage after stage.
//!
//! A wave is the rays of one generation: those from the camera, then those that the surfaces they met
//! reflect and refract, until none is left. Each is traced to its end by passes over the ray state, and so
//! are the rays from its lit hits towards each light. Between waves the rays that go on are moved
//! together, so that those that ended cost nothing.

use crate::RenderError;
use crate::renderer::Renderer;
use crate::stages::Fates;
use crate::stats::{FrameStats, Traced};
use bytemuck::NoUninit;
use gpu::{Bindings, Recorder};
use kernels::layout::{FilmPixel, TILE_GROUP, WaveParams};
use kernels::spirv::{Module, Rays};
use plan::{CENTER, Picture, Plan, StructureKind, Window};
use points::Watch;
use std::sync::Arc;
use std::time::Instant;

/// A picture under way: what every stage of it takes.
pub(crate) struct Frame<'a> {
    pub renderer: &'a mut Renderer,
    pub plan: Arc<Plan>,
    pub watch: &'a dyn Watch,
    pub stats: FrameStats,
    /// Rays of this sample: hits times lights, and rays of waves from surfaces.
    pub asked: Asked,
}

/// How many rays of a sample there would be, had none a reason not to be sent.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Asked {
    /// Lit hits, for each light.
    pub lights: u64,
    /// Rays from surfaces that send some on.
    pub scattered: u64,
}

/// The rays of a generation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wave {
    pub params: WaveParams,
    pub traced: Traced,
    /// What they go through.
    pub through: StructureKind,
    /// Of which sample of the pixels.
    pub sample: u32,
}

impl<'a> Frame<'a> {
    pub fn new(renderer: &'a mut Renderer, watch: &'a dyn Watch) -> Self {
        let plan = Arc::clone(&renderer.plan);
        Self { renderer, plan, watch, stats: FrameStats::default(), asked: Asked::default() }
    }

    /// All tiles of the picture.
    pub fn run(mut self) -> Result<(Picture, FrameStats), RenderError> {
        let plan = Arc::clone(&self.plan);
        let mut picture = plan.picture();
        let samples = u64::from(plan.samples) + u64::from(plan.takes_centers());
        self.watch.stage("tracing", plan.window.pixels() as u64 * samples);
        let most = self.renderer.buffers.film.pixels();
        let mut pixels = vec![FilmPixel::default(); most];
        let mut centers = vec![FilmPixel::default(); if plan.takes_centers() { most } else { 0 }];
        let made_before = self.renderer.run.device.pipeline_time();
        let started = Instant::now();
        self.light_points()?;
        self.stats.trace += started.elapsed();
        for tile in plan.tiles() {
            let started = Instant::now();
            let mut centers = centers.get_mut(..tile.pixels());
            if let Some(centers) = &mut centers {
                self.sample(&tile, CENTER)?;
                self.renderer.buffers.film.film.read(0, centers)?;
            }
            for sample in 0..plan.samples {
                self.sample(&tile, sample)?;
                picture.rays += self.counted(&tile)?;
            }
            self.stats.trace += started.elapsed();
            let pixels = &mut pixels[..tile.pixels()];
            self.renderer.buffers.film.film.read(0, pixels)?;
            let outcomes = &self.renderer.surfaces.outcomes;
            picture.put(&plan, outcomes, &tile, (pixels, centers.as_deref()));
        }
        let device = &self.renderer.run.device;
        self.stats.pipelines = device.pipeline_time().saturating_sub(made_before);
        self.stats.trace = self.stats.trace.saturating_sub(self.stats.pipelines);
        Ok((picture, self.stats))
    }

    /// One sample of a tile's pixels: the wave from the camera, and all that come of it. After the last
    /// sample the film holds the mean of all; after [`CENTER`], which is not followed beyond the first surface unless the
    /// plan asks, what that ray saw.
    fn sample(&mut self, tile: &Window, sample: u32) -> Result<(), RenderError> {
        let ends_at_first = sample == CENTER && !self.plan.follows_centers();
        let mut next = self.start_wave(tile, sample, ends_at_first)?;
        while let Some(wave) = next {
            self.trace(&wave)?;
            self.settle_hits(&wave)?;
            self.meet_isosurfaces(&wave)?;
            self.march_through_volumes(&wave, ends_at_first)?;
            let fates = self.classify(&wave)?;
            next = if ends_at_first { None } else { self.light_and_scatter(&wave, fates)? };
        }
        if sample != CENTER {
            self.accumulate(tile, sample);
        }
        self.submit(None)?;
        self.stats.rays += tile.pixels() as u64;
        self.watch.done(self.stats.rays);
        Ok(())
    }

    /// From what has become of a wave's rays to light and the next wave, if any ray goes on.
    pub fn light_and_scatter(
        &mut self,
        wave: &Wave,
        fates: Fates,
    ) -> Result<Option<Wave>, RenderError> {
        self.shade(&WaveParams { ray_count: fates.lit, ..wave.params })?;
        self.scatter(&WaveParams { ray_count: fates.scattering, ..wave.params })?;
        self.asked.lights += u64::from(fates.lit) * u64::from(wave.params.light_count);
        self.asked.scattered += u64::from(fates.next);
        let flags = self.plan.shows_of_volumes();
        let params = WaveParams { ray_count: fates.next, flags, ..wave.params };
        let through = self.structure_of(Traced::Scattered);
        let next = Wave { params, traced: Traced::Scattered, through, ..*wave };
        Ok((fates.next > 0).then_some(next))
    }

    /// Passes until no ray lives: `record` records one, told of how many rays, and whether none was before. Returns
    /// the sum of the second counts of live rays that they leave.
    pub fn until_none_lives(
        &mut self,
        mut alive: u32,
        traced: Option<Traced>,
        mut record: impl FnMut(&mut Self, u32),
    ) -> Result<u32, RenderError> {
        let mut counted = 0;
        while alive > 0 {
            if self.watch.interrupted() {
                return Err(RenderError::Interrupted);
            }
            self.clear_live();
            record(self, alive);
            let milliseconds = self.submit(traced)?;
            let [live, other] = self.renderer.buffers.wave.read_live()?;
            alive = live;
            counted += other;
            self.renderer.run.budget.passed(milliseconds, alive > 0);
            self.watch.done(self.stats.rays);
        }
        Ok(counted)
    }

    /// Runs what is recorded, and returns how many milliseconds the passes took.
    pub fn submit(&mut self, traced: Option<Traced>) -> Result<f64, RenderError> {
        let passes = self.recorder().submit()?.passes;
        self.stats.add(&passes, traced);
        Ok(passes.iter().map(|pass| pass.1).sum())
    }

    /// Records that no ray is counted yet.
    pub fn clear_live(&mut self) {
        self.renderer.run.recorder.fill(&self.renderer.buffers.wave.live, 0, 8, 0);
    }

    pub fn recorder(&mut self) -> &mut Recorder {
        &mut self.renderer.run.recorder
    }

    /// The variant of kernels for where the ray state lives.
    pub fn rays(&self) -> Rays {
        self.renderer.variant()
    }

    /// Records a pass: its kernel takes what it uses from `own`, and the rest from what is bound for all.
    pub fn dispatch<P: NoUninit>(
        &mut self,
        module: &'static Module,
        own: &Bindings,
        params: &P,
        invocations: [u32; 3],
    ) {
        let Renderer { run, bound, .. } = &mut *self.renderer;
        run.recorder.pass(module).bind(own).bind(bound).push(params).dispatch(invocations);
    }
}

/// Pixels that a workgroup covers along each side (`tile_pixel` in `glsl/shared/index.glsl`).
const TILE_EDGE: u32 = 8;

/// Invocations for a tile of pixels: a row of [`TILE_GROUP`] for each 8 × 8 of them.
pub(crate) fn over_pixels(size: [u32; 2]) -> [u32; 3] {
    [size[0].div_ceil(TILE_EDGE) * TILE_GROUP, size[1].div_ceil(TILE_EDGE), 1]
}
