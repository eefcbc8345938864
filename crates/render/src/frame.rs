//! One frame: tile after tile, wave after wave, pass after pass.
//!
//! A wave is the rays of one generation: those from the camera, then those that the surfaces they met
//! reflect and refract, until none is left. Each is traced to its end by passes over the ray state, and so
//! are the rays from its diffuse hits towards each light. Between waves the rays that go on are moved
//! together, so that those that ended cost nothing.

mod ahead;
mod first_wave;
mod in_volumes;
mod to_light;
mod to_the_end;

use crate::RenderError;
use crate::budget::Budget;
use crate::discs::{DiscLists, Discs};
use crate::passes::{
    AlbedoIo, CameraRays, CameraTrace, Classify, ClassifyIo, DiscTrace, GridTrace, Isosurface,
    LightPasses, ListMarked, March, Marks, PointLight, Refine, Scatter, ScatterIo, Shade, ShadeIo,
    ShadowRays, ShadowRaysIo, SurfaceHit, TreeTrace,
};
use crate::samples::Samples;
use crate::state::{RayLoop, RayState};
use crate::volumes::VolumeBuffers;
use crate::wave::WaveBuffers;
use gpu::{Buffer, Device, Recorder};
use kernels::layout::{
    FilmPixel, Hit, NONE, ObjectInfo, Path, Polynomial, SCENE_BLENDS, SCENE_LEVELS, SCENE_SKIPS,
    VolumeStop, WAVE_SHARES_PATH, WaveParams,
};
use plan::{CENTER, MAX_DISC_PAIRS, Picture, Plan, Rays, Window, camera_wave};
use points::Watch;
use points::device::{Needed, Surfaces};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Of 16 bytes.
const TEXELS_A_STOP: usize = size_of::<VolumeStop>() / 16;
const TEXELS_A_POLYNOMIAL: u64 = (size_of::<Polynomial>() / 16) as u64;
/// Of a path, the longest of a wave's records.
const TEXELS_A_RAY: u64 = (size_of::<Path>() / 16) as u64;

const EMPTY_PIXEL: FilmPixel = FilmPixel {
    color: [0.0; 4],
    position_depth: [0.0; 4],
    normal_object: [0.0; 4],
    counts: [0; 4],
    alpha: [0.0; 3],
    along: 0.0,
};

/// What a frame cost.
#[derive(Debug, Clone, Default)]
pub struct FrameStats {
    /// From submission to completion of all passes, shading included; without what `pipelines` took.
    pub trace: Duration,
    /// What passes waited for pipelines that were not made yet.
    pub pipelines: Duration,
    /// Dispatches of the traversal.
    pub passes: u32,
    /// Camera rays whose paths have ended.
    rays: u64,
    /// GPU time of each kernel, in milliseconds, by name, in the order of first use.
    pub kernels: Vec<(&'static str, f64)>,
    /// What of it the traversal took.
    pub traversal: Traversal,
}

/// GPU time of traversal by kind of rays, in milliseconds; all zero where the device has no timestamps.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Traversal {
    /// From the camera.
    pub camera: f64,
    /// From surfaces towards lights.
    pub shadow: f64,
    /// Reflected and refracted ones, which share their waves.
    pub scattered: f64,
}

