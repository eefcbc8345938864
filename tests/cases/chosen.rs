//! What is chosen where a scene leaves it to the program: that it is kept, that it says the same when it is given, and
//! that extinctions and logarithmic scales are what they claim to be.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use harness::{moved, plan_of, random, render_twin, set_of, with_attribute};
use plan::{Choice, Plan, SceneImages};
use points::PointSet;
use scene::{Scene, Up};
use std::path::Path;
use std::slice::from_ref;
use std::sync::Arc;

/// Points that fill a ball evenly.
fn ball(count: usize, radius: f64, middle: [f64; 3]) -> Vec<[f64; 3]> {
    let mut seed = 7;
    let mut points = Vec::new();
    while points.len() < count {
        let p = [0; 3].map(|_| 2.0 * random(&mut seed) - 1.0);
        if p.iter().map(|x| x * x).sum::<f64>() <= 1.0 {
            points.push(p.map(|x| radius * x));
        }
    }
    moved(&points, middle)
}

fn number(plan: &Plan, key: &str) -> f64 {
    let found = plan.chosen.iter().find(|chosen| chosen.key == key);
    match found.map(|chosen| chosen.value) {
        Some(Choice::Number(number)) => number,
        other => panic!("{key}: {other:?} among {:?}", plan.chosen),
    }
}

fn volume(keys: &str) -> String {
    format!("[[objects]]\npoints = \"a.ply\"\n[objects.volume]\nscalar = \"s\"\n{keys}\n")
}

/// In a ball the median of all parallel chords is √2 of the radius. Points reach beyond it by a radius r of their own: their
/// union's chords are between those of R and of R + r.
#[test]
fn an_automatic_extinction_lets_a_tenth_through_the_median_chord_at_any_size() {
    let mut factors = Vec::new();
    for (radius, middle) in [(1.0, [0.0; 3]), (1e-3, [0.0; 3]), (2e6, [3e7, -1e7, 0.0])] {
        let set = with_attribute(set_of(ball(20_000, radius, middle)), "s", |p| p[0]);
        let eye = [middle[0], middle[1], middle[2] + 4.0 * radius];
        let camera = format!(
            "[camera]\neye = {eye:?}\ntarget = {middle:?}\nprojection = \"orthographic\"\nheight = {}\n[image]\nsize = [64, 64]\n",
            2.4 * radius
        );
        let text = camera + &volume("color_map = \"gray\"\nextinction = \"auto\"");
        let plan = plan_of(&text, &[set]);
        let (sigma, reach) = (number(&plan, "volume.extinction"), number(&plan, "volume.radius"));
        let chord = |r: f64| std::f64::consts::SQRT_2 * r;
        let depths = [chord(radius), chord(radius + reach)].map(|chord| sigma * chord);
        assert!(depths[0] < 2.0 && depths[1] > 2.0, "{radius}: {depths:?}");
        // What a picture shows of it: one less the transmittance, of the middle one of the pixels that show something.
        let film = render_twin(&plan).film;
        let mut shown: Vec<f32> = film.color.iter().map(|c| c[3]).filter(|&a| a > 0.0).collect();
        shown.sort_unstable_by(f32::total_cmp);
        let median = f64::from(shown[shown.len() / 2]);
        // 24 lines across the ball place the median chord to about a hundredth of it, which is 0.003 of e^-2.
        assert!((median - (1.0 - (-2.0f64).exp())).abs() < 0.01, "{radius}: {median}");
        factors.push(sigma * radius);
    }
    for factor in &factors {
        assert!((factor / factors[0] - 1.0).abs() < 0.01, "{factors:?}");
    }
}

