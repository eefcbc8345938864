//! Isosurfaces: those of one point are spheres, so they are held against the same spheres in double precision.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "measured figures, for whoever asks with --nocapture")]

use film::Image;
use harness::analytic::{
    Body, Matter, Shape, V3, View, add, dot, environment_at, environment_of, follow, length,
    percentile, unit,
};
use harness::{
    Bench, assert_same_bits, assert_same_film, fibonacci_sphere, grid_points, plan_of, plan_with,
    random, render_twin, set_of, with_attribute,
};
use plan::{Plan, RayLoop, SceneImages};
use points::PointSet;
use scene::{Scene, Up};
use std::path::Path;
use std::sync::Arc;

const VIEW: View =
    View { eye: [0.4, 0.9, 3.6], target: [0.0, 0.0, 0.0], fov: 38.0, size: [160, 120] };

/// Where rays do not graze: this share of the ball's radius in the picture.
const INNER: f64 = 0.93;

/// One point whose field is a ball of radius 1 where it is over `iso`: exp(−d²) over 1/e, and the cubic spline
/// with h = 1, which is ¼ at q = 1, by (h/1.2)³/(π h³).
const GAUSSIAN: &str =
    "kernel = \"sum\"\nradius = 1.6\nsmoothing = 0.5\nstep = 0.05\niso = 0.36787944117144233";

fn spline() -> String {
    let iso = 0.25 / (1.728 * std::f64::consts::PI);
    format!("kernel = \"sph\"\nsmoothing_length = 1.0\nstep = 0.05\niso = {iso}")
}

fn ball(material: &str, field: &str) -> String {
    format!(
        "[[objects]]\npoints = \"ball.ply\"\nmaterial = {{ {material} }}\n[objects.volume]\n\
         scalar = \"s\"\nmode = \"isosurface\"\n{field}\n"
    )
}

fn one_point() -> PointSet {
    with_attribute(set_of(vec![[0.0; 3]]), "s", |_| 1.0)
}

fn sky() -> Arc<Image> {
    let wave =
        |d: V3, phase: f64| 0.5 + 0.25 * (3.0 * d[0] + phase).sin() + 0.2 * (2.0 * d[1]).cos();
    Arc::new(environment_of(512, |d| [wave(d, 0.0), wave(d, 1.0), wave(d, 2.0)]))
}

/// Places and normals of a ball, to what eight turns of regula falsi leave.
#[test]
fn the_isosurface_of_one_point_is_a_sphere() {
    let bench = Bench::open();
    for (name, field) in [("gaussian", GAUSSIAN.to_owned()), ("spline", spline())] {
        let text = VIEW.text() + &ball("kind = \"diffuse\"", &field);
        let plan = plan_of(&text, &[one_point()]);
        let on_device = bench.render(&plan);
        assert_same_bits(name, &on_device, &render_twin(&plan));
        let film = on_device.film;
        let shape = Shape::Sphere([0.0; 3], 1.0);
        let (mut places, mut angles, mut hits) = (0.0f64, 0.0f64, 0);
        for pixel in 0..film.depth.len() {
            let met = shape.crossing(VIEW.eye, VIEW.through(pixel));
            let off = VIEW.distance(pixel, [0.0; 3]);
            // A chord shorter than a step may lie between two samples: 1 - 0.05²/8 of the radius.
            if (off - 1.0).abs() > 1e-3 {
                assert_eq!(met.is_some(), film.object[pixel] == 0.0, "{name}: pixel {pixel}");
            }
            if off < INNER {
                let x = film.position[pixel].map(f64::from);
                let n = film.normal[pixel].map(f64::from);
                places = places.max((length(x) - 1.0).abs());
                angles = angles.max(length(add(n, unit(x), -1.0)));
                hits += 1;
            }
        }
        println!("{name}: off by {places:.1e}, normals by {angles:.1e}, of {hits} pixels");
        // The field to f32's last digits, over its slope; normals are those of the same point.
        assert!(hits > 3_000 && places < 1e-6 && angles < 1e-6, "{name}: {places:e} {angles:e}");
    }
}

