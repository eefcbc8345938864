//! `info`: what is in a point file, in a scene and the point files it names, or in a picture.

use crate::args::{InfoArgs, ViewArgs};
use crate::commands::info_picture;
use crate::console;
use crate::errors::Failure;
use crate::input::{self, Input, SceneValues};
use crate::point_file::can_be_read_again;
use crate::progress::Progress;
use plan::Plan;
use points::{Dimension, NoiseReport, PointSet, PointSummary, ReadOptions, Wanted, Watch};
use scene::{Light, Projection, Scene};
use serde_json::{Value, json};
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::sync::Arc;

/// Points that are held at once, about 80 bytes each, to see whether they fill a volume, and what noise they have.
const JUDGED: u64 = 2_000_000;

/// Prints what is there.
pub fn run(args: &InfoArgs) -> Result<(), Failure> {
    let progress = Progress::new(&args.progress);
    if args.columns.is_some() {
        if input::is_toml(&args.file) {
            return Err(input::columns_of_scene(&args.file));
        }
        if info_picture::is_picture(&args.file) {
            return Err(Failure::usage(format!(
                "{}: --columns is for point files, but this is a picture; leave it out",
                args.file.display()
            )));
        }
    }
    if args.scene {
        if input::is_toml(&args.file) || !info_picture::is_picture(&args.file) {
            return Err(Failure::usage(format!(
                "{}: --scene prints the scene of an EXR, but this is none; leave it out",
                args.file.display()
            )));
        }
        return console::result(&input::scene_of_picture(&args.file)?);
    }
    let text = if input::is_toml(&args.file) {
        of_scene(args, &progress)?
    } else if info_picture::is_picture(&args.file) {
        info_picture::of(&args.file, args.json)?
    } else {
        let columns = args.columns.clone().unwrap_or_default();
        let options = ReadOptions { columns, ..ReadOptions::default() };
        let mut summary = points::summarize(&args.file, &options, &progress)?;
        progress.clear();
        if let Some(set) = held_set(&args.file, options, summary.points, &progress)? {
            judge(&mut summary, &set, &progress);
        }
        summary.notes.extend(input::looks_like_degrees(&summary.units, 0));
        input::note_points(&args.file, &summary.notes, summary.dropped, summary.points, &progress);
        if args.json { pretty(&summary.to_json()) } else { format!("{summary}\n") }
    };
    progress.clear();
    progress.result_object(&format!("{}: read", args.file.display()), Value::Null);
    drop(progress);
    console::result(&text)
}

/// The points of a file, where it can be read once more and they are not too many to be held.
fn held_set(
    file: &Path,
    options: ReadOptions,
    points: u64,
    progress: &Progress,
) -> Result<Option<PointSet>, Failure> {
    if points > JUDGED || !can_be_read_again(file) {
        return Ok(None);
    }
    progress.stage("looking for volumes", fs::metadata(file).map_or(0, |file| file.len()));
    let wanted = Wanted::Some { colors: false, normals: false, attributes: Vec::new() };
    let options = ReadOptions { wanted, ..options };
    let set = points::read_with(file, &options, &mut |done, _| progress.done(done))?;
    Ok(Some(set))
}

/// What points fill, and what noise those of surfaces have.
fn judge(summary: &mut PointSummary, set: &PointSet, progress: &Progress) {
    let dimension = Dimension::of(set);
    progress.stage("measuring noise", 1);
    summary.noise = if dimension.is_volume() { None } else { NoiseReport::of(set) };
    summary.dimension = Some(dimension);
    progress.clear();
}

fn of_scene(args: &InfoArgs, progress: &Progress) -> Result<String, Failure> {
    let values = SceneValues::default().below(args.root.as_deref());
    let input = Input::load(&args.file, &values, &ViewArgs::default())?;
    let sets = input.read_all(progress)?;
    let plan = input.plan(&sets, None, progress)?;
    let mut summaries: Vec<Arc<PointSummary>> = Vec::new();
    for (index, set) in sets.iter().enumerate() {
        // A file that several objects use is summarised once.
        let known = sets[..index].iter().position(|earlier| Arc::ptr_eq(earlier, set));
        let summary = match known {
            Some(earlier) => Arc::clone(&summaries[earlier]),
            None => Arc::new(summarize(set, progress)),
        };
        summaries.push(summary);
    }
    Ok(if args.json {
        pretty(&scene_json(&input.scene, &plan, &summaries))
    } else {
        scene_text(&input.scene, &plan, &summaries)
    })
}