/// A cube whose σ is the scalar x from 0 to 1: across x every line has τ = 1/2, along y and z it has its own x, evenly.
/// Half of the lines have less than 1/2.
#[test]
fn an_automatic_factor_is_by_the_depth_of_the_transfer_function_itself() {
    let lattice: Vec<[f64; 3]> = (0..40 * 40 * 40)
        .map(|i| [i % 40, i / 40 % 40, i / 1600].map(|at| f64::from(at) / 39.0))
        .collect();
    let set = with_attribute(set_of(lattice), "s", |p| p[0]);
    let stops = "transfer = [{ value = 0, color = [1, 1, 1], extinction = 0 }, { value = 1, color = [1, 0, 0], extinction = 1 }]\n\
                 radius = 0.06\n";
    let auto = plan_of(&volume(&format!("{stops}extinction = \"auto\"")), from_ref(&set));
    let factor = number(&auto, "volume.extinction");
    // Points reach 0.06 beyond: chords are up to 12 % longer.
    assert!((3.5..4.1).contains(&factor), "{factor}");
    let given = plan_of(&volume(&format!("{stops}extinction = {factor:?}")), from_ref(&set));
    assert_eq!(auto.volumes, given.volumes);
    assert!(given.chosen.iter().all(|chosen| chosen.key != "volume.extinction"));
    let plain = plan_of(&volume(stops), &[set]);
    assert_eq!(plain.volumes.stops[1].extinction, 1.0);
    assert_eq!(given.volumes.stops[1].extinction, factor as f32);
}

/// Whatever was chosen, given as `--set` takes it, makes the same plan, of which nothing is chosen any more.
#[test]
fn what_was_chosen_is_the_same_when_it_is_given() {
    let set = with_attribute(set_of(ball(5000, 1.0, [10.0, 0.0, 0.0])), "s", |p| p[1] * 0.37);
    let set = with_attribute(set, "t", |p| p[2]);
    let text = volume("color_map = \"magma\"\nextinction = \"auto\"")
        + "[[objects]]\npoints = \"b.ply\"\nsurface.kind = \"spheres\"\nsurface.radius_scale = 0.7\n\
           material = { albedo = \"attribute:t\" }\n";
    let plan = |overrides: &[String]| {
        let scene = Scene::from_toml(&text, Path::new("s.toml"), overrides).expect("a scene");
        let sets: Vec<Arc<PointSet>> = [set.clone(), set.clone()].map(Arc::new).to_vec();
        Plan::new(&scene, &sets, &SceneImages::default(), None, Up::Y).expect("a plan")
    };
    let auto = plan(&[]);
    let keys: Vec<&str> = auto.chosen.iter().map(|chosen| chosen.key).collect();
    let mut sorted = keys.clone();
    sorted.sort_unstable();
    assert_eq!(
        sorted,
        [
            "material.value_range",
            "surface.radius",
            "volume.extinction",
            "volume.radius",
            "volume.smoothing",
            "volume.step",
            "volume.value_range"
        ]
    );
    let lines: Vec<String> = auto.chosen.iter().map(ToString::to_string).collect();
    let settings = &auto.provenance().settings;
    let attribute = settings.iter().find(|(key, _)| key == "chosen").map(|(_, text)| text.as_str());
    assert_eq!(attribute, Some(lines.join("\n").as_str()));
    let given = plan(&lines);
    assert_eq!(given.chosen, []);
    assert_eq!(given.volumes, auto.volumes);
    assert_eq!(given.colors, auto.colors);
    assert_eq!(given.shapes, auto.shapes);
    assert!(given.provenance().settings.iter().all(|(key, _)| key != "chosen"));
}

/// The colours of a logarithmic scale are those of the logarithms on a linear one.
#[test]
fn a_logarithmic_scale_shows_logarithms() {
    let points: Vec<[f64; 3]> = ball(2000, 1.0, [0.0; 3]);
    let value = |p: [f64; 3]| 10f64.powf(3.0 * p[0] - 2.0);
    let set = with_attribute(set_of(points), "v", value);
    let set = with_attribute(set, "log", |p| value(p).log10());
    let colors = |material: &str| {
        let text = format!("[[objects]]\npoints = \"a.ply\"\nmaterial = {{ {material} }}\n");
        plan_of(&text, from_ref(&set))
    };
    let log = colors("albedo = \"attribute:v\", scale = \"log\"");
    let linear = colors("albedo = \"attribute:log\"");
    assert_eq!(log.colors.len(), 6000);
    let far = log.colors.iter().zip(&linear.colors).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    // f64 rounds a logarithm; where that moves a value over the middle of a byte, the colour is the next: 0.009 near white.
    assert!(far < 0.01, "{far}");
    let given = colors("albedo = \"attribute:v\", scale = \"log\", value_range = [0.001, 10]");
    let linear = colors("albedo = \"attribute:log\", value_range = [-3, 1]");
    let far =
        given.colors.iter().zip(&linear.colors).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(far < 0.01, "{far}");
}

