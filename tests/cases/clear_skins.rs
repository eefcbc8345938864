//! Surfaces that light passes. Between media of one index, light and rays go through as if they were not there, dimmed by
//! what the media absorb; other glass takes what it reflects, or blocks light (`render.shadows`).
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

#[path = "clear_skins/grazing.rs"]
mod grazing;
#[path = "clear_skins/tinted.rs"]
mod tinted;

use film::Film;
use harness::analytic::{V3, View, add, dot, length, percentile, unit};
use harness::{
    Bench, assert_same_bits, fibonacci_sphere, grid_points, plan_of, random, render_twin, set_of,
    with_attribute,
};
use plan::{Plan, RayLoop};
use points::{Attribute, PointSet, Values};
use std::f64::consts::FRAC_1_PI;

const VIEW: View =
    View { eye: [0.4, 1.2, 5.0], target: [0.2, -0.6, 0.0], fov: 45.0, size: [120, 90] };

/// A floor at y = -1.5, five wide.
fn floor() -> PointSet {
    let wide = |[x, _, z]: V3| [6.0 * (x - 0.5), -1.5, 6.0 * (z - 0.5)];
    set_of(grid_points(80).into_iter().map(wide).collect())
}

const FLOOR: &str = "[[objects]]\npoints = \"floor.ply\"\n";
const SUN: V3 = [0.3, -1.0, -0.2];

fn sun() -> String {
    format!(
        "[[lights]]\nkind = \"directional\"\ndirection = {SUN:?}\nirradiance = [3.0, 3.0, 3.0]\n"
    )
}

/// Where a line passes through a ball about the origin: how long its way inside is, and how near to the middle it passes.
fn chord(from: V3, towards: V3, radius: f64) -> [f64; 2] {
    let along = dot(from, towards);
    let nearest = length(add(from, towards, -along));
    let half = (radius * radius - nearest * nearest).max(0.0).sqrt();
    [if along < 0.0 { 2.0 * half } else { 0.0 }, nearest]
}

/// Where a pixel sees the floor past a ball of this radius, the direction of the light there, and what arrives of it
/// across its way; `None` where it does not see the floor.
fn seen_floor(pixel: usize, radius: f64, light: Light) -> Option<(V3, V3, f64)> {
    let d = VIEW.through(pixel);
    let t = (-1.5 - VIEW.eye[1]) / d[1];
    let x = add(VIEW.eye, d, t);
    let on_floor = t > 0.0 && x[0].abs() < 2.8 && x[2].abs() < 2.8;
    if !on_floor || VIEW.distance(pixel, [0.0; 3]) < radius {
        return None;
    }
    let (towards, irradiance) = match light {
        Light::Sun => (unit(SUN.map(|c| -c)), 3.0),
        Light::Lamp(place) => {
            let way = add(place, x, -1.0);
            (unit(way), 40.0 / dot(way, way))
        }
    };
    Some((x, towards, irradiance))
}

/// Errors of the floor's radiance over what it is without shadow, at pixels that see it past a ball of this radius, and
/// whose light does not graze that. `share` says what of the light is left, from where on the floor.
fn floor_errors(film: &Film, radius: f64, light: Light, share: impl Fn(f64) -> V3) -> Vec<f64> {
    let mut errors = Vec::new();
    let mut shaded = 0;
    for pixel in 0..film.color.len() {
        let Some((x, towards, irradiance)) = seen_floor(pixel, 1.03 * radius, light) else {
            continue;
        };
        let [inside, nearest] = chord(x, towards, radius);
        if (nearest / radius - 1.0).abs() < 0.03 {
            continue;
        }
        shaded += usize::from(inside > 0.0);
        let lit = 0.8 * FRAC_1_PI * irradiance * towards[1];
        let left = share(inside);
        errors
            .extend((0..3).map(|c| (f64::from(film.color[pixel][c]) - lit * left[c]).abs() / lit));
    }
    assert!(shaded > 300, "{shaded} pixels of floor in the ball's shadow");
    errors
}

#[derive(Clone, Copy)]
enum Light {
    Sun,
    Lamp(V3),
}

impl Light {
    fn text(self) -> String {
        match self {
            Self::Sun => sun(),
            Self::Lamp(place) => format!(
                "[[lights]]\nkind = \"point\"\nposition = {place:?}\nintensity = [40.0, 40.0, 40.0]\n"
            ),
        }
    }
}

