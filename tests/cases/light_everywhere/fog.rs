//! A slab of fog, whose light is scattered once, or as often as it takes, against integrals and another solution.

use super::*;
use harness::analytic::{cross, dot, unit};
use harness::{random, render_twin, with_attribute};
use points::{Attribute, Values};

/// Points of the slab to each side of the middle, along x, y and z, this far from each other.
const SIDES: V3 = [10.0, 10.0, 4.0];
const SPACING: f64 = 0.125;
const RADIUS: f64 = 0.25;
const EXTINCTION: f64 = 1.5;
/// Pixels.
const SIZE: [usize; 2] = [16, 16];

fn slab() -> PointSet {
    let line = |side: f64| (-side as i32..=side as i32).map(|i| f64::from(i) * SPACING);
    let [x, y, z] = SIDES;
    let places = line(x).flat_map(|x| line(y).flat_map(move |y| line(z).map(move |z| [x, y, z])));
    with_attribute(set_of(places.collect()), "s", |_| 1.0)
}

/// A ball of points, those of its surface among them.
fn ball() -> PointSet {
    let line = || (-8..=8).map(|i| 0.12 * f64::from(i));
    let places = line().flat_map(|x| line().flat_map(move |y| line().map(move |z| [x, y, z])));
    let mut places: Vec<V3> = places.filter(|&p| dot(p, p) < 0.98).collect();
    let inner = places.len();
    places.extend(fibonacci_sphere(6_000));
    let skin = (0..places.len()).map(|i| f64::from(u8::from(i >= inner))).collect();
    let mut set = with_attribute(set_of(places), "s", |_| 1.0);
    set.attributes.push(Attribute { name: "skin".into(), values: Values::F64(skin) });
    set
}

/// Whether a point is in reach: the nearest of a lattice.
fn reaches(x: V3) -> bool {
    let off = [0, 1, 2].map(|i| {
        let nearest = (x[i] / SPACING).round().clamp(-SIDES[i], SIDES[i]) * SPACING;
        x[i] - nearest
    });
    dot(off, off) < RADIUS * RADIUS
}

/// How far into the slab a ray along z is that passes there, on each side of the middle: to the ball about the nearest of
/// the outermost points.
fn half_way(x: f64, y: f64) -> f64 {
    let off = [x, y].map(|x| x - (x / SPACING).round() * SPACING);
    SIDES[2] * SPACING + (RADIUS * RADIUS - off[0] * off[0] - off[1] * off[1]).sqrt()
}

/// The bodies of fog.
#[derive(Debug, Clone, Copy)]
enum Fog {
    /// Wherever a point is in reach.
    Slab,
    /// Of unit radius, inside a skin.
    Ball,
}

impl Fog {
    fn holds(self, x: V3) -> bool {
        match self {
            Self::Slab => reaches(x),
            Self::Ball => dot(x, x) < 1.0,
        }
    }

    /// Side of the square that the picture's parallel rays along -z go through: of the ball so small that the way through it
    /// is one to 3e-4.
    fn width(self) -> f64 {
        match self {
            Self::Slab => 0.8,
            Self::Ball => 0.05,
        }
    }

    /// Half the sides of a box around it.
    fn half(self) -> V3 {
        match self {
            Self::Slab => SIDES.map(|side| side * SPACING + RADIUS),
            Self::Ball => [1.0; 3],
        }
    }

    fn is_past(self, x: V3) -> bool {
        let half = self.half();
        (0..3).any(|i| x[i].abs() > half[i])
    }

    /// Whether light gets out of it. Woodcock's tracking, to no step.
    fn lets_out(self, mut x: V3, d: V3, seed: &mut u64) -> bool {
        loop {
            x = add(x, d, -(1.0 - random(seed)).ln() / EXTINCTION);
            if self.is_past(x) {
                return true;
            }
            if self.holds(x) {
                return false;
            }
        }
    }

