//! The f32 twin gives lavapipe's bits: polynomials, grid, picture.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use harness::{
    Bench, Rendered, assert_same_bits, assert_same_bits_unless_flushed, assert_same_film,
    fibonacci_sphere, grid_points, plan_of, random, render_twin, set_of, wavy_sheet,
};
use plan::{Diagnostic, Plan, RayLoop};
use points::PointSet;

const LIGHTS: &str = "
[[lights]]
kind = \"directional\"
direction = [-0.4, -1.0, -0.3]
irradiance = [3.0, 2.9, 2.7]
[[lights]]
kind = \"point\"
position = [2.0, 1.0, 3.0]
intensity = [4.0, 5.0, 6.0]
[background]
color = [0.1, 0.2, 0.3]
";

fn check(name: &str, settings: &str, positions: Vec<[f64; 3]>) -> Rendered {
    let plan = lit(settings, positions);
    let on_device = Bench::open().render(&plan);
    assert_same_bits(name, &on_device, &render_twin(&plan));
    on_device
}

fn lit(settings: &str, positions: Vec<[f64; 3]>) -> Plan {
    let mut plan = plan_of(&format!("{settings}\n{LIGHTS}"), &[set_of(positions)]);
    plan.diagnostics = Diagnostic::ALL.to_vec();
    plan
}

const SMALL: &str = "[image]\nsize = [160, 120]";

#[test]
fn sphere_is_the_same_to_the_bit() {
    for polynomial in ["full", "incomplete"] {
        let settings = format!(
            "[image]\nsize = [320, 240]\n[[objects]]\npoints = \"s.ply\"\n\
             surface = {{ polynomial = \"{polynomial}\" }}"
        );
        let sphere = check(polynomial, &settings, fibonacci_sphere(10_000));
        assert!(sphere.film.object.iter().filter(|&&object| object >= 0.0).count() > 10_000);
    }
}

#[test]
fn ties_and_random_spacing_are_the_same_to_the_bit() {
    check("grid", SMALL, grid_points(100));
    check("sheet", SMALL, wavy_sheet(5_000));
    // More than 64 are found by the CPU; 81 leave a part of four entries of a list unused.
    for k in [3, 5, 64, 81, 256] {
        let settings = format!(
            "{SMALL}\n[[objects]]\npoints = \"s.ply\"\nsurface = {{ neighbors = {k}, trust = 1.0 }}"
        );
        check("neighbors", &settings, wavy_sheet(2_000));
    }
}

#[test]
fn given_feature_sizes_are_the_same_to_the_bit() {
    let settings = |h: &str| {
        format!("{SMALL}\n[[objects]]\npoints = \"s.ply\"\nsurface = {{ feature_size = {h} }}")
    };
    for h in ["0.05", "5.0", "\"smoothed\""] {
        check(h, &settings(h), wavy_sheet(2_000));
    }
    let many = "surface = { feature_size = \"smoothed\", neighbors = 200 }";
    let many = format!("{SMALL}\n[[objects]]\npoints = \"s.ply\"\n{many}");
    check("smoothed over 200", &many, wavy_sheet(2_000));
    // Points are some ten h apart: what weights are multiplied to is below the least normal number.
    let plan = lit(&settings("0.001"), wavy_sheet(2_000));
    let on_device = Bench::open().render(&plan);
    assert_same_bits_unless_flushed("h = 0.001", &on_device, &render_twin(&plan));
}

/// One point, two, a line, a plane, all points equal, a far outlier: whatever comes out, it is the
/// same, it is finite, and what has no surface shows the background.
#[test]
fn degenerate_sets_are_the_same_to_the_bit() {
    let mut seed = 3;
    let mut outlier = fibonacci_sphere(2_000);
    outlier.push([1e5, -3e4, 7e4]);
    let along = |i: u32| f64::from(i) * 0.01;
    let cases: Vec<(&str, Vec<[f64; 3]>, bool)> = vec![
        ("one point", vec![[1.0, 2.0, 3.0]], false),
        ("two points", vec![[0.0; 3], [1.0, 0.5, 0.25]], false),
        ("three points", vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], true),
        ("an axis", (0..200).map(|i| [along(i), 0.0, 0.0]).collect(), false),
        (
            "a slanted line",
            (0..200).map(|i| [along(i), 2.0 * along(i), -0.3 * along(i)]).collect(),
            false,
        ),
        (
            "a plane",
            (0..400).map(|i| [along(i % 20), along(i / 20), 0.5 * along(i % 20)]).collect(),
            true,
        ),
        ("all equal", vec![[0.1, 0.2, 0.3]; 500], false),
        ("a cloud", (0..500).map(|_| [0; 3].map(|_| random(&mut seed))).collect(), true),
        (
            "pairs of duplicates",
            fibonacci_sphere(1_000).into_iter().flat_map(|p| [p, p]).collect(),
            true,
        ),
        ("a far outlier", outlier, true),
    ];
    for (name, positions, has_surface) in cases {
        let rendered = check(name, SMALL, positions);
        let finite = |values: &[f32]| values.iter().all(|v| v.is_finite());
        assert!(finite(rendered.film.color.as_flattened()), "{name}: colours");
        assert!(finite(rendered.film.normal.as_flattened()), "{name}: normals");
        let fitted = rendered.polynomials.iter().any(|p| p.center_trust[3] > 0.0);
        assert_eq!(fitted, has_surface, "{name}: carries a surface");
        assert!(has_surface || rendered.film.object.iter().all(|&object| object == -1.0));
    }
}