impl Traversal {
    /// Adds what the traversal among these passes took.
    fn add(&mut self, traced: Traced, passes: &[(&'static str, f64)]) {
        let names = [GridTrace::NAME, TreeTrace::NAME, DiscTrace::NAME, CameraTrace::NAME];
        let traversal = |pass: &&(&str, f64)| names.contains(&pass.0);
        let milliseconds: f64 = passes.iter().filter(traversal).map(|pass| pass.1).sum();
        match traced {
            Traced::ByDiscs(_) | Traced::Camera => self.camera += milliseconds,
            Traced::Shadows => self.shadow += milliseconds,
            Traced::Scattered => self.scattered += milliseconds,
            Traced::PastObject(_) => {} // rays from points, which no count of rays has
        }
    }
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
    filter: Buffer,
    camera_path: Buffer,
    film: Buffer,
    samples: Samples,
    hits: Buffer,
    live: Buffer,
    live_marks: Marks,
    /// The last list of those that live, and the one before.
    live_rays: [Buffer; 2],
    wave: WaveBuffers,
    volumes: Option<VolumeBuffers>,
    state: RayState,
    form: RayLoop,
    shadows: RayState,
    discs: Discs,
    /// Whether no ray of `camera_trace` has needed more work than it may spend.
    ends_at_once: bool,
    /// Rays of this sample: hits times lights, and rays of waves from surfaces.
    asked: Asked,
    passes: Passes,
    recorder: Recorder,
    budget: Budget,
    device: Arc<Device>,
}

/// The pipelines of a frame.
struct Passes {
    camera_rays: CameraRays,
    camera_trace: CameraTrace,
    disc_trace: DiscTrace,
    grid_trace: GridTrace,
    tree_trace: TreeTrace,
    surface_hit: SurfaceHit,
    refine: Refine,
    classify: Classify,
    shadow_rays: ShadowRays,
    shade: Shade,
    light_passes: LightPasses,
    scatter: Scatter,
    march: March,
    isosurface: Isosurface,
    point_light: PointLight,
    list_marked: ListMarked,
}

impl Passes {
    /// `skips`: `SCENE_SKIPS` or none, which `grid_trace` alone asks for.
    fn new(
        device: &Arc<Device>,
        form: RayLoop,
        scene: u32,
        skips: u32,
    ) -> Result<Self, RenderError> {
        Ok(Self {
            camera_rays: CameraRays::new(device, form)?,
            camera_trace: CameraTrace::new(device, scene)?,
            disc_trace: DiscTrace::new(device, form)?,
            grid_trace: GridTrace::new(device, form, scene | skips)?,
            tree_trace: TreeTrace::new(device, scene)?,
            surface_hit: SurfaceHit::new(device, form, scene)?,
            refine: Refine::new(device, form)?,
            classify: Classify::new(device, form, scene)?,
            shadow_rays: ShadowRays::new(device, form, scene)?,
            shade: Shade::new(device, form, scene)?,
            light_passes: LightPasses::new(device, form, scene)?,
            scatter: Scatter::new(device, form, scene)?,
            march: March::new(device, form, scene)?,
            isosurface: Isosurface::new(device, form)?,
            point_light: PointLight::new(device, form)?,
            list_marked: ListMarked::new(device)?,
        })
    }
}

/// How many rays of a sample there would be, had none a reason not to be sent.
#[derive(Debug, Clone, Copy, Default)]
struct Asked {
    /// Diffuse hits, for each light.
    lights: u64,
    /// Rays from surfaces that are not diffuse.
    scattered: u64,
}

/// What became of the rays of a wave.
#[derive(Debug, Clone, Copy)]
struct Classes {
    /// Hits on diffuse surfaces that light is asked for.
    lit: u32,
    /// Hits on others.
    scattering: u32,
    /// Rays of the next wave.
    next: u32,
}

/// Which rays a pass works on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Traced {
    /// From the camera, by the screen tiles of a tile of the picture.
    ByDiscs([u32; 2]),
    /// From the camera.
    Camera,
    /// From surfaces.
    Scattered,
    /// From surfaces towards a light, as far as the first hit.
    Shadows,
    /// From the points of a volume towards a light, past the surface of their object.
    PastObject(u32),
}

impl Traced {
    fn to_light(self) -> bool {
        matches!(self, Self::Shadows | Self::PastObject(_))
    }
}

impl Renderer {
    /// Fits the surfaces of a plan on a device and builds the grid.
    ///
    /// # Errors
    /// A device without the memory, a buffer over its limits, a lost device, an interruption.
    pub fn new(device: &Arc<Device>, plan: &Plan, watch: &dyn Watch) -> Result<Self, RenderError> {
        let pixels = plan.tiles().iter().map(Window::pixels).max().unwrap_or(1) as u64;
        let rays = wave_rays(plan);
        let surfaces = Surfaces::build(
            device,
            &plan.cloud,
            (&plan.fits, &plan.shapes),
            plan.grid_resolution,
            needed(plan, device, rays),
            &plan.volumes.stand_ins(),
            watch,
        )?;
        let form =
            RayLoop::of(plan.ray_loop, device, longest_list(plan, rays, surfaces.cells.bytes()));
        let live_rays = || Buffer::new(device, "list of live rays", u64::from(rays) * 4);
        let skips = if surfaces.is_listed && surfaces.grids.skip_cells() { SCENE_SKIPS } else { 0 };
        let levels = if surfaces.grids.are_several() { SCENE_LEVELS } else { 0 };
        let scene = plan.scene_bits() | levels;
        let shadows = if plan.lights.is_empty() { 1 } else { rays };
        Ok(Self {
            surfaces,
            objects: Buffer::from_slice(device, "objects", &plan.objects)?,
            colors: Buffer::from_slice(device, "point colors", &plan.colors)?,
            images: Buffer::from_slice(device, "images", &plan.images)?,
            texels: texel_buffer(device, plan)?,
            lights: Buffer::from_slice(device, "lights", &plan.lights)?,
            filter: Buffer::from_slice(device, "filter", &plan.filter)?,
            camera_path: Buffer::from_slice(device, "camera path", &[plan.camera_path()])?,
            samples: Samples::new(device, plan, pixels)?,
            film: Buffer::new(device, "film", pixels * size_of::<FilmPixel>() as u64)?,
            hits: Buffer::new(device, "hits", u64::from(rays) * size_of::<Hit>() as u64)?,
            live: Buffer::new(device, "live rays", 8)?,
            live_marks: Marks::new(device, rays, false)?,
            live_rays: [live_rays()?, live_rays()?],
            wave: WaveBuffers::new(device, rays, plan.scatters(), plan.light_passes)?,
            volumes: VolumeBuffers::new(device, &plan.volumes, rays)?,
            state: RayState::new(device, rays, form, plan.scatters())?,
            form,
            shadows: RayState::new(device, shadows, form, false)?,
            ends_at_once: true,
            asked: Asked::default(),
            discs: Discs::new(device, plan.cloud.points.len() as u32, form)?,
            passes: Passes::new(device, form, scene, skips)?,
            recorder: Recorder::new(device)?,
            budget: Budget::of(device.info()),
            device: Arc::clone(device),
        })
    }