/// A ball of index 1 that absorbs throws a shadow of exp(-a chord), channel by channel, as long as the ray is in it; its
/// surface throws none. Chords of 20 000 points err by 1e-5.
#[test]
fn an_absorbing_ball_of_index_one_dims_by_its_chord() {
    let a = [0.2, 0.7, 1.9];
    let sets = [floor(), set_of(fibonacci_sphere(20_000))];
    for light in [Light::Sun, Light::Lamp([0.6, 2.8, 0.3])] {
        for ior in ["1.0", "[1.0, 1.0, 1.0]"] {
            let text = format!(
                "{}{}{FLOOR}[[objects]]\npoints = \"ball.ply\"\n\
                 material = {{ kind = \"glass\", ior = {ior}, absorption = {a:?} }}\n",
                VIEW.text(),
                light.text()
            );
            let film = render_twin(&plan_of(&text, &sets)).film;
            let errors = floor_errors(&film, 1.0, light, |way| a.map(|a| (-a * way).exp()));
            let [most, worst] = [0.99, 1.0].map(|share| percentile(errors.clone(), share));
            assert!(most < 5e-5 && worst < 2e-3, "{most:e}, worst {worst:e}");
            // Nor is any light lost where it grazes the ball, and is in it for less than half a trust radius.
            if let Light::Sun = light {
                let darkest = 0.8 * FRAC_1_PI * 3.0 * unit(SUN)[1].abs() * (-2.0 * a[2]).exp();
                let dark = (0..film.color.len()).filter(|&at| {
                    film.object[at] == 0.0 && f64::from(film.color[at][2]) < 0.99 * darkest
                });
                assert_eq!(
                    dark.count(),
                    0,
                    "pixels that are darker than the longest chord makes them"
                );
            }
        }
    }
}

/// Light from within: the lamp in the ball, whose light leaves it.
#[test]
fn a_lamp_inside_a_clear_ball_shines_out() {
    let light = Light::Lamp([0.1, 0.2, -0.1]);
    let sets = [floor(), set_of(fibonacci_sphere(20_000))];
    let text = format!(
        "{}{}{FLOOR}[[objects]]\npoints = \"ball.ply\"\n\
         material = {{ kind = \"glass\", ior = 1.0, absorption = [0.5, 0.5, 0.5] }}\n",
        VIEW.text(),
        light.text()
    );
    let film = render_twin(&plan_of(&text, &sets)).film;
    let mut seen = 0;
    for pixel in 0..film.color.len() {
        let d = VIEW.through(pixel);
        let t = (-1.5 - VIEW.eye[1]) / d[1];
        let x = add(VIEW.eye, d, t);
        if t < 0.0 || x[0].abs().max(x[2].abs()) > 2.8 || VIEW.distance(pixel, [0.0; 3]) < 1.03 {
            continue;
        }
        let Light::Lamp(place) = light else { continue };
        let way = add(place, x, -1.0);
        let towards = unit(way);
        // From the lamp back to the surface.
        let along = dot(place, towards);
        let inside = along + (1.0 - dot(place, place) + along * along).sqrt();
        let expected = 0.8 * FRAC_1_PI * 40.0 / dot(way, way) * towards[1] * (-0.5 * inside).exp();
        let found = f64::from(film.color[pixel][0]);
        assert!((found - expected).abs() < 2e-4 * expected, "{pixel}: {found}, not {expected}");
        seen += 1;
    }
    assert!(seen > 1_000, "{seen} pixels");
}

const OPAQUE: &str = "[render]\nshadows = \"opaque\"\n";

/// With opaque shadows, other glass throws a black one.
#[test]
fn other_glass_is_opaque_to_light() {
    let sets = [floor(), set_of(fibonacci_sphere(20_000))];
    for ior in ["1.3", "1.0001", "[1.2, 1.1, 1.3]"] {
        let text = format!(
            "{}{OPAQUE}{}{FLOOR}[[objects]]\npoints = \"ball.ply\"\nmaterial = {{ kind = \"glass\", ior = {ior} }}\n",
            VIEW.text(),
            sun()
        );
        let plan = plan_of(&text, &sets);
        assert!(!plan.light_passes);
        let film = render_twin(&plan).film;
        let black = |way: f64| if way > 0.0 { [0.0; 3] } else { [1.0; 3] };
        let errors = floor_errors(&film, 1.0, Light::Sun, black);
        assert!(percentile(errors, 1.0) < 1e-5, "{ior}");
    }
    // Of one index in one channel, that channel passes.
    let text = format!(
        "{}{OPAQUE}{}{FLOOR}[[objects]]\npoints = \"ball.ply\"\n\
         material = {{ kind = \"glass\", ior = [1.3, 1.0, 1.3], absorption = [0.5, 0.5, 0.5] }}\n",
        VIEW.text(),
        sun()
    );
    let film = render_twin(&plan_of(&text, &sets)).film;
    let green = |way: f64| if way > 0.0 { [0.0, (-0.5 * way).exp(), 0.0] } else { [1.0; 3] };
    assert!(percentile(floor_errors(&film, 1.0, Light::Sun, green), 0.99) < 5e-5);
}

