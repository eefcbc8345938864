//! One frame: tile after tile, pass after pass.

use crate::RenderError;
use crate::discs::{DiscLists, Discs};
use crate::passes::{
    AlbedoIo, CameraRays, DiscTrace, DiscTraceIo, GridTrace, GridTraceIo, Records, Refine,
    RefineIo, Shade, ShadeIo, SurfaceHit, SurfaceHitIo,
};
use crate::state::RayState;
use gpu::{Buffer, Device, Recorder, Timings};
use kernels::layout::{FilmPixel, Hit, TraceParams};
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
    /// Dispatches of `grid_trace` and `disc_trace`.
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
    images: Buffer,
    texels: Buffer,
    lights: Buffer,
    film: Buffer,
    hits: Buffer,
    live: Buffer,
    state: RayState,
    camera_rays: CameraRays,
    grid_trace: GridTrace,
    surface_hit: SurfaceHit,
    refine: Refine,
    discs: Discs,
    disc_trace: DiscTrace,
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
        let surfaces = Surfaces::build(
            device,
            &plan.cloud,
            &plan.fits,
            plan.grid_resolution,
            plan.refines(),
            watch,
        )?;
        let tiles = plan.tiles();
        let largest = |axis: usize| tiles.iter().map(|tile| tile.size[axis]).max().unwrap_or(1);
        let tile_size = [largest(0), largest(1)];
        let tile_pixels = u64::from(tile_size[0]) * u64::from(tile_size[1]);
        let film_bytes = tile_pixels * size_of::<FilmPixel>() as u64;
        Ok(Self {
            surfaces,
            objects: Buffer::from_slice(device, "objects", &plan.objects)?,
            colors: Buffer::from_slice(device, "point colors", &plan.colors)?,
            images: Buffer::from_slice(device, "images", &plan.images)?,
            texels: texel_buffer(device, plan)?,
            lights: Buffer::from_slice(device, "lights", &plan.lights)?,
            film: Buffer::new(device, "film", film_bytes)?,
            hits: Buffer::new(device, "hits", tile_pixels * size_of::<Hit>() as u64)?,
            live: Buffer::new(device, "live rays", 8)?,
            state: RayState::new(device, tile_size)?,
            camera_rays: CameraRays::new(device)?,
            grid_trace: GridTrace::new(device, records)?,
            surface_hit: SurfaceHit::new(device)?,
            refine: Refine::new(device, records)?,
            discs: Discs::new(device, plan.cloud.points.len() as u32)?,
            disc_trace: DiscTrace::new(device, records)?,
            shade: Shade::new(device)?,
            recorder: Recorder::new(device)?,
        })
    }

    /// The surfaces that are traced.
    #[must_use]
    pub fn surfaces(&self) -> &Surfaces {
        &self.surfaces
    }

    /// The points of the last tile's screen tiles, where a tile was traced by discs.
    #[must_use]
    pub fn disc_lists(&self) -> Option<&DiscLists> {
        self.discs.lists()
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
            let by_discs = self.bin_discs(plan, &tile, &mut stats)?;
            self.trace_to_the_end(plan, &tile, by_discs, &mut stats, watch)?;
            self.settle_hits(plan, &tile, &mut stats, watch)?;
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

    /// Lists the points of each screen tile, if this tile is to be traced by discs; whether it is.
    fn bin_discs(
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

    /// Passes until no ray lives: the paper's loop on the CPU. Through the grid, unless the rays are
    /// fresh from the camera and `by_discs`.
    fn trace_to_the_end(
        &mut self,
        plan: &Plan,
        tile: &Window,
        by_discs: bool,
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
            match self.discs.lists().filter(|_| by_discs) {
                Some(lists) => {
                    let (surfaces, state, live) = (&self.surfaces, &self.state, &self.live);
                    let io = DiscTraceIo { lists, surfaces, state, live };
                    self.disc_trace.record(&mut self.recorder, io, &params);
                }
                None => {
                    let (surfaces, state, live) = (&self.surfaces, &self.state, &self.live);
                    let io = GridTraceIo { surfaces, state, live };
                    self.grid_trace.record(&mut self.recorder, io, &params);
                }
            }
            stats.add_kernels(&self.recorder.submit()?.passes);
            self.state.swap();
            stats.passes += 1;
            self.live.read(0, &mut live)?;
            watch.done(stats.camera_rays + tile.pixels() as u64 - u64::from(live[0]));
        }
        Ok(())
    }

    /// Hits of all rays that have ended; refined, where an object asks for it, and rays whose hit was
    /// refined away traced on.
    fn settle_hits(
        &mut self,
        plan: &Plan,
        tile: &Window,
        stats: &mut FrameStats,
        watch: &dyn Watch,
    ) -> Result<(), RenderError> {
        let params = TraceParams { tile_size: tile.size, cells: 0, work: 0 };
        let bytes = (tile.pixels() * size_of::<Hit>()) as u64;
        self.recorder.fill(&self.hits, 0, bytes, 0);
        loop {
            self.recorder.fill(&self.live, 0, 8, 0);
            let io = SurfaceHitIo {
                state: &self.state.current,
                surfaces: &self.surfaces,
                objects: &self.objects,
                hits: &self.hits,
                live: &self.live,
            };
            self.surface_hit.record(&mut self.recorder, io, &params);
            if !plan.refines() {
                return Ok(()); // recorded; shading submits it
            }
            let [pending, _] = self.submit_and_count(stats)?;
            if self.refine_hits(pending, &params, stats, watch)? == 0 {
                return Ok(());
            }
            let (surfaces, state) = (&self.surfaces, &self.state.current);
            self.refine.record_resume(&mut self.recorder, surfaces, state, &self.hits, &params);
            self.trace_to_the_end(plan, tile, false, stats, watch)?;
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
            self.refine.record(&mut self.recorder, io, params);
            let [still_pending, rejected] = self.submit_and_count(stats)?;
            pending = still_pending;
            all_rejected += rejected;
        }
        Ok(all_rejected)
    }

    /// Runs what is recorded, and reads the two counters.
    fn submit_and_count(&mut self, stats: &mut FrameStats) -> Result<[u32; 2], RenderError> {
        stats.add_kernels(&self.recorder.submit()?.passes);
        let mut counts = [0; 2];
        self.live.read(0, &mut counts)?;
        Ok(counts)
    }

    fn shade_tile(
        &mut self,
        plan: &Plan,
        tile: &Window,
        stats: &mut FrameStats,
    ) -> Result<(), RenderError> {
        let io = ShadeIo {
            state: &self.state.current,
            albedos: AlbedoIo {
                surfaces: &self.surfaces,
                objects: &self.objects,
                colors: &self.colors,
                images: &self.images,
                texels: &self.texels,
            },
            hits: &self.hits,
            lights: &self.lights,
            film: &self.film,
        };
        self.shade.record(&mut self.recorder, io, &plan.shade_of(tile));
        stats.add_kernels(&self.recorder.submit()?.passes);
        Ok(())
    }
}

/// The texels of all images, if the device takes so many.
fn texel_buffer(device: &Arc<Device>, plan: &Plan) -> Result<Buffer, RenderError> {
    let needed = size_of_val(plan.texels.as_slice()) as u64;
    let limit = device.limits().max_storage_buffer_range;
    if needed > limit {
        let images = plan.image_files.join(", ");
        return Err(RenderError::Images { images, needed, limit });
    }
    Ok(Buffer::from_slice(device, "texels", &plan.texels)?)
}