fn summarize(set: &PointSet, progress: &Progress) -> PointSummary {
    progress.stage("measuring the spacing", 1);
    let mut summary = PointSummary::of(set);
    judge(&mut summary, set, progress);
    summary.notes.extend(input::looks_like_degrees(&summary.units, 0));
    progress.clear();
    summary
}

fn scene_json(scene: &Scene, plan: &Plan, summaries: &[Arc<PointSummary>]) -> Value {
    let objects: Vec<Value> = (scene.objects.iter().zip(summaries))
        .map(|(object, summary)| {
            json!({
                "name": object.name,
                "file": object.points_as_written,
                "points": summary.to_json(),
            })
        })
        .collect();
    let camera = scene.camera.whole().map(|camera| {
        let mut fields = json!({
            "eye": camera.eye,
            "target": camera.target,
            "up": camera.up,
            "aperture": camera.aperture,
        });
        match camera.projection {
            Projection::Perspective { vertical_fov } => {
                fields["vertical_fov"] = json!(vertical_fov)
            }
            Projection::Orthographic { height } => fields["height"] = json!(height),
        }
        fields
    });
    let [min, max] = plan.cloud.bounds;
    json!({
        "format": "scene file",
        "image": { "size": scene.image.size, "samples": scene.image.samples },
        "camera": camera,
        "lights": scene.lights.len(),
        "points": plan.point_count,
        "bounds": { "min": min, "max": max },
        "origin": plan.cloud.origin,
        "projection": plan.projection.map(|projection| projection.to_string()),
        "objects": objects,
        "settings": scene.settings_toml(),
    })
}

fn scene_text(scene: &Scene, plan: &Plan, summaries: &[Arc<PointSummary>]) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_scene(&mut text, scene, plan, summaries);
    text
}

fn write_scene(
    text: &mut String,
    scene: &Scene,
    plan: &Plan,
    summaries: &[Arc<PointSummary>],
) -> std::fmt::Result {
    let corner = |[x, y, z]: [f64; 3]| format!("{x} {y} {z}");
    let [width, height] = scene.image.size;
    writeln!(text, "image    {width}x{height}, samples {}", scene.image.samples)?;
    match scene.camera.whole() {
        Some(camera) => writeln!(
            text,
            "camera   at {}, towards {}, {}",
            corner(camera.eye),
            corner(camera.target),
            match camera.projection {
                Projection::Perspective { vertical_fov } => format!("{vertical_fov} degrees"),
                Projection::Orthographic { height } => format!("orthographic, {height} high"),
            }
        )?,
        None => writeln!(text, "camera   framed on the scene")?,
    }
    let directional =
        scene.lights.iter().filter(|light| matches!(light, Light::Directional { .. })).count();
    let headlights =
        scene.lights.iter().filter(|light| matches!(light, Light::Headlight { .. })).count();
    let point = scene.lights.len() - directional - headlights;
    writeln!(text, "lights   {directional} directional, {point} point, {headlights} in the eye")?;
    writeln!(text, "points   {}", plan.point_count)?;
    writeln!(text, "min      {}", corner(plan.cloud.bounds[0]))?;
    writeln!(text, "max      {}", corner(plan.cloud.bounds[1]))?;
    writeln!(text, "origin   {} (subtracted before 32-bit arithmetic)", corner(plan.cloud.origin))?;
    if let Some(projection) = plan.projection {
        writeln!(text, "metres   {projection}")?;
    }
    for ((object, summary), index) in scene.objects.iter().zip(summaries).zip(0..) {
        writeln!(text, "\nobject {index} '{}', {}", object.name, object.points.display())?;
        for line in summary.to_string().lines() {
            writeln!(text, "  {line}")?;
        }
    }
    Ok(())
}

fn pretty(value: &Value) -> String {
    format!("{value:#}\n")
}