/// Points in a ball, those of its surface among them.
fn smoke(count: u32, radius: f64) -> PointSet {
    let mut seed = 3;
    let mut place = || loop {
        let p = [0, 1, 2].map(|_| 2.0 * random(&mut seed) - 1.0);
        if dot(p, p) < 0.98 {
            return p.map(|c| c * radius);
        }
    };
    let inner: Vec<V3> = (0..count).map(|_| place()).collect();
    let skin = fibonacci_sphere(8_000).into_iter().map(|p| p.map(|c| c * radius));
    let mut set = set_of(inner.into_iter().chain(skin).collect());
    let on_skin: Vec<f64> =
        (0..set.positions.len()).map(|i| f64::from(i >= count as usize)).collect();
    let boundary = Attribute { name: "skin".into(), values: Values::F64(on_skin) };
    set.attributes.push(boundary);
    set
}

const FOG: &str = "[objects.volume]\nscalar = \"s\"\nradius = 0.3\nsmoothing = 0.02\nstep = 0.01\n\
                   transfer = [{ value = 0.0, color = [1, 1, 1], extinction = 0.0 }, \
                   { value = 1.0, color = [1, 1, 1], extinction = 1.5 }]\n";

/// Even smoke in a skin of index 1 throws exp(-sigma chord) and no more: the volume counts inside alone, although its
/// points reach beyond. The last step of each way ends at the skin, so that the midpoint rule is exact for even smoke.
#[test]
fn smoke_in_a_skin_throws_the_smokes_shadow() {
    let set = with_attribute(smoke(12_000, 1.0), "s", |_| 1.0);
    let text = format!(
        "{}{}{FLOOR}[[objects]]\npoints = \"smoke.ply\"\n\
         material = {{ kind = \"glass\", ior = 1.0, absorption = [0.3, 0.0, 0.1] }}\n{FOG}boundary = \"skin\"\n",
        VIEW.text(),
        sun()
    );
    let film = render_twin(&plan_of(&text, &[floor(), set])).film;
    let share = |way: f64| [0.3, 0.0, 0.1].map(|a: f64| (-(1.5 + a) * way).exp());
    let errors = floor_errors(&film, 1.0, Light::Sun, share);
    let [most, worst] = [0.99, 1.0].map(|share| percentile(errors.clone(), share));
    assert!(most < 2e-4 && worst < 5e-3, "{most:e}, worst {worst:e}");
}

/// The same smoke with and without a skin of index 1 around it: the whole picture, light in the smoke included. Ways are
/// cut at the skin, and steps begin anew there: half a step of the smoke's changes.
#[test]
fn a_skin_around_smoke_changes_nothing() {
    let mut seed = 8;
    let cloud: Vec<V3> = (0..6_000)
        .map(|_| [0, 1, 2].map(|_| 1.2 * (random(&mut seed) - 0.5)))
        .filter(|p| length(*p) < 0.6)
        .collect();
    let set = with_attribute(set_of(cloud), "s", |p| 1.0 - length(p) / 0.6);
    let fog = FOG.replace("radius = 0.3", "radius = 0.15").replace("0.02", "0.004");
    let scene = |shading: &str| {
        format!(
            "{}{}[background]\ncolor = [0.2, 0.3, 0.4]\n{FLOOR}[[objects]]\npoints = \"smoke.ply\"\n\
             {fog}shading = \"{shading}\"\nboundary = \"none\"\n",
            VIEW.text(),
            sun()
        )
    };
    let skin = "[[objects]]\npoints = \"skin.ply\"\nmaterial = { kind = \"glass\", ior = 1.0 }\n";
    let shell = set_of(fibonacci_sphere(10_000));
    for shading in ["none", "scatter"] {
        let alone = plan_of(&scene(shading), &[floor(), set.clone()]);
        let within = plan_of(&(scene(shading) + skin), &[floor(), set.clone(), shell.clone()]);
        let [alone, within] = [alone, within].map(|plan| render_twin(&plan).film);
        let differences = differences(&alone, &within);
        let [most, worst] = [0.99, 1.0].map(|share| percentile(differences.clone(), share));
        assert!(most < 2e-3 && worst < 1e-2, "{shading}: {most:e}, worst {worst:e}");
        let shadow = (0..alone.color.len()).filter(|&at| alone.color[at][0] < 0.5).count();
        assert!(shadow > 500, "{shading}: {shadow} dark pixels");
    }
}

