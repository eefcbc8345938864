//! What a plan runs on: a Vulkan device, or the CPU reference in single or double precision.

use crate::args::DeviceArgs;
use crate::errors::{self, Exit, Failure};
use crate::progress::Progress;
use crate::{again, ending, interrupt, memory};
use film::Film;
use gpu::{Device, DeviceChoice, GpuError, Instance, InstanceOptions};
use kernels::layout::FitOutcome;
use plan::{Picture, Plan, Rays, RaysFrom, StructureKind};
use points::Grids;
use points::device::Tree;
use reference::Reference;
use render::{RayLoop, Renderer, Traversal};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Turns the validation layer on where it is `1`; any message then ends the process with code 4.
pub const VALIDATION: &str = "POINTILLIST_VALIDATION";

/// Why no device was opened.
pub enum Unopened {
    /// Vulkan, or all of its devices.
    Device(GpuError),
    /// A driver would not fit into memory, as the words say.
    Memory(String),
    /// A driver crashed while this program opened it, and it began anew.
    Crashed(String),
}

impl Unopened {
    /// In one line, without advice about other devices.
    pub fn in_words(&self) -> String {
        match self {
            Self::Device(error) => errors::chain(error),
            Self::Memory(why) | Self::Crashed(why) => why.clone(),
        }
    }
}

/// Opens a device, if the process has the memory that drivers take, and `beside` for the work.
pub fn open_device(choice: &DeviceChoice, beside: u64) -> Result<Arc<Device>, Unopened> {
    memory::require_driver(beside).map_err(Unopened::Memory)?;
    let validation = std::env::var_os(VALIDATION).is_some_and(|value| value == "1");
    ending::driver_is_there();
    Instance::new(&InstanceOptions { validation })
        .and_then(|instance| Device::open(&instance, choice))
        .map_err(Unopened::Device)
}

/// Something that can execute a plan.
#[derive(Debug)]
pub enum Engine {
    /// A Vulkan device.
    Gpu(Arc<Device>),
    /// The CPU twin in f32, whose pixels equal the kernels'.
    Reference,
    /// The CPU twin in f64, which says how far the others are from the truth.
    ReferenceF64,
}

/// A plan's surfaces on its engine.
pub struct Built {
    plan: Arc<Plan>,
    surfaces: BuiltOn,
    /// How long that took.
    pub duration: Duration,
    /// What of it was waiting for the driver to make pipelines; zero on the CPU.
    pub pipelines: Duration,
}

enum BuiltOn {
    Gpu(Box<Renderer>),
    Single(Reference<f32>),
    Double(Reference<f64>),
}

/// One picture and what it cost.
pub struct Frame {
    /// The picture.
    pub film: Film,
    /// Pixels that hit a surface.
    pub hits: u64,
    /// Points that rays were tested against.
    pub tests: u64,
    /// Rays, by kind.
    pub rays: Rays,
    /// Dispatches of the traversal.
    pub passes: u32,
    /// From submission to completion of all passes.
    pub trace: Duration,
    /// What it waited for pipelines that were new; not in `trace`.
    pub pipelines: Duration,
    /// All of it with the picture read back.
    pub wall: Duration,
    /// Milliseconds of each kernel.
    pub kernels: Vec<(&'static str, f64)>,
    /// What of it traversal took, by kind of rays.
    pub traversal: Traversal,
}

/// Opens the engine that was asked for, or else the default, and lets `work` use it, which takes about `beside` bytes. The messages
/// of the validation layer are reported when everything is destroyed.
pub fn with_engine<T>(
    args: &DeviceArgs,
    beside: u64,
    progress: &Progress,
    work: impl FnOnce(&Engine) -> Result<T, Failure>,
) -> Result<T, Failure> {
    // Not cut off: a process that ends while a driver starts its threads may crash.
    let engine = interrupt::held(|| Engine::open(args, beside, progress))?;
    let result = work(&engine);
    interrupt::finished();
    let Engine::Gpu(device) = engine else { return result };
    let instance = Arc::clone(device.instance());
    drop(device);
    let messages = instance.validation_messages();
    if messages.is_empty() {
        return result;
    }
    let mut lines = result.err().map_or_else(Vec::new, |failure| failure.lines);
    lines.extend(
        messages.iter().map(|message| format!("validation: {}", message.replace('\n', " "))),
    );
    Err(Failure { exit: Exit::Exhausted, lines })
}

impl Engine {
    fn open(args: &DeviceArgs, beside: u64, progress: &Progress) -> Result<Self, Failure> {
        let choice = match args.device.as_deref().map(str::trim) {
            Some(name) if name.eq_ignore_ascii_case("reference") => return Ok(Self::Reference),
            Some(name) if name.eq_ignore_ascii_case("reference-f64") => {
                return Ok(Self::ReferenceF64);
            }
            Some(name) if name.eq_ignore_ascii_case("vulkan") => DeviceChoice::Default,
            Some(name) => DeviceChoice::Named(name.to_owned()),
            None => match again::open_by_default(|| open_device(&DeviceChoice::Default, beside)) {
                Ok(device) => return Ok(Self::Gpu(device)),
                // Who checks a device by the layer wants no picture without it.
                Err(Unopened::Device(error @ GpuError::NoValidation { .. })) => {
                    return Err(Failure::no_device(&error));
                }
                Err(reason) => {
                    progress.note(&format!(
                        "rendering by the CPU reference, which gives the same picture, since {}; --device reference \
                         chooses it, --device vulkan insists on Vulkan",
                        reason.in_words()
                    ));
                    return Ok(Self::Reference);
                }
            },
        };
        match open_device(&choice, beside) {
            Ok(device) => Ok(Self::Gpu(device)),
            Err(Unopened::Device(error)) => Err(Failure::no_device(&error)),
            Err(Unopened::Memory(why) | Unopened::Crashed(why)) => {
                Err(Failure::exhausted(format!(
                    "{why}; raise the limit, or render with --device reference, which takes less"
                )))
            }
        }
    }