#[test]
fn what_is_not_positive_is_at_the_lower_end_of_a_logarithmic_scale() {
    let values = [-5.0, 0.0, 0.25, 1.0, 16.0, f64::NAN];
    let positions = (0..6).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    let set = with_attribute(set_of(positions), "v", |p| values[p[0] as usize]);
    let color_of = |plan: &Plan, i: u32| -> [f32; 3] {
        let slot = plan.cloud.slot(0, i as usize) as usize;
        [0, 1, 2].map(|channel| plan.colors[3 * slot + channel])
    };
    let text = |more: &str| {
        format!(
            "[[objects]]\npoints = \"a.ply\"\nmaterial = {{ albedo = \"attribute:v\", scale = \"log\", color_map = \"gray\"{more} }}\n"
        )
    };
    let plan = plan_of(&text(""), from_ref(&set));
    let chosen: Vec<String> = plan.chosen.iter().map(ToString::to_string).collect();
    assert_eq!(chosen, ["objects.0.material.value_range=[0.25, 16.0]"]);
    assert_eq!([0, 1, 2].map(|i| color_of(&plan, i)), [[0.0; 3]; 3]);
    assert_eq!(color_of(&plan, 4), [1.0; 3]);
    // A third of the way in sRGB.
    let third = film::linear_from_srgb(1.0 / 3.0) as f32;
    assert!((color_of(&plan, 3)[0] - third).abs() < 1e-6);
    assert!(color_of(&plan, 5)[0] < 0.0, "no number is marked");
    // With the greater end first, the lower end is the last colour.
    let turned = plan_of(&text(", value_range = [16, 0.25]"), from_ref(&set));
    assert_eq!([0, 1, 2, 4].map(|i| color_of(&turned, i)[0]), [1.0, 1.0, 1.0, 0.0]);
    // Nothing to show.
    let negative = with_attribute(set_of(vec![[0.0; 3], [1.0; 3]]), "v", |_| -1.0);
    let scene = Scene::from_toml(&text(""), Path::new("s.toml"), &[]).expect("a scene");
    let error = Plan::new(&scene, &[Arc::new(negative)], &SceneImages::default(), None, Up::Y)
        .expect_err("nothing positive")
        .to_string();
    for part in ["scale = \"log\"", "'v'", "a.ply", "value_range"] {
        assert!(error.contains(part), "{error}");
    }
}

/// The stops of a logarithmic map are even in the logarithm, at least 16 a decade; zeros have the lower end's extinction.
#[test]
fn a_volume_has_a_logarithmic_scale_as_well() {
    let set = with_attribute(set_of(ball(2000, 1.0, [0.0; 3])), "s", |p| {
        if p[0] < 0.0 { 0.0 } else { 10f64.powf(8.0 * p[0] - 4.0) }
    });
    let keys =
        "color_map = \"gray\"\nscale = \"log\"\nvalue_range = [1e-4, 1e4]\nextinction = [0, 8]";
    let plan = plan_of(&volume(keys), from_ref(&set));
    let stops = &plan.volumes.stops;
    assert_eq!(stops.len(), 129);
    for (i, stop) in stops.iter().enumerate() {
        let log = f64::from(stop.value).log10();
        assert!((log - (i as f64 / 16.0 - 4.0)).abs() < 1e-6, "{i}: {log}");
        assert!((stop.extinction - i as f32 / 16.0).abs() < 1e-6);
    }
    let auto = plan_of(&volume(&keys.replace("value_range = [1e-4, 1e4]\n", "")), &[set]);
    let range = auto.chosen.iter().find(|chosen| chosen.key == "volume.value_range");
    let Some(Choice::Range([low, high])) = range.map(|chosen| chosen.value) else {
        panic!("{:?}", auto.chosen)
    };
    assert!(low > 1e-4 && low < 1.1e-4 && high < 1e4 && high > 7e3, "{low} {high}");
}
