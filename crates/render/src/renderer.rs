//! A scene on a device, ready to be traced as often as one likes.

use crate::RenderError;
use crate::budget::Budget;
use crate::frame::Frame;
use crate::state::{RayLoop, RayState};
use crate::stats::FrameStats;
use crate::structure::{DiscLists, Structures};
use crate::tables::{self, FilmBuffers, VolumeBuffers, WaveBuffers};
use gpu::{Bindings, Constants, Device, Recorder};
use kernels::layout::{
    MARCHES, NONE, ObjectInfo, Path, Polynomial, SCENE_BLENDS, SCENE_LEVELS, VolumeStop,
};
use kernels::spirv::Rays;
use plan::{MAX_DISC_PAIRS, Picture, Plan, StructureKind, camera_wave};
use points::Watch;
use points::device::{Needed, Surfaces};
use std::sync::Arc;

/// Of 16 bytes.
const TEXELS_A_STOP: usize = size_of::<VolumeStop>() / 16;
const TEXELS_A_POLYNOMIAL: u64 = (size_of::<Polynomial>() / 16) as u64;
/// Of a path, the longest of a wave's records.
const TEXELS_A_RAY: u64 = (size_of::<Path>() / 16) as u64;

/// A scene on a device, ready to be traced.
pub struct Renderer {
    pub(crate) plan: Arc<Plan>,
    pub(crate) surfaces: Surfaces,
    /// What is bound and stays where it is.
    pub(crate) bound: Bindings,
    pub(crate) buffers: Buffers,
    pub(crate) rays: WaveRays,
    pub(crate) structures: Structures,
    pub(crate) run: Run,
}

/// What passes write, by what it is of.
pub(crate) struct Buffers {
    pub film: FilmBuffers,
    pub wave: WaveBuffers,
    pub volumes: Option<VolumeBuffers>,
}

/// The rays of a wave on their way.
pub(crate) struct WaveRays {
    pub form: RayLoop,
    pub state: RayState,
    pub shadows: RayState,
    /// Whether no ray of `camera_trace` has needed more work than it may spend.
    pub end_at_once: bool,
}

/// How passes run.
pub(crate) struct Run {
    pub recorder: Recorder,
    pub budget: Budget,
    pub device: Arc<Device>,
}

impl Renderer {
    /// Fits the surfaces of a plan on a device and builds what rays go through.
    ///
    /// # Errors
    /// A device without the memory, a buffer over its limits, a lost device, an interruption.
    pub fn new(
        device: &Arc<Device>,
        plan: &Arc<Plan>,
        watch: &dyn Watch,
    ) -> Result<Self, RenderError> {
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
        let film = FilmBuffers::new(device, plan)?;
        let wave = WaveBuffers::new(device, plan, rays)?;
        let bound = wave.bind(film.bind(tables::of_scene(device, plan, &surfaces)?));
        // Kernels read of marches only where there are volumes.
        let bound = bound.buffer(MARCHES, &wave.hits);
        let (volumes, bound) = VolumeBuffers::new(device, &plan.volumes, rays, bound)?;
        let shadows = if plan.lights.is_empty() { 1 } else { rays };
        let constants = constants(plan, &surfaces);
        let rays = WaveRays {
            form,
            state: RayState::new(device, rays, form, plan.scatters())?,
            shadows: RayState::new(device, shadows, form, false)?,
            end_at_once: true,
        };
        Ok(Self {
            plan: Arc::clone(plan),
            run: Run::new(device, constants)?,
            structures: Structures::new(device, &surfaces, (form, constants))?,
            surfaces,
            bound,
            buffers: Buffers { film, wave, volumes },
            rays,
        })
    }

    /// Lets a ray spend `work` loop iterations in one pass from now on, at least 64 and at most 7000, instead of as many as
    /// suit the device. No picture depends on it.
    pub fn set_budget(&mut self, work: u32) {
        self.run.budget = Budget::fixed(work);
    }

    /// Where the ray state lives: what the scene asked for, or was chosen.
    #[must_use]
    pub fn ray_loop(&self) -> RayLoop {
        self.rays.form
    }

    /// The surfaces that are traced.
    #[must_use]
    pub fn surfaces(&self) -> &Surfaces {
        &self.surfaces
    }

    /// The points of the last tile's screen tiles, where a tile was traced by discs.
    #[must_use]
    pub fn disc_lists(&self) -> Option<&DiscLists> {
        self.structures.disc_lists()
    }

    /// Whether rays can go through this structure.
    #[must_use]
    pub fn has(&self, kind: StructureKind) -> bool {
        self.structures.get(kind).is_some()
    }

    /// Traces one picture of the plan.
    ///
    /// # Errors
    /// A lost device, an interruption.
    pub fn frame(&mut self, watch: &dyn Watch) -> Result<(Picture, FrameStats), RenderError> {
        Frame::new(self, watch).run()
    }

    /// The variant of kernels for where the ray state lives.
    pub(crate) fn variant(&self) -> Rays {
        self.rays.form.rays()
    }
}

impl Run {
    fn new(device: &Arc<Device>, constants: Constants) -> Result<Self, RenderError> {
        let mut recorder = Recorder::new(device)?;
        recorder.specialize(constants);
        let (budget, device) = (Budget::of(device.info()), Arc::clone(device));
        Ok(Self { recorder, budget, device })
    }
}

/// What kernels are specialized by.
fn constants(plan: &Plan, surfaces: &Surfaces) -> Constants {
    let [scene, lighting] = plan.constants();
    [scene | if surfaces.grids.are_several() { SCENE_LEVELS } else { 0 }, lighting]
}

/// Rays of a wave of the plan, at most.
pub(crate) fn wave_rays(plan: &Plan) -> u32 {
    plan.tiles().iter().map(camera_wave).max().unwrap_or(1) * plan.rays_per_pixel()
}

/// Entries of the longest list that kernels of a plan read, with so many bytes of cells.
pub(crate) fn longest_list(plan: &Plan, rays: u32, cell_bytes: u64) -> u64 {
    let polynomials = plan.cloud.points.len() as u64 * TEXELS_A_POLYNOMIAL;
    let lists = (cell_bytes / 8).max(u64::from(MAX_DISC_PAIRS));
    let volumes = &plan.volumes;
    let of_volumes =
        [volumes.points.len(), volumes.cells.len(), TEXELS_A_STOP * volumes.stops.len()];
    let of_volumes = of_volumes.into_iter().max().unwrap_or(0) as u64;
    polynomials.max(lists).max(of_volumes).max(u64::from(rays) * TEXELS_A_RAY)
}

/// What the rays of a plan, at most so many at once, will ask of the surfaces.
pub(crate) fn needed(plan: &Plan, device: &Device, rays: u32) -> Needed {
    let longest = (u64::from(rays) * TEXELS_A_RAY).max(u64::from(MAX_DISC_PAIRS));
    let fits = longest <= u64::from(device.limits().max_texel_buffer_elements);
    // Spheres and discs have a colour of their own.
    let is_colored = |object: &ObjectInfo| object.first_color != NONE && object.slot_count > 0;
    let looks_around = plan.scene_bits() & SCENE_BLENDS != 0 || plan.objects.iter().any(is_colored);
    Needed {
        lists: looks_around || plan.takes(StructureKind::Grid),
        tree: fits && plan.takes(StructureKind::Tree),
        point_cells: plan.refines(),
    }
}
