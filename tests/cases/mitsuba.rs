//! Light from surface to surface against an independent renderer, Mitsuba 3, which has spheres where points are here.
//!
//! `POINTILLIST_MITSUBA` names a Python that has it; without one the test says `SKIPPED`.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use film::{Image, Texels};
use harness::analytic::{V3, View, dot, environment_of, unit};
use harness::{Bench, fibonacci_sphere, plan_with, said, set_of};
use plan::SceneImages;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

const VIEW: View =
    View { eye: [0.4, 2.6, 6.0], target: [0.0, 0.7, 0.0], fov: 36.0, size: [160, 120] };
const ROWS: u32 = 512;
/// Of a picture, on both sides.
const SAMPLES: u32 = 512;
/// The plane reaches so far from its middle to each side.
const HALF: f64 = 5.0;
/// Side of the blocks of pixels whose means are compared.
const BLOCK: usize = 8;

struct Ball {
    middle: V3,
    radius: f64,
    /// Of glass, where it has none.
    albedo: Option<V3>,
}

const BALLS: [Ball; 4] = [
    Ball { middle: [-1.5, 1.02, -0.4], radius: 1.0, albedo: Some([0.7, 0.25, 0.15]) },
    Ball { middle: [0.45, 0.82, 0.6], radius: 0.8, albedo: None },
    Ball { middle: [1.9, 0.92, -0.7], radius: 0.9, albedo: Some([0.2, 0.45, 0.75]) },
    Ball { middle: [-0.6, 0.37, 1.6], radius: 0.35, albedo: Some([0.9, 0.9, 0.9]) },
];
const PLANE: V3 = [0.6, 0.6, 0.55];

/// A sky that changes slowly, with a sun 20 degrees wide, whose edge is 2 degrees soft.
fn sky() -> Arc<Image> {
    let sun = unit([-0.5, 0.75, 0.55]);
    Arc::new(environment_of(ROWS, |d| {
        let angle = dot(d, sun).clamp(-1.0, 1.0).acos().to_degrees();
        let edge = ((11.0 - angle) / 2.0).clamp(0.0, 1.0);
        let shine = 14.0 * edge * edge * (3.0 - 2.0 * edge);
        let up = 0.5 + 0.5 * d[1];
        [
            0.35 + 0.25 * up + shine,
            0.4 + 0.35 * up + 0.95 * shine,
            0.45 + 0.55 * up - 0.1 * d[0] + 0.85 * shine,
        ]
    }))
}

fn ours(image: &Arc<Image>) -> Vec<V3> {
    let mut text = format!(
        "{}samples = {SAMPLES}\nfilter = \"box\"\n[render]\nintegrator = \"path\"\nfresnel = \"sample\"\n\
         max_bounces = 1024\n[background]\nenvironment = \"sky.exr\"\n\
         [[objects]]\npoints = \"plane.ply\"\nmaterial = {{ albedo = {PLANE:?} }}\n",
        VIEW.text()
    );
    let at = |i: u32| f64::from(i) * HALF / 100.0 - HALF;
    let mut sets = vec![set_of((0..201 * 201).map(|i| [at(i % 201), 0.0, at(i / 201)]).collect())];
    for Ball { middle, radius, albedo } in &BALLS {
        let material = match albedo {
            Some(albedo) => format!("albedo = {albedo:?}"),
            None => "kind = \"glass\", ior = 1.5".to_owned(),
        };
        text += &format!(
            "[[objects]]\npoints = \"ball.ply\"\ntransform = {{ translate = {middle:?}, scale = {radius} }}\n\
             material = {{ {material} }}\n"
        );
        sets.push(set_of(fibonacci_sphere(40_000)));
    }
    let images = SceneImages { environment: Some(Arc::clone(image)), textures: Vec::new() };
    let film = Bench::open().render(&plan_with(&text, &sets, &images)).film;
    film.color.iter().map(|c| [c[0], c[1], c[2]].map(f64::from)).collect()
}