/// Mirror and glass as those of points are measured: what is left is rounding.
#[test]
fn isosurfaces_of_mirror_and_glass_follow_the_analytic_rays() {
    let images = SceneImages { environment: Some(sky()), textures: Vec::new() };
    let bench = Bench::open();
    for (name, material, matter) in [
        ("mirror", "kind = \"mirror\"", Matter::Mirror([1.0; 3])),
        (
            "glass",
            "kind = \"glass\", ior = 1.33, absorption = [0.3, 0.3, 0.3]",
            Matter::Glass(1.33, 0.3),
        ),
    ] {
        let text =
            VIEW.text() + "[background]\nenvironment = \"sky.exr\"\n" + &ball(material, GAUSSIAN);
        let plan = plan_with(&text, &[one_point()], &images);
        let on_device = bench.render(&plan);
        assert_same_bits(name, &on_device, &render_twin(&plan));
        let bodies = [Body { shape: Shape::Sphere([0.0; 3], 1.0), matter }];
        let sky = images.environment.as_ref().expect("a sky");
        let errors: Vec<f64> = (0..on_device.film.color.len())
            .filter(|&pixel| VIEW.distance(pixel, [0.0; 3]) < INNER)
            .map(|pixel| {
                let way = follow(&bodies, VIEW.eye, VIEW.through(pixel));
                let light = environment_at(sky, way.direction);
                let off = |c: usize| {
                    let seen = f64::from(on_device.film.color[pixel][c]);
                    (seen - way.throughput[c] * light[c]).abs()
                };
                off(0).max(off(1)).max(off(2))
            })
            .collect();
        let (count, p99) = (errors.len(), percentile(errors, 0.99));
        println!("{name}: 99th percentile {p99:.1e} of {count} pixels");
        // Normals to 1e-7, twice refracted, under a sky with a slope of 0.75.
        assert!(count > 3_000 && p99 < 2e-6, "{name}: {p99:e}");
    }
}

/// The shadow of the ball on a floor of points, and of a sheet of points on the ball.
#[test]
fn isosurfaces_throw_and_take_shadows() {
    let text = VIEW.text()
        + "[[lights]]\nkind = \"directional\"\ndirection = [-0.5, -1.0, -0.3]\nirradiance = [3.0, 3.0, 3.0]\n"
        + &ball("albedo = [0.5, 0.5, 0.5]", GAUSSIAN)
        + "[[objects]]\npoints = \"floor.ply\"\ntransform = { scale = 8.0, translate = [-4.0, -1.2, -4.0] }\n\
           [[objects]]\npoints = \"roof.ply\"\ntransform = { scale = 1.0, translate = [0.0, 1.8, -0.5] }\n";
    let sets = [one_point(), set_of(grid_points(60)), set_of(grid_points(30))];
    let film = Bench::open().render(&plan_of(&text, &sets)).film;
    let towards = unit([0.5, 1.0, 0.3]);
    let shape = Shape::Sphere([0.0; 3], 1.0);
    // Whether the roof, [0, 1] by [-0.5, 0.5] at the height 1.8, is in the way; nothing within 0.05 of its rim.
    let roofed = |x: V3| {
        let at = add(x, towards, (1.8 - x[1]) / towards[1]);
        let inside = (at[0] - 0.5).abs().max(at[2].abs()) - 0.5;
        (inside.abs() > 0.05).then_some(inside < 0.0)
    };
    let (mut dark, mut lit) = ([0; 2], [0; 2]);
    for pixel in 0..film.color.len() {
        let object = film.object[pixel];
        if !(0.0..=1.0).contains(&object) {
            continue;
        }
        let x = film.position[pixel].map(f64::from);
        let n = film.normal[pixel].map(f64::from);
        let off = shape.crossing(add(x, n, 1e-4), towards).is_some();
        let near = length(add(x, towards, -dot(x, towards)));
        let Some(roof) = roofed(x) else { continue };
        if object == 1.0 && (near - 1.0).abs() < 0.02
            || object == 0.0 && dot(n, towards).abs() < 0.02
        {
            continue;
        }
        let blocked = roof || off || dot(n, towards) < 0.0;
        let albedo = if object == 0.0 { 0.5 } else { 0.8 };
        let expected = albedo / std::f64::consts::PI * 3.0 * dot(n, towards).max(0.0);
        let expected = if blocked { 0.0 } else { expected };
        let seen = f64::from(film.color[pixel][0]);
        assert!((seen - expected).abs() < 1e-5, "{object} at {x:?}: {seen} for {expected}");
        if blocked { dark[object as usize] += 1 } else { lit[object as usize] += 1 }
    }
    println!("dark {dark:?}, lit {lit:?} pixels of ball and floor");
    assert!(dark.iter().chain(&lit).all(|&count| count > 300), "{dark:?} {lit:?}");
}

fn cloud(count: usize) -> PointSet {
    let mut seed = 11;
    let positions: Vec<V3> =
        (0..count).map(|_| [0; 3].map(|_| 2.0 * random(&mut seed) - 1.0)).collect();
    let field =
        |[x, y, z]: V3| 0.5 + 0.5 * (3.0 * x).sin() * (2.5 * y + 0.4).cos() * (1.0 - 0.3 * z);
    with_attribute(set_of(positions), "s", field)
}

