//! Closed forms: the unit sphere, and a plane.
#![allow(clippy::print_stdout, reason = "measured figures, for whoever asks with --nocapture")]

use harness::{
    Bench, Rendered, fibonacci_sphere, grid_points, moved, pinholes, plan_of, render_twin, set_of,
};
use points::Unwatched;
use reference::Reference;

type V3 = [f64; 3];

const SIZE: [usize; 2] = [320, 240];
/// From the middle of the sphere.
const EYE: V3 = [0.9, 0.7, 2.4];
const FOV: f64 = 50.0;

fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn add(a: V3, b: V3, factor: f64) -> V3 {
    [0, 1, 2].map(|i| a[i] + factor * b[i])
}

fn unit(a: V3) -> V3 {
    a.map(|x| x / dot(a, a).sqrt())
}

/// Angle between two directions in degrees. By atan2: acos has a floor of 0.02° in f32.
fn angle(a: V3, b: V3) -> f64 {
    let c = cross(a, b);
    dot(c, c).sqrt().atan2(dot(a, b)).to_degrees()
}

/// Direction of the ray through a pixel's centre and the viewing axis, from the scene's own words.
fn view(pixel: usize) -> (V3, V3) {
    let forward = unit(EYE.map(|x| -x));
    let right = unit(cross(forward, [0.0, 1.0, 0.0]));
    let up = cross(right, forward);
    let half = (0.5 * FOV.to_radians()).tan() / (0.5 * SIZE[1] as f64);
    let x = ((pixel % SIZE[0]) as f64 + 0.5 - 0.5 * SIZE[0] as f64) * half;
    let y = (0.5 * SIZE[1] as f64 - (pixel / SIZE[0]) as f64 - 0.5) * half;
    (unit(add(add(forward, right, x), up, y)), forward)
}

/// Renders the unit sphere with its middle at `middle`.
fn plan(count: u32, polynomial: &str, middle: V3) -> plan::Plan {
    let eye = add(EYE, middle, 1.0);
    let text = format!(
        "[camera]\neye = {eye:?}\ntarget = {middle:?}\nvertical_fov = {FOV}\n\
         [image]\nsize = {SIZE:?}\n\
         [[objects]]\npoints = \"sphere.ply\"\nsurface = {{ polynomial = \"{polynomial}\" }}"
    );
    plan_of(&text, &[set_of(moved(&fibonacci_sphere(count), middle))])
}

fn percentile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share) as usize]
}

/// Checks coverage, and gives the 99th percentiles of the distance to the sphere and of the
/// normal's angle in degrees, both from Z and N alone.
fn errors(rendered: &Rendered) -> (f64, f64) {
    let film = &rendered.film;
    let (mut distances, mut angles) = (Vec::new(), Vec::new());
    for pixel in 0..SIZE[0] * SIZE[1] {
        let (d, forward) = view(pixel);
        let miss = {
            let c = cross(EYE, d);
            dot(c, c).sqrt() // distance of the ray from the middle
        };
        let hit = film.object[pixel] >= 0.0;
        // Trust balls reach b past the last point: 0.6 h, h = 0.08 at 10 000 points.
        assert!(hit || miss > 1.0, "pixel {pixel} is empty, {miss} from the middle");
        assert!(!hit || miss < 1.002, "pixel {pixel} is hit, {miss} from the middle");
        // Within 0.95 of the radius, where the ray does not graze.
        if hit && miss < 0.95 {
            let x = add(EYE, d, f64::from(film.depth[pixel]) / dot(d, forward));
            distances.push((dot(x, x).sqrt() - 1.0).abs());
            angles.push(angle(film.normal[pixel].map(f64::from), x));
        }
    }
    assert!(distances.len() > 10_000, "{} pixels measured", distances.len());
    (percentile(distances, 0.99), percentile(angles, 0.99))
}

/// Bounds from docs/method.md: 7.5e-7 and 0.0017° in f64 for `full`, 2.5e-4 and 0.55° for
/// `incomplete`, plus f32's floor of 3e-7 at this distance.
const FULL: (f64, f64) = (2e-6, 0.01);
const INCOMPLETE: (f64, f64) = (4e-4, 0.8);

fn check(polynomial: &str, middle: V3, bounds: (f64, f64)) {
    let (distance, degrees) = errors(&Bench::open().render(&plan(10_000, polynomial, middle)));
    println!("{polynomial} at {middle:?}: {distance:.2e}, {degrees:.4} degrees");
    assert!(distance < bounds.0, "{polynomial} at {middle:?}: distance {distance:e}");
    assert!(degrees < bounds.1, "{polynomial} at {middle:?}: angle {degrees}");
}