    /// Name for tables and messages.
    pub fn name(&self) -> String {
        match self {
            Self::Gpu(device) => device.info().name.clone(),
            Self::Reference => "reference (CPU, f32)".to_owned(),
            Self::ReferenceF64 => "reference (CPU, f64)".to_owned(),
        }
    }

    /// Driver with its version; the reference has none.
    pub fn driver(&self) -> String {
        match self {
            Self::Gpu(device) => device.info().driver.clone(),
            Self::Reference | Self::ReferenceF64 => String::new(),
        }
    }

    /// Fits the surfaces and builds the grid.
    pub fn build(&self, plan: &Arc<Plan>, progress: &Progress) -> Result<Built, Failure> {
        let started = Instant::now();
        let pipelines = self.pipeline_time();
        let surfaces = interrupt::held(|| {
            Ok(match self {
                Self::Gpu(device) => BuiltOn::Gpu(Box::new(Renderer::new(device, plan, progress)?)),
                Self::Reference => BuiltOn::Single(finished(Reference::new(plan, progress))?),
                Self::ReferenceF64 => BuiltOn::Double(finished(Reference::new(plan, progress))?),
            })
        });
        progress.clear();
        Ok(Built {
            plan: Arc::clone(plan),
            surfaces: surfaces?,
            duration: started.elapsed(),
            pipelines: self.pipeline_time().saturating_sub(pipelines),
        })
    }

    fn pipeline_time(&self) -> Duration {
        match self {
            Self::Gpu(device) => device.pipeline_time(),
            Self::Reference | Self::ReferenceF64 => Duration::ZERO,
        }
    }
}

impl Built {
    /// Traces one picture.
    pub fn frame(&mut self, progress: &Progress) -> Result<Frame, Failure> {
        let frame = interrupt::held(|| self.traced(progress));
        progress.clear();
        frame
    }

    fn traced(&mut self, progress: &Progress) -> Result<Frame, Failure> {
        let plan: &Plan = &self.plan;
        let started = Instant::now();
        match &mut self.surfaces {
            BuiltOn::Gpu(renderer) => {
                let (picture, stats) = renderer.frame(progress)?;
                Ok(Frame {
                    hits: picture.hits,
                    tests: picture.tests,
                    rays: picture.rays,
                    film: picture.finish(),
                    passes: stats.passes,
                    trace: stats.trace,
                    pipelines: stats.pipelines,
                    wall: started.elapsed(),
                    kernels: stats.kernels,
                    traversal: stats.traversal,
                })
            }
            BuiltOn::Single(reference) => {
                Ok(Frame::of_reference(finished(reference.frame(plan, progress))?, started))
            }
            BuiltOn::Double(reference) => {
                Ok(Frame::of_reference(finished(reference.frame(plan, progress))?, started))
            }
        }
    }

