//! Positions, matrices and origin of a file are in one frame, and of use there: through the matrices, a position
//! lands in the middle of its pixel, wherever the scene lies and however large it is.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use harness::{Rendered, fibonacci_sphere, moved, plan_of, render_twin, set_of, shared_data};
use plan::{Extra, Plan, Window};
use points::PointSet;
use reference::Reference;

/// Pixels that the arithmetic of positions and matrices may be off by, beside half a step of f32 in each coordinate.
const OFF: f64 = 0.01;

fn half_step(x: f64) -> f64 {
    0.5 * points::single_step(x)
}

/// Checks P of each hit, and returns how many there are and how far the worst is off, in pixels.
fn checked(name: &str, plan: &Plan, film: &film::Film) -> (usize, f64) {
    let provenance = plan.provenance();
    let apply = |m: &[[f32; 4]; 4], p: [f64; 3]| {
        [0, 1, 2, 3]
            .map(|j| (0..3).map(|i| p[i] * f64::from(m[i][j])).sum::<f64>() + f64::from(m[3][j]))
    };
    let place = |p: [f64; 3]| {
        let [x, y, _, w] = apply(&provenance.world_to_ndc, p);
        [x / w * f64::from(film.size[0]), y / w * f64::from(film.size[1])]
    };
    let (mut hits, mut worst) = (0, 0.0f64);
    for at in (0..film.object.len()).filter(|&at| film.object[at] >= 0.0) {
        let p = film.position[at].map(f64::from);
        let width = film.window.width as usize;
        let pixel = [at % width + film.window.x as usize, at / width + film.window.y as usize];
        let here = place(p);
        // What half a step of each coordinate moves on the picture, by differences.
        let rounding = |axis: usize| -> f64 {
            (0..3)
                .map(|i| {
                    let h = 1e3 * half_step(p[i].max(1e-3));
                    let mut q = p;
                    q[i] += h;
                    (place(q)[axis] - here[axis]).abs() / h * half_step(p[i])
                })
                .sum()
        };
        for axis in 0..2 {
            let off = (here[axis] - pixel[axis] as f64 - 0.5).abs();
            let limit = OFF + rounding(axis);
            assert!(
                off <= limit,
                "{name}: pixel {pixel:?} lands at {here:?}, {off} of {limit} off"
            );
            worst = worst.max(off);
        }
        let depth = f64::from(film.depth[at]);
        let step = half_step(depth.abs()) + (0..3).map(|i| half_step(p[i])).sum::<f64>();
        let error = (-apply(&provenance.world_to_camera, p)[2] - depth).abs();
        // A depth is a dot product of f32: a few of its own steps.
        assert!(error <= 8.0 * step, "{name}: depth {depth} off by {error}, steps of {step}");
        hits += 1;
    }
    (hits, worst)
}

/// A ball of points, of so large a radius, about a place.
fn ball(radius: f64, middle: [f64; 3]) -> PointSet {
    let sphere = fibonacci_sphere(4000);
    let scaled: Vec<[f64; 3]> = sphere.iter().map(|p| p.map(|x| radius * x)).collect();
    set_of(moved(&scaled, middle))
}

fn view(radius: f64, middle: [f64; 3], from: f64, more: &str) -> String {
    let at = |v: [f64; 3]| [0, 1, 2].map(|axis| middle[axis] + radius * v[axis]);
    let (eye, target) = (at([0.6 * from, 0.48 * from, 0.64 * from]), at([0.05, -0.02, 0.0]));
    format!("[camera]\neye = {eye:?}\ntarget = {target:?}\n{more}\n[image]\nsize = [320, 240]\n")
}

/// The middle, the radius and the distance of the eye in radii.
const PLACES: [(&str, f64, [f64; 3]); 8] = [
    ("unit sphere", 1.0, [0.0; 3]),
    ("a little aside", 1.0, [9.0, -12.0, 3.0]),
    ("survey", 180.0, [412_345.678, 5_412_345.678, 312.5]),
    ("geocentric", 35.0, [4_027_894.006, 307_045.600, 4_919_474.910]),
    ("small and far from the middle of the world", 1.0, [1e4, -1e4, 1e4]),
    ("a thousandth", 1e-3, [0.0; 3]),
    ("a million", 1e6, [2e5, 0.0, -7e5]),
    ("a thousandth, far", 1e-3, [12.345, 67.89, -1.0]),
];

