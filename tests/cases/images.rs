//! Textures, false colours, colours of points and the environment.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use film::{Film, Image, Texels};
use harness::{
    Bench, assert_same_bits, fibonacci_sphere, grid_points, plan_of, plan_with, random,
    render_twin, set_of, wavy_sheet, with_attribute,
};
use plan::{Plan, PlanError, SceneImages};
use points::{PointSet, Unwatched};
use reference::Reference;
use render::{RenderError, Renderer};
use scene::{Scene, Transform, Up};
use std::path::Path;
use std::sync::Arc;

/// An image whose texels hold column over width, row over height, and a half. Between the centres of its
/// outer texels, bilinear interpolation gives back the very place.
fn places(width: u32, height: u32) -> Arc<Image> {
    let texel = |i: u32| {
        let [column, row] = [i % width, i / width].map(|at| at as f32 + 0.5);
        [column / width as f32, row / height as f32, 0.5]
    };
    let texels = Texels::Linear((0..width * height).map(texel).collect());
    Arc::new(Image { width, height, texels })
}

/// Random bytes.
fn noise(width: u32, height: u32) -> Arc<Image> {
    let mut seed = 9;
    let mut byte = || (random(&mut seed) * 256.0) as u8;
    let texels = (0..width * height).map(|_| [byte(), byte(), byte()]).collect();
    Arc::new(Image { width, height, texels: Texels::Srgb8(texels) })
}

fn textured(image: &Arc<Image>) -> SceneImages {
    SceneImages { environment: None, textures: vec![Some(Arc::clone(image))] }
}

/// A camera that sees the unit square around `target` from the positive end of an axis, and a light from
/// there of irradiance pi: what is seen is the albedo.
fn seen_from(axis: usize, target: [f64; 3]) -> String {
    let mut eye = target;
    eye[axis] += 3.0;
    let mut light = [0.0; 3];
    light[axis] = -1.0;
    // As maps are drawn: from above, -z is upwards.
    let up = if axis == 1 { [0.0, 0.0, -1.0] } else { [0.0, 1.0, 0.0] };
    let pi = std::f64::consts::PI;
    format!(
        "[camera]\neye = {eye:?}\ntarget = {target:?}\nup = {up:?}\nvertical_fov = 25.0\n\
         [image]\nsize = [96, 64]\n\
         [[lights]]\nkind = \"directional\"\ndirection = {light:?}\nirradiance = {:?}\n",
        [pi; 3]
    )
}

/// A plane across an axis, 1.5 by 1.
fn plane_across(axis: usize) -> Vec<[f64; 3]> {
    grid_points(40)
        .into_iter()
        .map(|[a, _, b]| match axis {
            0 => [0.7, b, 1.5 * a],
            1 => [1.5 * a, 0.7, b],
            _ => [1.5 * a, b, 0.7],
        })
        .collect()
}

/// Pixels that hit something: place in the picture, position, colour.
fn hits(film: &Film) -> Vec<([usize; 2], [f64; 3], [f32; 4])> {
    let width = film.window.width as usize;
    let hit = |&i: &usize| film.object[i] >= 0.0;
    let all = (0..film.object.len()).filter(hit);
    all.map(|i| ([i % width, i / width], film.position[i].map(f64::from), film.color[i])).collect()
}

/// Where, on a plane across y, the rims are far.
fn inner(p: [f64; 3]) -> bool {
    (0.1..1.35).contains(&p[0]) && (0.1..0.87).contains(&p[2])
}

fn twin(plan: &Plan) -> Film {
    render_twin(plan).film
}

/// From the positive end of each axis, the picture stands upright and is not mirrored; and its places are
/// those over the bounding box.
#[test]
fn textures_lie_as_seen_from_the_positive_axis() {
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let set = set_of(plane_across(axis));
        let (min, max) = set.bounds().expect("points");
        let middle = [0, 1, 2].map(|i| 0.5 * (min[i] + max[i]));
        let text = format!(
            "{}[[objects]]\npoints = \"p.ply\"\n\
             material = {{ texture = \"t.png\", texture_axis = \"{name}\" }}\n",
            seen_from(axis, middle)
        );
        let film = twin(&plan_with(&text, &[set], &textured(&places(64, 64))));
        let over = |at: f64, i: usize| (at - min[i]) / (max[i] - min[i]);
        let found = hits(&film);
        assert!(found.len() > 2_000, "{name}: {} hits", found.len());
        for &(_, p, color) in &found {
            let [u, v] = match axis {
                0 => [1.0 - over(p[2], 2), 1.0 - over(p[1], 1)],
                1 => [over(p[0], 0), over(p[2], 2)],
                _ => [over(p[0], 0), 1.0 - over(p[1], 1)],
            };
            for (expected, found) in [(u, color[0]), (v, color[1]), (0.5, color[2])] {
                // Half a texel at the rims is clamped: 1/128.
                let expected = expected.clamp(1.0 / 128.0, 127.0 / 128.0);
                assert!((expected - f64::from(found)).abs() < 5e-6, "{name} at {p:?}: {color:?}");
            }
        }
        // To the right of the picture, u grows; downwards, v.
        let at = |x: usize, y: usize| film.color[y * 96 + x];
        assert!(at(60, 32)[0] > at(36, 32)[0] && at(48, 40)[1] > at(48, 24)[1], "{name}");
    }
}

