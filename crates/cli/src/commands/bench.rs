//! `bench`: how long frames take, on one engine, case after case.

use crate::args::BenchArgs;
use crate::bench::cases::{Case, Cases};
use crate::bench::changes::Earlier;
use crate::bench::measure::measure;
use crate::bench::report::{Report, Skipped};
use crate::bench::suites::{self, Asked, Suites};
use crate::bench::{plot, table};
use crate::engine::{Engine, with_engine};
use crate::errors::{Exit, Failure};
use crate::input::check_preset;
use crate::progress::Progress;
use crate::source::PIPE;
use crate::stats::{Beside, PreparedOver, Row};
use crate::{console, files, interrupt};
use film::Film;
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Times all that was asked for. Whatever can be checked is checked before.
pub fn run(args: &BenchArgs) -> Result<Exit, Failure> {
    if args.list {
        let text = if args.scenes.is_empty() { list() } else { list_rows(&args.scenes)? };
        return console::result(&text).map(|()| Exit::Done);
    }
    if args.scenes.iter().any(|scene| scene == Path::new(PIPE)) {
        return Err(Failure::usage(
            "-: bench reads nothing from stdin, since it renders each row several times; name a file",
        ));
    }
    check_preset(args.overrides.preset.as_deref(), &args.overrides.set)?;
    let outputs: Vec<&Path> = args
        .json
        .iter()
        .chain(&args.markdown)
        .chain(&args.plot)
        .map(|path| path.as_path())
        .collect();
    for output in &outputs {
        files::check_output(output)?;
    }
    args.plot.as_deref().map_or(Ok(()), plot::check_path)?;
    let earlier = args.compare.as_deref().map(Earlier::read).transpose()?;
    let mut suites = Suites::default();
    let progress = Progress::new(&args.progress);
    let cases = Cases::new(args, &mut suites, &progress)?;
    earlier.as_ref().map_or(Ok(()), |earlier| earlier.require_any(cases.names()))?;
    let mut inputs: Vec<&Path> = cases.cases.iter().flat_map(|case| case.input.files()).collect();
    inputs.extend(cases.suites.iter().chain(&args.compare).map(|path| path.as_path()));
    files::check_distinct(&outputs, &inputs)?;

    let mut report = with_engine(&args.device, 0, &progress, |engine| {
        let mut report = Report::new(engine, args.runs);
        // Held, so that what was measured is shown before an interruption ends the process.
        let timed = interrupt::held(|| time_all(args, &cases, engine, &mut report, &progress));
        progress.clear();
        if let (Err(_), false) = (&timed, report.rows.is_empty()) {
            console::result(&table::text(&report))?;
        }
        timed.map(|()| report)
    })?;
    report.complete = true;
    report.comparison = earlier.map(|earlier| earlier.compare(&report, 0.01 * args.tolerance));
    write(args, &report)?;
    let outputs: Vec<String> = outputs.iter().map(|output| output.display().to_string()).collect();
    let (rows, skipped) = (report.rows.len(), report.skipped.len());
    progress.result_object(
        &format!("{rows} rows measured, {skipped} skipped"),
        json!({ "outputs": outputs, "device": report.device, "rows": rows, "skipped": skipped }),
    );
    console::result(&table::text(&report))?;
    match report.comparison {
        Some(comparison) if !comparison.pass => Ok(Exit::Difference),
        _ => Ok(Exit::Done),
    }
}

/// Times case after case. The files have each row as soon as it is measured: an interruption, a failure or a driver that
/// crashes costs no earlier one.
fn time_all(
    args: &BenchArgs,
    cases: &Cases,
    engine: &Engine,
    report: &mut Report,
    progress: &Progress,
) -> Result<(), Failure> {
    for skipped in &cases.skipped {
        skip(skipped.clone(), report, progress);
    }
    let mut last = None;
    for (case, number) in cases.cases.iter().zip(1..) {
        progress.task(&format!("{number}/{} {}", cases.cases.len(), case.name));
        let rows = report.rows.len();
        time(case, engine, args.cpu_preparation, (&mut *report, &mut last), progress)?;
        if report.rows.len() > rows {
            write(args, report)?;
        }
    }
    Ok(())
}

