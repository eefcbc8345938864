//! `render`: from a scene or a point file to pictures.

use crate::ahead::Ahead;
use crate::args::{Channels, Exposure, RenderArgs};
use crate::engine::{Built, Engine, Frame, with_engine};
use crate::errors::Failure;
use crate::input::{Input, SceneValues, check_preset};
use crate::progress::Progress;
use crate::source::PIPE;
use crate::stats::{Measured, Row};
use crate::{console, files, interrupt, legend, memory, provenance};
use film::{FileFormat, Film, Provenance, Style, Tone};
use plan::{Diagnostic, Extra, Plan};
use points::Watch;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Renders. Whatever can be checked is checked before points are read.
pub fn run(args: &RenderArgs) -> Result<(), Failure> {
    let formats: Vec<FileFormat> =
        args.outputs.iter().map(|output| args.format_of(output)).collect::<Result<_, _>>()?;
    let to_stdout = args.outputs.iter().any(|output| output == Path::new(PIPE));
    if let (Some(_), false) = (args.format, to_stdout) {
        return Err(Failure::usage(
            "--format is for what is written to stdout, and files have their extension; add -o -, or leave it out",
        ));
    }
    let outputs: Vec<&Path> = args
        .outputs
        .iter()
        .chain(&args.stats)
        .chain(&args.legend)
        .map(|path| path.as_path())
        .collect();
    for output in &outputs {
        files::check_output(output)?;
    }
    if let Some(path) = &args.legend {
        legend::check(path)?;
    }
    check_preset(args.overrides.preset.as_deref(), &args.overrides.set)?;
    let mut values = SceneValues::new(&args.overrides);
    if let Some(quality) = args.quality {
        values = values.in_quality(&args.scene, quality.into());
    }
    if args.ground {
        values = values.on_ground();
    }
    if let Some(samples) = args.samples {
        values.add("image.samples", &samples.to_string(), &format!("--samples {samples}"));
    }
    if let Some(columns) = &args.columns {
        values.add_columns(&args.scene, columns)?;
    }
    let mut input =
        Input::load(&args.scene, &values, &args.view)?.colored_by(args.color.clone())?;
    let added = Added::of(args, &formats);
    let progress = Progress::new(&args.progress);
    let picture =
        memory::require_picture(input.window(args.crop)?, &formats, added.planes(), &progress)?;
    files::check_distinct(&outputs, &input.files())?;
    if added.planes() == 0 && !args.channels.is_empty() {
        progress.warn(
            "--channels is ignored, since only EXR files hold further channels; add \
             -o FILE.exr",
        );
    }
    if args.asks_for_tone() && formats.iter().all(|format| *format == FileFormat::Exr) {
        progress.warn(
            "--exposure and --tone are ignored, since EXR files hold the numbers as they are; \
             add -o FILE.png",
        );
    }
    if args.half && !formats.contains(&FileFormat::Exr) {
        progress.warn("--half is ignored, since it is for EXR files; add -o FILE.exr");
    }
    let objects = input.scene.objects.iter().filter(|object| !object.is_ground());
    let objects = objects.map(|object| object.points.as_path());
    let beside = memory::of_point_files(objects).saturating_add(picture);
    with_engine(&args.device, beside, &progress, |engine| {
        render(args, &mut input, added, engine, &progress)
    })
}

/// What `--channels` adds.
struct Added {
    diagnostics: Vec<Diagnostic>,
    extras: Vec<Extra>,
}

impl Added {
    /// What was asked for, each once, where a file can hold it.
    fn of(args: &RenderArgs, formats: &[FileFormat]) -> Self {
        let held = formats.contains(&FileFormat::Exr);
        let is_asked = |channels| held && args.channels.contains(&channels);
        let diagnostics = Diagnostic::ALL.into_iter();
        let extras = Extra::ALL.into_iter();
        Self {
            diagnostics: diagnostics.filter(|&one| is_asked(Channels::Diagnostic(one))).collect(),
            extras: extras.filter(|&one| is_asked(Channels::Extra(one))).collect(),
        }
    }

