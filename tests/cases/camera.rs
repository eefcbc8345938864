//! Cameras: perspective, orthographic, with a lens.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use film::Film;
use harness::{
    Bench, assert_same_bits, fibonacci_sphere, plan_of, render_twin, set_of, wavy_sheet,
};
use plan::{Plan, Window};

const LIGHT: &str = "
[[lights]]
kind = \"directional\"
direction = [-0.4, -1.0, -0.3]
irradiance = [3.0, 2.9, 2.7]
";

fn sheet_plan(camera: &str, image: &str) -> Plan {
    let text = format!(
        "[camera]\neye = [1.3, 1.1, 2.4]\ntarget = [0.5, 0.0, 0.5]\nup = [0.2, 1.0, 0.1]\n{camera}\n\
         [image]\n{image}\n{LIGHT}"
    );
    plan_of(&text, &[set_of(wavy_sheet(5_000))])
}

const PERSPECTIVE: &str = "vertical_fov = 30";
const ORTHOGRAPHIC: &str = "projection = \"orthographic\"\nheight = 1.2";

#[test]
fn every_camera_is_the_same_to_the_bit() {
    let bench = Bench::open();
    for (camera, image) in [
        (ORTHOGRAPHIC.to_owned(), "size = [120, 90]"),
        (ORTHOGRAPHIC.to_owned(), "size = [80, 60]\nsamples = 4"),
        (format!("{PERSPECTIVE}\naperture = 0.1"), "size = [80, 60]"),
        (format!("{PERSPECTIVE}\naperture = 0.1"), "size = [80, 60]\nsamples = 4"),
        (format!("{ORTHOGRAPHIC}\naperture = 0.3\nfocus = 1.5"), "size = [80, 60]\nsamples = 3"),
    ] {
        let plan = sheet_plan(&camera, image);
        let on_device = bench.render(&plan);
        assert_same_bits(&camera, &on_device, &render_twin(&plan));
        assert!(on_device.film.object.iter().filter(|&&object| object >= 0.0).count() > 1_000);
    }
}

/// With one sample a pixel, rays go through the lens's centre.
#[test]
fn a_lens_shows_only_in_many_samples() {
    let film = |aperture: &str, image: &str| {
        render_twin(&sheet_plan(&format!("{PERSPECTIVE}\n{aperture}"), image)).film
    };
    let one = "size = [80, 60]";
    assert_eq!(film("aperture = 0.1", one), film("", one));
    let many = "size = [80, 60]\nsamples = 4";
    assert_ne!(film("aperture = 0.1", many).color, film("", many).color);
}

/// P, through the matrices of the header: where it lands on the picture, and its depth.
fn project(plan: &Plan, film: &Film, at: usize) -> ([f64; 2], f64) {
    let provenance = plan.provenance();
    let local = film.position[at].map(f64::from);
    let apply = |m: &[[f32; 4]; 4]| {
        [0, 1, 2, 3].map(|j| {
            (0..3).map(|i| local[i] * f64::from(m[i][j])).sum::<f64>() + f64::from(m[3][j])
        })
    };
    let ndc = apply(&provenance.world_to_ndc);
    let size = film.size.map(f64::from);
    ([ndc[0] / ndc[3] * size[0], ndc[1] / ndc[3] * size[1]], -apply(&provenance.world_to_camera)[2])
}

/// Positions are rounded to f32 and hits err by about as much: at 100 pixels a scene unit and
/// distances of 3, that is 1e-4 of a pixel.
#[test]
fn positions_project_onto_their_pixels_and_depths() {
    for camera in [PERSPECTIVE, ORTHOGRAPHIC] {
        let mut plan = sheet_plan(camera, "size = [160, 120]");
        for window in [plan.window, Window { origin: [33, 17], size: [71, 60] }] {
            plan.window = window;
            let film = render_twin(&plan).film;
            let mut hits = 0;
            for at in (0..film.object.len()).filter(|&at| film.object[at] >= 0.0) {
                let ([x, y], depth) = project(&plan, &film, at);
                let column = at % film.window.width as usize + film.window.x as usize;
                let row = at / film.window.width as usize + film.window.y as usize;
                let off = (x - column as f64 - 0.5).abs().max((y - row as f64 - 0.5).abs());
                assert!(off < 1e-3, "{camera}: ({column}, {row}) lands at ({x}, {y})");
                assert!((depth - f64::from(film.depth[at])).abs() < 1e-5, "{camera}: Z {depth}");
                hits += 1;
            }
            assert!(hits > 2_000, "{hits} hits");
        }
    }
}

