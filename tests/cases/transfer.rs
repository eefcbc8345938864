//! Transfer functions sharper than the step: pre-integration against the integral itself, against far shorter steps,
//! and the warning where a step that a scene gives is too long.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "measured figures, for whoever asks with --nocapture")]

use film::Film;
use harness::{
    Bench, assert_same_bits, assert_same_film, plan_of, random, render_twin, set_of, with_attribute,
};
use plan::RayLoop;
use points::PointSet;
use reference::volume::mean_of;

const VIEW: &str = "[image]\nsize = [48, 36]\n[camera]\neye = [0.3, 0.4, 4.0]\ntarget = [0.0, 0.0, 0.0]\n\
                    vertical_fov = 34.0\n";

/// Random points in the ball about the origin that carry their distance from it, and a ripple.
fn ball(count: usize) -> PointSet {
    let mut seed = 23;
    let mut positions: Vec<[f64; 3]> = Vec::new();
    while positions.len() < count {
        let p = [0; 3].map(|_| 2.0 * random(&mut seed) - 1.0);
        if p.iter().map(|x| x * x).sum::<f64>() < 1.0 {
            positions.push(p);
        }
    }
    let field = |p: [f64; 3]| {
        let r = p.iter().map(|x| x * x).sum::<f64>().sqrt();
        r + 0.05 * (3.0 * p[0]).sin() * (2.0 * p[1] + 1.0).cos()
    };
    with_attribute(set_of(positions), "s", field)
}

/// Shells of three thousandths of a range about some scalars, as triangles: each colour with this optical depth where a
/// ray goes straight through a gradient.
fn shells(range: [f64; 2], gradient: f64, depth: f64) -> String {
    let width = 0.003 * (range[1] - range[0]);
    let extinction = depth * gradient / (0.5 * width);
    let colors = [[1.0, 0.2, 0.1], [0.2, 1.0, 0.2], [0.1, 0.3, 1.0]];
    let stop = |value: f64, color: [f64; 3], extinction: f64| {
        format!("{{ value = {value}, color = {color:?}, extinction = {extinction} }},\n")
    };
    let stops: String = [0.3, 0.55, 0.8]
        .iter()
        .zip(colors)
        .map(|(part, color)| {
            let value = range[0] + part * (range[1] - range[0]);
            stop(value - 0.5 * width, color, 0.0)
                + &stop(value, color, extinction)
                + &stop(value + 0.5 * width, color, 0.0)
        })
        .collect();
    format!("transfer = [\n{stops}]\n")
}

fn range_of(set: &PointSet, name: &str) -> [f64; 2] {
    let values = || set.attribute(name).expect("values").iter();
    [values().fold(f64::MAX, f64::min), values().fold(f64::MIN, f64::max)]
}

/// How far the pixels that show something in either are apart, in the order of that.
fn apart(a: &Film, b: &Film) -> Vec<f32> {
    let both = a.color.iter().zip(&b.color);
    let mut apart: Vec<f32> = both
        .filter(|(a, b)| a[3] > 1e-3 || b[3] > 1e-3)
        .map(|(a, b)| (0..4).map(|c| (a[c] - b[c]).abs()).fold(0.0, f32::max))
        .collect();
    apart.sort_by(f32::total_cmp);
    apart
}

/// The step that the plan chose, and the picture with one 25 times finer.
fn against_finer_steps(name: &str, text: &str, set: &PointSet, limit: f32) {
    let bench = Bench::open();
    let plan = plan_of(text, std::slice::from_ref(set));
    assert!(plan.long_steps.is_empty(), "{:?}", plan.long_steps);
    let chosen = bench.render(&plan);
    assert_same_bits(name, &chosen, &render_twin(&plan));
    let mut finer = plan_of(text, std::slice::from_ref(set));
    finer.volumes.step /= 25.0;
    let apart = apart(&chosen.film, &bench.render(&finer).film);
    let [median, p95] = [50, 95].map(|of| apart[apart.len() * of / 100]);
    println!("{name}: {} pixels, median {median:.4}, 95 % {p95:.4}", apart.len());
    assert!(apart.len() > 300, "{name}: {} pixels show something", apart.len());
    assert!(p95 < limit, "{name}: {p95}");
}

