//! Diagnostics against what is known of the points: which one was hit, where in its trust ball, how
//! it was fitted, and what that cost.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use harness::{
    Bench, Rendered, assert_same_film, fibonacci_sphere, grid_points, plan_of, render_twin, set_of,
};
use plan::{Diagnostic, Plan, RayLoop};
use points::PointSet;

fn plan(settings: &str, set: PointSet) -> Plan {
    let mut plan = plan_of(&format!("[image]\nsize = [160, 120]\n{settings}"), &[set]);
    plan.diagnostics = Diagnostic::ALL.to_vec();
    plan
}

fn plane(rendered: &Rendered, diagnostic: Diagnostic) -> &[f32] {
    let mut planes = rendered.film.extra.iter();
    let found = planes.find(|(name, _)| name == diagnostic.name());
    &found.expect("a plane of that name").1
}

/// What a diagnostic says where something was hit; where nothing was, it is -1.
fn of_hits(rendered: &Rendered, diagnostic: Diagnostic) -> Vec<f32> {
    let values = plane(rendered, diagnostic).iter().copied().zip(&rendered.film.object);
    let (hits, misses): (Vec<_>, Vec<_>) = values.partition(|&(_, &object)| object >= 0.0);
    assert!(misses.iter().all(|&(value, _)| value == -1.0), "{diagnostic:?} of misses");
    assert!(hits.len() > 500, "{} hits", hits.len());
    hits.into_iter().map(|(value, _)| value).collect()
}

/// With b = trust · h the same for all points, the hit's world position and the point of that index
/// give the fraction that `trust` must show. Every second point of the file was dropped.
#[test]
fn point_and_trust_tell_where_the_hit_lies() {
    let sphere = fibonacci_sphere(3_000);
    let file_index = (0..3_000).map(|i| 2 * i + 1).collect();
    let set = PointSet { file_index, ..set_of(sphere.clone()) };
    let (h, trust) = (0.15, 0.6);
    let plan = plan(
        &format!(
            "[[objects]]\npoints = \"s.ply\"\nsurface = {{ feature_size = {h}, trust = {trust} }}"
        ),
        set,
    );
    let rendered = render_twin(&plan);
    let fractions = of_hits(&rendered, Diagnostic::Trust);
    assert!(fractions.iter().all(|fraction| (0.0..=1.0).contains(fraction)));
    assert!(fractions.iter().any(|&f| f < 0.1) && fractions.iter().any(|&f| f > 0.5));
    let positions = rendered.film.position.iter().zip(&rendered.film.object);
    let hits = positions.filter(|&(_, &object)| object >= 0.0).map(|(position, _)| position);
    let indices = of_hits(&rendered, Diagnostic::Point);
    for ((x, index), fraction) in hits.zip(indices).zip(fractions) {
        assert_eq!(index % 2.0, 1.0, "a point that was kept");
        let p = sphere[index as usize / 2];
        let square: f64 = (0..3).map(|axis| (f64::from(x[axis]) - p[axis]).powi(2)).sum();
        let expected = square.sqrt() / (h * trust);
        // A position is put onto the ray of its pixel, by two steps of f32 at the eye's distance of 3 (2.4e-7 each)
        // at most; b is 0.09.
        assert!((f64::from(fraction) - expected).abs() < 6e-6, "{fraction} against {expected}");
    }
}

/// Four patches of four points, each point's neighbours those of its patch: a hit in a quarter of
/// the picture is one of the four points there.
#[test]
fn point_is_one_of_the_patch_that_is_seen() {
    let point = |i: u32| {
        let (patch, corner) = (i / 4, i % 4);
        let along = |bit: u32| f64::from(10 * (patch >> bit & 1) + (corner >> bit & 1));
        [along(0), along(1), 0.0]
    };
    let points = (0..16).map(point).collect();
    let plan = plan(
        "[camera]\neye = [5.5, 5.5, 25.0]\ntarget = [5.5, 5.5, 0.0]\n\
         [[objects]]\npoints = \"s.ply\"\nsurface = { neighbors = 3 }",
        set_of(points),
    );
    let rendered = render_twin(&plan);
    let mut seen = [false; 16];
    for (pixel, &index) in plane(&rendered, Diagnostic::Point).iter().enumerate() {
        if index >= 0.0 {
            let (right, upper) = (pixel % 160 >= 80, pixel / 160 < 60);
            let patch = usize::from(right) + 2 * usize::from(upper);
            assert_eq!(index as usize / 4, patch, "pixel {pixel}");
            seen[index as usize] = true;
        }
    }
    assert_eq!(seen, [true; 16], "points that are seen");
}

