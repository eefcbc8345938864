//! Light in volumes: single scattering in a fog of one density, Lambert's law across a field's gradient, and
//! the shadows that fall into them.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "measured figures, for whoever asks with --nocapture")]

use film::Film;
use harness::{
    Bench, assert_same_bits, assert_same_film, fibonacci_sphere, grid_points, plan_of, random,
    render_twin, set_of, with_attribute,
};
use plan::{Plan, RayLoop, SceneImages};
use points::PointSet;
use scene::{Scene, Up};
use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;

/// A lattice over the cube of side 2.
fn block(side: u32, field: impl Fn([f64; 3]) -> f64) -> PointSet {
    let at = |i: u32| -1.0 + 2.0 * f64::from(i) / f64::from(side - 1);
    let places = (0..side.pow(3)).map(|i| [i % side, i / side % side, i / (side * side)].map(at));
    with_attribute(set_of(places.collect()), "s", field)
}

/// Parallel rays along -z, and light from this direction.
fn scene(direction: [f64; 3], shading: &str, extinction: f64, more: &str) -> String {
    format!(
        "[image]\nsize = [12, 12]
[camera]\neye = [0.0, 0.0, 4.0]\ntarget = [0.0, 0.0, 0.0]\nprojection = \"orthographic\"\nheight = 1.6
[[lights]]\nkind = \"directional\"\ndirection = {direction:?}\nirradiance = [3.0, 3.0, 3.0]
[[objects]]\npoints = \"block.ply\"
[objects.volume]\nscalar = \"s\"\nradius = 0.2\nstep = 0.02\nshading = \"{shading}\"
transfer = [{{ value = 0.0, color = [0.9, 0.6, 0.3], extinction = {extinction} }}]
{more}"
    )
}

const ALBEDO: [f64; 3] = [0.9, 0.6, 0.3];

fn render(text: &str, sets: &[PointSet]) -> Film {
    Bench::open().render(&plan_of(text, sets)).film
}

/// Light from behind the viewer, twice dimmed by e^(−σx): L = cE/4π ∫ σ e^(−2σx) dx = cE/8π (1 − T²).
#[test]
fn fog_scatters_as_single_scattering_says() {
    for extinction in [0.1, 0.6] {
        let film =
            render(&scene([0.0, 0.0, -1.0], "scatter", extinction, ""), &[block(20, |_| 1.0)]);
        let mut worst = 0.0f64;
        for color in &film.color {
            let through = 1.0 - f64::from(color[3]);
            for channel in 0..3 {
                let expected = ALBEDO[channel] * 3.0 / (8.0 * PI) * (1.0 - through * through);
                worst = worst.max((f64::from(color[channel]) / expected - 1.0).abs());
            }
        }
        println!("extinction {extinction}: off by {worst:.1e} of the radiance");
        // Light is known at the points alone. Up to `radius` before the first it is that of the first ones, so
        // that it is dimmed by up to 0.2 σ too much there, over a tenth of the way.
        assert!(worst < 0.05 * extinction, "{worst}");
    }
}

/// A field that rises along z is lit as surfaces across z are: E/π cos θ, which the two sides of a thin fog share.
#[test]
fn a_gradient_is_a_normal() {
    for angle in [10.0f64, 40.0, 70.0, 120.0] {
        let (sin, cos) = angle.to_radians().sin_cos();
        let text = scene([-sin, 0.0, -cos], "gradient", 1e-3, "");
        // What is seen is the inner half: towards their ends, points are on one side alone.
        let ends = "{ value = 0.3, color = [0.9, 0.6, 0.3], extinction = 0.0 }";
        let (low, high) = (ends.replace("0.0 }", "1e-3 }"), ends.replace("= 0.3,", "= 0.7,"));
        let seen = high.replace("0.0 }", "1e-3 }");
        let stops = format!("transfer = [{ends}, {low}, {seen}, {high}]");
        let line = |line| if str::starts_with(line, "transfer") { &stops } else { line };
        let text = text.lines().map(line).collect::<Vec<_>>().join("\n");
        let film = render(&text, &[block(20, |p| 0.5 + 0.4 * p[2])]);
        let worst = (film.color.iter())
            .map(|color| {
                let expected = ALBEDO[0] * 3.0 / PI * cos.max(0.0) * f64::from(color[3]);
                (f64::from(color[0]) - expected).abs() / f64::from(color[3])
            })
            .fold(0.0, f64::max);
        println!("{angle} degrees: off by {worst:.1e} of a radiance of {:.2}", 2.7 / PI);
        // Between the lattice's planes the field is not quite linear.
        assert!(worst < 0.03, "{worst}");
    }
}

