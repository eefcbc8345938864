//! Shadows, mirrors and glass: the twin gives the device's bits, whatever the loop.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use harness::{
    Bench, Rendered, assert_same_bits, assert_same_film, fibonacci_sphere, plan_of, render_twin,
    set_of, wavy_sheet,
};
use plan::{Plan, RayLoop};
use points::PointSet;

const VIEW: &str = "
[camera]
eye = [0.5, 1.4, 4.5]
target = [0.0, 0.2, 0.0]
vertical_fov = 40.0
[background]
color = [0.4, 0.5, 0.7]
[[lights]]
kind = \"directional\"
direction = [-0.4, -1.0, -0.3]
irradiance = [3.0, 2.9, 2.7]
[[lights]]
kind = \"point\"
position = [2.0, 3.0, 2.0]
intensity = [4.0, 5.0, 6.0]
";

/// A sheet, and balls of every material: glass that disperses with an air bubble and a solid in it, another
/// half in it, a mirror, and a diffuse ball.
const OBJECTS: &str = "
[[objects]]
points = \"sheet.ply\"
[[objects]]
points = \"glass.ply\"
transform = { translate = [-0.6, 0.6, 0.4], scale = 0.8 }
material = { kind = \"glass\", ior = [1.4, 1.5, 1.65], absorption = [0.1, 0.3, 0.9] }
[[objects]]
points = \"bubble.ply\"
transform = { translate = [-0.6, 0.6, 0.4], scale = 0.4 }
material = { kind = \"glass\", ior = 1.0, priority = 1 }
[[objects]]
points = \"solid.ply\"
transform = { translate = [-0.6, 0.6, 0.4], scale = 0.2 }
material = { albedo = [0.9, 0.2, 0.1] }
[[objects]]
points = \"half.ply\"
transform = { translate = [0.2, 0.5, 0.7], scale = 0.4 }
material = { kind = \"glass\", ior = 1.3, priority = -1 }
[[objects]]
points = \"mirror.ply\"
transform = { translate = [1.0, 0.5, -0.6], scale = 0.7 }
material = { kind = \"mirror\", reflectance = [0.9, 0.8, 0.7] }
";

fn sets() -> Vec<PointSet> {
    let sheet = wavy_sheet(3_000).into_iter();
    let sheet = sheet.map(|[x, y, z]| [5.0 * (x - 0.5), y - 0.4, 5.0 * (z - 0.5)]);
    let balls = [4_000, 2_000, 1_000, 2_000, 2_000].map(|count| set_of(fibonacci_sphere(count)));
    std::iter::once(set_of(sheet.collect())).chain(balls).collect()
}

fn plan(settings: &str) -> Plan {
    plan_of(&format!("{settings}{VIEW}{OBJECTS}"), &sets())
}

fn check(name: &str, settings: &str) -> Rendered {
    let plan = plan(settings);
    let on_device = Bench::open().render(&plan);
    assert_same_bits(name, &on_device, &render_twin(&plan));
    on_device
}

#[test]
fn nested_glass_mirrors_and_shadows_are_the_same_to_the_bit() {
    let rendered = check("nested", "[image]\nsize = [160, 120]");
    let finite = rendered.film.color.as_flattened().iter().all(|value| value.is_finite());
    assert!(finite, "a colour is no number");
    for object in 0..6 {
        let seen = rendered.film.object.contains(&(object as f32));
        // Bubble and solid are inside the glass, which is what the camera meets first.
        assert_eq!(seen, object != 2 && object != 3, "object {object}");
    }
}

#[test]
fn few_and_no_bounces_are_the_same_to_the_bit() {
    for bounces in [0, 1, 3] {
        let settings = format!("[image]\nsize = [96, 72]\n[render]\nmax_bounces = {bounces}\n");
        check(&settings, &settings);
    }
}

#[test]
fn sampled_reflection_and_soft_shadows_are_the_same_to_the_bit() {
    let text = format!("{VIEW}{OBJECTS}")
        .replace("irradiance", "angle = 8.0\nirradiance")
        .replace("intensity", "radius = 0.3\nintensity");
    let settings =
        "[image]\nsize = [96, 72]\nsamples = 3\n[render]\nfresnel = \"sample\"\nseed = 5\n";
    let plan = plan_of(&format!("{settings}{text}"), &sets());
    let on_device = Bench::open().render(&plan);
    assert_same_bits("sampled", &on_device, &render_twin(&plan));
}

#[test]
fn refined_surfaces_and_single_normals_scatter_the_same_to_the_bit() {
    for surface in ["refine = \"project\", polynomial = \"incomplete\"", "normals = \"polynomial\""]
    {
        let text = format!("[image]\nsize = [96, 72]\n{VIEW}{OBJECTS}")
            .replace("material =", &format!("surface = {{ {surface} }}\nmaterial ="));
        let plan = plan_of(&text, &sets());
        let on_device = Bench::open().render(&plan);
        assert_same_bits(surface, &on_device, &render_twin(&plan));
    }
}

/// The paper's loop for every wave, tiles of other sizes, and crops whose rays lie elsewhere.
#[test]
fn every_k_and_any_crop_give_the_same_bytes() {
    let bench = Bench::open();
    let mut plan = plan("[image]\nsize = [96, 72]");
    let whole = bench.render(&plan);
    for (k, form) in [(1, RayLoop::Queue), (1, RayLoop::Images), (7, RayLoop::Images)] {
        (plan.cells_per_pass, plan.ray_loop) = (k, form);
        assert_same_film("K", &whole.film, &bench.render(&plan).film);
    }
    (plan.cells_per_pass, plan.ray_loop) = (0, RayLoop::Auto);
    plan.window = plan::Window { origin: [31, 17], size: [37, 43] };
    let crop = bench.render(&plan).film;
    for (i, color) in crop.color.iter().enumerate() {
        let at = (17 + i / 37) * 96 + 31 + i % 37;
        assert_eq!((color, crop.depth[i]), (&whole.film.color[at], whole.film.depth[at]), "{i}");
    }
}

/// One ray until the first refraction, then one a channel (\[T\] §5): each channel has the bytes of a render
/// with its index alone.
#[test]
fn each_channel_has_the_bytes_of_a_render_with_its_index() {
    let bench = Bench::open();
    let all = bench.render(&plan("[image]\nsize = [96, 72]")).film;
    for (channel, ior) in ["1.4", "1.5", "1.65"].into_iter().enumerate() {
        let text = format!("[image]\nsize = [96, 72]{VIEW}{OBJECTS}")
            .replace("ior = [1.4, 1.5, 1.65]", &format!("ior = {ior}"));
        let alone = bench.render(&plan_of(&text, &sets())).film;
        let differing = (0..all.color.len())
            .filter(|&at| all.color[at][channel] != alone.color[at][channel])
            .count();
        assert_eq!(differing, 0, "channel {channel}");
        assert_eq!((&all.depth, &all.normal), (&alone.depth, &alone.normal));
    }
}

/// Inside a medium of higher priority other surfaces do not exist (Schmidt and Budge 2002).
#[test]
fn a_surface_inside_a_medium_of_higher_priority_is_not_seen() {
    let ball = fibonacci_sphere(4_000);
    let scene = |inner: &str| {
        format!(
            "[image]\nsize = [96, 72]\n{VIEW}
[[objects]]
points = \"a.ply\"
material = {{ kind = \"glass\", ior = 1.5, priority = 3 }}
{inner}"
        )
    };
    let inner = "[[objects]]\npoints = \"b.ply\"\ntransform = { scale = 0.5 }\n\
                 material = { kind = \"glass\", ior = 1.2 }\n";
    let small = fibonacci_sphere(1_000);
    let alone = plan_of(&scene(""), &[set_of(ball.clone())]);
    let with = plan_of(&scene(inner), &[set_of(ball), set_of(small)]);
    let bench = Bench::open();
    let [alone, with] = [bench.render(&alone).film, bench.render(&with).film];
    // The ray is cut in two at the inner surface, which moves it by roundings: 1e-4 of what is seen, but
    // for single pixels where the ray changes what it meets.
    let far = |at: &usize| (0..3).any(|c| (alone.color[*at][c] - with.color[*at][c]).abs() > 1e-3);
    let differing = (0..alone.color.len()).filter(far).count();
    assert!(differing <= 3, "{differing} pixels show a surface that changes no medium");
}