/// Adds one row; or, where a suite asks for more than the device or the machine has, says so.
fn time(
    case: &Case,
    engine: &Engine,
    on_cpu: bool,
    (report, last): (&mut Report, &mut Option<(String, Film)>),
    progress: &Progress,
) -> Result<(), Failure> {
    // The picture of the case before, for one that is shown beside it.
    let before = last.take();
    match (measure(case, engine, report.runs, on_cpu, progress), &case.suite) {
        (Ok((row, film)), _) => {
            let other = before.filter(|_| case.beside).and_then(|(name, film)| {
                let is_it = |row: &&Row| row.suite == case.suite && row.name == name;
                Some((report.rows.iter().rev().find(is_it)?, film))
            });
            let beside = other.map(|(other, it)| Beside::new((&row, &film), (other, &it)));
            *last = Some((case.name.clone(), film));
            let is_earlier =
                |other: &&Row| other.suite == case.suite && Some(&other.name) == case.over.as_ref();
            let earlier = report.rows.iter().find(is_earlier);
            let prepared_over = earlier.map(|earlier| PreparedOver::new(&row, earlier));
            report.rows.push(Row { prepared_over, beside, ..row });
        }
        (Err(Failure { exit: Exit::Exhausted, lines }), Some(suite)) => {
            let reason = format!("does not fit: {}", lines.join("; "));
            let skipped = Skipped { name: case.name.clone(), suite: suite.clone(), reason };
            skip(skipped, report, progress);
        }
        (Err(failure), Some(_)) if failure.exit != Exit::Interrupted => {
            return Err(failure.of(&case.name));
        }
        (Err(failure), _) => return Err(failure),
    }
    Ok(())
}

fn skip(skipped: Skipped, report: &mut Report, progress: &Progress) {
    progress.warn(&format!("skipped '{}': {}", skipped.name, skipped.reason));
    report.skipped.push(skipped);
}

/// Before anything is printed: a terminal that is gone must not cost the results.
fn write(args: &BenchArgs, report: &Report) -> Result<(), Failure> {
    if let Some(path) = &args.json {
        files::keep(path, &files::json(path, report)?)?;
    }
    if let Some(path) = &args.markdown {
        files::keep(path, &table::markdown(report))?;
    }
    if let Some(path) = &args.plot {
        files::keep(path, &plot::svg(report)?)?;
    }
    Ok(())
}

/// The rows of suites, each with its scene.
fn list_rows(asked: &[PathBuf]) -> Result<String, Failure> {
    let mut suites = Suites::default();
    let mut text = String::new();
    for asked in asked {
        let Asked::Suite(name, suite) = suites.find(asked)? else {
            return Err(Failure::usage(format!(
                "{}: --list lists the rows of suites, but this is a scene or a point file; name a suite",
                asked.display()
            )));
        };
        // Writing to a string cannot fail; nor below.
        let _ = writeln!(text, "{name}: {}", suite.about);
        let width = suite.rows.iter().map(|row| row.name.chars().count()).max().unwrap_or(0);
        for row in &suite.rows {
            let scene = suites.as_written(&row.scene.display().to_string());
            let _ = write!(text, "  {:<width$}  {scene}", row.name);
            for (what, numbers) in
                [("points", &row.point_counts), ("cells a pass", &row.cells_per_pass)]
            {
                let numbers: Vec<String> = numbers.iter().map(u32::to_string).collect();
                if !numbers.is_empty() {
                    let _ = write!(text, "; {what}: {}", numbers.join(", "));
                }
            }
            text.push('\n');
        }
    }
    Ok(text)
}

fn list() -> String {
    let suites = suites::known();
    let width = suites.iter().map(|suite| suite.0.chars().count()).max().unwrap_or(0);
    let mut text = String::new();
    for (name, about) in suites {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{name:<width$}  {about}");
    }
    text
}
