//! Which glass the eye is inside: found by normals, by counting surfaces, or given.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use film::Film;
use harness::analytic::{Body, Matter, Shape, V3, add, cross, follow, percentile, unit};
use harness::{
    Bench, assert_same_bits, fibonacci_sphere, plan_of, random, render_twin, set_of, wavy_sheet,
    with_attribute,
};
use plan::Plan;
use points::PointSet;

const SIZE: [usize; 2] = [48, 36];
const WHITE: &str = "[image]\nsize = [48, 36]\n[background]\ncolor = [1.0, 1.0, 1.0]\n";

fn camera(eye: V3, target: V3, more: &str) -> String {
    format!("[camera]\neye = {eye:?}\ntarget = {target:?}\nvertical_fov = 60.0\n{more}\n{WHITE}")
}

fn through(eye: V3, target: V3, pixel: usize) -> V3 {
    let forward = unit(add(target, eye, -1.0));
    let right = unit(cross(forward, [0.0, 1.0, 0.0]));
    let above = cross(right, forward);
    let half = 30f64.to_radians().tan() / (0.5 * SIZE[1] as f64);
    let x = ((pixel % SIZE[0]) as f64 + 0.5 - 0.5 * SIZE[0] as f64) * half;
    let y = (0.5 * SIZE[1] as f64 - (pixel / SIZE[0]) as f64 - 0.5) * half;
    unit(add(add(forward, right, x), above, y))
}

fn ball(count: u32, normals: bool) -> PointSet {
    let mut set = set_of(fibonacci_sphere(count));
    if normals {
        set.normals = Some(set.positions.iter().map(|p| p.map(|x| x as f32)).collect());
    }
    set
}

/// The median and the 95th percentile of the errors against rays traced in closed form.
fn errors(film: &Film, bodies: &[Body], eye: V3, target: V3) -> [f64; 2] {
    let error = |pixel: usize| {
        let expected = follow(bodies, eye, through(eye, target, pixel)).throughput[0];
        (f64::from(film.color[pixel][0]) - expected).abs()
    };
    let errors: Vec<f64> = (0..SIZE[0] * SIZE[1]).map(error).collect();
    [0.5, 0.95].map(|share| percentile(errors.clone(), share))
}

fn shape(radius: f64, matter: Matter) -> Body {
    Body { shape: Shape::Sphere([0.0; 3], radius), matter }
}

/// With normals or without them, what is seen of a white background is what the way through the glass leaves.
#[test]
fn an_eye_inside_a_ball_sees_what_the_glass_leaves() {
    let (eye, target) = ([0.3, 0.1, 0.2], [0.0, 0.0, -1.0]);
    let glass = "[[objects]]\npoints = \"a.ply\"\n\
                 material = { kind = \"glass\", ior = 1.2, absorption = [0.5, 1.0, 2.0] }\n";
    let bodies = [shape(1.0, Matter::Glass(1.2, 0.5))];
    for normals in [true, false] {
        let plan = plan_of(&(camera(eye, target, "") + glass), &[ball(10_000, normals)]);
        assert_eq!((plan.camera_media.as_slice(), plan.doubts.len()), (&[0][..], 0), "{normals}");
        let rendered = render_twin(&plan);
        let [median, most] = errors(&rendered.film, &bodies, eye, target);
        // Total reflection adds ways of its own at the outer pixels.
        assert!(median < 2e-6 && most < 1e-4, "normals {normals}: {median:e}, {most:e}");
        assert_same_bits("inside", &Bench::open().render(&plan), &rendered);
    }
}

/// Beside the ball, near its surface and in the corner of its box, the eye is outside, and no one doubts it.
#[test]
fn an_eye_beside_a_ball_is_outside() {
    let glass = "[[objects]]\npoints = \"a.ply\"\nmaterial = { kind = \"glass\" }\n";
    for eye in [[0.72, 0.72, 0.3], [0.0, 1.01, 0.0], [0.6, -0.64, 0.5], [0.0, 0.0, 3.0]] {
        for normals in [true, false] {
            let plan =
                plan_of(&(camera(eye, [0.0, 0.1, 0.05], "") + glass), &[ball(10_000, normals)]);
            assert!(plan.camera_media.is_empty() && plan.doubts.is_empty(), "{eye:?}, {normals}");
        }
    }
}