/// More pairs of cell and point than one row of a dispatch has invocations.
#[test]
fn lists_longer_than_a_row_of_a_dispatch_are_the_same_to_the_bit() {
    let large = check("large", "[image]\nsize = [96, 64]", fibonacci_sphere(300_000));
    assert!(large.slots.len() > 1 << 20, "{} pairs", large.slots.len());
}

/// More pairs of cell and point than are sorted in one go, so many that the grid is listed in slabs; and balls
/// so large that their pairs are emitted one by one, in a grid so fine that they meet thousands of cells.
#[test]
fn grids_listed_in_slabs_are_the_same_to_the_bit() {
    let settings = |resolution| {
        format!(
            "[image]\nsize = [48, 32]\n[render]\ngrid_resolution = {resolution}\n[[objects]]\n\
             points = \"s.ply\"\nsurface = {{ normals = \"polynomial\", trust = 1.0 }}"
        )
    };
    let slabs = check("slabs", &settings(300), fibonacci_sphere(520_000));
    assert!(slabs.slots.len() > 7_000_000, "{} pairs", slabs.slots.len());
    let mut uneven = fibonacci_sphere(20_000);
    uneven.extend(fibonacci_sphere(100).into_iter().map(|p| p.map(|x| 1.5 * x)));
    let large = check("large balls", &settings(90), uneven);
    let most = large.cells.iter().map(|range| range[1] - range[0]).max().unwrap_or(0);
    assert!(most > 0 && large.slots.len() > 100_000, "{} pairs", large.slots.len());
}

/// Half of a file's points are no numbers: they are dropped and counted, the rest is the same to the
/// bit, and indices are places in the file.
#[test]
fn a_set_half_of_nan_is_the_same_to_the_bit() {
    let sphere = fibonacci_sphere(4_000);
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nend_header\n",
        2 * sphere.len()
    );
    for [x, y, z] in &sphere {
        text += &format!("{x} nan {z}\n{x} {y} {z}\n");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("half.ply");
    std::fs::write(&path, text).expect("a written file");
    let set = points::read(&path, &mut |_, _| {}).expect("a readable file");
    assert_eq!((set.len(), set.non_finite), (4_000, 4_000));
    assert!(set.file_index.iter().all(|index| index % 2 == 1));
    let plan = plan_of(&format!("{SMALL}\n{LIGHTS}"), &[set]);
    let on_device = Bench::open().render(&plan);
    assert_same_bits("half NaN", &on_device, &render_twin(&plan));
    assert!(on_device.film.object.iter().filter(|&&object| object == 0.0).count() > 5_000);
}