#[test]
fn fit_tells_how_the_polynomial_came_about() {
    let incomplete = "[[objects]]\npoints = \"s.ply\"\nsurface = { polynomial = \"incomplete\" }";
    let three = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for (settings, positions, expected) in [
        ("", fibonacci_sphere(3_000), 3.0),
        (incomplete, fibonacci_sphere(3_000), 2.0),
        ("", three, 1.0),
    ] {
        let rendered = render_twin(&plan(settings, set_of(positions)));
        let fits = of_hits(&rendered, Diagnostic::Fit);
        assert!(fits.iter().all(|&fit| fit == expected), "{expected}");
    }
}

/// Over all pixels, `tests` add up to what the statistics count. A ray that misses the grid costs
/// nothing; in a grid of one cell, no ray crosses a border, and every ray tests all points or none.
#[test]
fn tests_and_cells_are_what_the_traversal_did() {
    let mut plan = plan("", set_of(fibonacci_sphere(3_000)));
    let fine = render_twin(&plan);
    let sum = |plane: &[f32]| plane.iter().map(|&value| f64::from(value)).sum::<f64>();
    assert_eq!(sum(plane(&fine, Diagnostic::Tests)), fine.tests as f64);
    assert!(sum(plane(&fine, Diagnostic::Cells)) > 160.0 * 120.0);
    assert!(plane(&fine, Diagnostic::Iterations).iter().all(|&iterations| iterations == 0.0));

    plan.grid_resolution = 1;
    let coarse = render_twin(&plan);
    assert_eq!(sum(plane(&coarse, Diagnostic::Tests)), coarse.tests as f64);
    let tests = plane(&coarse, Diagnostic::Tests);
    assert!(tests.iter().all(|&tests| tests == 0.0 || tests == 3_000.0));
    assert!(tests.contains(&3_000.0));
    assert_eq!(sum(plane(&coarse, Diagnostic::Cells)), 0.0);
    for diagnostic in [Diagnostic::Point, Diagnostic::Trust, Diagnostic::Fit] {
        assert_eq!(plane(&fine, diagnostic), plane(&coarse, diagnostic), "{diagnostic:?}");
    }
}

/// Asking for diagnostics changes nothing else, and they are the same on every way through the
/// picture: any K, a crop.
#[test]
fn diagnostics_are_the_same_to_the_bit() {
    let bench = Bench::open();
    let mut plan = plan("", set_of(grid_points(60)));
    let whole = bench.render(&plan);
    assert_same_film("twin", &whole.film, &render_twin(&plan).film);
    (plan.cells_per_pass, plan.ray_loop) = (1, RayLoop::Images);
    assert_same_film("K = 1", &whole.film, &bench.render(&plan).film);

    let window = plan::Window { origin: [70, 40], size: [31, 17] };
    plan.window = window;
    let crop = bench.render(&plan);
    for diagnostic in Diagnostic::ALL {
        for (i, value) in plane(&crop, diagnostic).iter().enumerate() {
            let at = (40 + i / 31) * 160 + 70 + i % 31;
            assert_eq!(*value, plane(&whole, diagnostic)[at], "{diagnostic:?}, pixel {i}");
        }
    }
    plan.window = plan::Window { origin: [0, 0], size: [160, 120] };
    plan.diagnostics.clear();
    let mut film = whole.film;
    film.extra.clear();
    assert_same_film("without", &film, &bench.render(&plan).film);
}