fn theirs(python: &Path, image: &Image) -> Vec<V3> {
    let folder = tempfile::tempdir().expect("a folder");
    let [scene, sky, out] =
        ["scene.json", "sky.raw", "out.raw"].map(|name| folder.path().join(name));
    let Texels::Linear(texels) = &image.texels else { panic!("an image of bytes") };
    let bytes: &[u8] = bytemuck::cast_slice(texels.as_slice());
    std::fs::write(&sky, bytes).expect("a file");
    let balls: Vec<String> = (BALLS.iter())
        .map(|Ball { middle, radius, albedo }| {
            let material = match albedo {
                Some(albedo) => format!("\"kind\": \"diffuse\", \"albedo\": {albedo:?}"),
                None => "\"kind\": \"glass\", \"ior\": 1.5".to_owned(),
            };
            format!(
                "{{\"middle\": {middle:?}, \"radius\": {radius}, \"material\": {{{material}}}}}"
            )
        })
        .collect();
    let View { eye, target, fov, size } = VIEW;
    let text = format!(
        "{{\"eye\": {eye:?}, \"target\": {target:?}, \"fov\": {fov}, \"size\": {size:?}, \"samples\": {SAMPLES},\n\
         \"seed\": 7, \"environment\": {sky:?}, \"environment_rows\": {ROWS}, \"half\": {HALF},\n\
         \"plane\": {{\"kind\": \"diffuse\", \"albedo\": {PLANE:?}}}, \"balls\": [{}]}}",
        balls.join(", ")
    );
    std::fs::write(&scene, text).expect("a file");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tools/compare-with-mitsuba");
    let run =
        Command::new(python).arg(script).arg(&scene).arg(&out).output().expect("python starts");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let bytes = std::fs::read(&out).expect("the picture");
    let values: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes);
    values.chunks(3).map(|c| [c[0], c[1], c[2]].map(f64::from)).collect()
}

/// Means of blocks, row by row.
fn blocks(pixels: &[V3]) -> Vec<f64> {
    let [width, height] = VIEW.size;
    let mut sums = vec![0.0; width / BLOCK * (height / BLOCK)];
    for (at, color) in pixels.iter().enumerate() {
        let block = at / width / BLOCK * (width / BLOCK) + at % width / BLOCK;
        sums[block] += (color[0] + color[1] + color[2]) / (3 * BLOCK * BLOCK) as f64;
    }
    sums
}

/// The root of the mean of the squares of errors, each over the mean of both.
fn error(a: &[f64], b: &[f64], counts: impl Fn(usize) -> bool) -> f64 {
    let squares: Vec<f64> = (a.iter().zip(b).enumerate())
        .filter(|&(at, _)| counts(at))
        .map(|(_, (a, b))| ((a - b) / (0.5 * (a + b))).powi(2))
        .collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// Both have noise, of some tenths of a percent of a block; the balls of 40 000 points are spheres to 1e-6. What is seen
/// past everything has neither: that differs by how the environment is looked up, half a texel at the poles.
#[test]
fn balls_on_a_plane_are_mitsubas() {
    let Some(python) = std::env::var_os("POINTILLIST_MITSUBA").map(PathBuf::from) else {
        return said(
            "SKIPPED: balls_on_a_plane_are_mitsubas: POINTILLIST_MITSUBA names no Python with mitsuba",
        );
    };
    let image = sky();
    let (ours, theirs) = (ours(&image), theirs(&python, &image));
    assert_eq!(ours.len(), theirs.len(), "pixels");
    let (here, there) = (blocks(&ours), blocks(&theirs));
    let columns = VIEW.size[0] / BLOCK;
    let all = error(&here, &there, |_| true);
    let behind = error(&here, &there, |at| at < columns);
    said(&format!(
        "mitsuba: relative RMSE of blocks {:.3} %, of the sky {:.3} %",
        100.0 * all,
        100.0 * behind
    ));
    if let Some(folder) = std::env::var_os("POINTILLIST_MITSUBA_TO").map(PathBuf::from) {
        for (name, pixels) in [("ours", &ours), ("theirs", &theirs)] {
            let values: Vec<f32> = pixels.as_flattened().iter().map(|&x| x as f32).collect();
            let bytes: &[u8] = bytemuck::cast_slice(&values);
            std::fs::write(folder.join(name).with_extension("raw"), bytes).expect("a file");
        }
    }
    assert!(behind < 2e-3, "the sky: {behind}");
    assert!(all <= 0.015, "{all}");
}
