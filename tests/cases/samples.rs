//! Several samples a pixel: the same on device and twin, whatever the crop, and as even as they should
//! be.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use harness::{
    Bench, assert_same_bits, assert_same_film, fibonacci_sphere, plan_of, render_twin, set_of,
};
use plan::{Diagnostic, Plan, Window};

const LIGHTS: &str = "
[[lights]]
kind = \"directional\"
direction = [-0.4, -1.0, -0.3]
irradiance = [3.0, 2.9, 2.7]
angle = 20.0
[[lights]]
kind = \"point\"
position = [2.0, 1.0, 3.0]
intensity = [4.0, 5.0, 6.0]
radius = 0.5
[background]
color = [0.1, 0.2, 0.3]
";

fn sphere_plan(settings: &str) -> Plan {
    plan_of(&format!("{settings}\n{LIGHTS}"), &[set_of(fibonacci_sphere(4_000))])
}

#[test]
fn samples_are_the_same_to_the_bit() {
    let bench = Bench::open();
    for image in [
        "samples = 4",
        "samples = 4\nfilter = \"triangle\"",
        "samples = 3\nfilter = \"box\"\nfilter_width = 2.5",
        "samples = 5\ntransparent = true\n[render]\nseed = 77\ncells_per_pass = 2",
        "samples = 2\n[render]\nprimary = \"discs\"",
    ] {
        let mut plan = sphere_plan(&format!("[image]\nsize = [90, 61]\n{image}"));
        plan.diagnostics = Diagnostic::ALL.to_vec();
        assert_same_bits(image, &bench.render(&plan), &render_twin(&plan));
    }
}

/// A pixel's samples know of the pixel alone: parts of a picture are the picture's.
#[test]
fn a_crop_has_the_pixels_of_the_whole() {
    let whole = sphere_plan("[image]\nsize = [90, 60]\nsamples = 4");
    let mut crop = whole.clone();
    crop.window = Window { origin: [31, 7], size: [40, 35] };
    let (whole, crop) = (render_twin(&whole).film, render_twin(&crop).film);
    for y in 0..35 {
        for x in 0..40 {
            let (part, all) = (y * 40 + x, (y + 7) * 90 + x + 31);
            assert_eq!(crop.color[part], whole.color[all], "({x}, {y})");
            assert_eq!(crop.position[part], whole.position[all], "({x}, {y})");
        }
    }
}

#[test]
fn the_seed_changes_the_samples_and_one_sample_has_none() {
    let film = |samples: u32, seed: u32| {
        let settings =
            format!("[image]\nsize = [60, 40]\nsamples = {samples}\n[render]\nseed = {seed}");
        render_twin(&sphere_plan(&settings)).film
    };
    assert_same_film("one sample", &film(1, 1), &film(1, 2));
    assert_ne!(film(2, 1).color, film(2, 2).color);
}

/// How much of the pixel at (x, y) from the centre of a disc the disc covers, by strips of it.
fn covered(x: f64, y: f64, radius: f64) -> f64 {
    let strips = 2_000;
    let strip = |i: i32| {
        let across = x - 0.5 + (f64::from(i) + 0.5) / f64::from(strips);
        let half = (radius * radius - across * across).max(0.0).sqrt();
        ((y + 0.5).min(half) - (y - 0.5).max(-half)).max(0.0)
    };
    (0..strips).map(strip).sum::<f64>() / f64::from(strips)
}

/// A sphere's silhouette against the disc that it is. An edge cuts about 2 √n of n elementary squares
/// of a pixel; each errs by a uniform share of one, so the coverage by √(2 √n / 12) / n: 0.018 for 64,
/// where random places would err by up to 0.06.
#[test]
fn coverage_is_the_area_within_the_error_of_stratified_samples() {
    let size = 64;
    let distance = 4.0f64;
    let radius = 0.5 * f64::from(size) * distance.recip().asin().tan() / 20f64.to_radians().tan();
    for samples in [16, 64, 256] {
        let n = f64::from(samples);
        let deviation = (2.0 * n.sqrt() / 12.0).sqrt() / n;
        let text = format!(
            "[camera]\neye = [0.0, 0.0, {distance}]\ntarget = [0.0, 0.0, 0.0]\nvertical_fov = 40.0\n\
             [image]\nsize = [{size}, {size}]\nsamples = {samples}\nfilter = \"box\""
        );
        let film = render_twin(&plan_of(&text, &[set_of(fibonacci_sphere(20_000))])).film;
        let (mut sum, mut count, mut worst, mut area) = (0.0, 0.0, 0.0f64, 0.0);
        for (at, color) in film.color.iter().enumerate() {
            let place = |i: usize| i as f64 + 0.5 - 0.5 * f64::from(size);
            let expected = covered(place(at % size as usize), place(at / size as usize), radius);
            let error = f64::from(color[3]) - expected;
            area += f64::from(color[3]);
            worst = worst.max(error.abs());
            if expected > 0.0 && expected < 1.0 {
                sum += error * error;
                count += 1.0;
            }
        }
        let rms = f64::sqrt(sum / count);
        assert!(rms < 1.2 * deviation, "{samples} samples: rms {rms} over {count} pixels");
        assert!(worst < 5.0 * deviation, "{samples} samples: worst {worst}");
        // Errors of the pixels are independent.
        let disc = std::f64::consts::PI * radius * radius;
        assert!((area - disc).abs() < 4.0 * rms * f64::sqrt(count), "{area} of {disc}");
        println!("{samples} samples: rms {rms:.4}, worst {worst:.4}, area {area:.3} of {disc:.3}");
    }
}