/// Means that end where their points do, sums of glass that disperses, fog through both, points of glass in
/// front: the twin, which looks everywhere, gives the device's bits, for any K.
#[test]
fn isosurfaces_among_volumes_and_glass_are_the_same_to_the_bit() {
    let text = "[image]\nsize = [96, 72]
[camera]\neye = [0.3, 0.4, 4.0]\ntarget = [0.0, 0.0, 0.0]\nvertical_fov = 36.0
[background]\ncolor = [0.2, 0.3, 0.4]
[[lights]]\nkind = \"directional\"\ndirection = [-0.3, -1.0, -0.2]\nirradiance = [3.0, 3.0, 3.0]
[[lights]]\nkind = \"point\"\nposition = [1.0, 1.5, 2.0]\nintensity = [4.0, 3.0, 2.0]
[[objects]]\npoints = \"mean.ply\"
[objects.volume]\nscalar = \"s\"\nradius = 0.13\nsmoothing = 0.004\nmode = \"isosurface\"\niso = 0.4
color_map = \"viridis\"
[[objects]]\npoints = \"drop.ply\"\ntransform = { scale = 0.6, translate = [0.6, 0.3, 0.8] }
material = { kind = \"glass\", ior = [1.3, 1.35, 1.4] }
[objects.volume]\nscalar = \"s\"\nkernel = \"sum\"\nradius = 0.2\nmode = \"isosurface\"\niso = 4.0
[[objects]]\npoints = \"fog.ply\"\ntransform.scale = 1.2
[objects.volume]\nscalar = \"s\"
transfer = [{ value = 0.0, color = [0.1, 0.2, 0.3], extinction = 0.2 },
            { value = 1.0, color = [0.9, 0.5, 0.3], extinction = 0.9 }]
[[objects]]\npoints = \"ball.ply\"\ntransform = { scale = 0.4, translate = [-0.4, 0.3, 1.5] }
material = { kind = \"glass\", ior = 1.5 }
";
    let sets = [cloud(4_000), cloud(2_000), cloud(1_500), set_of(fibonacci_sphere(2_000))];
    let mut plan = plan_of(text, &sets);
    let bench = Bench::open();
    let whole = bench.render(&plan);
    assert_same_bits("isosurfaces", &whole, &render_twin(&plan));
    assert!(whole.film.color.as_flattened().iter().all(|value| value.is_finite()));
    let of = |index: f32| whole.film.object.iter().filter(|&&object| object == index).count();
    assert!([0.0, 1.0, 3.0].into_iter().all(|index| of(index) > 300), "each is seen");
    let kinds = |kind: u32| plan.volumes.cells.iter().filter(|cell| cell.counts == kind).count();
    println!("cells of each kind: {:?}", [0, 1, 2, 3].map(kinds));
    assert!((0..4).all(|kind| kinds(kind) > 0), "each kind of cell occurs");
    (plan.cells_per_pass, plan.ray_loop) = (3, RayLoop::Images);
    assert_same_film("K", &whole.film, &bench.render(&plan).film);
}

fn error_of(text: &str, set: PointSet) -> String {
    let scene = Scene::from_toml(text, Path::new("s.toml"), &[]).expect("a valid scene");
    let sets = [Arc::new(set)];
    Plan::new(&scene, &sets, &SceneImages::default(), None, Up::Y).expect_err("no plan").to_string()
}

#[test]
fn what_isosurfaces_cannot_be_says_so() {
    let mean = GAUSSIAN.replace("sum", "shepard");
    let open = error_of(&ball("kind = \"glass\"", &mean), one_point());
    assert!(open.contains("rays cannot tell inside from outside"), "{open}");
    let many = error_of(&ball("albedo = \"attribute:s\"", GAUSSIAN), one_point());
    assert!(many.contains("an isosurface has one albedo"), "{many}");
}

/// Where the material has no albedo, the transfer function says the colour.
#[test]
fn the_transfer_function_colors_an_isosurface() {
    let albedo = |more: &str| {
        let plan = plan_of(
            &ball(more, &(GAUSSIAN.to_owned() + "\ncolor_map = \"gray\"\nvalue_range = [0, 1]")),
            &[one_point()],
        );
        plan.objects[0].albedo
    };
    let gray = albedo("kind = \"diffuse\"");
    // 1/e of the way through the bytes of the map, which are sRGB.
    assert_eq!(film::srgb_byte(gray[0]), (255.0f64 / std::f64::consts::E).round() as u8);
    assert!(gray[0] == gray[1] && gray[1] == gray[2], "{gray:?}");
    assert_eq!(albedo("albedo = [0.1, 0.2, 0.3]"), [0.1, 0.2, 0.3]);
}