fn differences(a: &Film, b: &Film) -> Vec<f64> {
    let far = |at: usize| {
        (0..3).map(|c| f64::from((a.color[at][c] - b.color[at][c]).abs())).fold(0.0, f64::max)
    };
    (0..a.color.len()).map(far).collect()
}

/// Skins of index 1 around a ball, a mirror and glass, one in another: no bounce is spent on them, nothing is reflected at
/// grazing angles, and the picture is the one without, up to the rounding of where rays are cut.
#[test]
fn skins_of_index_one_are_not_seen() {
    let scene = |bounces: u32, fresnel: &str| {
        format!(
            "{}{}[render]\nmax_bounces = {bounces}\nfresnel = \"{fresnel}\"\n\
             [background]\ncolor = [0.2, 0.5, 0.9]\n{FLOOR}\
             [[objects]]\npoints = \"ball.ply\"\ntransform = {{ scale = 0.3, translate = [0.4, 0.1, 0.3] }}\n\
             [[objects]]\npoints = \"ball.ply\"\ntransform = {{ scale = 0.3, translate = [-0.4, 0.1, 0.2] }}\n\
             material = {{ kind = \"mirror\" }}\n\
             [[objects]]\npoints = \"ball.ply\"\ntransform = {{ scale = 0.25, translate = [0.0, -0.4, 0.5] }}\n\
             material = {{ kind = \"glass\" }}\n",
            VIEW.text(),
            sun()
        )
    };
    let skin = |scale: f64| {
        format!(
            "[[objects]]\npoints = \"ball.ply\"\ntransform.scale = {scale}\n\
             material = {{ kind = \"glass\", ior = 1.0, priority = -1 }}\n"
        )
    };
    let skins: String = [1.0, 1.1, 1.2].map(skin).concat();
    let ball = || set_of(fibonacci_sphere(8_000));
    let bare = [floor(), ball(), ball(), ball()];
    let mut dressed = bare.to_vec();
    dressed.extend([ball(), ball(), ball()]);
    for (bounces, fresnel) in [(8, "transmit"), (2, "transmit"), (0, "transmit"), (8, "sample")] {
        let scene = scene(bounces, fresnel);
        let alone = render_twin(&plan_of(&scene, &bare)).film;
        let with = render_twin(&plan_of(&format!("{scene}{skins}"), &dressed)).film;
        let differences = differences(&alone, &with);
        let far = differences.iter().filter(|&&difference| difference > 1e-4).count();
        // Rays cut in six meet edges of the balls a rounding away: single pixels.
        assert!(far <= 4, "{bounces}, {fresnel}: {far} pixels show a skin");
    }
}