/// Nested balls: an eye in the inner one is inside both, in the outer one only in that; a hollow is an object of its own,
/// or a part of one whose points have both its sides.
#[test]
fn nested_balls_and_shells() {
    let glass = |scale: f64, more: &str| {
        format!(
            "[[objects]]\npoints = \"a.ply\"\ntransform.scale = {scale}\n\
             material = {{ kind = \"glass\", {more} }}\n"
        )
    };
    let nested = glass(1.0, "ior = 1.2, absorption = [0.4, 0.4, 0.4]")
        + &glass(0.5, "ior = 1.1, absorption = [1.0, 1.0, 1.0], priority = 1");
    let bodies = [shape(1.0, Matter::Glass(1.2, 0.4)), shape(0.5, Matter::Glass(1.1, 1.0))];
    for (eye, media) in
        [([0.1, 0.2, 0.1], &[0, 1][..]), ([0.7, 0.0, 0.2], &[0]), ([0.8, 0.8, 0.1], &[])]
    {
        let target = [0.0, 0.05, -1.5];
        let sets = [ball(10_000, false), ball(5_000, false)];
        let plan = plan_of(&(camera(eye, target, "") + &nested), &sets);
        assert_eq!((plan.camera_media.as_slice(), plan.doubts.len()), (media, 0), "{eye:?}");
        let [median, most] = errors(&render_twin(&plan).film, &bodies, eye, target);
        assert!(median < 1e-5 && most < 1e-3, "{eye:?}: {median:e}, {most:e}");
    }
    let both = fibonacci_sphere(10_000).into_iter();
    let hollow = fibonacci_sphere(4_000).into_iter().map(|p| p.map(|x| 0.6 * x));
    let shell = set_of(both.chain(hollow).collect());
    for (eye, inside) in [([0.1, 0.2, 0.1], false), ([0.8, 0.0, 0.1], true)] {
        let plan =
            plan_of(&(camera(eye, [0.0; 3], "") + &glass(1.0, "")), std::slice::from_ref(&shell));
        assert_eq!((plan.camera_media.is_empty(), plan.doubts.len()), (!inside, 0), "{eye:?}");
    }
}

/// A ball with the noise of a scan, two thirds of a spacing, uneven points and a hole at its foot.
#[test]
fn a_noisy_scan_of_a_ball_holds_the_eye() {
    let mut seed = 11;
    let mut noise = || (0..4).map(|_| random(&mut seed)).sum::<f64>() - 2.0;
    let mut points: Vec<V3> = fibonacci_sphere(30_000)
        .into_iter()
        .filter(|p| p[1] > -0.95)
        .map(|p| p.map(|x| x * (1.0 + 0.02 * noise())))
        .collect();
    points.extend((0..30).map(|i| [0.03 * f64::from(i) - 0.5, 0.4, 0.3])); // what floats inside
    let glass = "[[objects]]\npoints = \"a.ply\"\nmaterial = { kind = \"glass\" }\n";
    for (eye, inside) in [([0.2, -0.2, 0.1], true), ([0.75, 0.75, 0.1], false)] {
        let plan = plan_of(&(camera(eye, [0.0, 0.0, -0.5], "") + glass), &[set_of(points.clone())]);
        assert_eq!(plan.camera_media.contains(&0), inside, "{eye:?}: {:?}", plan.doubts);
    }
}

