//! One frame: tile after tile, pass after pass.

use crate::RenderError;
use crate::passes::{CameraRays, GridTrace, GridTraceIo, Records, Shade, ShadeIo};
use crate::state::RayState;
use gpu::{Buffer, Device, Recorder};
use kernels::layout::{FilmPixel, TraceParams};
use plan::{Picture, Plan, Window};
use points::Watch;
use points::device::Surfaces;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Loop iterations that a ray may spend in one pass. lavapipe silently stops all loops of a shader
/// group at 65 535 iterations; eight rays share that count there, and each may go 64 over its share.
const WORK_PER_PASS: u32 = 7_000;

const EMPTY_PIXEL: FilmPixel = FilmPixel {
    color: [0.0; 4],
    position_depth: [0.0; 4],
    normal_object: [0.0; 4],
    counts: [0; 4],
};

/// What a frame cost.
#[derive(Debug, Clone, Default)]
pub struct FrameStats {
    /// From submission to completion of all passes, shading included.
    pub trace: Duration,
    /// Dispatches of `grid_trace`.
    pub passes: u32,
    /// Rays from the camera.
    pub camera_rays: u64,
    /// GPU time of each kernel, in milliseconds, by name, in the order of first use.
    pub kernels: Vec<(&'static str, f64)>,
}

impl FrameStats {
    fn add_kernels(&mut self, passes: &[(&'static str, f64)]) {
        for &(name, milliseconds) in passes {
            match self.kernels.iter_mut().find(|kernel| kernel.0 == name) {
                Some(kernel) => kernel.1 += milliseconds,
                None => self.kernels.push((name, milliseconds)),
            }
        }
    }
}

/// A scene on a device, ready to be traced.
pub struct Renderer {
    surfaces: Surfaces,
    objects: Buffer,
    colors: Buffer,
    lights: Buffer,
    film: Buffer,
    live: Buffer,
    state: RayState,
    camera_rays: CameraRays,
    grid_trace: GridTrace,
    shade: Shade,
    recorder: Recorder,
}

impl Renderer {
    /// Fits the surfaces of a plan on a device and builds the grid.
    ///
    /// # Errors
    /// A device without the memory, a buffer over its limits, a lost device, an interruption.
    pub fn new(device: &Arc<Device>, plan: &Plan, watch: &dyn Watch) -> Result<Self, RenderError> {
        Self::with_records(device, plan, Records::best_for(device, plan.cloud.points.len()), watch)
    }

    /// As [`Renderer::new`], with a given way to read polynomials.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn with_records(
        device: &Arc<Device>,
        plan: &Plan,
        records: Records,
        watch: &dyn Watch,
    ) -> Result<Self, RenderError> {
        let surfaces =
            Surfaces::build(device, &plan.cloud, &plan.fits, plan.grid_resolution, watch)?;
        let tiles = plan.tiles();
        let largest = |axis: usize| tiles.iter().map(|tile| tile.size[axis]).max().unwrap_or(1);
        let tile_size = [largest(0), largest(1)];
        let film_bytes =
            u64::from(tile_size[0]) * u64::from(tile_size[1]) * size_of::<FilmPixel>() as u64;
        Ok(Self {
            surfaces,
            objects: Buffer::from_slice(device, "objects", &plan.objects)?,
            colors: Buffer::from_slice(device, "point colors", &plan.colors)?,
            lights: Buffer::from_slice(device, "lights", &plan.lights)?,
            film: Buffer::new(device, "film", film_bytes)?,
            live: Buffer::new(device, "live rays", 4)?,
            state: RayState::new(device, tile_size)?,
            camera_rays: CameraRays::new(device)?,
            grid_trace: GridTrace::new(device, records)?,
            shade: Shade::new(device)?,
            recorder: Recorder::new(device)?,
        })
    }

    /// The surfaces that are traced.
    #[must_use]
    pub fn surfaces(&self) -> &Surfaces {
        &self.surfaces
    }

    /// Traces one picture of the plan that this renderer was made for.
    ///
    /// # Errors
    /// A lost device, an interruption.
    pub fn frame(
        &mut self,
        plan: &Plan,
        watch: &dyn Watch,
    ) -> Result<(Picture, FrameStats), RenderError> {
        let mut picture = plan.picture();
        let mut stats = FrameStats::default();
        watch.stage("tracing", plan.window.pixels() as u64);
        let mut pixels =
            vec![EMPTY_PIXEL; (self.film.bytes() / size_of::<FilmPixel>() as u64) as usize];
        for tile in plan.tiles() {
            let started = Instant::now();
            self.start_rays(plan, &tile);
            self.trace_to_the_end(plan, &tile, &mut stats, watch)?;
            self.shade_tile(plan, &tile, &mut stats)?;
            stats.trace += started.elapsed();
            stats.camera_rays += tile.pixels() as u64;
            let pixels = &mut pixels[..tile.pixels()];
            self.film.read(0, pixels)?;
            picture.put(plan, &self.surfaces.outcomes, &tile, pixels);
            watch.done(stats.camera_rays);
        }
        Ok((picture, stats))
    }

    fn start_rays(&mut self, plan: &Plan, tile: &Window) {
        self.camera_rays.record(
            &mut self.recorder,
            &self.surfaces.grid_info,
            &self.state.current,
            &plan.camera_of(tile),
        );
    }

    /// Passes until no ray lives: the paper's loop on the CPU.
    fn trace_to_the_end(
        &mut self,
        plan: &Plan,
        tile: &Window,
        stats: &mut FrameStats,
        watch: &dyn Watch,
    ) -> Result<(), RenderError> {
        let cells = if plan.cells_per_pass == 0 { u32::MAX } else { plan.cells_per_pass };
        let params = TraceParams { tile_size: tile.size, cells, work: WORK_PER_PASS };
        let mut live = [u32::MAX];
        while live != [0] {
            if watch.interrupted() {
                return Err(RenderError::Interrupted);
            }
            self.recorder.fill(&self.live, 0, 4, 0);
            let io = GridTraceIo { surfaces: &self.surfaces, state: &self.state, live: &self.live };
            self.grid_trace.record(&mut self.recorder, io, &params);
            stats.add_kernels(&self.recorder.submit()?.passes);
            self.state.swap();
            stats.passes += 1;
            self.live.read(0, &mut live)?;
            watch.done(stats.camera_rays + tile.pixels() as u64 - u64::from(live[0]));
        }
        Ok(())
    }

    fn shade_tile(
        &mut self,
        plan: &Plan,
        tile: &Window,
        stats: &mut FrameStats,
    ) -> Result<(), RenderError> {
        let io = ShadeIo {
            state: &self.state.current,
            polynomials: &self.surfaces.polynomials,
            objects: &self.objects,
            colors: &self.colors,
            lights: &self.lights,
            film: &self.film,
        };
        self.shade.record(&mut self.recorder, io, &plan.shade_of(tile));
        stats.add_kernels(&self.recorder.submit()?.passes);
        Ok(())
    }
}
