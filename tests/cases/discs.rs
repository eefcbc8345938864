//! Primary rays by discs give the grid's bytes, and the twin's.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use harness::{
    Bench, Rendered, assert_same_bits, assert_same_film, fibonacci_sphere, plan_of, random,
    render_twin, set_of, wavy_sheet,
};
use kernels::layout::LEAF_POINTS;
use plan::{Diagnostic, MAX_DISC_PAIRS, Plan, Primary, RayLoop};
use points::{PointSet, Unwatched};
use reference::Reference;
use render::Renderer;

const LIGHTS: &str = "
[[lights]]
kind = \"point\"
position = [2.0, 1.0, 3.0]
intensity = [4.0, 5.0, 6.0]
[background]
color = [0.1, 0.2, 0.3]
";
const SMALL: &str = "[image]\nsize = [163, 117]";

fn plan(settings: &str, sets: &[PointSet], primary: Primary) -> Plan {
    let mut plan = plan_of(&format!("{settings}\n{LIGHTS}"), sets);
    plan.primary = primary;
    plan
}

/// Fails unless grid, discs and the discs' twin give the same picture, and device and twin test the
/// same points.
fn check(bench: &Bench, name: &str, settings: &str, sets: &[PointSet]) -> Rendered {
    let by_discs = bench.render(&plan(settings, sets, Primary::Discs));
    let by_grid = bench.render(&plan(settings, sets, Primary::Grid));
    assert_same_film(name, &by_grid.film, &by_discs.film);
    let twin = render_twin(&plan(settings, sets, Primary::Discs));
    assert_same_bits(name, &by_discs, &twin);
    by_discs
}

fn looking(eye: [f64; 3], target: [f64; 3], fov: f64) -> String {
    format!("{SMALL}\n[camera]\neye = {eye:?}\ntarget = {target:?}\nvertical_fov = {fov:?}")
}

fn seen(rendered: &Rendered) -> usize {
    rendered.film.object.iter().filter(|&&object| object >= 0.0).count()
}