#[test]
fn several_objects_with_colors_and_transforms_are_the_same_to_the_bit() {
    let scene = format!(
        "{SMALL}\n{LIGHTS}
[[objects]]
points = \"a.ply\"
transform = {{ scale = 0.5, rotate = [10.0, 20.0, 30.0], translate = [0.2, 0.0, 0.0] }}
[[objects]]
points = \"b.ply\"
material = {{ albedo = [0.2, 0.9, 0.4] }}
surface = {{ polynomial = \"incomplete\", neighbors = 12 }}
[[objects]]
points = \"c.ply\"
"
    );
    let positions = fibonacci_sphere(3_000);
    let colors = positions.iter().map(|p| p.map(|x| 0.5 + 0.5 * x as f32)).collect();
    let coloured = PointSet { colors: Some(colors), ..set_of(positions) };
    let sets = [coloured, set_of(wavy_sheet(3_000)), set_of(fibonacci_sphere(2))];
    let mut plan = plan_of(&scene, &sets);
    plan.diagnostics = Diagnostic::ALL.to_vec();
    let on_device = Bench::open().render(&plan);
    assert_same_bits("objects", &on_device, &render_twin(&plan));
    for object in [0.0, 1.0] {
        assert!(on_device.film.object.contains(&object), "object {object} is seen");
    }
}

/// K = 1 is the paper's loop; any K, and any grid, gives the same picture.
#[test]
fn every_k_gives_the_same_bytes() {
    let bench = Bench::open();
    let mut plan = plan_of(&format!("{SMALL}\n{LIGHTS}"), &[set_of(fibonacci_sphere(10_000))]);
    let whole = bench.render(&plan);
    let mut passes = vec![whole.passes];
    for (k, form) in [(1, RayLoop::Queue), (4, RayLoop::Images), (1_000_000, RayLoop::Images)] {
        (plan.cells_per_pass, plan.ray_loop) = (k, form);
        let rendered = bench.render(&plan);
        assert_same_bits("K", &whole, &rendered);
        passes.push(rendered.passes);
    }
    assert!(passes[1] > 4 * passes[0] && passes[2] > passes[0], "passes: {passes:?}");
    // Blended normals ask 4096 points of a cell at most, and a single cell has more.
    let single = "[[objects]]\npoints = \"s.ply\"\nsurface = { normals = \"polynomial\" }";
    let text = format!("{SMALL}\n{LIGHTS}\n{single}");
    let mut plan = plan_of(&text, &[set_of(fibonacci_sphere(10_000))]);
    let whole = bench.render(&plan);
    for resolution in [1, 5, 200] {
        plan.grid_resolution = resolution;
        assert_same_film("grid resolution", &whole.film, &bench.render(&plan).film);
    }
}

/// One cell with every point: a ray tests them all, far more than lavapipe's loops bear in one
/// dispatch, and still none is cut short.
#[test]
fn a_cell_with_too_many_points_for_one_pass_is_finished_in_the_next() {
    let mut plan = plan_of(
        "[image]\nsize = [24, 16]\n[render]\ngrid_resolution = 1\nprimary = \"grid\"\nsecondary = \"grid\"\n[[objects]]\npoints = \"s.ply\"\n\
         surface = { normals = \"polynomial\" }",
        &[set_of(fibonacci_sphere(300_000))],
    );
    let one_cell = Bench::open().render(&plan);
    assert!(one_cell.passes > 10, "passes: {}", one_cell.passes);
    // Four at a time, 65 535 iterations would test 262 140.
    assert!(one_cell.tests >= 300_000 * 24, "tests: {}", one_cell.tests);
    plan.grid_resolution = 0;
    assert_same_film("one cell", &one_cell.film, &render_twin(&plan).film);
}

/// A large grid, whose empty cells say how far they are from others: camera rays, and those towards lights.
#[test]
fn rays_that_leave_empty_cells_together_are_the_same_to_the_bit() {
    let mut plan = plan_of(&format!("{SMALL}\n{LIGHTS}"), &[set_of(fibonacci_sphere(30_000))]);
    let stepping = Bench::open().render(&plan);
    plan.grid_resolution = 80;
    plan.diagnostics = Diagnostic::ALL.to_vec();
    let skipping = Bench::open().render(&plan);
    assert_same_bits("skipping", &skipping, &render_twin(&plan));
    let distances =
        skipping.cells.iter().filter(|range| range[0] == range[1]).map(|range| range[0]);
    assert_eq!((distances.clone().min(), distances.max()), (Some(1), Some(4)));
    plan.diagnostics.clear();
    assert_same_film("skipping", &stepping.film, &Bench::open().render(&plan).film);
}

/// However little a ray may do in a pass, it goes on in the next where it stopped.
#[test]
fn any_budget_gives_the_same_bytes() {
    let bench = Bench::open();
    let glass = "[[objects]]\npoints = \"s.ply\"\nmaterial = { kind = \"glass\" }";
    for text in [format!("{SMALL}\n{LIGHTS}"), format!("{SMALL}\n{glass}")] {
        let plan = plan_of(&text, &[set_of(fibonacci_sphere(10_000))]);
        let whole = bench.render(&plan);
        let cut = bench.render_within(&plan, Some(64));
        assert!(cut.passes > whole.passes, "passes: {} and {}", whole.passes, cut.passes);
        assert_same_bits("budget", &whole, &cut);
    }
}

/// A crop, whose pixels are other invocations of other workgroups, shows what the whole shows there;
/// pictures larger than a tile come together without a seam.
#[test]
fn crops_and_tiles_show_the_same_pixels() {
    let bench = Bench::open();
    let text = format!("[image]\nsize = [1100, 1030]\n{LIGHTS}");
    let mut plan = plan_of(&text, &[set_of(fibonacci_sphere(5_000))]);
    let whole = bench.render(&plan).film;
    assert_same_film("tiles", &whole, &render_twin(&plan).film);
    plan.window = plan::Window { origin: [1000, 500], size: [77, 33] };
    let crop = bench.render(&plan).film;
    for (i, color) in crop.color.iter().enumerate() {
        let at = (500 + i / 77) * 1100 + 1000 + i % 77;
        assert_eq!((color, crop.depth[i]), (&whole.color[at], whole.depth[at]), "pixel {i}");
    }
}

/// Two runs, two renderers: the same bytes.
#[test]
fn a_second_run_gives_the_same_bytes() {
    let plan = plan_of(&format!("{SMALL}\n{LIGHTS}"), &[set_of(wavy_sheet(4_000))]);
    let bench = Bench::open();
    assert_same_bits("second run", &bench.render(&plan), &bench.render(&plan));
}