#[test]
fn shells_of_three_thousandths_have_no_rings_at_the_automatic_step() {
    let set = ball(20_000);
    let transfer = shells(range_of(&set, "s"), 1.0, 0.7);
    let of = |keys: &str| {
        format!(
            "{VIEW}[[objects]]\npoints = \"ball.ply\"\n[objects.volume]\nscalar = \"s\"\n{keys}{transfer}"
        )
    };
    // Weights that end at e^-5, not at e^-2: where points come into reach, the field itself jumps by less than a shell.
    against_finer_steps("ball", &of("radius = 0.2\nsmoothing = 0.004\n"), &set, 0.05);
    against_finer_steps("ball, wide", &of("radius = 0.3\nsmoothing = 0.009\n"), &set, 0.05);
    // Those that end at e^-2, as they do by default: it jumps by half a shell, and a step passes by six points.
    against_finer_steps("ball, by default", &of(""), &set, 0.05);
}

/// Points of a lattice come into reach many at once.
#[test]
fn shells_through_a_lattice_have_no_rings_at_the_automatic_step() {
    let at = |i: usize| (i as f64) / 12.0 - 1.0;
    let nodes = 0..25 * 25 * 25;
    let positions = nodes.map(|i| [at(i % 25), at(i / 25 % 25), at(i / 625)]).collect();
    let field = |p: [f64; 3]| p.iter().map(|x| x * x).sum::<f64>().sqrt();
    let set = with_attribute(set_of(positions), "s", field);
    let transfer = shells([0.0, 1.2], 1.0, 0.7);
    let text = format!(
        "{VIEW}[[objects]]\npoints = \"lattice.ply\"\n[objects.volume]\nscalar = \"s\"\n{transfer}"
    );
    against_finer_steps("lattice", &text, &set, 0.05);
}

/// Particles of smoothed particle hydrodynamics, whose density falls off from the middle.
#[test]
fn shells_of_particles_have_no_rings_at_the_automatic_step() {
    let mut seed = 5;
    let mut positions: Vec<[f64; 3]> = Vec::new();
    while positions.len() < 6_000 {
        let p = [0; 3].map(|_| 2.0 * random(&mut seed) - 1.0);
        let square = p.iter().map(|x| x * x).sum::<f64>();
        if random(&mut seed) < (-4.0 * square).exp() {
            positions.push(p);
        }
    }
    // Some 300 particles in reach in the middle, so that the density is smooth.
    let set = with_attribute(set_of(positions), "h", |_| 0.1);
    let set = with_attribute(set, "rho", |_| 1.0);
    let keys = "kernel = \"sph\"\nsmoothing_length = \"h\"\nmass = 1.0\n";
    let text = |transfer: &str| {
        format!(
            "{VIEW}[[objects]]\npoints = \"gas.ply\"\n[objects.volume]\nscalar = \"rho\"\n{keys}{transfer}"
        )
    };
    // The density of 6000 particles of mass 1 with a Gaussian of this width: 6000 (4/π)^1.5 in the middle.
    let most = 6_000.0 * (4.0 / std::f64::consts::PI).powf(1.5);
    let text =
        |transfer: &str| text(transfer).replace("vertical_fov = 34.0", "vertical_fov = 22.0");
    // Particles at random make a density that is rough on the scale of h, of which the step is a half.
    let transfer = shells([0.0, most], 1.2 * most, 2.0);
    against_finer_steps("particles", &text(&transfer), &set, 0.1);
}