    /// Lets a ray spend `work` loop iterations in one pass from now on, at least 64 and at most 7000, instead of as many as
    /// suit the device. No picture depends on it.
    pub fn set_budget(&mut self, work: u32) {
        self.budget = Budget::fixed(work);
    }

    /// Where the ray state lives: what the scene asked for, or was chosen.
    #[must_use]
    pub fn ray_loop(&self) -> RayLoop {
        self.form
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
        let samples = u64::from(plan.samples) + u64::from(plan.takes_centers());
        watch.stage("tracing", plan.window.pixels() as u64 * samples);
        let most = (self.film.bytes() / size_of::<FilmPixel>() as u64) as usize;
        let mut pixels = vec![EMPTY_PIXEL; most];
        let mut centers = vec![EMPTY_PIXEL; if plan.takes_centers() { most } else { 0 }];
        let made_before = self.device.pipeline_time();
        let started = Instant::now();
        self.light_points(plan, &mut stats, watch)?;
        stats.trace += started.elapsed();
        for tile in plan.tiles() {
            let started = Instant::now();
            let mut centers = centers.get_mut(..tile.pixels());
            if let Some(centers) = &mut centers {
                self.trace_sample(plan, &tile, CENTER, &mut stats, watch)?;
                self.film.read(0, centers)?;
            }
            for sample in 0..plan.samples {
                self.trace_sample(plan, &tile, sample, &mut stats, watch)?;
                let [dark, reflected] = self.wave.read_tally()?;
                let (camera, shadow) = (tile.pixels() as u64, self.asked.lights - dark);
                let refracted = self.asked.scattered - reflected;
                picture.rays += Rays { camera, shadow, reflected, refracted };
            }
            stats.trace += started.elapsed();
            let pixels = &mut pixels[..tile.pixels()];
            self.film.read(0, pixels)?;
            picture.put(plan, &self.surfaces.outcomes, &tile, (pixels, centers.as_deref()));
        }
        stats.pipelines = self.device.pipeline_time().saturating_sub(made_before);
        stats.trace = stats.trace.saturating_sub(stats.pipelines);
        Ok((picture, stats))
    }