    /// How many channels these are.
    fn planes(&self) -> usize {
        let extras = self.extras.iter().map(|extra| extra.channels().len());
        self.diagnostics.len() + extras.sum::<usize>()
    }
}

fn render(
    args: &RenderArgs,
    input: &mut Input,
    added: Added,
    engine: &Engine,
    progress: &Progress,
) -> Result<(), Failure> {
    let started = Instant::now();
    let ahead = Ahead::new(engine);
    ahead.fits(&input.scene);
    let sets = input.read_points(progress)?;
    let read = started.elapsed();
    let dropped: u64 = sets.iter().map(|set| set.dropped()).sum();
    let filtered_out = sets.iter().map(|set| set.filtered_out).sum();
    let mut plan = input.plan(&sets, args.crop, progress)?;
    (plan.diagnostics, plan.extras) = (added.diagnostics, added.extras);
    let exr = args.outputs.iter().any(|path| args.format_of(path).ok() == Some(FileFormat::Exr));
    plan.aovs = exr; // no other file holds them
    let legend = args.legend.as_ref().map(|path| Ok::<_, Failure>((path, legend::of(&plan)?)));
    let legend = legend.transpose()?;
    ahead.picture(&plan);
    for (name, count) in plan.names.iter().zip(&plan.isolated).filter(|(_, count)| **count > 0) {
        progress.note(&format!("object '{name}': dropped {count} isolated points"));
    }
    let nothing = plan::nothing_seen(&input.scene, &sets, &plan);
    for line in &nothing {
        progress.warn(line);
    }
    progress.refuse_warnings(args.strict, ", and nothing was rendered")?;
    let of_header = input.exposure_of_header()?;
    let mut provenance = exr.then(|| provenance::of(&plan, input, &sets, engine));
    drop(sets);
    let planned = started.elapsed() - read;
    let plan = Arc::new(plan);
    let mut built = engine.build(&plan, progress)?;
    let frame = built.frame(progress)?;
    let wall = started.elapsed();
    warn_of_missing_surfaces(&plan, &built, progress);
    // Of a part that was asked for, or where it is known why, nothing is no surprise.
    let in_eight_bits =
        args.outputs.iter().any(|path| args.format_of(path).ok() != Some(FileFormat::Exr));
    let exposure = match (args.exposure, of_header) {
        (Some(Exposure::Stops(stops)), _) | (None, Some(stops)) => stops,
        (None, None) if !input.is_point_file() => 0.0,
        (Some(Exposure::Auto) | None, _) => {
            let is_beside = |object: usize| input.scene.objects[object].is_ground();
            film::mid_grey_exposure(&frame.film, &is_beside).unwrap_or(0.0)
        }
    };
    if let (Some(provenance), true) = (&mut provenance, exposure != 0.0) {
        provenance.settings.push(("exposure".to_owned(), exposure.to_string()));
    }
    let tone = args.tone(exposure);
    let shown = plan::Shown::of(&plan, in_eight_bits.then_some(tone));
    let blank =
        plan::blank(&frame.film, shown).filter(|_| nothing.is_empty() && args.crop.is_none());
    if let Some(line) = blank {
        progress.warn(&line);
    }

    let provenance = provenance.as_ref().unwrap_or(plan.provenance());
    if exr && args.half {
        warn_of_bright_values(&frame.film, progress);
    }
    write_pictures(args, provenance, (&frame, tone), progress)?;
    if let Some((path, legend)) = &legend {
        legend::write(legend, path)?;
    }
    if let Some(path) = &args.stats {
        let row = Row::new(&Measured {
            name: input.name(),
            engine,
            plan: &plan,
            built: &built,
            frame: &frame,
            trace: &[frame.trace],
            wall: &[wall],
            prepared: [read, planned],
            dropped: dropped + plan.isolated.iter().sum::<u64>(),
            filtered_out,
        });
        files::write_json(path, &row)?;
    }
    interrupt::finished();
    let times = [read, planned, built.duration];
    progress.result(
        &summary(args, &plan, engine, (&frame, exposure), times),
        fields(args, &plan, engine, (&frame, exposure), times),
    );
    progress.refuse_warnings(args.strict, " of the picture, which was written")
}