/// A sphere seen by parallel rays is a disc of its own radius at any distance, the nearest place one
/// radius before its centre.
#[test]
fn an_orthographic_sphere_is_a_disc_of_its_radius() {
    let mut discs = Vec::new();
    for eye in [1.5, 40.0] {
        let text = format!(
            "[camera]\neye = [0.0, 0.0, {eye}]\ntarget = [0.0, 0.0, 0.0]\nheight = 2.5\n\
             projection = \"orthographic\"\n[image]\nsize = [101, 101]\nsamples = 16"
        );
        let film = render_twin(&plan_of(&text, &[set_of(fibonacci_sphere(20_000))])).film;
        let area: f32 = film.color.iter().map(|color| color[3]).sum();
        let radius = 101.0 / 2.5;
        let expected = std::f32::consts::PI * radius * radius;
        // Some 300 pixels of the rim err by 0.04 each, independently (tests/cases/samples.rs).
        assert!((area - expected).abs() < 3.0, "{area} pixels, expected {expected}");
        let nearest = film.depth[50 * 101 + 50];
        // The first sample lies up to 1.5 pixels off the centre: 1 - sqrt(1 - (2.1 / 40.4)²).
        assert!((nearest - (eye as f32 - 1.0)).abs() < 1.4e-3, "Z {nearest} from {eye}");
        discs.push(film.color);
    }
    // Both eyes see the same, but for roundings that move a silhouette's samples.
    let differing = discs[0].iter().zip(&discs[1]).filter(|(a, b)| a[3] != b[3]).count();
    assert!(differing < 20, "{differing} pixels differ");
}

/// Sum, centre and variance along x and y of the coverage of a picture.
fn moments(film: &Film) -> (f64, [f64; 2], [f64; 2]) {
    let width = film.size[0] as usize;
    let place =
        |at: usize, axis: usize| (if axis == 0 { at % width } else { at / width }) as f64 + 0.5;
    let mean = |f: &dyn Fn(usize) -> f64| -> f64 {
        film.color.iter().enumerate().map(|(at, color)| f64::from(color[3]) * f(at)).sum()
    };
    let sum = mean(&|_| 1.0);
    let center = [0, 1].map(|axis| mean(&|at| place(at, axis)) / sum);
    let variance = [0, 1].map(|axis| mean(&|at| (place(at, axis) - center[axis]).powi(2)) / sum);
    (sum, center, variance)
}

/// A small ball out of focus is a disc: by the thin lens formula a point at depth z is spread over a
/// circle of diameter A |z - f| / z on the plane in focus. A disc of radius R has the variance R²/4
/// along each axis; the ball's own disc and the pixel's square (1/12) add theirs.
#[test]
fn blur_is_the_thin_lens_circle() {
    let (size, aperture, focus) = (64.0, 0.4, 2.0);
    let scale = 20f64.to_radians().tan() / (0.5 * size); // of a pixel at distance 1
    for depth in [1.3, 2.0, 4.0, 10.0f64] {
        let ball = 0.04 * depth;
        let small: Vec<[f64; 3]> =
            fibonacci_sphere(2_000).iter().map(|p| p.map(|x| ball * x)).collect();
        let text = format!(
            "[camera]\neye = [0.0, 0.0, {depth}]\ntarget = [0.0, 0.0, 0.0]\nvertical_fov = 40.0\n\
             aperture = {aperture}\nfocus = {focus}\n\
             [image]\nsize = [64, 64]\nsamples = 256\nfilter = \"box\""
        );
        let film = render_twin(&plan_of(&text, &[set_of(small)])).film;
        let blur = 0.5 * aperture * (depth - focus).abs() / (depth * focus) / scale;
        let sharp = ball / depth / scale;
        let (sum, center, variance) = moments(&film);
        let expected = 0.25 * (blur * blur + sharp * sharp) + 1.0 / 12.0;
        // The ball is seen from all over the lens, whose rays to it are longer than the axis: by
        // A²/8z² of it, under 1.2%. Each pixel errs as in tests/cases/samples.rs.
        let area = std::f64::consts::PI * sharp * sharp;
        println!(
            "depth {depth}: blur {blur:.3}, sum {sum:.3} of {area:.3}, {variance:?} of {expected:.4}"
        );
        assert!((sum / area - 1.0).abs() < 0.02, "depth {depth}: {sum} of {area}");
        for axis in 0..2 {
            assert!((center[axis] - 32.0).abs() < 0.02, "depth {depth}: at {center:?}");
            let ratio = variance[axis] / expected;
            assert!((ratio - 1.0).abs() < 0.02, "depth {depth}: variance {ratio} of expected");
        }
        let reach = blur + 1.02 * sharp + 0.5f64.sqrt();
        for (at, color) in film.color.iter().enumerate() {
            let away = [at % 64, at / 64].map(|i| i as f64 + 0.5 - 32.0);
            assert!(color[3] == 0.0 || away[0].hypot(away[1]) < reach, "{away:?} within {reach}");
        }
    }
}
