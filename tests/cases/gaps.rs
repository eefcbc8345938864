//! `close_gaps`, and weights of another width: surfaces of uneven and noisy points.
#![allow(clippy::expect_used, clippy::print_stdout, reason = "tests panic and print")]

use harness::{Bench, Rendered, assert_same_bits, plan_of, random, render_twin, set_of};

/// Looks straight down at the middle of the unit square.
const DOWN: &str = "
[camera]
eye = [0.5, 2.0, 0.5]
target = [0.5, 0.0, 0.5]
up = [0.0, 0.0, -1.0]
vertical_fov = 20.0
[image]
size = [200, 200]
";

fn render(view: &str, surface: &str, positions: &[[f64; 3]]) -> Rendered {
    let text = format!("{view}\n[[objects]]\npoints = \"p.ply\"\nsurface = {{ {surface} }}");
    let plan = plan_of(&text, &[set_of(positions.to_vec())]);
    let rendered = Bench::open().render(&plan);
    assert_same_bits(surface, &rendered, &render_twin(&plan));
    rendered
}

fn misses(rendered: &Rendered) -> usize {
    rendered.film.object.iter().filter(|&&object| object < 0.0).count()
}

/// Random points leave discs without a point; b = h / 2 does not reach across the largest.
#[test]
fn gaps_between_random_points_are_closed() {
    let mut seed = 5;
    let sheet: Vec<[f64; 3]> =
        (0..10_000).map(|_| [random(&mut seed), 0.0, random(&mut seed)]).collect();
    let open = misses(&render(DOWN, "trust = 0.5, close_gaps = false", &sheet));
    let closed = misses(&render(DOWN, "trust = 0.5, close_gaps = true", &sheet));
    println!("{open} pixels missed, {closed} with gaps closed");
    assert!(open > 100, "{open} pixels missed");
    // Heights are zero here; what is left lies between two of the 24 directions.
    assert!(closed * 50 <= open, "{closed} of {open} pixels are still missed");
}

/// The rim of a square sheet: cells that are open ask for nothing, so the outline does not grow.
#[test]
fn rims_do_not_grow() {
    let sheet: Vec<[f64; 3]> = (0..2_500)
        .map(|i| [0.25 + 0.01 * f64::from(i % 50), 0.0, 0.25 + 0.01 * f64::from(i / 50)])
        .collect();
    let wide = DOWN.replace("20.0", "30.0");
    let open = misses(&render(&wide, "close_gaps = false", &sheet));
    let closed = misses(&render(&wide, "close_gaps = true", &sheet));
    assert_eq!(open, closed);
}

/// Points off the unit sphere by up to 1 % of its radius.
fn noisy_sphere() -> Vec<[f64; 3]> {
    let mut seed = 9;
    harness::fibonacci_sphere(10_000)
        .into_iter()
        .map(|p| p.map(|x| x * (1.0 + 0.02 * (random(&mut seed) - 0.5))))
        .collect()
}

/// Median angle between the normal and the sphere's, in degrees.
fn normal_error(rendered: &Rendered) -> f64 {
    let film = &rendered.film;
    let mut angles: Vec<f64> = film
        .object
        .iter()
        .enumerate()
        .filter(|(_, object)| **object == 0.0)
        .map(|(at, _)| {
            let (n, x) = (film.normal[at].map(f64::from), film.position[at].map(f64::from));
            let dot = n[0] * x[0] + n[1] * x[1] + n[2] * x[2];
            let cross =
                [n[1] * x[2] - n[2] * x[1], n[2] * x[0] - n[0] * x[2], n[0] * x[1] - n[1] * x[0]];
            cross.iter().map(|c| c * c).sum::<f64>().sqrt().atan2(dot.abs()).to_degrees()
        })
        .collect();
    angles.sort_by(f64::total_cmp);
    angles[angles.len() / 2]
}

/// More neighbours, or wider weights, average more noise away.
#[test]
fn normals_of_a_noisy_sphere_get_better_with_more_neighbors_and_wider_weights() {
    let view = "[camera]\neye = [0.9, 0.7, 2.4]\ntarget = [0.0, 0.0, 0.0]\nvertical_fov = 50.0\n\
                [image]\nsize = [120, 90]";
    let sphere = noisy_sphere();
    let curve: Vec<f64> = [8, 16, 32, 64]
        .map(|k| normal_error(&render(view, &format!("neighbors = {k}"), &sphere)))
        .to_vec();
    println!("neighbors 8, 16, 32, 64: {curve:.2?} degrees");
    assert!(curve.windows(2).all(|pair| pair[1] < 0.8 * pair[0]), "{curve:?}");
    let narrow = normal_error(&render(view, "weight_width = 0.6", &sphere));
    let wide = normal_error(&render(view, "weight_width = 2.0", &sphere));
    println!("weight_width 0.6, 1, 2: {narrow:.2}, {:.2}, {wide:.2} degrees", curve[1]);
    assert!(wide < curve[1] && curve[1] < narrow, "{narrow}, {}, {wide}", curve[1]);
}

/// Blended normals: the seams of `incomplete` polynomials go, and `full` ones gain as well.
#[test]
fn blended_normals_hide_seams_and_err_less() {
    let view = "[camera]\neye = [0.9, 0.7, 2.4]\ntarget = [0.0, 0.0, 0.0]\nvertical_fov = 50.0\n\
                [image]\nsize = [120, 90]";
    let sphere = harness::fibonacci_sphere(10_000);
    let error = |settings: &str| normal_error(&render(view, settings, &sphere));
    let single = ", normals = \"polynomial\"";
    let incomplete = error(&format!("polynomial = \"incomplete\"{single}"));
    let blended = error("polynomial = \"incomplete\"");
    let [full, full_blended] = [error(&format!("polynomial = \"full\"{single}")), error("")];
    println!(
        "incomplete {incomplete:.3} -> {blended:.3}, full {full:.5} -> {full_blended:.5} degrees"
    );
    assert!(blended < 0.7 * incomplete, "{incomplete} -> {blended}");
    assert!(full_blended < 0.5 * full, "{full} -> {full_blended}");
}