    /// What comes along the picture's rays of a lamp's light from `towards`, of irradiance 1, or of a background of radiance 1:
    /// the mean, and its standard error.
    fn tracked(self, [albedo, g]: [f64; 2], towards: Option<V3>, paths: u32) -> [f64; 2] {
        let mut seed = 17;
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..paths {
            let side = |seed: &mut u64| (random(seed) - 0.5) * self.width();
            let (mut d, mut weight, mut light) = ([0.0, 0.0, -1.0], 1.0, 0.0);
            let mut x = [side(&mut seed), side(&mut seed), self.half()[2]];
            while weight > 1e-12 {
                x = add(x, d, -(1.0 - random(&mut seed)).ln() / EXTINCTION);
                if self.is_past(x) {
                    light += if towards.is_none() { weight } else { 0.0 };
                    break;
                }
                if !self.holds(x) {
                    continue;
                }
                weight *= albedo;
                if let Some(towards) = towards {
                    let arrives = self.lets_out(x, towards, &mut seed);
                    light += if arrives { weight * phase(g, dot(d, towards)) } else { 0.0 };
                }
                d = turned(d, g, [random(&mut seed), random(&mut seed)]);
            }
            sum += light;
            squares += light * light;
        }
        let mean = sum / f64::from(paths);
        [mean, ((squares / f64::from(paths) - mean * mean) / f64::from(paths)).sqrt()]
    }

    /// The mean over the picture of a function of the way through it.
    fn mean_over_ways(self, value: impl Fn(f64) -> f64) -> f64 {
        let (steps, width) = (400, self.width());
        let at = |i: i32| (f64::from(i) + 0.5) * width / f64::from(steps) - 0.5 * width;
        let way = |x: f64, y: f64| match self {
            Self::Slab => half_way(x, y),
            Self::Ball => (1.0 - x * x - y * y).sqrt(),
        };
        let sum: f64 =
            (0..steps * steps).map(|i| value(2.0 * way(at(i % steps), at(i / steps)))).sum();
        sum / f64::from(steps * steps)
    }

    fn scene(self, step: f64, [albedo, g]: [f64; 2], render: &str) -> String {
        let object = match self {
            Self::Slab => "[objects.volume]\nboundary = \"none\"\n",
            Self::Ball => {
                "material = { kind = \"glass\", ior = 1.0 }\n[objects.volume]\nboundary = \"skin\"\n"
            }
        };
        format!(
            "[camera]\neye = [0.0, 0.0, 4.0]\ntarget = [0.0, 0.0, 0.0]\nprojection = \"orthographic\"\nheight = {}\n\
             [image]\nsize = {SIZE:?}\nfilter = \"box\"\nsamples = 96\n[render]\nintegrator = \"path\"\n{render}\n\
             [[objects]]\npoints = \"fog.ply\"\n{object}scalar = \"s\"\nradius = {RADIUS}\nstep = {step}\n\
             shading = \"scatter\"\nanisotropy = {g:?}\n\
             transfer = [{{ value = 0.0, color = {:?}, extinction = {EXTINCTION} }}]\n",
            self.width(),
            [albedo; 3]
        )
    }

    fn set(self) -> PointSet {
        match self {
            Self::Slab => slab(),
            Self::Ball => ball(),
        }
    }

    /// Checks the ball, of which any step is exact, and the slab, of which each end of a way is off by up to half a step, and
    /// by less with a shorter one.
    fn check_both(name: &str, albedo: [f64; 2], render: &str, expected: impl Fn(Self) -> [f64; 2]) {
        let plan_of = |fog: Self, step| plan(&fog.scene(step, albedo, render), &[fog.set()], None);
        let [truth, error] = expected(Self::Ball);
        for step in [0.3, 0.1] {
            let name = format!("{name}, ball, step {step}");
            let floor = (5e-5, error / truth);
            check_within(&name, &plan_of(Self::Ball, step), floor, |_| Some([truth; 3]));
        }
        let [truth, error] = expected(Self::Slab);
        let mut before = f64::INFINITY;
        for step in [0.1, 0.05] {
            let mut plan = plan_of(Self::Slab, step);
            let means = [0, 1, 2, 3, 4, 5, 6, 7].map(|seed| {
                sample(&mut plan, 4 * more_samples(), seed);
                off(&render_twin(&plan).film, |_| Some([truth; 3])).0
            });
            let [mean, spread] = mean_and_error(&means);
            let error = spread.hypot(error / truth);
            println!("{name}, slab, step {step}: off by {mean:.2e}, error {error:.2e}");
            let most = (EXTINCTION * step).exp_m1().min(0.6 * before);
            assert!(mean.abs() < most + 3.0 * error, "{name}, slab, step {step}: {mean}, {error}");
            before = mean.abs();
        }
    }
}

