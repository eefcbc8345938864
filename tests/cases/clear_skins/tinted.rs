//! Light that goes straight on through glass, less what Fresnel's equations reflect and what the glass absorbs, against
//! closed forms.

use super::*;
use harness::analytic::fresnel;
use harness::moved;
use points::Unwatched;
use reference::Reference;

/// A level square of this many points a side about the middle, `wide` across.
fn level(side: u32, wide: f64, y: f64) -> Vec<V3> {
    let place = |[x, _, z]: V3| [wide * (x - 0.5), y, wide * (z - 0.5)];
    grid_points(side).into_iter().map(place).collect()
}

/// What a surface of the index lets through, at this cosine on the side of the air.
fn passed(cosine: f64, index: f64) -> f64 {
    1.0 - fresnel(cosine, 1.0, index)
}

/// Under a slab of two level sheets the floor has E cos (1 - R)² exp(-a d / cos), channel by channel, R being that of the
/// air's side at both sheets, as for the light that is refracted there and back. Fits of level sheets err by rounding alone:
/// 1e-6 of the normal's angle at most, which changes R by less, and the way by 1e-6 of d.
#[test]
fn a_slab_passes_what_its_two_sheets_and_its_depth_leave() {
    let (thickness, a) = (0.4, [0.3, 0.8, 1.7]);
    let (low, high) = (0.5, 0.5 + thickness);
    let slab = || set_of([level(100, 12.0, low), level(100, 12.0, high)].concat());
    let view = View { eye: [0.0, 0.0, 4.0], target: [0.0, -1.5, 0.0], ..VIEW };
    for (degrees, ior) in
        [(0.0f64, [1.5; 3]), (60.0, [1.5; 3]), (60.0, [1.3, 1.5, 1.9]), (25.0, [1.0, 1.33, 2.4])]
    {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let text = format!(
            "{}[[lights]]\nkind = \"directional\"\ndirection = [{sin:?}, {:?}, 0.0]\nirradiance = [3.0, 3.0, 3.0]\n\
             {FLOOR}[[objects]]\npoints = \"slab.ply\"\n\
             material = {{ kind = \"glass\", ior = {ior:?}, absorption = {a:?} }}\n",
            view.text(),
            -cos
        );
        let film = render_twin(&plan_of(&text, &[floor(), slab()])).film;
        let expected = [0, 1, 2].map(|c| {
            let through = passed(cos, ior[c]).powi(2) * (-a[c] * thickness / cos).exp();
            0.8 * FRAC_1_PI * 3.0 * cos * through
        });
        let mut seen = 0;
        for pixel in 0..film.color.len() {
            let d = view.through(pixel);
            let x = add(view.eye, d, (-1.5 - view.eye[1]) / d[1]);
            if d[1] > 0.0 || x[0].abs().max(x[2].abs()) > 1.5 {
                continue;
            }
            seen += 1;
            for (c, expected) in expected.iter().enumerate() {
                let found = f64::from(film.color[pixel][c]);
                let error = (found / expected - 1.0).abs();
                assert!(error < 5e-6, "{degrees}°, {ior:?}, {pixel}, {c}: {found}, not {expected}");
            }
        }
        assert!(seen > 1_000, "{seen} pixels");
    }
}

/// A ball of radius 1 that is an isosurface: of one point, where exp(-d²) is over 1/e.
const ISOSURFACE: &str = "[objects.volume]\nscalar = \"s\"\nmode = \"isosurface\"\nkernel = \"sum\"\nradius = 1.6\n\
                          smoothing = 0.5\nstep = 0.05\niso = 0.36787944117144233\n";

fn one_point() -> PointSet {
    with_attribute(set_of(vec![[0.0; 3]]), "s", |_| 1.0)
}