#[test]
fn textures_move_with_the_object() {
    let transform = Transform { scale: 0.4, rotate: [90.0, 0.0, 0.0], translate: [7.0, 2.0, -3.0] };
    let set = set_of(plane_across(1));
    // Turned about x, -z of the file is up: what +y saw is seen from +z.
    let text = format!(
        "{}[[objects]]\npoints = \"p.ply\"\nmaterial = {{ texture = \"t.png\" }}\n\
         transform = {{ scale = 0.4, rotate = [90.0, 0.0, 0.0], translate = [7.0, 2.0, -3.0] }}\n",
        seen_from(2, transform.apply([0.73, 0.7, 0.49]))
    );
    let film = twin(&plan_with(&text, &[set], &textured(&places(64, 64))));
    let found = hits(&film);
    assert!(found.len() > 400, "{} hits", found.len());
    for (_, p, color) in found {
        let (x, z) = ((p[0] - 7.0) / 0.4, (2.0 - p[1]) / 0.4);
        let expected = [x / 1.4625, z / 0.975].map(|at| at.clamp(1.0 / 128.0, 127.0 / 128.0));
        for (expected, found) in expected.into_iter().zip(color) {
            // P is rounded to the f32 of the world's coordinates: 2.4e-7 / 0.4 and what follows.
            assert!((expected - f64::from(found)).abs() < 5e-6, "at {p:?}: {color:?}");
        }
    }
}

/// u and v, given by the points, are interpolated at the hit; v counts from the bottom row.
#[test]
fn places_of_points_are_interpolated() {
    for [u, v] in [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]] {
        let set = with_attribute(set_of(plane_across(1)), u, |p| 0.1 + 0.5 * p[0]);
        let set = with_attribute(set, v, |p| 0.9 - 0.8 * p[2]);
        let text = format!(
            "{}[[objects]]\npoints = \"p.ply\"\nmaterial.texture = \"t.png\"\n",
            seen_from(1, [0.73, 0.7, 0.49])
        );
        let film = twin(&plan_with(&text, &[set], &textured(&places(64, 64))));
        let mut worst = 0.0f64;
        for (_, p, color) in hits(&film).into_iter().filter(|hit| inner(hit.1)) {
            let [u, v] = [0.1 + 0.5 * p[0], 0.1 + 0.8 * p[2]];
            worst = worst.max((u - f64::from(color[0])).abs()).max((v - f64::from(color[1])).abs());
        }
        println!("{u}, {v}: error {worst:.2e}");
        // A thirtieth of the step from one point to the next, which is 0.019 in u and 0.02 in v.
        assert!(worst < 0.0007, "{u}, {v}: error {worst}");
    }
}

/// A linear ramp of colours on even and on random points: the error of its weighted mean, over the step
/// of the ramp from one point to the next, and no two neighbouring pixels alike.
#[test]
fn a_ramp_of_colors_stays_a_ramp() {
    let mut seed = 5;
    let scattered: Vec<[f64; 3]> =
        (0..1600).map(|_| [1.5 * random(&mut seed), 0.7, random(&mut seed)]).collect();
    for (name, positions, limit) in [("even", plane_across(1), 0.03), ("random", scattered, 1.3)] {
        let mut set = set_of(positions);
        set.colors =
            Some(set.positions.iter().map(|p| [p[0] as f32 / 1.5, p[2] as f32, 0.25]).collect());
        let text = seen_from(1, [0.73, 0.7, 0.49]);
        let film = twin(&plan_of(&text, &[set]));
        let found: Vec<_> = hits(&film).into_iter().filter(|hit| inner(hit.1)).collect();
        let mut sum = 0.0;
        let mut worst = 0.0f64;
        for (_, p, color) in &found {
            // 1600 points: 40 steps along each side.
            let error = (p[0] / 1.5 - f64::from(color[0])).abs() * 40.0;
            sum += error;
            worst = worst.max(error);
            assert!((color[2] - 0.25).abs() < 1e-6, "a constant stays: {color:?}");
        }
        println!("{name}: mean {:.3}, worst {worst:.3} steps", sum / found.len() as f64);
        assert!(worst < limit, "{name}: {worst} steps");
        let flat = found.windows(2).filter(|pair| pair[0].2[0] == pair[1].2[0]).count();
        assert!(flat * 100 < found.len(), "{name}: {flat} of {} pixels are flat", found.len());
    }
}