    /// One sample of a tile's pixels: the wave from the camera, and all that come of it. After the last
    /// sample the film holds the mean of all; after [`CENTER`], which is not followed beyond the first surface unless the
    /// plan asks, what that ray saw.
    fn trace_sample(
        &mut self,
        plan: &Plan,
        tile: &Window,
        sample: u32,
        stats: &mut FrameStats,
        watch: &dyn Watch,
    ) -> Result<(), RenderError> {
        let mut params = plan.wave_of(tile, sample);
        self.asked = Asked::default();
        self.recorder.fill(self.wave.tally(), 0, self.wave.tally().bytes(), 0);
        let by_discs = self.bin_discs(plan, tile, stats)?;
        let mut traced = if by_discs { Traced::ByDiscs(tile.size) } else { Traced::Camera };
        let ends_at_first = sample == CENTER && !plan.follows_centers();
        match self.trace_at_once(plan, tile, &params, stats)? {
            Some(_) if ends_at_first => params.ray_count = 0,
            Some(classes) => {
                params.flags |= WAVE_SHARES_PATH;
                self.go_on(plan, &mut params, classes, stats, watch)?;
                traced = Traced::Scattered;
            }
            None => self.start_rays(plan, tile, sample),
        }
        while params.ray_count > 0 {
            self.trace_to_the_end(plan, [params.ray_count; 2], traced, stats, watch)?;
            traced = if traced == Traced::Scattered { traced } else { Traced::Camera };
            self.settle_hits(plan, params.ray_count, traced, stats, watch)?;
            self.isosurfaces(plan, params.ray_count, false, stats, watch)?;
            if !ends_at_first || plan.wants_along() {
                let is_center = sample == CENTER || !plan.takes_centers();
                let depths = is_center && plan.wants_volume_depth();
                params.flags |= plan.shows_of_volumes();
                let axis = depths.then_some(params.forward);
                self.march(plan, params.ray_count, (false, axis), stats, watch)?;
            }
            if ends_at_first {
                self.classify(plan, &params, stats)?;
                break;
            }
            let classes = self.classify(plan, &params, stats)?;
            self.go_on(plan, &mut params, classes, stats, watch)?;
            traced = Traced::Scattered;
        }
        if sample != CENTER {
            self.samples.record(&mut self.recorder, &self.film, plan, tile, sample);
        }
        stats.add_kernels(&self.recorder.submit()?.passes);
        stats.rays += tile.pixels() as u64;
        watch.done(stats.rays);
        Ok(())
    }

    /// From what has become of a wave's rays to light and the next wave, whose parameters these are then.
    fn go_on(
        &mut self,
        plan: &Plan,
        params: &mut WaveParams,
        classes: Classes,
        stats: &mut FrameStats,
        watch: &dyn Watch,
    ) -> Result<(), RenderError> {
        self.shade(plan, &WaveParams { ray_count: classes.lit, ..*params }, stats, watch)?;
        self.scatter(plan, &WaveParams { ray_count: classes.scattering, ..*params }, stats)?;
        self.asked.lights += u64::from(classes.lit) * u64::from(params.light_count);
        self.asked.scattered += u64::from(classes.next);
        params.ray_count = classes.next;
        params.flags = 0;
        Ok(())
    }

    /// Records the lists of a wave's rays by what has become of them.
    fn record_lists(&mut self, plan: &Plan, params: &WaveParams) {
        let (rec, wave, list) = (&mut self.recorder, &self.wave, &self.passes.list_marked);
        if params.light_count > 0 {
            list.record(rec, &wave.lit, params.ray_count, None, wave.lit_rays());
        }
        if plan.scatters() {
            list.record(rec, &wave.scattering, params.ray_count, None, wave.scattering_rays());
            list.record_offsets(rec, &wave.next, params.ray_count);
        }
    }

    /// What [`Renderer::record_lists`] has counted.
    fn read_classes(&self, plan: &Plan, params: &WaveParams) -> Result<Classes, RenderError> {
        let (wave, rays) = (&self.wave, params.ray_count);
        let lit = if params.light_count > 0 { wave.lit.read_total(rays)? } else { 0 };
        let [scattering, next] = match plan.scatters() {
            true => [wave.scattering.read_total(rays)?, wave.next.read_total(rays)?],
            false => [0; 2],
        };
        Ok(Classes { lit, scattering, next })
    }

    /// What becomes of each ray of a wave.
    fn classify(
        &mut self,
        plan: &Plan,
        params: &WaveParams,
        stats: &mut FrameStats,
    ) -> Result<Classes, RenderError> {
        let io = ClassifyIo {
            state: &self.state.current,
            polynomials: &self.surfaces.polynomials,
            objects: &self.objects,
            images: &self.images,
            texels: &self.texels,
            hits: &self.hits,
            film: &self.film,
            marches: self.volumes.as_ref().map(|volumes| &volumes.marches),
            wave: &self.wave,
        };
        record_no_marks(&mut self.recorder, &self.wave, plan, params);
        self.passes.classify.record(&mut self.recorder, io, params);
        self.record_lists(plan, params);
        stats.add_kernels(&self.recorder.submit()?.passes);
        self.read_classes(plan, params)
    }

