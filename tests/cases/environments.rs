//! Environments that are turned: by the axis that is up, and by `background.rotate`.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use film::{Film, Image, Texels};
use harness::analytic::{
    Body, Matter, Shape, V3, add, cross, dot, environment_at, environment_of, follow, looked_up,
    turned_back, unit,
};
use harness::{Bench, assert_same_bits, fibonacci_sphere, plan_with, render_twin, set_of};
use plan::{Plan, SceneImages};
use scene::{Scene, Up};
use std::path::Path;
use std::sync::Arc;

const SIZE: [usize; 2] = [96, 72];
const EYE: V3 = [0.7, -0.5, 2.2];
const TARGET: V3 = [0.1, 0.2, -0.1];
const FOV: f64 = 70.0;

fn smooth() -> Arc<Image> {
    Arc::new(environment_of(512, |[x, y, z]| {
        [1.0 + 0.5 * x + 0.2 * y * z, 1.0 + 0.6 * y, 1.0 + 0.4 * z - 0.3 * x * y]
    }))
}

/// A scene with this camera, and a ball of that material in its middle.
fn text(up: V3, rotate: V3, material: &str) -> String {
    format!(
        "[camera]\neye = {EYE:?}\ntarget = {TARGET:?}\nup = {up:?}\nvertical_fov = {FOV:?}\n\
         [image]\nsize = {SIZE:?}\n\
         [background]\nenvironment = \"sky.exr\"\nrotate = {rotate:?}\n\
         [[objects]]\npoints = \"ball.ply\"\ntransform.scale = 0.6\nmaterial = {{ {material} }}\n"
    )
}

fn plan(text: &str, image: &Arc<Image>) -> Plan {
    let images = SceneImages { environment: Some(Arc::clone(image)), textures: Vec::new() };
    plan_with(text, &[set_of(fibonacci_sphere(20_000))], &images)
}

fn through(up: V3, pixel: usize) -> V3 {
    let forward = unit(add(TARGET, EYE, -1.0));
    let right = unit(cross(forward, up));
    let above = cross(right, forward);
    let half = (0.5 * FOV.to_radians()).tan() / (0.5 * SIZE[1] as f64);
    let x = ((pixel % SIZE[0]) as f64 + 0.5 - 0.5 * SIZE[0] as f64) * half;
    let y = (0.5 * SIZE[1] as f64 - (pixel / SIZE[0]) as f64 - 0.5) * half;
    unit(add(add(forward, right, x), above, y))
}

/// The worst error of the background, and the 95th percentile of those of what the ball shows.
fn errors(film: &Film, image: &Image, up: V3, rotate: V3, matter: Matter) -> [f64; 2] {
    let body = Body { shape: Shape::Sphere([0.0; 3], 0.6), matter };
    let (mut background, mut ball) = (0.0f64, Vec::new());
    for pixel in 0..SIZE[0] * SIZE[1] {
        let d = through(up, pixel);
        let nearest = add(EYE, d, -dot(EYE, d));
        let share = dot(nearest, nearest).sqrt() / 0.6;
        let way = follow(&[body], EYE, d);
        let own = looked_up(up, turned_back(rotate, way.direction));
        let seen = environment_at(image, own);
        let error =
            (0..3).map(|c| (f64::from(film.color[pixel][c]) - seen[c]).abs()).fold(0.0, f64::max);
        if share > 1.02 {
            background = background.max(error);
        } else if share < 0.9 {
            ball.push(error);
        }
    }
    ball.sort_by(f64::total_cmp);
    assert!(ball.len() > 300, "{} pixels of the ball", ball.len());
    [background, ball[ball.len() * 95 / 100]]
}

const UPS: [V3; 8] = [
    [0.0, 1.0, 0.0],
    [0.0, -2.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -0.5],
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    // No axis: as for +y.
    [0.0, 0.1, 1.0],
    [1.0, 1.0, 1.0],
];

/// The background, and what a mirror and glass show of it. A direction's f32 roundings are worth 1e-7 of a radiance
/// that changes by less than 1 a radian, and u and v are rounded to 6e-8 of 1024 texels whose neighbours differ by
/// 6e-3: under 2e-6; balls add the errors of their surfaces (docs/method.md, section 6).
#[test]
fn directions_are_looked_up_as_documented() {
    let image = smooth();
    let mirror = ("kind = \"mirror\"", Matter::Mirror([1.0; 3]));
    let glass = ("kind = \"glass\"", Matter::Glass(1.5, 0.0));
    let turns = [[0.0; 3], [90.0, 0.0, 0.0], [20.0, -35.0, 140.0], [0.0, 370.0, 0.0]];
    for (i, up) in UPS.into_iter().enumerate() {
        for (j, rotate) in turns.into_iter().enumerate() {
            let (material, matter) = if (i + j) % 2 == 0 { mirror } else { glass };
            let film = render_twin(&plan(&text(up, rotate, material), &image)).film;
            let [background, ball] = errors(&film, &image, up, rotate, matter);
            assert!(background < 4e-6, "up {up:?}, {rotate:?}: background off by {background:e}");
            assert!(ball < 2e-4, "up {up:?}, {rotate:?}, {material}: ball off by {ball:e}");
        }
    }
}