/// An open surface has no inside: the eye is taken to be outside, with a doubt that names the object and the key.
#[test]
fn an_open_surface_raises_a_doubt() {
    let sheet: Vec<V3> =
        wavy_sheet(10_000).into_iter().map(|[x, y, z]| [2.0 * x, 3.0 * y, 2.0 * z]).collect();
    let middle = sheet.iter().map(|p| p[1]).sum::<f64>() / sheet.len() as f64;
    let glass = "[[objects]]\nname = \"lake\"\npoints = \"a.ply\"\n\
                 material = { kind = \"glass\" }\n";
    let eye = [1.0, middle, 1.0];
    let text = |more: &str| camera(eye, [1.5, middle, 0.0], more) + glass;
    let plan = plan_of(&text(""), &[set_of(sheet.clone())]);
    assert!(plan.camera_media.is_empty());
    let doubt = plan.doubts.first().expect("a doubt");
    assert!(doubt.contains("'lake'") && doubt.contains("camera.inside = \"lake\""), "{doubt}");
    for (given, media) in
        [("inside = \"lake\"", &[0][..]), ("inside = [\"lake\"]", &[0]), ("inside = []", &[])]
    {
        let plan = plan_of(&text(given), &[set_of(sheet.clone())]);
        assert_eq!((plan.camera_media.as_slice(), plan.doubts.len()), (media, 0), "{given}");
    }
}

/// What is given counts, also against what would be found.
#[test]
fn what_is_given_counts() {
    let glass = "[[objects]]\nname = \"b\"\npoints = \"b.ply\"\nmaterial = { kind = \"glass\" }\n\
                 [[objects]]\nname = \"c\"\npoints = \"b.ply\"\nmaterial = { kind = \"glass\" }\n";
    let plan = |more: &str| -> Plan {
        let text = camera([0.1, 0.0, 0.2], [0.0; 3], more) + glass;
        plan_of(&text, &[ball(2_000, true), ball(2_000, false)])
    };
    assert_eq!(plan("").camera_media, [0, 1]);
    assert_eq!(plan("inside = []").camera_media, [0u32; 0]);
    assert_eq!(plan("inside = \"c\"").camera_media, [1]);
    assert_eq!(plan("inside = [\"c\", \"b\"]").camera_media, [0, 1]);
}

/// Normals that look inwards are outvoted by the surfaces around the eye, with a word about it.
#[test]
fn normals_that_look_inwards_are_doubted() {
    let glass = "[[objects]]\nname = \"b\"\npoints = \"b.ply\"\nmaterial = { kind = \"glass\" }\n";
    let mut set = ball(5_000, true);
    set.normals = set.normals.map(|all| all.into_iter().map(|n| n.map(|x| -x)).collect());
    for (eye, media) in [([0.1, 0.0, 0.2], &[0][..]), ([0.0, 0.5, 2.0], &[])] {
        let plan =
            plan_of(&(camera(eye, [0.0, 0.0, -0.5], "") + glass), std::slice::from_ref(&set));
        assert_eq!(plan.camera_media, media, "{eye:?}");
        assert!(plan.doubts[0].contains("'b': by its normals"), "{:?}", plan.doubts);
    }
}

/// An isosurface knows by its scalar.
#[test]
fn an_eye_inside_an_isosurface_is_known() {
    // s exp(-d^2 / 2 rho) = iso at d = 0.37.
    let set = with_attribute(set_of(vec![[0.0; 3]]), "s", |_| 1.0);
    let glass = "[[objects]]\npoints = \"a.ply\"\nmaterial = { kind = \"glass\" }\n\
                 [objects.volume]\nscalar = \"s\"\nkernel = \"sum\"\nboundary = \"none\"\nradius = 1.0\n\
                 smoothing = 0.1\nmode = \"isosurface\"\niso = 0.5\n";
    for (eye, inside) in [([0.1, 0.1, 0.3], true), ([0.2, 0.2, 0.3], false)] {
        let plan =
            plan_of(&(camera(eye, [0.0, 0.0, -0.3], "") + glass), std::slice::from_ref(&set));
        assert_eq!(plan.camera_media.len(), usize::from(inside), "{eye:?}");
        assert_same_bits("isosurface", &Bench::open().render(&plan), &render_twin(&plan));
    }
}