#[test]
fn discs_give_the_bytes_of_the_grid() {
    let bench = Bench::open();
    let sphere = [set_of(fibonacci_sphere(10_000))];
    assert!(seen(&check(&bench, "sphere", SMALL, &sphere)) > 5_000);
    let sheet = [set_of(wavy_sheet(5_000))];
    assert!(seen(&check(&bench, "sheet", SMALL, &sheet)) > 500);
    let objects = format!(
        "{SMALL}
[[objects]]
points = \"a.ply\"
transform = {{ scale = 0.5, rotate = [10.0, 20.0, 30.0], translate = [0.2, 0.0, 0.0] }}
[[objects]]
points = \"b.ply\"
surface = {{ polynomial = \"incomplete\", neighbors = 12 }}
[[objects]]
points = \"c.ply\"
"
    );
    let sets =
        [set_of(fibonacci_sphere(3_000)), set_of(wavy_sheet(3_000)), set_of(fibonacci_sphere(2))];
    let several = check(&bench, "objects", &objects, &sets);
    assert!([0.0, 1.0].iter().all(|object| several.film.object.contains(object)));
    // Twice the same set: every hit is a tie, which the first object wins.
    let twice = "[[objects]]\npoints = \"a.ply\"\n[[objects]]\npoints = \"b.ply\"";
    let ties = check(
        &bench,
        "ties",
        &format!("{SMALL}\n{twice}"),
        &[set_of(fibonacci_sphere(2_000)), set_of(fibonacci_sphere(2_000))],
    );
    assert!(!ties.film.object.contains(&1.0));
}

/// Discs around the eye, beside it, behind it, across the eye's plane, and in a view of 170 degrees.
#[test]
fn discs_give_the_bytes_of_the_grid_from_within() {
    let bench = Bench::open();
    let sphere = [set_of(fibonacci_sphere(5_000))];
    for fov in [20.0, 90.0, 170.0] {
        let view = looking([0.1, 0.2, 0.3], [1.0, 0.5, 0.2], fov);
        let inside = check(&bench, "inside", &view, &sphere);
        assert_eq!(seen(&inside), 163 * 117, "fov {fov}");
        for off in [1e-3, 0.02, 0.3] {
            let [x, y, z] = fibonacci_sphere(5_000)[1_234];
            let eye = [x, y, z].map(|x| x * (1.0 + off));
            check(&bench, "near a point", &looking(eye, [0.0; 3], fov), &sphere);
            let along = [eye[0] - z, eye[1] + 0.1, eye[2] + x];
            check(&bench, "along the surface", &looking(eye, along, fov), &sphere);
        }
        let [x, y, z] = fibonacci_sphere(5_000)[77];
        check(&bench, "at a point", &looking([x, y, z], [0.0, 2.0, 0.0], fov), &sphere);
    }
    let mut seed = 5;
    let cloud: Vec<[f64; 3]> = (0..3_000).map(|_| [0; 3].map(|_| random(&mut seed))).collect();
    let view = looking([0.5, 0.5, 0.5], [1.0, 0.4, 0.3], 100.0);
    check(&bench, "in a cloud", &view, &[set_of(cloud)]);
}

#[test]
fn degenerate_sets_give_the_bytes_of_the_grid() {
    let bench = Bench::open();
    check(&bench, "one point", SMALL, &[set_of(vec![[1.0, 2.0, 3.0]])]);
    let three = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    check(&bench, "three points", SMALL, &[set_of(three)]);
    let mut outlier = fibonacci_sphere(2_000);
    outlier.push([1e5, -3e4, 7e4]);
    check(&bench, "a far outlier", SMALL, &[set_of(outlier.clone())]);
    let view = looking([0.0, 0.0, 4.0], [0.0; 3], 40.0);
    check(&bench, "a huge ball around all", &view, &[set_of(outlier)]);
    let huge = "[[objects]]\npoints = \"s.ply\"\nsurface = { feature_size = 5.0 }";
    check(&bench, "huge discs", &format!("{SMALL}\n{huge}"), &[set_of(wavy_sheet(500))]);
}

/// Discs smaller than a pixel, most of which cover no pixel's centre.
#[test]
fn tiny_discs_give_the_bytes_of_the_grid() {
    let bench = Bench::open();
    let view = looking([0.0, 0.0, 30.0], [0.0; 3], 20.0);
    check(&bench, "far away", &view, &[set_of(fibonacci_sphere(40_000))]);
    let tiny = "[[objects]]\npoints = \"s.ply\"\nsurface = { feature_size = 0.012 }";
    let sheet = [set_of(wavy_sheet(20_000))];
    check(&bench, "tiny", &format!("{SMALL}\n{tiny}"), &sheet);
}

#[test]
fn tiles_and_crops_by_discs_give_the_bytes_of_the_grid() {
    let bench = Bench::open();
    let sets = [set_of(fibonacci_sphere(5_000))];
    let mut plans = [Primary::Grid, Primary::Discs]
        .map(|primary| plan("[image]\nsize = [1100, 1030]", &sets, primary));
    let [by_grid, by_discs] = plans.each_ref().map(|plan| bench.render(plan).film);
    assert_same_film("tiles", &by_grid, &by_discs);
    for plan in &mut plans {
        plan.window = plan::Window { origin: [517, 500], size: [77, 33] };
    }
    let [by_grid, by_discs] = plans.each_ref().map(|plan| bench.render(plan).film);
    assert_same_film("crop", &by_grid, &by_discs);
    assert_same_film("crop's twin", &by_discs, &render_twin(&plans[1]).film);
}

#[test]
fn screen_tiles_list_what_the_twin_lists() {
    let bench = Bench::open();
    for (settings, positions) in [
        (SMALL.to_owned(), fibonacci_sphere(10_000)),
        (looking([0.1, 0.2, 0.3], [1.0, 0.5, 0.2], 120.0), fibonacci_sphere(3_000)),
        (SMALL.to_owned(), vec![[1.0; 3]]),
    ] {
        let plan = plan(&settings, &[set_of(positions)], Primary::Discs);
        let reference = Reference::<f32>::new(&plan, &Unwatched).expect("nobody interrupts");
        let twin = reference.bin_discs(&plan, &plan.tiles()[0]).expect("not too many pairs");
        let mut tiles = vec![[0; 2]; twin.tiles.len()];
        let (ranks, pairs) = bench.with_device(|device| {
            let mut renderer =
                Renderer::new(device, &std::sync::Arc::new(plan.clone()), &Unwatched)
                    .expect("builds");
            renderer.frame(&Unwatched).expect("renders");
            let lists = renderer.disc_lists().expect("a tile traced by discs");
            lists.tiles.read(0, &mut tiles).expect("tiles");
            let mut pairs = [0; 2].map(|_| vec![0; lists.pair_count as usize]);
            lists.pairs.keys.read(0, &mut pairs[0]).expect("keys");
            lists.pairs.slots.read(0, &mut pairs[1]).expect("slots");
            (lists.ranks, pairs)
        });
        assert_eq!(ranks, twin.ranks);
        assert!(tiles == twin.tiles && pairs == [twin.keys, twin.leaves], "{settings}");
    }
}

/// K counts cells, which discs have none of; a list too long for one dispatch is finished in the
/// next.
#[test]
fn every_k_and_long_lists_give_the_same_bytes() {
    let bench = Bench::open();
    let mut small = plan(SMALL, &[set_of(fibonacci_sphere(5_000))], Primary::Discs);
    let whole = bench.render(&small);
    for k in [1, 3, 1_000_000] {
        small.cells_per_pass = k;
        assert_same_bits("K", &whole, &bench.render(&small));
    }
    small.cells_per_pass = 0;
    // Images come with storage buffers, the queue with texel buffers.
    let [images, queue] = [RayLoop::Images, RayLoop::Queue].map(|ray_loop| {
        small.ray_loop = ray_loop;
        bench.render(&small)
    });
    assert_same_bits("loops", &images, &queue);
    let large = "[image]\nsize = [24, 16]\n[[objects]]\npoints = \"s.ply\"\n\
                 surface = { feature_size = 0.5 }";
    let mut long = plan(large, &[set_of(fibonacci_sphere(60_000))], Primary::Discs);
    let by_discs = bench.render(&long);
    assert!(by_discs.passes > 1, "passes: {}", by_discs.passes);
    long.primary = Primary::Grid;
    assert_same_film("long lists", &by_discs.film, &bench.render(&long).film);
}

/// More pairs than fit: the grid takes over, and nothing but the time tells.
#[test]
fn too_many_pairs_fall_back_to_the_grid() {
    let bench = Bench::open();
    let text = "[image]\nsize = [1024, 512]\n[[objects]]\npoints = \"s.ply\"\n\
                surface = { feature_size = 5.0 }";
    let sets = [set_of(wavy_sheet(2_000))];
    let [mut by_grid, mut by_discs] =
        [Primary::Grid, Primary::Discs].map(|primary| plan(text, &sets, primary));
    assert!(2_000 / LEAF_POINTS * plan::screen_tiles(&by_discs.window) > MAX_DISC_PAIRS);
    for plan in [&mut by_grid, &mut by_discs] {
        plan.diagnostics = Diagnostic::ALL.to_vec();
    }
    assert_same_bits("fallback", &bench.render(&by_grid), &bench.render(&by_discs));
}

/// Few points a pixel, enough pixels, and nobody who looks at cells.
#[test]
fn auto_takes_discs_where_they_are_faster() {
    let sets = [set_of(fibonacci_sphere(2_000))];
    let by_discs = |size: &str, change: fn(&mut Plan)| {
        let mut plan = plan(&format!("[image]\nsize = {size}"), &sets, Primary::Auto);
        change(&mut plan);
        plan.by_discs(&plan.tiles()[0])
    };
    assert!(by_discs("[320, 240]", |_| ()));
    assert!(!by_discs("[80, 60]", |_| ()), "few pixels");
    assert!(!by_discs("[320, 240]", |plan| plan.cells_per_pass = 1), "the paper's loop");
    assert!(!by_discs("[320, 240]", |plan| plan.diagnostics = vec![Diagnostic::Cells]));
    assert!(by_discs("[320, 240]", |plan| plan.diagnostics = vec![Diagnostic::Point]));
}
