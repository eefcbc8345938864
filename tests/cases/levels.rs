//! Scenes whose points differ in size by orders of magnitude: several grids, the pictures of one.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use harness::{
    Bench, Rendered, assert_same_bits, assert_same_film, fibonacci_sphere, moved, plan_of,
    render_twin, set_of,
};
use kernels::layout::MOST_LEVELS;
use plan::{Diagnostic, Plan};
use points::{PointSet, Unwatched};
use reference::Reference;

const VIEW: &str = "
[camera]
eye = [0.5, 0.6, 1.3]
target = [0.0, 0.2, 0.0]
vertical_fov = 40.0
[image]
size = [96, 72]
[background]
color = [0.3, 0.4, 0.5]
[[lights]]
kind = \"directional\"
direction = [-0.4, -1.0, -0.3]
irradiance = [3.0, 2.9, 2.7]
";

/// Hills of this width, and `side` points along them.
fn land(width: f64, side: u32) -> PointSet {
    let step = width / f64::from(side);
    let hill = |x: f64| (x / width * 9.0).sin();
    let at = |i: u32| step * (f64::from(i) - 0.5 * f64::from(side));
    let places = (0..side * side).map(|i| [at(i % side), at(i / side)]);
    set_of(places.map(|[x, z]| [x, -0.31 + 0.004 * width * hill(x) * hill(z), z]).collect())
}

/// Two balls of glass and one that is not, a fifth as large as the view, on hills a hundred times as wide.
fn scene(settings: &str, width: f64) -> Plan {
    let ball = || {
        let sphere = fibonacci_sphere(4000);
        sphere.into_iter().map(|p| p.map(|x| 0.3 * x)).collect::<Vec<_>>()
    };
    let sets = [
        set_of(ball()),
        set_of(moved(&ball(), [-0.7, 0.0, -0.3])),
        set_of(moved(&ball(), [0.3 * width, 0.1, -0.3 * width])),
        land(width, 100),
    ];
    let text = format!(
        "{VIEW}\n[render]\n{settings}\n\
         [[objects]]\npoints = \"a.ply\"\nmaterial = {{ kind = \"glass\", ior = [1.4, 1.5, 1.6] }}\n\
         [[objects]]\npoints = \"b.ply\"\n\
         [[objects]]\npoints = \"c.ply\"\nmaterial = {{ kind = \"mirror\" }}\n\
         [[objects]]\npoints = \"d.ply\"\nmaterial = {{ kind = \"diffuse\", albedo = [0.4, 0.5, 0.3] }}"
    );
    plan_of(&text, &sets)
}

fn levels_of(plan: &Plan) -> usize {
    Reference::<f32>::new(plan, &Unwatched).expect("nobody interrupts").grids.levels.len()
}

/// The same picture through one grid.
fn in_one_grid(mut plan: Plan) -> Plan {
    plan.grid_resolution = 200; // no cell with more points than are asked around a hit
    assert_eq!(levels_of(&plan), 1);
    plan
}

#[test]
fn several_grids_give_the_bytes_of_one() {
    let bench = Bench::open();
    let one = bench.render(&in_one_grid(scene("primary = \"grid\"", 60.0))).film;
    for settings in [
        "primary = \"grid\"",
        "primary = \"discs\"",
        "primary = \"grid\"\nloop = \"images\"",
        "cells_per_pass = 1",
    ] {
        let plan = scene(settings, 60.0);
        // The balls that lie together, the one far away, the hills.
        assert_eq!(levels_of(&plan), 3, "{settings}");
        assert_same_film(settings, &one, &bench.render(&plan).film);
    }
    for settings in ["primary = \"grid\"", "primary = \"discs\""] {
        let bit_by_bit = bench.render_within(&scene(settings, 60.0), Some(1));
        assert_same_film("a little work a pass", &one, &bit_by_bit.film);
    }
}

#[test]
fn several_grids_are_the_same_to_the_bit_as_their_twin() {
    let mut plan = scene("primary = \"grid\"", 60.0);
    plan.diagnostics = Diagnostic::ALL.to_vec();
    assert_same_bits("levels", &Bench::open().render(&plan), &render_twin(&plan));
}