#[test]
fn full_polynomials_lie_on_the_sphere() {
    check("full", [0.0; 3], FULL);
}

#[test]
fn incomplete_polynomials_lie_near_the_sphere() {
    check("incomplete", [0.0; 3], INCOMPLETE);
}

/// A survey's coordinates: f32 would leave half a unit of them.
#[test]
fn survey_coordinates_cost_no_accuracy() {
    check("full", [500_000.0, 4_100_000.0, 1200.0], FULL);
    check("incomplete", [500_000.0, 4_100_000.0, 1200.0], INCOMPLETE);
}

/// The twin in f64 says what f32 costs: both are within f32's floor of one another.
#[test]
fn f64_twin_agrees_with_the_device_to_f32s_precision() {
    let plan = plan(10_000, "full", [0.0; 3]);
    let exact = Reference::<f64>::new(&plan, &Unwatched).expect("nobody interrupts");
    let exact = exact.frame(&plan, &Unwatched).expect("nobody interrupts").finish();
    let single = render_twin(&plan).film;
    let differences: Vec<f64> = exact
        .depth
        .iter()
        .zip(&single.depth)
        .filter(|(a, b)| a.is_finite() && b.is_finite())
        .map(|(a, b)| f64::from((a - b).abs()))
        .collect();
    // An ulp of a depth of 2 is 2.4e-7; at grazing angles a few of them add up.
    let p99 = percentile(differences, 0.99);
    assert!(p99 < 2e-6 && p99 > 0.0, "99th percentile {p99:e}");
}

#[test]
fn no_pixel_inside_the_sphere_is_a_pinhole() {
    let rendered = Bench::open().render(&plan(10_000, "full", [0.0; 3]));
    assert_eq!(pinholes(&rendered.film), 0);
}

/// A flat grid: f is 0 everywhere, so the fit is the plane itself.
#[test]
fn a_plane_is_exact() {
    let text = "[camera]\neye = [0.5, 2.0, 0.5]\ntarget = [0.5, 0.0, 0.5]\nup = [0.0, 0.0, -1.0]\n\
                vertical_fov = 20.0\n[image]\nsize = [64, 64]";
    let film = Bench::open().render(&plan_of(text, &[set_of(grid_points(50))])).film;
    // An ulp below 2 is 1.2e-7; depth is a product of two rounded numbers.
    assert!(film.depth.iter().all(|depth| (depth - 2.0).abs() < 3e-7));
    assert!(film.normal.iter().all(|&normal| normal == [0.0, 1.0, 0.0]));
}

/// Lambert: radiance = albedo / pi * E * cos, with the albedo of points without colours.
#[test]
fn a_plane_under_a_slanted_light_obeys_lambert() {
    let text = "[camera]\neye = [0.5, 2.0, 0.5]\ntarget = [0.5, 0.0, 0.5]\nup = [0.0, 0.0, -1.0]\n\
                vertical_fov = 20.0\n[image]\nsize = [16, 16]\n\
                [[lights]]\nkind = \"directional\"\ndirection = [3.0, -4.0, 0.0]\n\
                irradiance = [1.0, 2.0, 3.0]";
    let film = Bench::open().render(&plan_of(text, &[set_of(grid_points(50))])).film;
    for pixel in &film.color {
        for (channel, irradiance) in [1.0f64, 2.0, 3.0].into_iter().enumerate() {
            let expected = 0.8 / std::f64::consts::PI * irradiance * 0.8;
            // Three roundings.
            assert!((f64::from(pixel[channel]) / expected - 1.0).abs() < 3e-7, "{pixel:?}");
        }
        assert_eq!(pixel[3], 1.0);
    }
}

/// A point light: E = I / r² * cos; the light's distance to the plane is 1.
#[test]
fn a_point_light_falls_off_with_the_square() {
    let text = "[camera]\neye = [0.5, 2.0, 0.5]\ntarget = [0.5, 0.0, 0.5]\nup = [0.0, 0.0, -1.0]\n\
                vertical_fov = 20.0\n[image]\nsize = [33, 33]\n\
                [[lights]]\nkind = \"point\"\nposition = [0.5, 1.0, 0.5]\nintensity = [3.0, 3.0, 3.0]";
    let film = Bench::open().render(&plan_of(text, &[set_of(grid_points(50))])).film;
    for (pixel, position) in film.color.iter().zip(&film.position) {
        let [x, z] = [position[0], position[2]].map(|x| f64::from(x) - 0.5);
        let square = 1.0 + x * x + z * z;
        let expected = 0.8 / std::f64::consts::PI * 3.0 / (square * square.sqrt());
        assert!((f64::from(pixel[0]) / expected - 1.0).abs() < 1e-6, "{pixel:?} at {position:?}");
    }
}