#[test]
fn positions_land_in_the_middle_of_their_pixels() {
    for (name, radius, middle) in PLACES {
        for (kind, from, more) in [
            ("perspective", 4.0, "vertical_fov = 32"),
            ("tele", 1e4, "vertical_fov = 0.013"),
            ("near", 1.3, "vertical_fov = 100"),
            ("parallel", 4.0, "projection = \"orthographic\"\nheight = HEIGHT"),
            ("lens", 4.0, "vertical_fov = 32\naperture = APERTURE"),
        ] {
            let more = more
                .replace("HEIGHT", &format!("{}", 2.3 * radius))
                .replace("APERTURE", &format!("{}", 0.2 * radius));
            let mut plan = plan_of(&view(radius, middle, from, &more), &[ball(radius, middle)]);
            let whole = plan.window;
            for window in [whole, Window { origin: [101, 33], size: [77, 55] }] {
                plan.window = window;
                let name = format!("{name}, {kind}, {window:?}");
                let (hits, _) = checked(&name, &plan, &render_twin(&plan).film);
                assert!(hits > window.pixels() / 4, "{name}: {hits} hits");
            }
        }
    }
}

/// A picture of a two-hundredth of the scene, eight sizes of it away from where its coordinates begin: one step of f32 is
/// half a hundredth of a pixel there.
#[test]
fn positions_of_a_small_part_of_a_scene_do_as_well() {
    let sheet: Vec<[f64; 3]> = (0..40_000)
        .map(|i| [f64::from(i % 200) * 0.005 + 7.0, f64::from(i / 200) * 0.005 - 7.0, 0.0])
        .collect();
    let text = "[camera]\neye = [7.313, -6.69, 0.02]\ntarget = [7.31, -6.687, 0.0]\nvertical_fov = 14\nup = [0, 0, 1]\n\
                [image]\nsize = [320, 240]\n";
    let plan = plan_of(text, &[set_of(sheet)]);
    assert_eq!(plan.provenance().origin, [0.0; 3]);
    let (hits, _) = checked("sheet", &plan, &render_twin(&plan).film);
    assert_eq!(hits, 320 * 240);
}

/// Where the numbers of the file are fine, nothing is subtracted; else a few digits.
#[test]
fn origins_are_none_or_short() {
    let origin = |radius: f64, middle: [f64; 3]| {
        plan_of("[image]\nsize = [32, 24]", &[ball(radius, middle)]).provenance().origin
    };
    let expected = [
        [0.0; 3],
        [0.0; 3],
        [412_350.0, 5_412_350.0, 310.0],
        [4_027_895.0, 307_045.0, 4_919_475.0].map(|x: f64| x.round()),
        [1e4, -1e4, 1e4],
        [0.0; 3],
        [0.0; 3],
        [12.345, 67.89, -1.0],
    ];
    for ((name, radius, middle), expected) in PLACES.into_iter().zip(expected) {
        if name == "geocentric" {
            // 70 across: whole numbers. The points of the ball are not quite symmetric.
            let found = origin(radius, middle);
            assert!(
                (0..3).all(|i| (found[i] - middle[i]).abs() < 0.6 && found[i].fract() == 0.0),
                "{found:?}"
            );
        } else {
            assert_eq!(origin(radius, middle), expected, "{name}");
        }
    }
}

/// One point far off is no part of the scene's size: it moves neither origin nor positions.
#[test]
fn a_stray_point_changes_neither_origin_nor_positions() {
    let middle = [412_345.678, 5_412_345.678, 312.5];
    let render = |strays: &[[f64; 3]]| {
        let mut set = ball(50.0, middle);
        set.positions.extend(strays);
        let count = set.positions.len() as u32;
        let set = PointSet { file_index: (0..count).collect(), ..set };
        let plan = plan_of("[image]\nsize = [160, 120]", &[set]);
        (plan.provenance().clone(), render_twin(&plan).film)
    };
    let (clean, film) = render(&[]);
    for strays in [vec![[0.0; 3]], vec![[1e9, -1e9, 0.0]]] {
        let (found, stray_film) = render(&strays);
        assert_eq!(found.origin, clean.origin, "{strays:?}");
        assert_eq!(found.world_to_ndc, clean.world_to_ndc, "{strays:?}");
        assert_eq!(stray_film.position, film.position, "{strays:?}");
    }
}