/// Blending never looks through a wall: trust balls of 0.06 around a sheet 0.04 below hold the upper one.
#[test]
fn colors_of_another_sheet_do_not_shine_through() {
    let sheet = plane_across(1);
    let below: Vec<[f64; 3]> = sheet.iter().map(|p| [p[0], p[1] - 0.04, p[2]]).collect();
    let mut set = set_of([sheet, below].concat());
    let red_over_green =
        (0..set.len()).map(|i| if i < set.len() / 2 { [0.8, 0.0, 0.0] } else { [0.0, 0.8, 0.0] });
    set.colors = Some(red_over_green.collect());
    let text = format!(
        "{}[[objects]]\npoints = \"p.ply\"\nsurface = {{ neighbors = 4, feature_size = 0.1 }}\n",
        seen_from(1, [0.73, 0.7, 0.49])
    );
    let found = hits(&twin(&plan_of(&text, &[set])));
    assert!(found.len() > 2_000, "{} hits", found.len());
    for (_, p, color) in found.into_iter().filter(|hit| inner(hit.1)) {
        assert!(p[1] < 0.69 || color[1] == 0.0, "at {p:?}: {color:?}");
    }
}

/// Gray at a value is the sRGB of its part of the range: here, the height of a slope.
#[test]
fn attributes_are_shown_in_the_colors_of_their_map() {
    let set = with_attribute(set_of(plane_across(1)), "heat", |p| 100.0 * p[0]);
    let render = |material: &str| {
        let text = format!(
            "{}[[objects]]\npoints = \"p.ply\"\nmaterial = {{ {material} }}\n",
            seen_from(1, [0.73, 0.7, 0.49])
        );
        twin(&plan_of(&text, std::slice::from_ref(&set)))
    };
    let heat = render("albedo = \"attribute:heat\", color_map = \"gray\", value_range = [0, 200]");
    for (_, p, color) in hits(&heat).into_iter().filter(|hit| inner(hit.1)) {
        let expected = film::linear_from_srgb(100.0 * p[0] / 200.0);
        // The mean over a few points of a curve that is bent, and a step of 0.019 in brightness.
        assert!((expected - f64::from(color[0])).abs() < 2e-3, "at {p:?}: {color:?}");
    }
    // Without a range, the attribute's own; without such an attribute, the coordinate.
    let own = render("albedo = \"attribute:heat\", color_map = \"gray\"");
    let x = render("albedo = \"attribute:x\", color_map = \"gray\"");
    assert_eq!(own.color, x.color);
}

/// What no file should have: values that are no numbers, infinite colours, places far outside.
#[test]
fn strange_values_give_finite_pictures() {
    let mut set = set_of(plane_across(1));
    let strange = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 0.0];
    let pick = move |p: [f64; 3]| strange[(p[0] * 40.0) as usize % 6];
    set.colors = Some(set.positions.iter().map(|&p| [pick(p) as f32; 3]).collect());
    for name in ["u", "v", "odd"] {
        set = with_attribute(set, name, pick);
    }
    let image = noise(16, 16);
    for material in [
        "albedo = \"points\"",
        "albedo = \"attribute:odd\"",
        "albedo = \"attribute:odd\", value_range = [-1e300, 1e300]",
        "texture = \"t.png\"",
    ] {
        let text = format!(
            "{}[[objects]]\npoints = \"p.ply\"\nmaterial = {{ {material} }}\n",
            seen_from(1, [0.73, 0.7, 0.49])
        );
        let images =
            if material.contains("texture") { textured(&image) } else { SceneImages::default() };
        let film = twin(&plan_with(&text, std::slice::from_ref(&set), &images));
        assert!(film.color.as_flattened().iter().all(|c| c.is_finite()), "{material}");
    }
}

