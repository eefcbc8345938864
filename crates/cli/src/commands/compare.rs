//! `compare`: how far two pictures are apart, and whether that is too far.

use crate::args::CompareArgs;
use crate::commands::compare_report::{Measured, Report, SeenFlip};
use crate::errors::{Exit, Failure};
use crate::log::{self, Level};
use crate::{console, files, interrupt, memory};
use compare::{AttributeDifference, FalseColor, Measures, Pair, Picture, Rect, Tally};
use film::FileFormat;
use serde_json::json;
use std::collections::HashMap;
use std::path::Path;

/// Pixels of pictures of which FLIP is computed without being asked for: it takes longer than all the rest.
const LARGEST_WITH_FLIP: usize = 1 << 21;

/// Compares, writes pictures of the differences, and says what was found.
pub fn run(args: &CompareArgs) -> Result<Exit, Failure> {
    check_diffs(args)?;
    memory::require_pictures(&[&args.a, &args.b])?;
    let [name_a, name_b] = [&args.a, &args.b].map(|path| path.display().to_string());
    let not_comparable =
        |error: compare::CompareError| Failure::usage(format!("{name_a} and {name_b}: {error}"));
    let pair = read_pair(args)?.map_err(not_comparable)?;
    let channels = pair.selected(&args.channels).map_err(not_comparable)?;
    let tallies = channels
        .iter()
        .map(|&channel| Ok((channel, pair.tally(channel, pair.region(&[channel])?))))
        .collect::<Result<HashMap<&str, Tally<'_>>, _>>()
        .map_err(not_comparable)?;

    let measured = |name: &str, channels: &[&str]| {
        let region = pair.region(channels)?;
        let known: Option<Vec<&Tally<'_>>> = (channels.iter())
            .map(|channel| tallies.get(channel).filter(|tally| tally.region() == region))
            .collect();
        let measures = match known {
            Some(tallies) => Measures::of(&tallies),
            None => pair.measure(channels, region),
        };
        Ok(Measured { name: name.to_owned(), region, measures })
    };
    let mut report = Report {
        names: [name_a.clone(), name_b.clone()],
        size: pair.a().size,
        srgb: pair.is_srgb(),
        channels: (channels.iter().map(|name| measured(name, &[name])).collect::<Result<_, _>>())
            .map_err(not_comparable)?,
        layers: layers(&channels)
            .into_iter()
            .map(|(layer, channels)| measured(layer, &channels))
            .collect::<Result<_, _>>()
            .map_err(not_comparable)?,
        flip: None,
        flip_why: None,
        unmatched: pair.unmatched().map(|names| names.into_iter().map(str::to_owned).collect()),
        differing: differing(&pair),
        list_headers: args.headers,
        over: Vec::new(),
    };
    match seen_flip(&pair, &channels, &tallies, args).map_err(not_comparable)? {
        Ok(seen) => report.flip = Some(seen),
        Err(why) => report.flip_why = Some(why),
    }
    if args.flip.is_some() && report.flip.is_none() {
        return Err(Failure::usage(format!(
            "{name_a} and {name_b}: --flip needs the channels R, G and B, found {}; leave --flip out \
             or name RGB in --channels",
            channels.join(", ")
        )));
    }
    report.over = over(args, &report);
    for diff in &args.diffs {
        write_diff(diff, args, &pair, &channels, report.flip.as_ref())
            .map_err(not_comparable)??;
    }
    let exit = if report.over.is_empty() { Exit::Done } else { Exit::Difference };
    if log::is_json() {
        let found = match report.over.len() {
            0 => "within the limits, or none given".to_owned(),
            count => format!("over {count} of the limits"),
        };
        let fields = json!({
            "outputs": args.diffs.iter().map(|diff| diff.display().to_string()).collect::<Vec<_>>(),
            "over": report.over,
            "exit": exit.code(),
        });
        console::say(Level::Info, "result", &format!("{name_a} and {name_b}: {found}"), fields);
    }
    console::result(&if args.json { report.json(args) } else { report.text(args) })?;
    Ok(exit)
}

/// Whatever can be known of the outputs before the pictures are read.
fn check_diffs(args: &CompareArgs) -> Result<(), Failure> {
    let diffs: Vec<&Path> = args.diffs.iter().map(|path| path.as_path()).collect();
    for diff in &diffs {
        if !matches!(FileFormat::from_path(diff), Ok(FileFormat::Exr | FileFormat::Png)) {
            return Err(Failure::usage(format!(
                "{}: expected the extension '.png' or '.exr' for a picture of differences; rename the \
                 output",
                diff.display()
            )));
        }
        files::check_output(diff)?;
    }
    files::check_distinct(&diffs, &[&args.a, &args.b])
}

fn require_header(path: &Path, picture: &Picture) -> Result<(), Failure> {
    if picture.headers.is_empty() {
        return Err(Failure::usage(format!(
            "{}: --headers is for OpenEXR files, found another; leave --headers out",
            path.display()
        )));
    }
    Ok(())
}

/// What differs in two headers, where there are two.
fn differing(pair: &Pair) -> Vec<AttributeDifference> {
    let [a, b] = [&pair.a().headers, &pair.b().headers];
    if a.is_empty() || b.is_empty() { Vec::new() } else { compare::differing_attributes(a, b) }
}

/// Layers of more than one channel, each with its channels.
fn layers<'a>(channels: &[&'a str]) -> Vec<(&'a str, Vec<&'a str>)> {
    let mut layers: Vec<(&str, Vec<&str>)> = Vec::new();
    for &channel in channels {
        let Some(layer) = compare::layer_of(channel) else { continue };
        match layers.iter_mut().find(|(name, _)| *name == layer) {
            Some((_, members)) => members.push(channel),
            None => layers.push((layer, vec![channel])),
        }
    }
    layers.retain(|(_, members)| members.len() > 1);
    layers
}

