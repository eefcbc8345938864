//! Light from the background and from surface to surface against closed forms, on the device, and by the reference in f64.
//!
//! Neighbouring pixels share their numbers, and pictures of other seeds none: the mean error of each of [`SEEDS`] pictures is
//! one independent number, and their spread is the standard error. Errors must lie within three of those, and with 10⁶
//! samples in all, as `POINTILLIST_MORE_SAMPLES=16` has them, within 10⁻³ of what is expected.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "measured figures, for whoever asks with --nocapture")]

#[path = "light_everywhere/bits.rs"]
mod bits;
#[path = "light_everywhere/convergence.rs"]
mod convergence;
#[path = "light_everywhere/fog.rs"]
mod fog;
#[path = "light_everywhere/furnaces.rs"]
mod furnaces;
#[path = "light_everywhere/lamps.rs"]
mod lamps;
#[path = "light_everywhere/plates.rs"]
mod plates;
#[path = "light_everywhere/skies.rs"]
mod skies;

use film::{Film, Image};
use harness::analytic::{V3, View, add};
use harness::{Bench, fibonacci_sphere, moved, plan_with, set_of};
use plan::{Plan, SceneImages};
use points::{PointSet, Unwatched};
use reference::Reference;
use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

/// A level square lattice, `half` to each side of the axis.
fn lattice(half: f64, spacing: f64, y: f64) -> Vec<V3> {
    let side = (half / spacing).round() as i32;
    let at = |i: i32| f64::from(i) * spacing;
    (-side..=side).flat_map(|i| (-side..=side).map(move |j| [at(i), y, at(j)])).collect()
}

fn plan(text: &str, sets: &[PointSet], environment: Option<&Arc<Image>>) -> Plan {
    plan_with(text, sets, &SceneImages { environment: environment.cloned(), textures: Vec::new() })
}

/// The picture by the reference in f64.
fn in_f64(plan: &Plan) -> Film {
    let reference = Reference::<f64>::new(plan, &Unwatched).expect("nobody interrupts");
    reference.frame(plan, &Unwatched).expect("nobody interrupts").finish()
}

/// How many times as many samples the tests are to take: `POINTILLIST_MORE_SAMPLES`.
fn more_samples() -> u32 {
    let more = std::env::var("POINTILLIST_MORE_SAMPLES").ok();
    more.map_or(1, |more| more.parse().expect("POINTILLIST_MORE_SAMPLES is a number"))
}

/// Gives a plan so many samples and a seed, as its scene would.
fn sample(plan: &mut Plan, samples: u32, seed: u32) {
    plan.samples = samples;
    (plan.wave.seed, plan.camera.seed) = (seed, seed);
}

/// Both pictures of a plan, which are named.
fn pictures(plan: &Plan) -> [(&'static str, Film); 2] {
    [("device", Bench::open().render(plan).film), ("f64", in_f64(plan))]
}

/// The mean over pixels of what is found over what is expected, less one, where something is expected; and how many are.
fn off(film: &Film, expected: impl Fn(usize) -> Option<V3>) -> (f64, usize) {
    let (mut sum, mut pixels) = (0.0, 0);
    for (pixel, color) in film.color.iter().enumerate() {
        let Some(expected) = expected(pixel) else { continue };
        // Channels share their numbers: one value a pixel.
        sum += (0..3).map(|i| f64::from(color[i]) / expected[i] - 1.0).sum::<f64>() / 3.0;
        pixels += 1;
    }
    (sum / f64::from(pixels), pixels as usize)
}

/// Pictures that share no number.
const SEEDS: u32 = 16;

/// The mean of values that are independent, and its standard error.
fn mean_and_error(values: &[f64]) -> [f64; 2] {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
    [mean, (square / count).sqrt()]
}

/// Checks a plan's pictures in f64, whose samples are divided among [`SEEDS`]; and that the device's picture of the first is
/// the same in the mean. What is expected may itself have a relative standard error. `floor` is for what points are off by, not
/// chance.
fn check_within(
    name: &str,
    plan: &Plan,
    (floor, error_of_expected): (f64, f64),
    expected: impl Fn(usize) -> Option<V3>,
) {
    let mut plan = plan.clone();
    // A picture of one sample would have none that is random.
    let samples = (plan.samples * more_samples() / SEEDS).max(2);
    sample(&mut plan, samples, 0);
    let reference = Reference::<f64>::new(&plan, &Unwatched).expect("nobody interrupts");
    let mut pixels = 0;
    let means: Vec<f64> = (0..SEEDS)
        .map(|seed| {
            sample(&mut plan, samples, seed);
            let film = reference.frame(&plan, &Unwatched).expect("nobody interrupts").finish();
            let (mean, count) = off(&film, &expected);
            pixels = count;
            mean
        })
        .collect();
    let [mean, error] = mean_and_error(&means);
    let error = error.hypot(error_of_expected);
    sample(&mut plan, samples, 0);
    let (on_device, _) = off(&Bench::open().render(&plan).film, &expected);
    let apart = on_device - means[0];
    let samples = pixels * (samples * SEEDS) as usize;
    println!(
        "{name}: {samples} samples, off by {mean:.2e}, standard error {error:.2e}; device {apart:.1e} from f64"
    );
    assert!(pixels >= 200, "{name}: {pixels} pixels");
    assert!(mean.abs() <= 3.0 * error + floor, "{name}: off by {mean:e}, standard error {error:e}");
    assert!(samples < 1_000_000 || mean.abs() < 1e-3, "{name}: off by {mean:e}");
    // Rays that pass an edge on the other side by a rounding change what they bring, one in 10⁵.
    assert!(apart.abs() < 1e-4, "{name}: device {apart:e} from f64");
}

fn check(name: &str, plan: &Plan, floor: f64, expected: impl Fn(usize) -> Option<V3>) {
    check_within(name, plan, (floor, 0.0), expected);
}

/// Where the line of sight through a pixel meets a level.
fn on_level(view: &View, pixel: usize, level: f64) -> Option<V3> {
    let d = view.through(pixel);
    let t = (level - view.eye[1]) / d[1];
    (t > 0.0 && t < 1e9).then(|| add(view.eye, d, t))
}

/// A matt ball of unit radius about the origin, seen within its outline.
fn ball(pixel: usize, view: &View) -> bool {
    view.distance(pixel, [0.0; 3]) < 0.97
}