/// Where no direction is steeper than another there is no normal, and light is scattered evenly.
#[test]
fn a_constant_field_scatters_evenly_whatever_the_shading() {
    let film =
        |shading: &str| render(&scene([-0.5, -0.3, -1.0], shading, 0.5, ""), &[block(12, |_| 0.7)]);
    let (even, gradient) = (film("scatter"), film("gradient"));
    let off = (even.color.as_flattened().iter().zip(gradient.color.as_flattened()))
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f32::max);
    assert!(off < 1e-6, "{off}");
}

/// A sheet over one half of the block, light from above: black below it, and as without it beside it.
#[test]
fn surfaces_throw_shadows_into_volumes() {
    let sheet = "[[objects]]\npoints = \"sheet.ply\"\ntransform = { scale = 6.0, translate = [0.0, 1.5, -3.0] }\n";
    let light = [0.0, -1.0, 0.0];
    let set = || block(20, |_| 1.0);
    let open = render(&scene(light, "scatter", 0.3, ""), &[set()]);
    let half = render(&scene(light, "scatter", 0.3, sheet), &[set(), set_of(grid_points(50))]);
    // The sheet's edge is at x = 0, 6 columns from the left; half a spacing of the sheet and the reach of a
    // point blur it by 0.06 + 0.2, that is two columns.
    for (at, color) in half.color.iter().enumerate() {
        match at % 12 {
            // The scene is centred elsewhere.
            0..4 => assert!((color[0] - open.color[at][0]).abs() < 1e-6, "beside it"),
            8.. => assert_eq!(color[..3], [0.0; 3], "below it"),
            _ => {}
        }
        assert!((color[3] - open.color[at][3]).abs() < 1e-6, "shadows change no coverage");
    }
    assert!(open.color.iter().all(|color| color[0] > 0.01));
}

/// Light enters a volume through the surface of its own object, and is dimmed by the volume.
#[test]
fn the_skin_of_a_volume_lets_light_in() {
    let mut seed = 5;
    let mut positions = fibonacci_sphere(2_000);
    while positions.len() < 9_000 {
        let p = [0; 3].map(|_| 2.0 * random(&mut seed) - 1.0);
        if p.iter().map(|x| x * x).sum::<f64>() < 0.97 {
            positions.push(p);
        }
    }
    let set = with_attribute(set_of(positions), "s", |_| 1.0);
    let set =
        with_attribute(set, "skin", |p| f64::from(p.iter().map(|x| x * x).sum::<f64>() > 0.99));
    let text = scene([0.0, 0.0, -1.0], "scatter", 0.4, "");
    let skinned = text.replace(
        "[objects.volume]",
        "material = { kind = \"glass\", ior = 1.0 }\n[objects.volume]\nboundary = \"skin\"",
    );
    let (open, closed) = (render(&text, std::slice::from_ref(&set)), render(&skinned, &[set]));
    let middle = 6 * 12 + 6;
    let (open, closed) = (open.color[middle], closed.color[middle]);
    // Without a skin the fog ends a radius beyond it: 2.4 against 2, with 1 - T² = 0.85 against 0.80.
    let ratio = |color: [f32; 4]| {
        let through = 1.0 - f64::from(color[3]);
        f64::from(color[0]) / (1.0 - through * through)
    };
    assert!((ratio(open) - 0.9 * 3.0 / (8.0 * PI)).abs() < 3e-3, "{open:?}");
    let through = (-0.4f64 * 2.0).exp();
    let expected = 0.9 * 3.0 / (8.0 * PI) * (1.0 - through * through);
    // The skin's points see 0.2 more of fog than there is.
    assert!((f64::from(closed[0]) / expected - 1.0).abs() < 0.08, "{closed:?} for {expected}");
}