/// Objects of every kind before an environment.
fn everything(transparent: bool) -> Plan {
    let text = format!(
        "[camera]\neye = [0.6, 0.9, 3.2]\ntarget = [0.6, 0.3, 0.3]\nvertical_fov = 60.0\n\
         [image]\nsize = [160, 120]\ntransparent = {transparent}\n\
         [background]\nenvironment = \"sky.hdr\"\n\
         [[lights]]\nkind = \"directional\"\ndirection = [-0.4, -1.0, -0.3]\nirradiance = [3.0, 2.9, 2.7]\n\
         [[lights]]\nkind = \"point\"\nposition = [0.5, 1.0, 3.0]\nintensity = [2.0, 2.0, 2.5]\n\
         [[objects]]\npoints = \"a.ply\"\nmaterial.texture = \"noise.png\"\n\
         [[objects]]\npoints = \"b.ply\"\ntransform = {{ scale = 0.4, translate = [1.2, 0.5, 0.5] }}\n\
         material = {{ texture = \"places.exr\", texture_axis = \"z\" }}\n\
         [[objects]]\npoints = \"c.ply\"\ntransform = {{ scale = 0.3, rotate = [10.0, 40.0, 0.0] }}\n\
         surface.normals = \"blended\"\nmaterial = {{ albedo = \"attribute:z\", color_map = \"turbo\" }}\n\
         [[objects]]\npoints = \"d.ply\"\ntransform = {{ scale = 0.3, translate = [0.4, 0.8, 0.4] }}\n\
         surface.refine = \"project\"\n\
         [[objects]]\npoints = \"e.ply\"\ntransform = {{ scale = 0.8, translate = [-0.9, 0.0, 0.4] }}\n\
         material = {{ texture = \"noise.png\", texture_axis = \"uv\" }}\n"
    );
    let sheet = || set_of(wavy_sheet(3_000));
    let ball = || set_of(fibonacci_sphere(2_000));
    let mut coloured = ball();
    coloured.colors =
        Some(coloured.positions.iter().map(|p| p.map(|c| 0.5 + 0.5 * c as f32)).collect());
    let wrapped = with_attribute(sheet(), "u", |p| 1.3 * p[0] + 0.2 * p[2]);
    let wrapped = with_attribute(wrapped, "v", |p| p[2] - 0.1);
    let noise = noise(37, 21);
    let images = SceneImages {
        environment: Some(places(50, 25)),
        textures: vec![Some(Arc::clone(&noise)), Some(places(9, 17)), None, None, Some(noise)],
    };
    plan_with(&text, &[sheet(), ball(), ball(), coloured, wrapped], &images)
}

#[test]
fn every_color_is_the_same_to_the_bit() {
    let bench = Bench::open();
    for transparent in [false, true] {
        let plan = everything(transparent);
        assert_eq!(plan.image_files.len(), 3, "each image once");
        let on_device = bench.render(&plan);
        assert_same_bits("everything", &on_device, &render_twin(&plan));
        let film = on_device.film;
        for object in 0..5 {
            let pixels = film.object.iter().filter(|&&found| found == object as f32).count();
            assert!(pixels > 100, "object {object}: {pixels} pixels");
        }
        // Transparent, the environment is left out as a colour is.
        let behind: Vec<_> =
            film.color.iter().zip(&film.object).filter(|pixel| *pixel.1 < 0.0).collect();
        assert!(behind.len() > 1_000, "{} pixels of background", behind.len());
        assert!(behind.iter().all(|(color, _)| (**color == [0.0; 4]) == transparent));
    }
}

/// An environment of random bytes all around, by device and twin.
#[test]
fn environments_are_the_same_to_the_bit_in_all_directions() {
    let bench = Bench::open();
    let images = SceneImages { environment: Some(noise(128, 64)), textures: Vec::new() };
    for (target, up) in [
        ([0.0, 0.0, -1.0], [0.0, 1.0, 0.0]),
        ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
        ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        ([0.0, -1.0, 0.0], [1.0, 0.0, 0.0]),
    ] {
        let text = format!(
            "[camera]\neye = [0.0, 0.0, 0.0]\ntarget = {target:?}\nup = {up:?}\nvertical_fov = 120.0\n\
             [image]\nsize = [128, 96]\n[background]\nenvironment = \"sky.png\"\n"
        );
        let plan = plan_with(&text, &[set_of(vec![[0.0; 3]])], &images);
        assert_same_bits("sky", &bench.render(&plan), &render_twin(&plan));
    }
}