/// In a scene with +z up, the texels of the horizon are the middle rows, and the zenith is the top row.
#[test]
fn a_scene_with_z_up_has_a_level_horizon() {
    let rows = 64;
    let texel = |i: u32| [if i / 128 < rows / 2 { 1.0 } else { 0.0 }, (i / 128) as f32, 0.0];
    let image = Arc::new(Image {
        width: 128,
        height: rows,
        texels: Texels::Linear((0..128 * rows).map(texel).collect()),
    });
    let text = "[camera]\neye = [9.0, 9.0, 0.0]\ntarget = [10.0, 9.5, 0.0]\nup = [0.0, 0.0, 1.0]\n\
                [image]\nsize = [64, 64]\n[background]\nenvironment = \"sky.exr\"\n";
    let film = render_twin(&plan(text, &image)).film;
    for (pixel, color) in film.color.iter().enumerate() {
        let row = pixel / 64;
        if row.abs_diff(32) > 5 {
            assert_eq!(color[0], if row < 32 { 1.0 } else { 0.0 }, "row {row}");
        }
    }
    // Straight up: the camera's up is another axis then.
    let text = text.replace("target = [10.0, 9.5, 0.0]", "target = [9.0, 9.0, 1.0]");
    let text = text.replace("up = [0.0, 0.0, 1.0]", "up = [0.0, 1e-9, 0.0]");
    let film = render_twin(&plan(&text, &image)).film;
    assert!((film.color[32 * 64 + 32][1] - 31.5).abs() < 1.0, "+y is up: +z is on the horizon");
}

/// An automatic camera's up counts as a given one's.
#[test]
fn an_automatic_camera_decides_as_a_given_one_does() {
    let image = smooth();
    let images = SceneImages { environment: Some(Arc::clone(&image)), textures: Vec::new() };
    let text = "[image]\nsize = [96, 72]\n[background]\nenvironment = \"sky.exr\"\n\
                [[objects]]\npoints = \"ball.ply\"\n";
    let scene = Scene::from_toml(text, Path::new("s.toml"), &[]).expect("a scene");
    let set = Arc::new(set_of(fibonacci_sphere(2_000)));
    for (up, axis) in
        [(Up::Y, [0.0, 1.0, 0.0]), (Up::Z, [0.0, 0.0, 1.0]), (Up::MinusY, [0.0, -1.0, 0.0])]
    {
        let plan = Plan::new(&scene, &[Arc::clone(&set)], &images, None, up).expect("a plan");
        let film = render_twin(&plan).film;
        let [right, above, forward] =
            [plan.camera.right, plan.camera.up, plan.camera.forward].map(|v| v.map(f64::from));
        let mut seen = 0;
        for pixel in (0..96 * 72).filter(|&pixel| film.color[pixel][3] == 0.0) {
            let scale = f64::from(plan.camera.scale);
            let x = ((pixel % 96) as f64 + 0.5 - 48.0) * scale;
            let y = (36.0 - (pixel / 96) as f64 - 0.5) * scale;
            let d = unit(add(add(forward, right, x), above, y));
            let expected = environment_at(&image, looked_up(axis, d));
            for (c, expected) in expected.into_iter().enumerate() {
                let found = f64::from(film.color[pixel][c]);
                assert!((found - expected).abs() < 4e-6, "{axis:?}, pixel {pixel}: {found}");
            }
            seen += 1;
        }
        assert!(seen > 2_000, "{seen} pixels of background");
    }
}

/// Device and twin, where rays are traced in one pass, in several, and go on from mirrors and glass.
#[test]
fn turned_environments_are_the_same_to_the_bit() {
    let bench = Bench::open();
    let image = smooth();
    for (up, rotate, material) in [
        ([0.0, 0.0, 1.0], [0.0; 3], "kind = \"mirror\""),
        ([0.0, 1.0, 0.0], [20.0, -35.0, 140.0], "kind = \"glass\", ior = [1.4, 1.5, 1.6]"),
        ([-1.0, 0.0, 0.0], [0.0, 0.0, 12.5], "kind = \"diffuse\""),
    ] {
        for more in ["", "samples = 2\n"] {
            let text = text(up, rotate, material).replace("[image]\n", &format!("[image]\n{more}"));
            let plan = plan(&text, &image);
            assert_same_bits(&text, &bench.render(&plan), &render_twin(&plan));
        }
    }
}

/// A full turn, and an up of +y of any length, leave every bit.
#[test]
fn what_turns_nothing_changes_no_bit() {
    let image = smooth();
    let glass = "kind = \"glass\"";
    let plain = render_twin(&plan(&text([0.0, 1.0, 0.0], [0.0; 3], glass), &image)).film;
    let full = render_twin(&plan(&text([0.0, 2.5, 0.0], [360.0, 0.0, -720.0], glass), &image)).film;
    assert_eq!(plain.color, full.color);
}