/// Both pictures, one over the other. Files of the same bytes are read once. The outer error is of the files, the
/// inner of the pictures.
fn read_pair(args: &CompareArgs) -> Result<Result<Pair, compare::CompareError>, Failure> {
    if files::same_bytes(&args.a, &args.b) {
        let picture = Picture::read(&args.a)?;
        if args.headers {
            require_header(&args.a, &picture)?;
        }
        return Ok(Pair::same(picture));
    }
    let [a, b] = Picture::read_both([&args.a, &args.b])?;
    if args.headers {
        require_header(&args.a, &a)?;
        require_header(&args.b, &b)?;
    }
    Ok(Pair::new(a, b))
}

/// FLIP of the colours among the channels, or else why there is none and how to have it.
fn seen_flip(
    pair: &Pair,
    channels: &[&str],
    tallies: &HashMap<&str, Tally<'_>>,
    args: &CompareArgs,
) -> Result<Result<SeenFlip, String>, compare::CompareError> {
    if args.no_flip {
        return Ok(Err("left out".to_owned()));
    }
    let Some(colors) = pair.colors(channels) else {
        return Ok(Err("none, since R, G and B are not among the channels".to_owned()));
    };
    let region = pair.region(&colors.each_ref().map(String::as_str))?;
    let known = |name: &String| tallies.get(name.as_str());
    let equal = |tally: &Tally<'_>| tally.region() == region && tally.is_equal();
    let is_equal = colors.iter().all(|name| known(name).is_some_and(equal));
    if region.pixels() > LARGEST_WITH_FLIP && args.flip.is_none() && !is_equal {
        return Ok(Err(format!(
            "left out of {}x{} pixels, which is over 2 megapixels; --flip after the names computes it",
            region.width, region.height
        )));
    }
    let (flip, on_screen) = pair.flip(&colors, region);
    Ok(Ok(SeenFlip { colors, region, flip, on_screen }))
}

/// What is over which limit, one line each.
fn over(args: &CompareArgs, report: &Report) -> Vec<String> {
    let mut over = Vec::new();
    let limited = [args.max_abs, args.rmse, args.flip_limit()].iter().any(Option::is_some);
    for Measured { name, measures, .. } in &report.channels {
        let Measures { max_abs, rmse, nan, .. } = measures;
        let place = format!("first at {},{}", measures.worst.x, measures.worst.y);
        if limited && *nan > 0 {
            let are = if *nan == 1 { "pixel is" } else { "pixels are" };
            over.push(format!("{name}: {nan} {are} NaN in only one of the files, {place}"));
        }
        let limits = [
            ("largest difference", max_abs, args.max_abs, "--max-abs"),
            ("RMSE", rmse, args.rmse, "--rmse"),
        ];
        for (what, found, limit, option) in limits {
            if let Some(limit) = limit.filter(|limit| found > limit) {
                let place =
                    if option == "--max-abs" { format!(", {place}") } else { String::new() };
                over.push(format!(
                    "{name}: the {what} {found:?} is over {option} {limit:?}{place}"
                ));
            }
        }
    }
    if let (Some(limit), Some(seen)) = (args.flip_limit(), &report.flip)
        && seen.flip.mean > limit
    {
        over.push(format!("FLIP: the mean {:?} is over --flip {limit:?}", seen.flip.mean));
    }
    if args.headers && !report.differing.is_empty() {
        over.push(format!("headers: {} attributes differ", report.differing.len()));
    }
    over
}

/// Writes a picture of the differences. The outer error is of the pictures, the inner of the file.
fn write_diff(
    path: &Path,
    args: &CompareArgs,
    pair: &Pair,
    channels: &[&str],
    seen: Option<&SeenFlip>,
) -> Result<Result<(), Failure>, compare::CompareError> {
    let colors = pair.colors(channels);
    let colors: Option<Vec<&str>> =
        colors.as_ref().map(|names| names.iter().map(String::as_str).collect());
    Ok(match FileFormat::from_path(path) {
        Ok(FileFormat::Png) => {
            let shown = colors.as_deref().unwrap_or(channels);
            let region = pair.region(shown)?;
            let FalseColor { pixels, scale } = FalseColor::of(pair, shown, region, args.max_abs);
            console::note(&format!(
                "{}: the largest difference of {}: black is 0, pale yellow {scale} and more, cyan \
                 infinite or NaN in only one of the files",
                path.display(),
                shown.join(", ")
            ));
            let size = [region.width as u32, region.height as u32];
            interrupt::writing(|| Ok(film::write_png(size, &pixels, path)?))
        }
        _ => {
            let region = pair.region(channels)?;
            let mut planes = pair.differences(channels, region);
            let free = !channels.contains(&"flip");
            if let Some(seen) = seen.filter(|seen| seen.region == region && free) {
                planes.push(("flip".to_owned(), seen.flip.map.clone()));
            }
            write_planes(path, pair.a().size, region, planes)
        }
    })
}

fn write_planes(
    path: &Path,
    size: [u32; 2],
    region: Rect,
    planes: Vec<(String, Vec<f32>)>,
) -> Result<(), Failure> {
    let origin = [region.x as i32, region.y as i32];
    let extent = [region.width as u32, region.height as u32];
    interrupt::writing(|| Ok(film::write_planes(size, origin, extent, planes, path)?))
}