/// Looking along each axis, the middle of the picture is the environment's texel there.
#[test]
fn cameras_see_the_environment_where_they_look() {
    let images = SceneImages { environment: Some(places(512, 256)), textures: Vec::new() };
    for (target, up, [u, v]) in [
        ([0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [0.5, 0.5]),
        ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.75, 0.5]),
        ([-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.25, 0.5]),
        (
            [0.1, 0.0, 1.0],
            [0.0, 1.0, 0.0],
            [0.5 + (0.1f64).atan2(-1.0) / std::f64::consts::TAU, 0.5],
        ),
        // Up is no axis there: what is looked up is the direction itself.
        ([0.0, 1.0, -1e-2], [0.0, 1e-3, 1.0], [0.5, (1e-2f64).atan() / std::f64::consts::PI]),
        (
            [0.0, -1.0, -1e-2],
            [0.0, 1e-3, 1.0],
            [0.5, 1.0 - (1e-2f64).atan() / std::f64::consts::PI],
        ),
    ] {
        let text = format!(
            "[camera]\neye = [5.0, 2.0, 1.0]\ntarget = {:?}\nup = {up:?}\nvertical_fov = 10.0\n\
             [image]\nsize = [65, 65]\n[background]\nenvironment = \"sky.exr\"\n",
            [5.0 + target[0], 2.0 + target[1], 1.0 + target[2]]
        );
        let film = twin(&plan_with(&text, &[set_of(vec![[0.0; 3]])], &images));
        let [found_u, found_v, ..] = film.color[32 * 65 + 32];
        // A thousandth of a texel of 1/512.
        assert!((f64::from(found_u) - u).abs() < 2e-6, "{target:?}: u {found_u}, not {u}");
        assert!((f64::from(found_v) - v).abs() < 4e-6, "{target:?}: v {found_v}, not {v}");
    }
}

fn plan_error(text: &str, set: PointSet) -> PlanError {
    let scene = Scene::from_toml(text, Path::new("s.toml"), &[]).expect("a valid scene");
    let images = textured(&noise(2, 2));
    match Plan::new(&scene, &[Arc::new(set)], &images, None, Up::Y) {
        Ok(_) => panic!("planned: {text}"),
        Err(error) => error,
    }
}

#[test]
fn what_points_lack_is_an_error_that_names_what_they_have() {
    let set = || with_attribute(set_of(plane_across(1)), "heat", |_| f64::NAN);
    let text =
        |material: &str| format!("[[objects]]\npoints = \"p.ply\"\nmaterial = {{ {material} }}\n");
    let missing = plan_error(&text("albedo = \"attribute:heart\""), set()).to_string();
    assert!(missing.contains("p.ply has no such attribute; it has heat, x, y, z"), "{missing}");
    let nothing = plan_error(&text("albedo = \"attribute:heat\""), set()).to_string();
    assert!(nothing.contains("none of its values in p.ply is finite"), "{nothing}");
    let places = plan_error(&text("texture = \"t.png\", texture_axis = \"uv\""), set()).to_string();
    assert!(places.contains("p.ply has no attributes u and v"), "{places}");
}

#[test]
fn images_over_the_device_s_limit_are_an_error_that_says_how_large_they_may_be() {
    let bench = Bench::open();
    let mut plan = everything(false);
    let limit = bench.with_device(|device| device.limits().max_storage_buffer_range);
    if limit > 1 << 30 {
        return; // more memory than a test should take
    }
    plan.texels.resize(limit as usize / 4 + 1, 0);
    match bench
        .with_device(|device| Renderer::new(device, &Arc::new(plan.clone()), &Unwatched).map(drop))
    {
        Err(error @ RenderError::Images { .. }) => {
            let message = error.to_string();
            assert!(
                message.contains("sky.hdr") && message.contains("--device reference"),
                "{message}"
            );
        }
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("rendered"),
    }
}

/// f64 says how far f32 is off: shading and sampling keep six digits where pictures are smooth.
#[test]
fn single_precision_is_near_double() {
    let mut plan = everything(false);
    // Random bytes make places that are off by 1e-7 into colours that are off by more.
    let random = plan.images[0];
    let first = random.first as usize;
    plan.texels[first..first + (random.width * random.height) as usize].fill(0x0080_8080);
    let exact = Reference::<f64>::new(&plan, &Unwatched).expect("nobody interrupts");
    let exact = exact.frame(&plan, &Unwatched).expect("nobody interrupts").finish();
    let single = twin(&plan);
    let far = (exact.color.as_flattened().iter().zip(single.color.as_flattened()))
        .filter(|(a, b)| (*a - *b).abs() > 1e-4 * a.abs().max(0.1))
        .count();
    assert!(far * 200 < single.color.len(), "{far} values differ by more than 1e-4");
}