/// Every kind of shading, kernel and light, with surfaces in the way: the twin's bits, for any K.
#[test]
fn lit_volumes_are_the_same_to_the_bit() {
    let mut seed = 11;
    let positions: Vec<[f64; 3]> =
        (0..2_500).map(|_| [0; 3].map(|_| 2.0 * random(&mut seed) - 1.0)).collect();
    let field =
        |[x, y, z]: [f64; 3]| 0.5 + 0.5 * (2.0 * x).sin() * (1.5 * y).cos() * (1.0 - 0.3 * z);
    let cloud = with_attribute(set_of(positions), "s", field);
    let stops = "transfer = [{ value = 0.2, color = [0.9, 0.6, 0.3], extinction = 0.0 },\n\
                 { value = 0.9, color = [0.3, 0.6, 0.9], extinction = 3.0 }]";
    let text = format!(
        "[image]\nsize = [64, 48]\n[camera]\neye = [0.3, 0.4, 4.0]\ntarget = [0.0, 0.0, 0.0]
[[lights]]\nkind = \"directional\"\ndirection = [-0.3, -1.0, -0.2]\nirradiance = [3.0, 3.0, 3.0]
[[lights]]\nkind = \"point\"\nposition = [1.0, 1.5, 2.0]\nintensity = [4.0, 3.0, 2.0]\nradius = 0.2
[[objects]]\npoints = \"a.ply\"
[objects.volume]\nscalar = \"s\"\nshading = \"gradient\"\n{stops}
[[objects]]\npoints = \"b.ply\"\ntransform = {{ scale = 0.7, translate = [0.8, 0.0, 0.5] }}
[objects.volume]\nscalar = \"s\"\nkernel = \"sph\"\nsmoothing_length = 0.15\nshading = \"gradient\"\n{stops}
[[objects]]\npoints = \"c.ply\"\ntransform = {{ scale = 0.5, translate = [-0.8, 0.6, 0.5] }}
[objects.volume]\nscalar = \"s\"\nkernel = \"sum\"\nradius = 0.1\nshading = \"scatter\"\n{stops}
[[objects]]\npoints = \"ball.ply\"\ntransform = {{ scale = 0.3, translate = [-0.2, 1.0, 1.0] }}
[[objects]]\npoints = \"floor.ply\"\ntransform = {{ scale = 4.0, translate = [-2.0, -1.2, -2.0] }}
"
    );
    let sets = [
        cloud.clone(),
        cloud.clone(),
        cloud,
        set_of(fibonacci_sphere(800)),
        set_of(grid_points(30)),
    ];
    let mut plan = plan_of(&text, &sets);
    let bench = Bench::open();
    let whole = bench.render(&plan);
    assert_same_bits("lit volumes", &whole, &render_twin(&plan));
    assert!(whole.film.color.as_flattened().iter().all(|value| value.is_finite()));
    let cut = bench.render_within(&plan, Some(300)); // passes that end within a place
    assert_same_bits("budget", &whole, &cut);
    (plan.cells_per_pass, plan.ray_loop) = (3, RayLoop::Images);
    assert_same_film("K", &whole.film, &bench.render(&plan).film);
}

#[test]
fn too_many_lights_say_so() {
    let light = "[[lights]]\nkind = \"directional\"\ndirection = [0.0, -1.0, 0.0]\nirradiance = [1.0, 1.0, 1.0]\n";
    let text = light.repeat(4) + &scene([0.0, 0.0, -1.0], "scatter", 1.0, "");
    let scene = Scene::from_toml(&text, Path::new("s.toml"), &[]).expect("a valid scene");
    let sets = [Arc::new(block(4, |_| 1.0))];
    let error =
        Plan::new(&scene, &sets, &SceneImages::default(), None, Up::Y).expect_err("five lights");
    assert!(error.to_string().contains("4 lights, but there are 5"), "{error}");
}