/// Henyey and Greenstein's, per steradian.
fn phase(g: f64, cosine: f64) -> f64 {
    (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cosine).powf(1.5))
}

/// A direction drawn by it.
fn turned(d: V3, g: f64, [u, v]: [f64; 2]) -> V3 {
    let cosine = if g == 0.0 {
        1.0 - 2.0 * u
    } else {
        let ratio = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
        (1.0 + g * g - ratio * ratio) / (2.0 * g)
    };
    let other = if d[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let across = unit(cross(d, other));
    let along = cross(d, across);
    let (sin, cos) = (2.0 * PI * v).sin_cos();
    let level = (1.0 - cosine * cosine).max(0.0).sqrt();
    add(add(d.map(|c| cosine * c), across, level * cos), along, level * sin)
}

const WHITE: &str = "max_bounces = 1024\n[background]\ncolor = [1.0, 1.0, 1.0]";

fn lamp(direction: &str) -> String {
    format!(
        "[[lights]]\nkind = \"directional\"\ndirection = {direction}\nirradiance = [1.0, 1.0, 1.0]"
    )
}

/// Fog that takes nothing, in a white furnace, whatever the step.
#[test]
fn white_fog_in_a_white_furnace_is_white() {
    for (fog, g) in [(Fog::Slab, 0.0), (Fog::Slab, 0.7), (Fog::Ball, 0.7)] {
        let text = fog.scene(0.1, [1.0, g], WHITE).replace("samples = 96", "samples = 32");
        let name = format!("white fog, {fog:?}, g = {g}");
        check(&name, &plan(&text, &[fog.set()], None), 2e-6, |_| Some([1.0; 3]));
    }
}

/// Black fog lets e^(-σ way) through.
#[test]
fn what_fog_does_not_scatter_falls_by_beers_law() {
    Fog::check_both("transmittance", [0.0, 0.0], &format!("{WHITE}\nlights = false"), |fog| {
        [fog.mean_over_ways(|way| (-EXTINCTION * way).exp()), 0.0]
    });
}

/// Light from behind the viewer that is scattered once: p E c σ ∫ e^(-2σx) dx = p E c (1 - T²) / 2.
#[test]
fn light_that_is_scattered_once_is_its_integral() {
    let render = format!("max_bounces = 0\n{}", lamp("[0.0, 0.0, -1.0]"));
    Fog::check_both("once", [0.8, 0.5], &render, |fog| {
        let lost = fog.mean_over_ways(|way| 0.5 * (1.0 - (-2.0 * EXTINCTION * way).exp()));
        [0.8 * phase(0.5, -1.0) * lost, 0.0]
    });
}

/// Albedo ½ in a white furnace, against a solution by other means, which follows light to no step.
#[test]
fn half_of_the_light_at_a_time_is_lost() {
    Fog::check_both("furnace", [0.5, 0.0], WHITE, |fog| {
        fog.tracked([0.5, 0.0], None, 400_000 * more_samples())
    });
}

/// A slanting lamp, and fog that scatters ahead, against the same solution.
#[test]
fn a_lamps_light_is_scattered_as_often_as_it_takes() {
    let render = format!("max_bounces = 1024\n{}", lamp("[0.6, 0.0, -0.8]"));
    Fog::check_both("lamp", [0.9, 0.5], &render, |fog| {
        fog.tracked([0.9, 0.5], Some([-0.6, 0.0, 0.8]), 200_000 * more_samples())
    });
}
