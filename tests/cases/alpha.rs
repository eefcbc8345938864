//! Coverage by channel, where glass treats the channels differently.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use film::Film;
use harness::{
    Bench, assert_same_film, fibonacci_sphere, plan_of, render_twin, set_of, with_attribute,
};
use plan::Plan;
use points::PointSet;

const BACKGROUND: [f32; 3] = [0.25, 0.5, 1.5];

/// A ball of glass about the origin, of radius 1, seen from z = 4.
fn scene(transparent: bool, glass: &str, more: &str) -> String {
    format!(
        "[camera]\neye = [0.0, 0.0, 4.0]\ntarget = [0.0, 0.0, 0.0]\nvertical_fov = 40.0\n\
         [image]\nsize = [97, 97]\ntransparent = {transparent}\nSAMPLES\n\
         [background]\ncolor = {BACKGROUND:?}\nRENDER\n\
         [[objects]]\npoints = \"ball.ply\"\nmaterial = {{ kind = \"glass\", {glass} }}\n{more}"
    )
}

fn sampled(text: &str) -> String {
    text.replace("SAMPLES", "samples = 8").replace("RENDER", "[render]\nfresnel = \"sample\"")
}

fn once(text: &str) -> String {
    text.replace("SAMPLES", "").replace("RENDER", "")
}

fn ball() -> PointSet {
    set_of(fibonacci_sphere(4_000))
}

/// On the device, which is the same as on the CPU.
fn film(plan: &Plan) -> Film {
    let on_device = Bench::open().render(plan).film;
    assert_same_film("alpha", &on_device, &render_twin(plan).film);
    on_device
}

fn alpha(film: &Film) -> &[[f32; 3]] {
    film.channel_alpha.as_ref().expect("AR AG AB")
}

/// The opaque picture, and that which the transparent one makes over the background; the greatest
/// difference of a channel.
fn over(text: impl Fn(bool) -> String, sets: &[PointSet]) -> f32 {
    let [opaque, transparent] =
        [false, true].map(|transparent| film(&plan_of(&text(transparent), sets)));
    assert_eq!(alpha(&opaque), alpha(&transparent), "alpha is the same with or without background");
    let mut worst = 0.0_f32;
    for (at, (whole, part)) in opaque.color.iter().zip(&transparent.color).enumerate() {
        assert_eq!(whole[3], part[3], "A");
        for channel in 0..3 {
            let alpha = alpha(&transparent)[at][channel];
            assert!((0.0..=1.0).contains(&alpha), "pixel {at}: alpha {alpha}");
            let composed = part[channel] + (1.0 - alpha) * BACKGROUND[channel];
            worst = worst.max((whole[channel] - composed).abs());
        }
    }
    worst
}

/// Roundings of sums of eight samples.
const ROUNDING: f32 = 2e-6;

/// Beer's law along the axis: two radii of way. The ball of 4000 points is that thick to 1e-4.
#[test]
fn alpha_of_a_coloured_ball_is_what_its_middle_absorbs() {
    let text = once(&scene(true, "ior = 1.4, absorption = [0.0, 0.3, 1.5]", ""));
    let film = film(&plan_of(&text, &[ball()]));
    let middle = 48 * 97 + 48;
    for (channel, absorption) in [0.0f32, 0.3, 1.5].into_iter().enumerate() {
        let expected = 1.0 - (-2.0 * absorption).exp();
        let found = alpha(&film)[middle][channel];
        assert!((found - expected).abs() < 2e-4, "channel {channel}: {found}, not {expected}");
    }
    assert_eq!(film.color[middle], [0.0, 0.0, 0.0, 1.0], "glass covers, and adds nothing");
    assert_eq!((alpha(&film)[0], film.color[0]), ([0.0; 3], [0.0; 4]), "beside it is nothing");
}

#[test]
fn a_transparent_picture_over_its_background_is_the_opaque_one() {
    let absorbing = "ior = 1.4, absorption = [0.0, 0.3, 1.5]";
    let dispersing = "ior = [1.3, 1.5, 1.7]";
    for glass in [absorbing, dispersing] {
        let worst = over(|transparent| once(&scene(transparent, glass, "")), &[ball()]);
        assert!(worst < ROUNDING, "{glass}: off by {worst}");
        let worst = over(|transparent| sampled(&scene(transparent, glass, "")), &[ball()]);
        assert!(worst < ROUNDING, "{glass}, reflections by chance: off by {worst}");
    }
}

/// Smoke before, and in, glass: what it lets through counts, what it emits stays.
#[test]
fn volumes_and_glass_multiply() {
    let smoke = with_attribute(
        set_of(fibonacci_sphere(500).into_iter().map(|p| p.map(|c| 0.6 * c)).collect()),
        "density",
        |p| 3.0 + 5.0 * p[1],
    );
    let volume = "[[objects]]\npoints = \"smoke.ply\"\n[objects.volume]\nscalar = \"density\"\nboundary = \"none\"\n\
         radius = 0.4\ntransfer = [{ value = 0.0, color = [1.0, 0.2, 0.1], extinction = 0.1 }, \
         { value = 6.0, color = [0.1, 0.4, 1.0], extinction = 1.0 }]\n";
    let glass = "ior = 1.2, absorption = [0.4, 0.1, 0.0]";
    let worst =
        over(|transparent| once(&scene(transparent, glass, volume)), &[ball(), smoke.clone()]);
    assert!(worst < ROUNDING, "off by {worst}");
}

/// A mirror behind coloured glass: the background that it shows is no background of the picture.
#[test]
fn what_is_reflected_stays_in_the_colour() {
    let mirror = "[[objects]]\npoints = \"mirror.ply\"\nmaterial = { kind = \"mirror\" }\n\
                  transform = { scale = 0.5 }\n";
    let text = |transparent| {
        once(&scene(transparent, "ior = 1.0001, absorption = [0.1, 0.2, 0.3]", mirror))
    };
    let worst = over(text, &[ball(), ball()]);
    assert!(worst < ROUNDING, "off by {worst}");
    let film = film(&plan_of(&text(true), &[ball(), ball()]));
    let middle = 48 * 97 + 48;
    assert_eq!(alpha(&film)[middle], [1.0; 3]);
    assert!(film.color[middle][..3].iter().all(|&c| c > 0.1), "{:?}", film.color[middle]);
}

#[test]
fn clear_glass_has_no_alpha_by_channel_and_keeps_the_background() {
    let text =
        |transparent| once(&scene(transparent, "ior = 1.4, absorption = [0.3, 0.3, 0.3]", ""));
    let [opaque, transparent] =
        [false, true].map(|transparent| film(&plan_of(&text(transparent), &[ball()])));
    assert_eq!((&opaque.channel_alpha, &transparent.channel_alpha), (&None, &None));
    let middle = 48 * 97 + 48;
    assert_eq!(opaque.color[middle], transparent.color[middle]);
    assert_eq!(transparent.color[0], [0.0; 4]);
}