/// A sheet whose points lie farther apart the farther away they are, from one size to a hundred times that.
fn fading_sheet(count: u32) -> PointSet {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let place = |i: u32| {
        let radius = 0.02 * 3000f64.powf((f64::from(i) + 0.5) / f64::from(count));
        let (sin, cos) = (golden * f64::from(i)).sin_cos();
        [radius * cos, 0.05 * radius * (4.0 * radius.ln()).sin(), radius * sin]
    };
    let mut set = set_of((0..count).map(place).collect());
    let color = |p: &[f64; 3]| [p[0].sin().abs() as f32, 0.5, p[2].cos().abs() as f32];
    set.colors = Some(set.positions.iter().map(color).collect());
    set
}

/// Within one object, polynomials of several grids are blended around a hit.
#[test]
fn an_object_in_several_grids_is_blended_as_in_one() {
    let bench = Bench::open();
    let plan = |settings: &str| {
        let text = format!("{VIEW}\n[render]\n{settings}\n[[objects]]\npoints = \"a.ply\"");
        plan_of(&text, &[fading_sheet(4000)])
    };
    let levels = levels_of(&plan(""));
    assert!((3..=MOST_LEVELS as usize).contains(&levels), "{levels} grids");
    let one = bench.render(&in_one_grid(plan(""))).film;
    for settings in ["primary = \"grid\"", "primary = \"discs\""] {
        let several = bench.render(&plan(settings));
        assert_same_film(settings, &one, &several.film);
        assert_same_bits(settings, &several, &render_twin(&plan(settings)));
    }
}

/// Points around a hit are looked for in all grids; what is rejected goes on through all of them.
#[test]
fn hits_are_refined_through_several_grids() {
    let surface = "surface = { polynomial = \"incomplete\", refine = \"project\" }";
    let text = format!(
        "{VIEW}\n[render]\nprimary = \"grid\"\n[[objects]]\npoints = \"a.ply\"\n{surface}\n\
         [[objects]]\npoints = \"b.ply\"\n{surface}"
    );
    let ball = fibonacci_sphere(3000).into_iter().map(|p| p.map(|x| 0.3 * x)).collect();
    for sets in [[set_of(ball), land(60.0, 80)], [fading_sheet(8000), land(60.0, 80)]] {
        let plan = plan_of(&text, &sets);
        assert!(levels_of(&plan) > 1);
        let bench = Bench::open();
        let several = bench.render(&plan);
        assert_same_bits("refined", &several, &render_twin(&plan));
        // The order of sums is that of cells: the same places but for rounding.
        let one = bench.render(&in_one_grid(plan)).film;
        let differ = several.film.object.iter().zip(&one.object).filter(|(a, b)| a != b).count();
        assert!(differ <= 3, "{differ} pixels");
    }
}

/// Points that are tested, and cells that are crossed, a ray: what a picture costs, counted.
fn work_of(rendered: &Rendered) -> f64 {
    let plane = rendered.film.extra.iter().find(|(name, _)| name == Diagnostic::Cells.name());
    let (_, cells) = plane.expect("the plan asks for it");
    let crossed: f64 = cells.iter().map(|&cells| f64::from(cells)).sum();
    (rendered.tests as f64 + crossed) / cells.len() as f64
}

/// The measure: hills a hundred times as wide may cost half as much again. (In time, and for the Bunny:
/// docs/benchmarks.md.)
#[test]
fn what_lies_around_costs_little_however_wide_it_is() {
    let bench = Bench::open();
    let work = [6.0, 60.0, 600.0].map(|width| {
        let mut plan = scene("primary = \"grid\"", width);
        plan.diagnostics = Diagnostic::ALL.to_vec();
        work_of(&bench.render(&plan))
    });
    println!("tests and cells a pixel on hills 20, 200, 2000 times as wide as a ball: {work:.0?}");
    // In between, single balls of the hills are as large as what lies on them: each ray tests some.
    assert!(work[1] < 1.75 * work[0] && work[2] < 1.5 * work[0], "{work:?}");
}