/// A ball of 1.33 in water of 1.33, and a lamp in the water: the ball's surface is not there, and the way in each medium
/// is dimmed by its own absorption.
#[test]
fn a_skin_inside_a_medium_of_its_index_lets_light_pass() {
    let water: Vec<V3> = fibonacci_sphere(20_000).into_iter().map(|p| p.map(|c| 6.0 * c)).collect();
    let place = [0.6, 2.8, 0.3];
    let text = |priority: i32| {
        format!(
            "{}{}{FLOOR}[[objects]]\npoints = \"ball.ply\"\n\
             material = {{ kind = \"glass\", ior = 1.33, absorption = [0.9, 0.9, 0.9], priority = {priority} }}\n\
             [[objects]]\npoints = \"water.ply\"\n\
             material = {{ kind = \"glass\", ior = 1.33, absorption = [0.1, 0.1, 0.1] }}\n",
            VIEW.text(),
            Light::Lamp(place).text()
        )
    };
    let sets = [floor(), set_of(fibonacci_sphere(20_000)), set_of(water)];
    // Of lower priority, the ball is not there at all.
    for (priority, of_ball) in [(1, 0.9), (-1, 0.1)] {
        let plan = plan_of(&text(priority), &sets);
        assert_eq!(plan.camera_media, [2], "the eye is under water");
        let film = render_twin(&plan).film;
        let mut errors = Vec::new();
        for pixel in 0..film.color.len() {
            let d = VIEW.through(pixel);
            let t = (-1.5 - VIEW.eye[1]) / d[1];
            let x = add(VIEW.eye, d, t);
            if t < 0.0 || x[0].abs().max(x[2].abs()) > 2.8 || VIEW.distance(pixel, [0.0; 3]) < 1.03
            {
                continue;
            }
            let way = add(place, x, -1.0);
            let [inside, nearest] = chord(x, unit(way), 1.0);
            if (nearest - 1.0).abs() < 0.03 {
                continue;
            }
            let lit = 0.8 * FRAC_1_PI * 40.0 / dot(way, way) * unit(way)[1];
            let depth = 0.1 * (length(way) - inside) + of_ball * inside + 0.1 * t;
            let found = f64::from(film.color[pixel][1]);
            errors.push((found - lit * (-depth).exp()).abs() / lit);
        }
        let most = percentile(errors, 0.99);
        assert!(most < 5e-5, "priority {priority}: {most:e}");
    }
}

/// A scene with everything that light may meet: skins one in another, of points and of spheres, smoke in them, an
/// isosurface, opaque things, and lamps that are soft.
fn everything(settings: &str, camera: &str) -> Plan {
    let lights = "[[lights]]\nkind = \"directional\"\ndirection = [0.3, -1.0, -0.2]\n\
                  irradiance = [3.0, 2.0, 3.0]\nangle = 5.0\n\
                  [[lights]]\nkind = \"point\"\nposition = [0.2, 0.3, 0.1]\nintensity = [1.0, 2.0, 3.0]\nradius = 0.1\n";
    let fog = FOG.replace("step = 0.01", "step = 0.1");
    let text = format!(
        "[camera]\neye = [0.4, 1.2, 5.0]\ntarget = [0.2, -0.6, 0.0]\nvertical_fov = 45.0\n{camera}\n{settings}\n\
         {lights}{FLOOR}\
         [[objects]]\npoints = \"smoke.ply\"\n\
         material = {{ kind = \"glass\", ior = 1.0, absorption = [0.3, 0.0, 0.1], priority = 1 }}\n\
         {fog}boundary = \"skin\"\nshading = \"scatter\"\n\
         [[objects]]\npoints = \"outer.ply\"\ntransform.scale = 1.3\n\
         material = {{ kind = \"glass\", ior = 1.0, absorption = [0.1, 0.2, 0.1] }}\n\
         [[objects]]\npoints = \"beads.ply\"\ntransform = {{ translate = [1.4, -0.8, 0.4], scale = 0.4 }}\n\
         surface = {{ kind = \"spheres\", radius = 0.15 }}\n\
         material = {{ kind = \"glass\", ior = [1.0, 1.2, 1.0], absorption = [0.9, 0.5, 0.1] }}\n\
         [[objects]]\npoints = \"glass.ply\"\ntransform = {{ translate = [-1.4, -0.8, 0.4], scale = 0.4 }}\n\
         material = {{ kind = \"glass\", ior = [1.4, 1.5, 1.6] }}\n\
         [[objects]]\npoints = \"iso.ply\"\ntransform.translate = [0.2, -1.3, 1.5]\n\
         [objects.volume]\nscalar = \"s\"\nkernel = \"sum\"\nboundary = \"none\"\nradius = 0.5\nsmoothing = 0.02\n\
         mode = \"isosurface\"\niso = 0.5\n",
    );
    let beads = fibonacci_sphere(60);
    let sets = [
        floor(),
        with_attribute(smoke(600, 1.0), "s", |p| 0.5 + 0.3 * p[0]),
        set_of(fibonacci_sphere(2_000)),
        set_of(beads),
        set_of(fibonacci_sphere(1_000)),
        with_attribute(set_of(vec![[0.0; 3]]), "s", |_| 1.0),
    ];
    plan_of(&text, &sets)
}