/// A ball of glass throws (1 - R)² exp(-2 a r cos) around the middle of its shadow, cos being that at either surface and R
/// that of the air's side; in the middle (1 - R₀)² exp(-2 a r). A ball of points or an isosurface, it is the same. Of 20 000
/// points, chords err by 1e-5 of the radius and normals by 1e-4, which counts most where R is steep, near the rim; regula
/// falsi and gradients of an isosurface err by 1e-6.
#[test]
fn a_ball_passes_what_its_chord_leaves() {
    let (a, ior) = ([0.2, 0.7, 1.9], [1.4, 1.5, 1.65]);
    let points = (set_of(fibonacci_sphere(20_000)), "");
    for (light, (ball, volume)) in [
        (Light::Sun, points.clone()),
        (Light::Lamp([0.6, 2.8, 0.3]), points),
        (Light::Sun, (one_point(), ISOSURFACE)),
        (Light::Lamp([0.6, 2.8, 0.3]), (one_point(), ISOSURFACE)),
    ] {
        let text = format!(
            "{}{}{FLOOR}[[objects]]\npoints = \"ball.ply\"\n\
             material = {{ kind = \"glass\", ior = {ior:?}, absorption = {a:?} }}\n{volume}",
            VIEW.text(),
            light.text()
        );
        let film = render_twin(&plan_of(&text, &[floor(), ball])).film;
        let share = |way: f64| {
            let of = |c: usize| passed(0.5 * way, ior[c]).powi(2) * (-a[c] * way).exp();
            if way > 0.0 { [0, 1, 2].map(of) } else { [1.0; 3] }
        };
        let errors = floor_errors(&film, 1.0, light, share);
        let [most, worst] = [0.99, 1.0].map(|share| percentile(errors.clone(), share));
        assert!(most < 2e-5 && worst < 1e-4, "{most:e}, worst {worst:e}");
        let middle = |pixel: usize| {
            let (x, towards, irradiance) = seen_floor(pixel, 1.03, light)?;
            let [inside, nearest] = chord(x, towards, 1.0);
            let lit = 0.8 * FRAC_1_PI * irradiance * towards[1];
            (inside > 0.0).then_some((nearest, f64::from(film.color[pixel][1]) / lit))
        };
        let all = (0..film.color.len()).filter_map(middle);
        let (nearest, found) = all.min_by(|a, b| a.0.total_cmp(&b.0)).expect("a shadow");
        // R is flat there, and the chord shorter by the square of the distance from the axis.
        let expected = (1.0f64 - 0.04).powi(2) * (-2.0 * a[1]).exp();
        let off = (found / expected - 1.0).abs();
        assert!(nearest < 0.05 && off < 1e-4 + a[1] * nearest.powi(2), "{nearest}: off by {off:e}");
    }
}

/// A lamp in a ball of glass: its light leaves through one surface, at the angle on the glass's side, where light that is
/// bent would be reflected totally beyond 42 degrees; straight light never is.
#[test]
fn a_lamp_in_glass_shines_out_through_one_surface() {
    let place = [0.5, 0.3, -0.3];
    let sets = [floor(), set_of(fibonacci_sphere(20_000))];
    let text = format!(
        "{}{}{FLOOR}[[objects]]\npoints = \"ball.ply\"\n\
         material = {{ kind = \"glass\", ior = 1.5, absorption = [0.5, 0.5, 0.5] }}\n",
        VIEW.text(),
        Light::Lamp(place).text()
    );
    let plan = plan_of(&text, &sets);
    assert_eq!(plan.lamp_media, [Some(vec![1])]);
    let film = render_twin(&plan).film;
    let mut errors = Vec::new();
    for pixel in 0..film.color.len() {
        let Some((x, towards, irradiance)) = seen_floor(pixel, 1.03, Light::Lamp(place)) else {
            continue;
        };
        // From the lamp back to the surface, whose normal is the place there.
        let along = dot(place, towards);
        let inside = along + (1.0 - dot(place, place) + along * along).sqrt();
        let cosine = dot(add(place, towards, -inside), towards).abs();
        let share = passed(cosine, 1.5) * (-0.5 * inside).exp();
        let lit = 0.8 * FRAC_1_PI * irradiance * towards[1];
        errors.push((f64::from(film.color[pixel][0]) / lit - share).abs());
        assert!(x[1] < 0.0);
    }
    assert!(errors.len() > 1_000, "{} pixels", errors.len());
    let worst = percentile(errors, 1.0);
    assert!(worst < 5e-4, "{worst:e}");
}