fn plane<'a>(rendered: &'a Rendered, name: &str) -> &'a [f32] {
    let found = rendered.film.extra.iter().find(|(plane, _)| plane == name);
    &found.expect("a plane of that name").1
}

/// world + worldLow is the frame's position plus its origin, and lies on the ball that was seen: to the step of the
/// kernels' own positions there, 2^-17 at 64 to 128.
#[test]
fn world_positions_keep_their_digits() {
    let (radius, middle) = (80.0, [412_345.678, 5_412_345.678, 312.5]);
    let mut plan = plan_of(&view(radius, middle, 4.0, ""), &[ball(radius, middle)]);
    plan.extras = Extra::ALL.to_vec();
    let rendered = render_twin(&plan);
    let origin = plan.provenance().origin;
    let planes = ["world.X", "world.Y", "world.Z", "worldLow.X", "worldLow.Y", "worldLow.Z"]
        .map(|name| plane(&rendered, name));
    let mut hits = 0;
    for (at, object) in rendered.film.object.iter().enumerate() {
        let world =
            [0, 1, 2].map(|axis| f64::from(planes[axis][at]) + f64::from(planes[axis + 3][at]));
        if *object < 0.0 {
            assert_eq!(world, [0.0; 3]);
            continue;
        }
        hits += 1;
        for axis in 0..3 {
            let p = f64::from(rendered.film.position[at][axis]);
            let error = (world[axis] - origin[axis] - p).abs();
            assert!(error <= half_step(p) + 2f64.powi(-46) * 5.5e6, "pixel {at}: {error}");
        }
        let off =
            (0..3).map(|axis| (world[axis] - middle[axis]).powi(2)).sum::<f64>().sqrt() - radius;
        // Polynomials over points 0.05 radii apart err by 1e-5 of the radius.
        assert!(off.abs() < 2e-5 * radius, "pixel {at}: {off} off the ball");
    }
    assert!(hits > 10_000, "{hits} hits");
}

/// The engine in f64 writes the same frame.
#[test]
fn the_reference_in_double_precision_is_in_the_same_frame() {
    let (radius, middle) = (180.0, [412_345.678, 5_412_345.678, 312.5]);
    let plan = plan_of(&view(radius, middle, 4.0, ""), &[ball(radius, middle)]);
    let single = render_twin(&plan).film;
    let double = Reference::<f64>::new(&plan, &points::Unwatched).expect("not interrupted");
    let film = double.frame(&plan, &points::Unwatched).expect("not interrupted").finish();
    let (hits, _) = checked("f64", &plan, &film);
    assert!(hits > 20_000, "{hits}");
    for (a, b) in single.position.iter().zip(&film.position) {
        // At an outline one of them may see nothing, or farther round.
        let far = (0..3).map(|axis| f64::from(a[axis] - b[axis]).abs()).fold(0.0, f64::max);
        assert!(far < 0.01 * radius || a == &[0.0; 3] || b == &[0.0; 3], "{a:?} {b:?}");
    }
}

/// Laser scans of a survey in feet, and a height map.
#[test]
fn positions_of_scans_land_in_the_middle_of_their_pixels() {
    for file in ["scans/autzen_trim.laz", "terrain/rainier_256.ply", "reported/utm_ball_zero.npy"] {
        let Some(path) = shared_data(file) else { continue };
        let set = points::read(&path, &mut |_, _| {}).expect("a readable file");
        let plan = plan_of("[image]\nsize = [400, 300]\n", &[set]);
        let (hits, worst) = checked(file, &plan, &render_twin(&plan).film);
        assert!(hits > 1000, "{file}: {hits} hits");
        assert!(worst < 0.05, "{file}: {worst} pixels");
    }
}