#[test]
fn light_through_skins_is_the_same_to_the_bit() {
    let bench = Bench::open();
    for (settings, camera) in [
        ("[image]\nsize = [40, 30]", ""),
        ("[image]\nsize = [32, 24]\nsamples = 3\n[render]\nfresnel = \"sample\"", ""),
        ("[image]\nsize = [40, 30]\n[render]\nshadows = \"opaque\"", ""),
        ("[image]\nsize = [32, 24]", "inside = [\"smoke\", \"outer\"]"),
    ] {
        let mut plan = everything(settings, camera);
        assert!(plan.light_passes);
        let on_device = bench.render(&plan);
        assert_same_bits(settings, &on_device, &render_twin(&plan));
        let finite = on_device.film.color.as_flattened().iter().all(|value| value.is_finite());
        assert!(finite, "{settings}: a colour is no number");
        for (k, form) in [(1, RayLoop::Images), (7, RayLoop::Queue)] {
            (plan.cells_per_pass, plan.ray_loop) = (k, form);
            let other = bench.render(&plan);
            assert_eq!(on_device.film.color, other.film.color, "{settings}, K = {k}");
        }
        (plan.cells_per_pass, plan.ray_loop) = (0, RayLoop::Auto);
        let few = bench.render_within(&plan, Some(64));
        assert_eq!(on_device.film.color, few.film.color, "{settings}, few iterations a pass");
    }
}

/// Where shadows are opaque, glass that shares an index with none, or is far from what does, asks for nothing.
#[test]
fn scenes_without_such_surfaces_are_left_alone() {
    let glass = |ior: f64, at: f64| {
        format!(
            "[[objects]]\npoints = \"a.ply\"\ntransform.translate = [{at}, 0.0, 0.0]\n\
             material = {{ kind = \"glass\", ior = {ior} }}\n"
        )
    };
    let ball = || set_of(fibonacci_sphere(500));
    let passes = |objects: &str, lights: &str| {
        plan_of(&format!("{OPAQUE}{lights}{objects}"), &[ball(), ball()]).light_passes
    };
    assert!(!passes(&(glass(1.5, 0.0) + &glass(1.5, 3.0)), &sun()), "apart");
    assert!(passes(&(glass(1.5, 0.0) + &glass(1.5, 1.0)), &sun()), "one index, overlapping");
    assert!(!passes(&(glass(1.5, 0.0) + &glass(1.4, 1.0)), &sun()), "two indices");
    assert!(passes(&(glass(1.5, 0.0) + &glass(1.0, 3.0)), &sun()), "the index of air");
    assert!(!passes(&(glass(1.5, 0.0) + &glass(1.0, 3.0)), ""), "no light");
}

/// A lamp inside is inside; a soft one, or one in doubt, may be.
#[test]
fn the_plan_knows_what_a_lamp_is_inside() {
    let media = |light: &str| {
        let text = format!(
            "{}{light}{FLOOR}[[objects]]\npoints = \"ball.ply\"\nmaterial = {{ kind = \"glass\", ior = 1.0 }}\n",
            VIEW.text()
        );
        plan_of(&text, &[floor(), set_of(fibonacci_sphere(2_000))]).lamp_media
    };
    assert_eq!(media(&sun()), [Some(vec![])]);
    assert_eq!(media(&Light::Lamp([0.1, 0.2, 0.0]).text()), [Some(vec![1])]);
    assert_eq!(media(&Light::Lamp([0.1, 2.2, 0.0]).text()), [Some(vec![])]);
    let soft = Light::Lamp([0.0, 1.2, 0.0]).text() + "radius = 0.4\n";
    assert_eq!(media(&soft), [Some(vec![1])]);
}

/// Passing a surface of one index on both sides is no bounce: with none to spend, the picture is the same, on the device,
/// whose first wave may be one pass, too.
#[test]
fn no_bounce_is_needed_to_pass_a_clear_skin() {
    let bench = Bench::open();
    for primary in ["grid", "discs", "tree"] {
        let film = |bounces: u32| {
            let text = format!(
                "{}[render]\nmax_bounces = {bounces}\nprimary = \"{primary}\"\n\
                 {}{FLOOR}[[objects]]\npoints = \"ball.ply\"\n\
                 material = {{ kind = \"glass\", ior = 1.0, absorption = [0.2, 0.7, 1.5] }}\n",
                VIEW.text(),
                sun()
            );
            let plan = plan_of(&text, &[floor(), set_of(fibonacci_sphere(2_000))]);
            let on_device = bench.render(&plan);
            assert_same_bits(primary, &on_device, &render_twin(&plan));
            on_device.film
        };
        let [none, many] = [0, 8].map(film);
        assert_eq!(none.color, many.color, "{primary}");
    }
}