/// Functions of sharp peaks and of many decades: the mean between two scalars, by integrals of two floats, against the
/// same in f64, and that against a sum of many values.
#[test]
fn means_are_the_integral_between_two_scalars() {
    let transfer = "transfer = [
  { value = -1.0, color = [1.0, 0.1, 0.0], extinction = 1e4 },
  { value = -0.5, color = [0.0, 0.3, 0.5], extinction = 1e4 },
  { value = -0.499, color = [0.0, 1.0, 0.5], extinction = 1e-7 },
  { value = 0.0, color = [0.9, 0.2, 0.5], extinction = 2e-7, emission = [3.0, 0.0, 1e-9] },
  { value = 0.0, color = [0.9, 0.2, 0.5], extinction = 5e-10, emission = [1e-5, 2.0, 1e-9] },
  { value = 0.7, color = [0.4, 0.4, 0.4], extinction = 0.0 },
  { value = 0.701, color = [1.0, 0.0, 2.0], extinction = 30.0 },
  { value = 0.702, color = [1.0, 0.0, 2.0], extinction = 0.0 },
]\n";
    let text = format!(
        "{VIEW}[[objects]]\npoints = \"b.ply\"\n[objects.volume]\nscalar = \"s\"\n{transfer}"
    );
    let plan = plan_of(&text, &[ball(200)]);
    let volumes = &plan.volumes;
    let info = &volumes.infos[0];
    let of = |a: f64, b: f64| {
        let mean = mean_of::<f64>(info, volumes, a, b);
        let ([x, y, z], [r, g, b]) = (mean.scattering.0, mean.emission.0);
        [x, y, z, mean.extinction, r, g, b]
    };
    let mut seed = 7;
    let mut worst = 0.0f64;
    for i in 0..4_000 {
        let a = f64::from((2.6 * random(&mut seed) - 1.4) as f32);
        let width = 10f64.powf(-6.0 * random(&mut seed));
        let b = f64::from((a + if i % 2 == 0 { width } else { -width }) as f32);
        let exact = of(a, b);
        let mean = mean_of::<f32>(info, volumes, a as f32, b as f32);
        let ([x, y, z], [r, g, e]) = (mean.scattering.0, mean.emission.0);
        for (found, exact) in [x, y, z, mean.extinction, r, g, e].into_iter().zip(exact) {
            // Relative; at the foot of a flank, what is left of its height loses digits to the height's rounding.
            let scale = exact.abs().max(1e-12);
            worst = worst.max((f64::from(found) - exact).abs() / scale);
        }
        if i < 200 && width > 1e-3 {
            let many = 200_000;
            let mut sums = [0.0; 7];
            for k in 0..many {
                let at = a + (b - a) * (f64::from(k) + 0.5) / f64::from(many);
                let value = of(at, at);
                sums = [0, 1, 2, 3, 4, 5, 6].map(|j| sums[j] + value[j] / f64::from(many));
            }
            for j in 0..7 {
                let near = (sums[j] - exact[j]).abs() < 2e-3 * exact[j].abs().max(1e-9);
                assert!(near, "{a} to {b}: {} for {}", exact[j], sums[j]);
            }
        }
    }
    println!("f32 against f64: worst {worst:.1e}");
    assert!(worst < 1e-4, "{worst}");
}

/// Volumes that overlap with transfer functions of their own, one of them lit, surfaces between: the same bits, for any
/// K; and what is skipped changes no byte, however long the step.
#[test]
fn overlapping_shells_are_the_same_to_the_bit() {
    let set = ball(2_500);
    let transfer = shells(range_of(&set, "s"), 1.0, 0.4);
    for step in [0.05, 0.6] {
        let text = format!(
            "{VIEW}[[lights]]\nkind = \"directional\"\ndirection = [-0.3, -1.0, -0.2]\nirradiance = [9.0, 9.0, 9.0]\n\
             [[objects]]\npoints = \"a.ply\"\n[objects.volume]\nscalar = \"s\"\nradius = 0.25\nstep = {step}\n{transfer}\
             [[objects]]\npoints = \"b.ply\"\ntransform = {{ scale = 0.6, translate = [0.5, 0.3, 0.4] }}\n\
             [objects.volume]\nscalar = \"s\"\nradius = 0.2\nstep = {step}\nshading = \"gradient\"\n{transfer}\
             [[objects]]\npoints = \"c.ply\"\ntransform = {{ scale = 0.3, translate = [-0.5, 0.2, 0.6] }}\n"
        );
        let mut plan = plan_of(&text, &[set.clone(), set.clone(), ball(500)]);
        let bench = Bench::open();
        let whole = bench.render(&plan);
        assert_same_bits("shells", &whole, &render_twin(&plan));
        assert!(whole.film.color.as_flattened().iter().all(|value| value.is_finite()));
        for cell in &mut plan.volumes.cells {
            cell.counts |= 1;
        }
        (plan.cells_per_pass, plan.ray_loop) = (3, RayLoop::Images);
        assert_same_film("skipping and K", &whole.film, &bench.render(&plan).film);
    }
}