    /// Light after light, shadow rays from a wave's diffuse hits, and then Lambert's law. The wave's rays
    /// are those hits.
    fn shade(
        &mut self,
        plan: &Plan,
        params: &WaveParams,
        stats: &mut FrameStats,
        watch: &dyn Watch,
    ) -> Result<(), RenderError> {
        if params.ray_count == 0 || params.light_count == 0 {
            return Ok(());
        }
        let paths = self.paths_of(params);
        for light in 0..params.light_count {
            let io = ShadowRaysIo {
                shadows: &self.shadows,
                grid_levels: &self.surfaces.grid_levels,
                lit_hits: self.wave.lit_hits(),
                lights: &self.lights,
                film: &self.film,
                paths: &paths,
                lit_rays: self.wave.lit_rays(),
                light_sums: self.wave.light_sums(),
                tally: self.wave.tally(),
            };
            let params = WaveParams { light, ..*params };
            self.passes.shadow_rays.record(&mut self.recorder, io, &params);
            self.shadows.passed();
            self.record_shadow_media(plan, &params, &paths);
            self.send_to_light(plan, (params.ray_count, light), Traced::Shadows, stats, watch)?;
        }
        let io = ShadeIo {
            shadows: &self.shadows.current,
            albedos: AlbedoIo {
                surfaces: &self.surfaces,
                objects: &self.objects,
                colors: &self.colors,
                images: &self.images,
                texels: &self.texels,
            },
            lit_hits: self.wave.lit_hits(),
            film: &self.film,
            paths: &paths,
            lit_rays: self.wave.lit_rays(),
            light_sums: self.wave.light_sums(),
        };
        self.passes.shade.record(&mut self.recorder, io, params);
        stats.add_kernels(&self.recorder.submit()?.passes);
        Ok(())
    }

    /// Makes the next wave. The wave's rays are those that hit what is not diffuse.
    fn scatter(
        &mut self,
        plan: &Plan,
        params: &WaveParams,
        stats: &mut FrameStats,
    ) -> Result<(), RenderError> {
        if !plan.scatters() || params.ray_count == 0 {
            return Ok(());
        }
        let paths = self.paths_of(params);
        let io = ScatterIo {
            state: &self.state,
            surfaces: &self.surfaces,
            hits: &self.hits,
            objects: &self.objects,
            film: &self.film,
            images: &self.images,
            texels: &self.texels,
            paths: &paths,
            wave: &self.wave,
        };
        self.passes.scatter.record(&mut self.recorder, io, params);
        stats.add_kernels(&self.recorder.submit()?.passes);
        self.state.swap();
        self.wave.swap();
        Ok(())
    }

    /// Of the wave's rays, or the one that they share.
    fn paths_of(&self, params: &WaveParams) -> Buffer {
        match params.flags & WAVE_SHARES_PATH {
            0 => self.wave.paths().clone(),
            _ => self.camera_path.clone(),
        }
    }
}

/// Rays of a wave of the plan, at most.
fn wave_rays(plan: &Plan) -> u32 {
    plan.tiles().iter().map(camera_wave).max().unwrap_or(1) * plan.rays_per_pixel()
}

/// Entries of the longest list that kernels of a plan read, with so many bytes of cells.
fn longest_list(plan: &Plan, rays: u32, cell_bytes: u64) -> u64 {
    let records = plan.cloud.points.len() as u64 * TEXELS_A_POLYNOMIAL;
    let lists = (cell_bytes / 8).max(u64::from(MAX_DISC_PAIRS));
    let volumes = &plan.volumes;
    let of_volumes =
        [volumes.points.len(), volumes.cells.len(), TEXELS_A_STOP * volumes.stops.len()];
    let of_volumes = of_volumes.into_iter().max().unwrap_or(0) as u64;
    records.max(lists).max(of_volumes).max(u64::from(rays) * TEXELS_A_RAY)
}

/// What the rays of a plan, at most so many at once, will ask of the surfaces.
fn needed(plan: &Plan, device: &Device, rays: u32) -> Needed {
    let longest = (u64::from(rays) * TEXELS_A_RAY).max(u64::from(MAX_DISC_PAIRS));
    let fits = longest <= u64::from(device.limits().max_texel_buffer_elements);
    let (camera, others) = (plan.camera_by_tree(), plan.by_tree());
    // Spheres and discs have a colour of their own.
    let is_colored = |object: &ObjectInfo| object.first_color != NONE && object.slot_count > 0;
    let looks_around = plan.scene_bits() & SCENE_BLENDS != 0 || plan.objects.iter().any(is_colored);
    Needed {
        lists: looks_around || !(camera && others),
        tree: fits && plan.takes_tree(),
        point_cells: plan.refines(),
    }
}

/// Records that nothing is known yet of what becomes of a wave's rays.
fn record_no_marks(rec: &mut Recorder, wave: &WaveBuffers, plan: &Plan, params: &WaveParams) {
    if params.light_count > 0 {
        wave.lit.record_none(rec, params.ray_count);
    }
    if plan.scatters() {
        wave.scattering.record_none(rec, params.ray_count);
        wave.next.record_none(rec, params.ray_count);
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