/// Light for the points of smoke in glass, a skin of the same object: through its own surface and, for some, through a ball
/// beside it. What arrives is the mean of the channels.
#[test]
fn light_for_smoke_in_glass_passes_its_own_surface() {
    let a = 0.6;
    let set = with_attribute(smoke(400, 1.0), "s", |_| 1.0);
    let fog = FOG.replace("extinction = 1.5", "extinction = 1e-9");
    let text = format!(
        "{}{}[[objects]]\npoints = \"smoke.ply\"\n\
         material = {{ kind = \"glass\", ior = 1.4, absorption = [{a}, {a}, {a}] }}\n\
         {fog}boundary = \"skin\"\nshading = \"scatter\"\n\
         [[objects]]\npoints = \"ball.ply\"\ntransform.translate = [0.0, 4.0, 0.0]\n\
         material = {{ kind = \"glass\", ior = 1.6 }}\n",
        VIEW.text(),
        sun().replace(&format!("{SUN:?}"), "[0.0, -1.0, 0.0]")
    );
    let plan = plan_of(&text, &[set, set_of(fibonacci_sphere(20_000))]);
    let reference = Reference::<f32>::new(&plan, &Unwatched).expect("is not interrupted");
    let origin = plan.cloud.origin;
    let up = [0.0, 1.0, 0.0];
    let (mut asked, mut errors) = (0, Vec::new());
    for (point, visible) in plan.volumes.points.iter().zip(&reference.visible) {
        let x = [0, 1, 2].map(|axis| f64::from(point.position[axis]) + origin[axis]);
        // Not those on the skin, nor where light grazes.
        if length(x) > 0.95 || x[0].hypot(x[2]) > 0.9 {
            continue;
        }
        asked += 1;
        let out = (1.0 - x[0] * x[0] - x[2] * x[2]).sqrt();
        let share = passed(dot([x[0], out, x[2]], up), 1.4) * (-a * (out - x[1])).exp();
        let expected = share * passed(out, 1.6).powi(2);
        errors.push((f64::from(visible[0]) - expected).abs());
    }
    assert!(asked > 200, "{asked} points");
    // Chords of the skin's 8 000 points err by 1e-4.
    let worst = percentile(errors, 1.0);
    assert!(worst < 1e-3, "{worst:e}");
}