    /// How each fit ended, by slot.
    pub fn outcomes(&self) -> &[FitOutcome] {
        match &self.surfaces {
            BuiltOn::Gpu(renderer) => &renderer.surfaces().outcomes,
            BuiltOn::Single(reference) => &reference.outcomes,
            BuiltOn::Double(reference) => &reference.outcomes,
        }
    }

    /// Where the grids lie, if they list anything.
    pub fn grids(&self) -> Option<&Grids> {
        match &self.surfaces {
            BuiltOn::Gpu(renderer) => {
                let surfaces = renderer.surfaces();
                surfaces.is_listed.then_some(&surfaces.grids)
            }
            BuiltOn::Single(reference) => Some(&reference.grids),
            BuiltOn::Double(reference) => Some(&reference.grids),
        }
    }

    /// The tree, if there is one; the CPU goes through the grid.
    pub fn tree(&self) -> Option<&Tree> {
        match &self.surfaces {
            BuiltOn::Gpu(renderer) => renderer.surfaces().tree.as_ref(),
            BuiltOn::Single(_) | BuiltOn::Double(_) => None,
        }
    }

    /// What rays go through, as scene files name it; the CPU has no tree.
    pub fn through(&self, plan: &Plan, from: RaysFrom<'_>) -> &'static str {
        let has = |kind: &StructureKind| match &self.surfaces {
            BuiltOn::Gpu(renderer) => renderer.has(*kind),
            BuiltOn::Single(_) | BuiltOn::Double(_) => {
                matches!(kind, StructureKind::Grid | StructureKind::Discs)
            }
        };
        let kind = plan.structures(from).into_iter().find(has);
        kind.unwrap_or(StructureKind::Grid).name()
    }

    /// Where the ray state lives on the device; the CPU has none.
    pub fn ray_loop(&self) -> Option<&'static str> {
        match &self.surfaces {
            BuiltOn::Gpu(renderer) => Some(match renderer.ray_loop() {
                RayLoop::Images => "images",
                RayLoop::Queue => "queue",
            }),
            BuiltOn::Single(_) | BuiltOn::Double(_) => None,
        }
    }

    /// Milliseconds of each kernel of the build, where it ran on a device.
    pub fn kernels(&self) -> &[(&'static str, f64)] {
        match &self.surfaces {
            BuiltOn::Gpu(renderer) => &renderer.surfaces().kernels,
            BuiltOn::Single(_) | BuiltOn::Double(_) => &[],
        }
    }

    /// Points whose neighbours the device left to the CPU.
    pub fn searched_on_cpu(&self) -> u64 {
        match &self.surfaces {
            BuiltOn::Gpu(renderer) => renderer.surfaces().searched_on_host,
            BuiltOn::Single(_) | BuiltOn::Double(_) => 0,
        }
    }

    /// Bytes that tracing needs: polynomials, cells and their lists.
    pub fn bytes(&self) -> u64 {
        fn of<R>(reference: &Reference<R>) -> u64 {
            let lists = &reference.lists;
            (size_of_val(reference.polynomials.as_slice())
                + size_of_val(lists.cells.as_slice())
                + size_of_val(lists.slots.as_slice())) as u64
        }
        match &self.surfaces {
            BuiltOn::Gpu(renderer) => renderer.surfaces().bytes(),
            BuiltOn::Single(reference) => of(reference),
            BuiltOn::Double(reference) => of(reference),
        }
    }
}

impl Frame {
    /// Milliseconds of all kernels, where the device has a clock.
    pub fn gpu_ms(&self) -> Option<f64> {
        let sum: f64 = self.kernels.iter().map(|kernel| kernel.1).sum();
        (sum > 0.0).then_some(sum)
    }

    fn of_reference(picture: Picture, started: Instant) -> Self {
        let elapsed = started.elapsed();
        let (hits, tests, rays) = (picture.hits, picture.tests, picture.rays);
        let film = picture.finish();
        Self {
            hits,
            tests,
            rays,
            film,
            passes: 1,
            trace: elapsed,
            pipelines: Duration::ZERO,
            wall: elapsed,
            kernels: Vec::new(),
            traversal: Traversal::default(),
        }
    }
}

/// The reference gives nothing where the watcher asked for an end.
fn finished<T>(result: Option<T>) -> Result<T, Failure> {
    result.ok_or_else(Failure::interrupted)
}
