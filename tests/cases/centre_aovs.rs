//! Depth, position, normal, object and diagnostics are those of the ray through a pixel's centre, whatever the number of
//! samples.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use film::Film;
use harness::{
    Bench, assert_same_bits, assert_same_film, fibonacci_sphere, plan_of, random, render_twin,
    set_of, wavy_sheet, with_attribute,
};
use plan::{Diagnostic, Plan};
use points::PointSet;

const LIGHTS: &str = "
[background]
color = [0.4, 0.5, 0.7]
[[lights]]
kind = \"directional\"
direction = [-0.4, -1.0, -0.3]
irradiance = [3.0, 2.9, 2.7]
angle = 8.0
[[lights]]
kind = \"point\"
position = [2.0, 3.0, 2.0]
intensity = [4.0, 5.0, 6.0]
radius = 0.3
";

/// A sheet, glass that disperses with a bubble in it, a mirror and a diffuse ball, whose edges cross each other.
const OBJECTS: &str = "
[[objects]]
points = \"sheet.ply\"
[[objects]]
points = \"glass.ply\"
transform = { translate = [-0.6, 0.6, 0.4], scale = 0.8 }
material = { kind = \"glass\", ior = [1.4, 1.5, 1.65] }
[[objects]]
points = \"bubble.ply\"
transform = { translate = [-0.6, 0.6, 0.4], scale = 0.4 }
material = { kind = \"glass\", ior = 1.0, priority = 1 }
[[objects]]
points = \"ball.ply\"
transform = { translate = [0.2, 0.5, 0.7], scale = 0.4 }
[[objects]]
points = \"mirror.ply\"
transform = { translate = [1.0, 0.5, -0.6], scale = 0.7 }
material = { kind = \"mirror\" }
";

fn camera(more: &str) -> String {
    format!(
        "[camera]\neye = [0.5, 1.4, 4.5]\ntarget = [0.0, 0.2, 0.0]\nvertical_fov = 40.0\n{more}\n"
    )
}

fn sheet_and_balls() -> Vec<PointSet> {
    let sheet = wavy_sheet(3_000).into_iter();
    let sheet = sheet.map(|[x, y, z]| [5.0 * (x - 0.5), y - 0.4, 5.0 * (z - 0.5)]);
    let balls = [3_000, 1_000, 1_500, 1_500].map(|count| set_of(fibonacci_sphere(count)));
    std::iter::once(set_of(sheet.collect())).chain(balls).collect()
}

/// Fog with a density that grows outwards, an isosurface in fog of its own, and a ball before both.
const VOLUMES: &str = "
[[objects]]
points = \"fog.ply\"
volume = { scalar = \"s\", boundary = \"none\", transfer = [{ value = 0.0, color = [1, 0, 0], extinction = 0.0 }, { value = 1.0, color = [0, 0, 1], extinction = 3.0 }] }
[[objects]]
points = \"iso.ply\"
transform = { translate = [0.9, 0.4, 0.2], scale = 0.7 }
volume = { scalar = \"s\", boundary = \"none\", mode = \"isosurface\", iso = 0.4 }
[[objects]]
points = \"ball.ply\"
transform = { translate = [-0.3, 0.2, 1.2], scale = 0.3 }
";

fn fog_and_ball() -> Vec<PointSet> {
    let mut seed = 7;
    let mut place = || [0, 1, 2].map(|_| 2.0 * random(&mut seed) - 1.0);
    let cloud: Vec<[f64; 3]> = (0..3_000).map(|_| place()).collect();
    let grows = |p: [f64; 3]| p.iter().map(|x| x * x).sum::<f64>().sqrt();
    let falls = |p: [f64; 3]| 1.0 - p.iter().map(|x| x * x).sum::<f64>().sqrt();
    vec![
        with_attribute(set_of(cloud.clone()), "s", grows),
        with_attribute(set_of(cloud), "s", falls),
        set_of(fibonacci_sphere(1_500)),
    ]
}

fn cases() -> Vec<(&'static str, String, Vec<PointSet>)> {
    let surfaces = |camera: String, render: &str| format!("{camera}{render}{LIGHTS}{OBJECTS}");
    let refined = surfaces(camera(""), "")
        .replace("points = \"ball.ply\"", "points = \"ball.ply\"\nsurface.refine = \"project\"");
    vec![
        ("edges, glass and dispersion", surfaces(camera(""), ""), sheet_and_balls()),
        (
            "a lens",
            surfaces(camera("aperture = 0.4\nfocus = 3.2"), "[render]\nfresnel = \"sample\"\n"),
            sheet_and_balls(),
        ),
        (
            "parallel rays",
            surfaces(camera("").replace("vertical_fov = 40.0", PARALLEL), ""),
            sheet_and_balls(),
        ),
        ("refined surfaces", refined, sheet_and_balls()),
        ("volumes", format!("{}{LIGHTS}{VOLUMES}", camera("")), fog_and_ball()),
    ]
}

const PARALLEL: &str = "projection = \"orthographic\"\nheight = 3.0";

fn plan(text: &str, sets: &[PointSet], samples: u32, diagnostics: &[Diagnostic]) -> Plan {
    let image = format!("[image]\nsize = [64, 48]\nsamples = {samples}\n");
    let mut plan = plan_of(&format!("{image}{text}"), sets);
    plan.diagnostics = diagnostics.to_vec();
    plan
}

/// A film with its colours left out.
fn surfaces_of(film: &Film) -> Film {
    let mut film = film.clone();
    film.color.fill([0.0; 4]);
    film.channel_alpha = None;
    film
}

/// Of 16 samples, or three, they are those of one, to the bit, by device and twin; and colours are what they are where nobody wants
/// anything else.
#[test]
fn surfaces_of_many_samples_are_those_of_one() {
    let bench = Bench::open();
    let hits = [Diagnostic::Point, Diagnostic::Iterations, Diagnostic::Trust, Diagnostic::Fit];
    for (name, text, sets) in cases() {
        for diagnostics in [&[][..], &hits, &Diagnostic::ALL] {
            let one = bench.render(&plan(&text, &sets, 1, diagnostics));
            let samples = if diagnostics.is_empty() { 16 } else { 3 };
            let mut many = plan(&text, &sets, samples, diagnostics);
            let rendered = bench.render(&many);
            let [a, b] = [&one.film, &rendered.film].map(surfaces_of);
            assert_same_film(name, &a, &b);
            let edges = (0..64 * 48).filter(|&at| rendered.film.color[at][3].fract() > 0.0).count();
            assert!(edges > 100 || samples < 16, "{name}: {edges} pixels on an edge");
            assert_same_bits(name, &rendered, &render_twin(&many));
            many.aovs = false;
            let colors = bench.render(&many);
            assert_eq!(rendered.film.color, colors.film.color, "{name}: colours");
            assert_eq!(rendered.film.channel_alpha, colors.film.channel_alpha, "{name}: alpha");
            if diagnostics.is_empty() {
                assert_eq!(rendered.tests, colors.tests, "{name}: what samples test");
                let off = (colors.film.object.iter().zip(&one.film.object)).filter(|(a, b)| a != b);
                assert!(
                    off.count() > 10,
                    "{name}: the first sample is on the same side everywhere"
                );
            }
        }
    }
}

/// A crop has the whole picture's, also where tiles begin elsewhere.
#[test]
fn a_crop_has_the_whole_pictures() {
    let bench = Bench::open();
    for (name, text, sets) in cases() {
        let mut plan = plan(&text, &sets, 3, &Diagnostic::ALL);
        let whole = bench.render(&plan).film;
        plan.window = plan::Window { origin: [13, 9], size: [37, 31] };
        let crop = bench.render(&plan).film;
        for i in 0..37 * 31 {
            let at = (9 + i / 37) * 64 + 13 + i % 37;
            let of = |film: &Film, at: usize| {
                let more: Vec<f32> = film.extra.iter().map(|(_, plane)| plane[at]).collect();
                let surface = (film.object[at], film.depth[at], film.position[at], film.normal[at]);
                (film.color[at], surface, more)
            };
            assert_eq!(of(&crop, i), of(&whole, at), "{name}: pixel {i}");
        }
    }
}

/// A ball before nothing, against the circle that it is: the object of each pixel is what its centre shows.
#[test]
fn an_outline_is_where_the_centres_see_it() {
    let text = "[camera]\neye = [0.0, 0.0, 4.0]\ntarget = [0.0, 0.0, 0.0]\nvertical_fov = 40.0\n\
                [image]\nsize = [128, 128]\nsamples = 8\n";
    let film = render_twin(&plan_of(text, &[set_of(fibonacci_sphere(20_000))])).film;
    let radius = 64.0 * 0.25f64.asin().tan() / 20f64.to_radians().tan();
    for (at, &object) in film.object.iter().enumerate() {
        let place = |i: usize| i as f64 + 0.5 - 64.0;
        let distance = place(at % 128).hypot(place(at / 128));
        // The surface is within 1e-4 of the ball; a hundredth of a pixel is 4e-4.
        if (distance - radius).abs() > 0.01 {
            assert_eq!(object >= 0.0, distance < radius, "pixel {at}, {distance} of {radius}");
        }
        assert_eq!(film.depth[at].is_finite(), object >= 0.0);
    }
}