/// Smoke that is lit in glass, balls in balls, a lamp in glass and one outside, soft ones: bit for bit, whatever the loop.
#[test]
fn tinted_shadows_are_the_same_to_the_bit() {
    let bench = Bench::open();
    let set = with_attribute(smoke(600, 1.0), "s", |p| 0.5 + 0.3 * p[0]);
    let fog = FOG.replace("step = 0.01", "step = 0.1");
    let text = |more: &str| {
        format!(
            "[camera]\neye = [0.4, 1.2, 5.0]\ntarget = [0.2, -0.6, 0.0]\nvertical_fov = 45.0\n\
             [image]\nsize = [40, 30]\n{more}\n\
             [[lights]]\nkind = \"directional\"\ndirection = [0.3, -1.0, -0.2]\n\
             irradiance = [3.0, 2.0, 3.0]\nangle = 5.0\n\
             [[lights]]\nkind = \"point\"\nposition = [-1.2, -0.7, 0.5]\nintensity = [1.0, 2.0, 3.0]\nradius = 0.05\n\
             [[lights]]\nkind = \"point\"\nposition = [2.0, 2.5, 1.0]\nintensity = [9.0, 8.0, 7.0]\n{FLOOR}\
             [[objects]]\npoints = \"smoke.ply\"\n\
             material = {{ kind = \"glass\", ior = [1.3, 1.4, 1.5], absorption = [0.3, 0.0, 0.1] }}\n\
             {fog}boundary = \"skin\"\nshading = \"scatter\"\n\
             [[objects]]\npoints = \"outer.ply\"\ntransform = {{ translate = [-1.3, -0.8, 0.4], scale = 0.6 }}\n\
             material = {{ kind = \"glass\", ior = 1.5, absorption = [0.1, 0.9, 0.1] }}\n\
             [[objects]]\npoints = \"bubble.ply\"\ntransform = {{ translate = [-1.3, -0.8, 0.3], scale = 0.3 }}\n\
             material = {{ kind = \"glass\", ior = 1.0, priority = 1 }}\n\
             [[objects]]\npoints = \"beads.ply\"\ntransform = {{ translate = [1.4, -0.8, 0.4], scale = 0.4 }}\n\
             surface = {{ kind = \"spheres\", radius = 0.15 }}\n\
             material = {{ kind = \"glass\", ior = [1.1, 1.2, 1.3], absorption = [0.9, 0.5, 0.1] }}\n\
             [[objects]]\npoints = \"mirror.ply\"\ntransform = {{ translate = [0.3, 1.6, 0.0], scale = 0.3 }}\n\
             material = {{ kind = \"mirror\" }}\n\
             [[objects]]\npoints = \"iso.ply\"\ntransform = {{ translate = [0.2, -1.0, 1.5], scale = 0.4 }}\n\
             material = {{ kind = \"glass\", ior = [1.2, 1.0, 1.4], absorption = [0.1, 0.2, 2.0] }}\n{}\
             [[objects]]\npoints = \"matt.ply\"\ntransform = {{ translate = [0.6, -1.1, 1.2], scale = 0.2 }}\n{}",
            ISOSURFACE.replace("1.6", "0.64").replace("= 0.5", "= 0.08").replace("0.05", "0.1"),
            ISOSURFACE.replace("1.6", "0.32").replace("= 0.5", "= 0.02").replace("0.05", "0.1"),
        )
    };
    let ball = |count: u32| set_of(moved(&fibonacci_sphere(count), [0.0; 3]));
    let sets =
        [floor(), set, ball(1_000), ball(600), ball(60), ball(600), one_point(), one_point()];
    for more in ["", "samples = 3\n[render]\nfresnel = \"sample\""] {
        let mut plan = plan_of(&text(more), &sets);
        assert!(plan.light_passes && plan.tints(0));
        let on_device = bench.render(&plan);
        assert_same_bits(more, &on_device, &render_twin(&plan));
        for (k, form) in [(1, RayLoop::Images), (7, RayLoop::Queue)] {
            (plan.cells_per_pass, plan.ray_loop) = (k, form);
            let other = bench.render(&plan);
            assert_eq!(on_device.film.color, other.film.color, "{more}, K = {k}");
        }
    }
}

/// Light passes any glass, of which a scene pays that has some and a light; and nothing else.
#[test]
fn only_glass_in_light_asks_for_more_than_any_hit() {
    let passes = |light: &str, material: &str| {
        let text = format!("{light}[[objects]]\npoints = \"a.ply\"\nmaterial = {{ {material} }}\n");
        plan_of(&text, &[set_of(fibonacci_sphere(500))]).light_passes
    };
    assert!(passes(&sun(), "kind = \"glass\""));
    assert!(!passes("", "kind = \"glass\""), "no light");
    assert!(!passes(&sun(), "kind = \"mirror\""), "a mirror");
    assert!(!passes(&sun(), "albedo = [0.5, 0.5, 0.5]"), "a matt surface");
    assert!(!passes(&format!("{OPAQUE}{}", sun()), "kind = \"glass\""), "opaque");
}
