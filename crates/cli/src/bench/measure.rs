//! Times one case.
//!
//! A scene is built, and one frame warms it up: drivers compile kernels at their first dispatch. Then
//! frames are timed one after the other. Builds are repeated as often, but not for long.

use crate::bench::cases::Case;
use crate::bench::generated::{self, Made};
use crate::engine::{Built, Engine};
use crate::errors::Failure;
use crate::input::Input;
use crate::progress::Progress;
use crate::stats::{Measured, RaysPerSecond, Row, Spread, milliseconds, pixel_hash};
use crate::{interrupt, memory, temporary};
use film::Film;
use plan::Plan;
use points::PointSet;
use render::Traversal;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Builds are repeated within this time, so that those of a million points are timed once.
const BUILDING: Duration = Duration::from_secs(5);

/// The row of a case, and its picture: `runs` frames after one to warm up.
pub fn measure(
    case: &Case,
    engine: &Engine,
    runs: u32,
    on_cpu: bool,
    progress: &Progress,
) -> Result<(Row, Film), Failure> {
    // Held, so that temporary files are removed before an interruption ends the process.
    interrupt::held(|| match case.made {
        None => timed(case, &case.input, engine, [runs, u32::from(on_cpu)], progress),
        Some(made) => {
            memory::require_points(u64::from(made.count()), progress)?;
            let folder = temporary::Folder::new("pointillist-bench-")?;
            let name = made.file_name();
            let path = folder.path().join(&name);
            generated::write(&path, made, progress)?;
            let mut input = case.input.clone();
            if let Some(object) = input.scene.objects.first_mut() {
                object.points = path;
                object.points_as_written = name;
            }
            timed(case, &input, engine, [runs, u32::from(on_cpu)], progress)
        }
    })
}

fn timed(
    case: &Case,
    input: &Input,
    engine: &Engine,
    [runs, on_cpu]: [u32; 2],
    progress: &Progress,
) -> Result<(Row, Film), Failure> {
    memory::require_picture(input.window(None)?, &[], 0, progress)?;
    let started = Instant::now();
    let mut input = input.clone();
    let sets = input.read_points(progress)?;
    let read = started.elapsed();
    go_on()?;
    let dropped = sets.iter().map(|set| set.dropped()).sum();
    let filtered_out = sets.iter().map(|set| set.filtered_out).sum();
    let (plan, planned) = planned(case, &input, &sets, runs, progress)?;
    drop(sets);
    let plan = Arc::new(plan);
    let (mut built, builds, prepared) = build(engine, &plan, [runs, on_cpu], progress)?;
    let warm_up = built.built.frame(progress)?;
    let pixels = pixel_hash(&warm_up.film, plan.samples);
    let warm_up_ms = milliseconds(warm_up.wall);
    let pipelines_ms = milliseconds(built.first_pipelines + warm_up.pipelines);
    let mut frame = warm_up;
    let mut times = Times::default();
    for _ in 0..runs {
        frame = built.built.frame(progress)?;
        times.trace.push(frame.trace);
        times.wall.push(frame.wall);
        times.gpu.extend(frame.gpu_ms());
        times.traversal.push(frame.traversal);
        if pixel_hash(&frame.film, plan.samples) != pixels {
            progress.warn(&format!(
                "{}: two frames of the same scene differ, which is a bug of the device \
                 or of pointillist; please report it",
                case.name
            ));
        }
    }
    let row = Row::new(&Measured {
        name: case.name.clone(),
        engine,
        plan: &plan,
        built: &built.built,
        frame: &frame,
        trace: &times.trace,
        wall: &times.wall,
        prepared: [read, planned],
        dropped,
        filtered_out,
    });
    let row = Row {
        suite: case.suite.clone(),
        gpu_ms: (!times.gpu.is_empty()).then(|| Spread::of_milliseconds(times.gpu.clone())),
        build_ms: Spread::of(&builds),
        builds: builds.len() as u32,
        cpu_preparation_ms: (!prepared.is_empty()).then(|| Spread::of(&prepared)),
        pipelines_ms,
        warm_up_ms: Some(warm_up_ms),
        paper_frames_per_second: case.paper_ms.map(|ms| 1e3 / ms),
        rays_per_second: RaysPerSecond::new(&row.rays, row.trace_ms.median, &times.traversal()),
        ..row
    };
    Ok((row, frame.film))
}

/// Plans; of scans, whose planning is what is to be looked at, as often as frames while that takes no longer than
/// [`BUILDING`]. Returns the last plan and the median time.
fn planned(
    case: &Case,
    input: &Input,
    sets: &[Arc<PointSet>],
    runs: u32,
    progress: &Progress,
) -> Result<(Plan, Duration), Failure> {
    let started = Instant::now();
    let mut times = Vec::new();
    loop {
        let begun = Instant::now();
        let mut plan = input.plan(sets, None, progress)?;
        plan.aovs = false; // only the picture is timed
        times.push(begun.elapsed());
        go_on()?;
        let is_scan = matches!(case.made, Some(Made::Scan(_)));
        if !is_scan || times.len() >= runs as usize || started.elapsed() > BUILDING {
            times.sort_unstable();
            return Ok((plan, times[times.len() / 2]));
        }
    }
}

/// Of each frame.
#[derive(Default)]
struct Times {
    trace: Vec<Duration>,
    wall: Vec<Duration>,
    gpu: Vec<f64>,
    traversal: Vec<Traversal>,
}

impl Times {
    /// The median of each kind.
    fn traversal(&self) -> Traversal {
        let median = |of: fn(&Traversal) -> f64| {
            Spread::of_milliseconds(self.traversal.iter().map(of).collect()).median
        };
        Traversal {
            camera: median(|t| t.camera),
            shadow: median(|t| t.shadow),
            scattered: median(|t| t.scattered),
        }
    }
}

/// The last of some builds.
struct LastBuilt {
    built: Built,
    /// How long the first waited for pipelines.
    first_pipelines: Duration,
}

/// Builds, and times it as often as frames while that takes no longer than [`BUILDING`]. The first build
/// warms up: it counts only where there is no other. If `on_cpu` is not 0, as often as frames however long it
/// takes, and in turn with the preparation of the same points on the CPU.
fn build(
    engine: &Engine,
    plan: &Arc<Plan>,
    [runs, on_cpu]: [u32; 2],
    progress: &Progress,
) -> Result<(LastBuilt, Vec<Duration>, Vec<Duration>), Failure> {
    let started = Instant::now();
    let mut built = engine.build(plan, progress)?;
    let (first, first_pipelines) = (built.duration, built.pipelines);
    let (mut times, mut prepared) = (Vec::new(), Vec::new());
    let mut prepare = || {
        let started = Instant::now();
        if on_cpu != 0 {
            let fits = reference::fit_surfaces::<f32>(plan, progress);
            fits.ok_or_else(Failure::interrupted)?;
            prepared.push(started.elapsed());
        }
        Ok::<_, Failure>(())
    };
    let in_time = |last: Duration| on_cpu != 0 || started.elapsed() + last < BUILDING;
    while times.len() < runs as usize && in_time(built.duration) {
        // One at a time: two might not fit.
        drop(built);
        prepare()?;
        built = engine.build(plan, progress)?;
        times.push(built.duration);
    }
    if times.is_empty() {
        times.push(first);
    }
    progress.clear();
    Ok((LastBuilt { built, first_pipelines }, times, prepared))
}

fn go_on() -> Result<(), Failure> {
    if interrupt::requested() { Err(Failure::interrupted()) } else { Ok(()) }
}