fn warnings(keys: &str, set: &PointSet) -> Vec<String> {
    let text = format!(
        "{VIEW}[[objects]]\nname = \"cloud\"\npoints = \"b.ply\"\n[objects.volume]\nscalar = \"s\"\n\
         color_map = \"viridis\"\nextinction = 1\n{keys}"
    );
    plan_of(&text, std::slice::from_ref(set)).long_steps
}

/// Where features are missed, one line names the object, the step, and one that would do; the step that it names
/// brings no warning, nor does the automatic one, nor a long one through a constant, unless it passes by points.
#[test]
fn a_step_too_long_for_the_gradient_is_named() {
    let set = ball(20_000);
    for keys in ["", "radius = 0.3\n", "radius = 0.3\nstep = 0.075\n"] {
        assert!(warnings(keys, &set).is_empty(), "{keys}: {:?}", warnings(keys, &set));
    }
    let found = warnings("radius = 0.3\nstep = 0.5\n", &set);
    let [line] = found.as_slice() else { panic!("{found:?}") };
    assert!(
        line.contains("'cloud'") && line.contains("step of 0.5") && line.contains("'s'"),
        "{line}"
    );
    let step =
        line.split("set step = ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a step");
    let step: f64 = step.parse().expect("a number");
    assert!((0.074..0.5).contains(&step), "{line}");
    let again = warnings(&format!("radius = 0.3\nstep = {step}\n"), &set);
    assert!(again.is_empty(), "{again:?}");
    let constant = with_attribute(set_of(set.positions.to_vec()), "s", |_| 2.0);
    let none = warnings("radius = 0.3\nstep = 0.3\nvalue_range = [0, 4]\n", &constant);
    assert!(none.is_empty(), "{none:?}");
    let passing = warnings("radius = 0.3\nstep = 0.5\nvalue_range = [0, 4]\n", &constant);
    let [line] = passing.as_slice() else { panic!("{passing:?}") };
    assert!(
        line.contains("longer than a point reaches, 0.3") && line.contains("set step = 0.3"),
        "{line}"
    );
}

/// A feature counts though it fills less than a hundredth of the volume; a single stray value does not.
#[test]
fn a_small_feature_needs_short_steps_and_a_stray_value_does_not() {
    let set = ball(20_000);
    let of = |keys: &str, scalar: &dyn Fn([f64; 3]) -> f64| {
        let set = with_attribute(set_of(set.positions.to_vec()), "s", scalar);
        warnings(keys, &set)
    };
    let narrow = "radius = 0.1\nstep = 0.09\n";
    let edge = of(narrow, &|p| f64::from(u8::from(p[0] > 0.0)));
    assert_eq!(edge.len(), 1, "an edge: {edge:?}");
    let blob = of("radius = 0.2\nstep = 0.19\n", &|p| {
        (-p.iter().map(|x| x * x).sum::<f64>() / 0.02).exp()
    });
    assert_eq!(blob.len(), 1, "a blob: {blob:?}");
    let ramp = of(narrow, &|p| p[0]);
    assert!(ramp.is_empty(), "{ramp:?}");
    let stray = of(narrow, &|p| if p == set.positions[7] { 9.0 } else { p[0] });
    assert!(stray.is_empty(), "{stray:?}");
}