fn write_pictures(
    args: &RenderArgs,
    provenance: &Provenance,
    (frame, tone): (&Frame, Tone),
    progress: &Progress,
) -> Result<(), Failure> {
    let style = Style { tone, half: args.half };
    progress.stage("writing pictures", args.outputs.len() as u64);
    for (output, written) in args.outputs.iter().zip(1..) {
        let film = &frame.film;
        if output == Path::new(PIPE) {
            let format = args.format_of(output)?;
            // Not held: a reader that takes nothing must not hold up an interruption.
            console::result_bytes(&film::encode(film, provenance, style, format, output)?)?;
        } else {
            interrupt::writing(|| Ok(film::write_styled(film, provenance, style, output)?))?;
        }
        progress.done(written);
    }
    progress.clear();
    Ok(())
}

/// 16 bits end at 65504, far below what a light in view can have.
fn warn_of_bright_values(film: &Film, progress: &Progress) {
    let beyond = film::beyond_half(film);
    if beyond > 0 {
        progress.warn(&format!(
            "--half: {beyond} values of R, G and B are beyond {}, the largest that 16 bits hold, \
             and were written as that; leave --half out to keep them",
            film::HALF_MAX
        ));
    }
}

/// An object of one point, or of coinciding ones, is no error, but surely not what was meant.
fn warn_of_missing_surfaces(plan: &Plan, built: &Built, progress: &Progress) {
    let mut volumes =
        (0u32..).map(|object| plan.volumes.infos.iter().any(|volume| volume.object == object));
    for (index, (slots, name)) in (0u32..).zip(plan.cloud.objects.iter().zip(&plan.names)) {
        let outcomes = &built.outcomes()[slots.range()];
        if volumes.next().is_some_and(|is_volume| is_volume) {
            continue;
        }
        if outcomes.iter().all(|outcome| outcome.trust <= 0.0) {
            let why = match plan.shapes.iter().any(|shapes| shapes.object == index) {
                true => "has a radius over 1e-15; give surface.radius a length",
                false => {
                    "carries a surface, since points without distinct neighbours have none; it renders as \
                     background"
                }
            };
            progress.warn(&format!("object '{name}': none of its {} points {why}", outcomes.len()));
        }
    }
}

/// The same for `--log json`.
fn fields(
    args: &RenderArgs,
    plan: &Plan,
    engine: &Engine,
    (frame, exposure): (&Frame, f64),
    [read, planned, built]: [Duration; 3],
) -> Value {
    let outputs: Vec<String> =
        args.outputs.iter().chain(&args.stats).map(|output| output.display().to_string()).collect();
    let seconds = json!({
        "read": read.as_secs_f64(),
        "plan": planned.as_secs_f64(),
        "build": built.as_secs_f64(),
        "trace": frame.trace.as_secs_f64(),
    });
    json!({
        "outputs": outputs,
        "device": engine.name(),
        "points": plan.point_count,
        "size": plan.window.size,
        "passes": frame.passes,
        "exposure": exposure,
        "seconds": seconds,
    })
}

/// One line of what was done and how long it took.
fn summary(
    args: &RenderArgs,
    plan: &Plan,
    engine: &Engine,
    (frame, exposure): (&Frame, f64),
    [read, planned, built]: [Duration; 3],
) -> String {
    let outputs: Vec<String> =
        args.outputs.iter().map(|output| output.display().to_string()).collect();
    let [width, height] = plan.window.size;
    let points = plan.point_count;
    let passes = match frame.passes {
        1 => "1 pass".to_owned(),
        passes => format!("{passes} passes"),
    };
    let exposed = match exposure {
        0.0 => String::new(),
        stops => format!(", exposed by {stops} stops"),
    };
    format!(
        "{}: {points} points, {width}x{height} on {}: read {:.2} s, planned {:.2} s, \
         built {:.2} s, traced {:.2} s in {passes}{exposed} -> {}",
        args.scene.display(),
        engine.name(),
        read.as_secs_f64(),
        planned.as_secs_f64(),
        built.as_secs_f64(),
        frame.trace.as_secs_f64(),
        outputs.join(", ")
    )
}
