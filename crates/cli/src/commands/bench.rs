//! `bench`: how long frames take, on one engine, scene after scene.
//!
//! A scene is built once and one frame warms it up: drivers compile kernels at their first dispatch.
//! Then frames are timed one after the other; the middle one counts.

use crate::args::BenchArgs;
use crate::console;
use crate::engine::{Engine, with_engine};
use crate::errors::Failure;
use crate::input::{Input, SceneValues};
use crate::progress::Progress;
use crate::stats::{Measured, Row, pixel_hash};
use crate::{files, memory};
use serde::Serialize;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// What `--json` writes.
#[derive(Debug, Serialize)]
struct Report {
    device: String,
    driver: String,
    cpu: String,
    version: &'static str,
    /// What the binary was built from, where git knew.
    commit: Option<&'static str>,
    runs: u32,
    rows: Vec<Row>,
}

/// Times every scene.
pub fn run(args: &BenchArgs) -> Result<(), Failure> {
    if args.scenes.is_empty() {
        return Err(Failure::usage(
            "bench: the suite of all scenes is not built yet; name scene files or point files",
        ));
    }
    if let Some(suite) =
        args.scenes.iter().find(|path| path.extension().is_none() && !path.exists())
    {
        return Err(Failure::usage(format!(
            "bench: found no file '{}', and named suites are not built yet; name scene files or \
             point files",
            suite.display()
        )));
    }
    let outputs: Vec<&Path> =
        args.json.iter().chain(&args.markdown).map(|path| path.as_path()).collect();
    for output in &outputs {
        files::check_output(output)?;
    }
    let values = SceneValues::new(&args.overrides);
    let inputs: Vec<Input> = args
        .scenes
        .iter()
        .map(|path| Input::load(path, &values, None))
        .collect::<Result<_, _>>()?;
    let all_inputs: Vec<&Path> = inputs.iter().flat_map(Input::files).collect();
    files::check_distinct(&outputs, &all_inputs)?;
    let progress = Progress::new(&args.progress);
    with_engine(&args.device, |engine| {
        let report = Report {
            device: engine.name(),
            driver: engine.driver(),
            cpu: cpu(),
            version: env!("CARGO_PKG_VERSION"),
            commit: option_env!("POINTILLIST_COMMIT"),
            runs: args.runs,
            rows: inputs
                .iter()
                .map(|input| measure(input, engine, args.runs, &progress))
                .collect::<Result<_, _>>()?,
        };
        if let Some(path) = &args.json {
            files::write_json(path, &report)?;
        }
        if let Some(path) = &args.markdown {
            files::write(path, &markdown(&report))?;
        }
        console::result(&table(&report))
    })
}

fn measure(input: &Input, engine: &Engine, runs: u32, progress: &Progress) -> Result<Row, Failure> {
    memory::require_picture(input.window(None)?, &[], 0)?;
    let sets = input.read_points(progress)?;
    let dropped = sets.iter().map(|set| set.non_finite).sum();
    let plan = input.plan(&sets, None, progress)?;
    drop(sets);
    let mut built = engine.build(&plan, progress)?;
    let mut frame = built.frame(&plan, progress)?;
    let pixels = pixel_hash(&frame.film);
    let (mut trace, mut wall) = (Vec::new(), Vec::new());
    for _ in 0..runs {
        frame = built.frame(&plan, progress)?;
        trace.push(frame.trace);
        wall.push(frame.wall);
        if pixel_hash(&frame.film) != pixels {
            progress.note(&format!(
                "warning: {}: two frames of the same scene differ, which is a bug of the device \
                 or of pointillist; please report it",
                input.path.display()
            ));
        }
    }
    Ok(Row::new(&Measured {
        name: input.name(),
        engine,
        plan: &plan,
        built: &built,
        frame: &frame,
        trace: &trace,
        wall: &wall,
        dropped,
    }))
}

const COLUMNS: [&str; 8] =
    ["scene", "points", "trace ms", "min", "max", "build ms", "tests/ray", "passes"];

fn cells(row: &Row) -> [String; 8] {
    [
        row.name.clone(),
        row.points.to_string(),
        format!("{:.1}", row.trace_ms.median),
        format!("{:.1}", row.trace_ms.min),
        format!("{:.1}", row.trace_ms.max),
        format!("{:.1}", row.build_ms.median),
        format!("{:.1}", row.tests_per_ray),
        row.passes.to_string(),
    ]
}

fn heading(report: &Report) -> String {
    let driver = match report.driver.as_str() {
        "" => String::new(),
        driver => format!(", {driver}"),
    };
    let commit = report.commit.map_or_else(String::new, |commit| format!(", commit {commit}"));
    format!(
        "{}{driver}; {}; pointillist {}{commit}; {} runs after one to warm up",
        report.device, report.cpu, report.version, report.runs
    )
}

fn table(report: &Report) -> String {
    let rows: Vec<[String; 8]> = report.rows.iter().map(cells).collect();
    let widths: Vec<usize> = COLUMNS
        .iter()
        .enumerate()
        .map(|(column, title)| {
            let longest = rows.iter().map(|row| row[column].chars().count()).max();
            title.len().max(longest.unwrap_or(0))
        })
        .collect();
    let mut text = format!("{}\n", heading(report));
    let titles = COLUMNS.map(str::to_owned);
    for row in std::iter::once(&titles).chain(&rows) {
        let mut line = format!("{:<width$}", row[0], width = widths[0]);
        for (cell, width) in row.iter().zip(&widths).skip(1) {
            // Writing to a string cannot fail; nor below.
            let _ = write!(line, "  {cell:>width$}");
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

fn markdown(report: &Report) -> String {
    let mut text = format!("{}\n\n| {} |\n", heading(report), COLUMNS.join(" | "));
    let _ = writeln!(text, "|---|{}", "---:|".repeat(COLUMNS.len() - 1));
    for row in &report.rows {
        let _ = writeln!(text, "| {} |", cells(row).join(" | ").replace('\n', " "));
    }
    text
}

/// The processor's name, or at least its architecture.
fn cpu() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find_map(|line| {
        let (key, value) = line.split_once(':')?;
        (key.trim() == "model name").then(|| value.trim().to_owned())
    });
    model.unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}
