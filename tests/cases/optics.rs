//! Shadows, mirrors and glass against closed forms: spheres and planes of points, and the same traced in
//! double precision.
#![allow(clippy::print_stdout, reason = "measured figures, for whoever asks with --nocapture")]

#[path = "optics/plates.rs"]
mod plates;

use film::{Film, Image};
use harness::analytic::{
    Body, Matter, Shape, V3, View, add, divided, dot, environment_at, environment_of, follow,
    fresnel, length, percentile, unit,
};
use harness::{Bench, fibonacci_sphere, moved, plan_of, plan_with, set_of};
use plan::SceneImages;
use points::PointSet;
use std::f64::consts::{FRAC_1_PI, PI, TAU};
use std::sync::Arc;

const SIZE: [usize; 2] = [320, 240];

/// Where rays do not graze: this share of a ball's radius in the picture.
const INNER: f64 = 0.93;

/// A level square lattice about the origin, `half` to each side.
fn lattice(half: f64, spacing: f64, y: f64) -> Vec<V3> {
    let side = (half / spacing).round() as i32;
    let at = |i: i32| f64::from(i) * spacing;
    (-side..=side).flat_map(|i| (-side..=side).map(move |j| [at(i), y, at(j)])).collect()
}

fn render(text: &str, sets: &[PointSet], environment: Option<&Arc<Image>>) -> Film {
    let images = SceneImages { environment: environment.cloned(), textures: Vec::new() };
    Bench::open().render(&plan_with(text, sets, &images)).film
}

/// Slopes of up to 1.5 a radian in each channel. Bilinear look-ups of it in f32 and in f64 differ by
/// rounding alone.
fn sky() -> Arc<Image> {
    let wave = |d: V3, phase: f64| {
        0.5 + 0.25 * (3.0 * d[0] + phase).sin()
            + 0.2 * (2.0 * d[1] - 2.0 * d[2] + 2.0 * phase).cos()
    };
    Arc::new(environment_of(512, |d| [wave(d, 0.0), wave(d, 1.0), wave(d, 2.0)]))
}

const SKY: &str = "[background]\nenvironment = \"sky.exr\"\n";

/// The greatest error of a pixel's channels.
fn off(film: &Film, pixel: usize, expected: V3) -> f64 {
    let error = |i: usize| (f64::from(film.color[pixel][i]) - expected[i]).abs();
    error(0).max(error(1)).max(error(2))
}

// ---- shadows ----------------------------------------------------------------------------------------

#[derive(Debug, Clone, Copy)]
enum Lamp {
    Directional(V3),
    Point(V3),
}

impl Lamp {
    fn text(self) -> String {
        match self {
            Self::Directional(direction) => format!(
                "[[lights]]\nkind = \"directional\"\ndirection = {direction:?}\nirradiance = [3.0, 3.0, 3.0]\n"
            ),
            Self::Point(position) => format!(
                "[[lights]]\nkind = \"point\"\nposition = {position:?}\nintensity = [30.0, 30.0, 30.0]\n"
            ),
        }
    }

    /// Direction towards it, and irradiance on a surface that faces it.
    fn from(self, x: V3) -> (V3, f64) {
        match self {
            Self::Directional(direction) => (unit(direction.map(|c| -c)), 3.0),
            Self::Point(position) => {
                let away = add(position, x, -1.0);
                (unit(away), 30.0 / dot(away, away))
            }
        }
    }

    fn shadowed(self, x: V3, ball: Shape) -> bool {
        let distance = match self {
            Self::Directional(_) => f64::INFINITY,
            Self::Point(position) => length(add(position, x, -1.0)),
        };
        ball.crossing(x, self.from(x).0).is_some_and(|t| t < distance)
    }
}

/// A ball that lies on a plane, both of points this far from each other.
struct Shadow {
    lamp: Lamp,
    step: f64,
    film: Film,
}

impl Shadow {
    const VIEW: View =
        View { eye: [2.1, 2.8, 4.0], target: [-0.2, 0.6, -0.2], fov: 45.0, size: SIZE };
    const MIDDLE: V3 = [0.0, 1.0, 0.0];
    const BALL: Shape = Shape::Sphere(Self::MIDDLE, 1.0);
    /// The plane reaches so far from the place that the ball lies on.
    const HALF: f64 = 4.0;

    fn render(lamp: Lamp, step: f64) -> Self {
        let text = format!(
            "{}{}[[objects]]\npoints = \"plane.ply\"\n[[objects]]\npoints = \"ball.ply\"\n",
            Self::VIEW.text(),
            lamp.text()
        );
        let ball = fibonacci_sphere((4.0 * PI / (step * step)) as u32);
        let sets = [set_of(lattice(Self::HALF, step, 0.0)), set_of(moved(&ball, Self::MIDDLE))];
        Self { lamp, step, film: render(&text, &sets, None) }
    }

    /// What is seen at a pixel: whether the ball, and where; nothing where it is neither, or near the
    /// plane's rim.
    fn seen(&self, pixel: usize) -> Option<(bool, V3)> {
        let d = Self::VIEW.through(pixel);
        let on_ball = Self::BALL.crossing(Self::VIEW.eye, d);
        let t = on_ball.or(Shape::Below(0.0).crossing(Self::VIEW.eye, d))?;
        let x = add(Self::VIEW.eye, d, t);
        let rim = Self::HALF - 2.0 * self.step;
        (on_ball.is_some() || x[0].abs().max(x[2].abs()) < rim).then_some((on_ball.is_some(), x))
    }

    /// Whether the outline of the shadow, the terminator, or the ball's own outline in the picture is
    /// nearer than `band`.
    fn near_outline(&self, pixel: usize, on_ball: bool, x: V3, band: f64) -> bool {
        if (Self::VIEW.distance(pixel, Self::MIDDLE) - 1.0).abs() < 1e-3 {
            return true; // a thirtieth of a pixel from the ball's outline: either may be seen
        }
        if on_ball {
            let (towards, ..) = self.lamp.from(x);
            return dot(add(x, Self::MIDDLE, -1.0), towards).asin().abs() < band;
        }
        let dark = self.lamp.shadowed(x, Self::BALL);
        (0..32).any(|i| {
            let (sin, cos) = (TAU * f64::from(i) / 32.0).sin_cos();
            self.lamp.shadowed(add(x, [cos, 0.0, sin], band), Self::BALL) != dark
        })
    }

    /// Pixels that show something else than they should, are lit where they should be dark or dark where
    /// they should be lit, or whose light is off by over 1e-4 of what a surface that faces the lamp gets
    /// (normals of 8 000 points are off by 3e-5); of how many. Those nearer to an outline than `band` do
    /// not count.
    fn wrong_pixels(&self, band: f64) -> [usize; 2] {
        let (mut wrong, mut measured) = (0, 0);
        for pixel in 0..SIZE[0] * SIZE[1] {
            let Some((on_ball, x)) = self.seen(pixel) else { continue };
            if self.near_outline(pixel, on_ball, x, band) {
                continue;
            }
            measured += 1;
            let (towards, irradiance) = self.lamp.from(x);
            let normal = if on_ball { add(x, Self::MIDDLE, -1.0) } else { [0.0, 1.0, 0.0] };
            let dark = !on_ball && self.lamp.shadowed(x, Self::BALL);
            let cosine = if dark { 0.0 } else { dot(normal, towards).max(0.0) };
            let unit = 0.8 * FRAC_1_PI * irradiance;
            let off = off(&self.film, pixel, [unit * cosine; 3]) > 1e-4 * unit;
            let flipped = (self.film.color[pixel][0] == 0.0) != (cosine == 0.0);
            let other = self.film.object[pixel] as i32 != i32::from(on_ball);
            wrong += usize::from(off || flipped || other);
        }
        [wrong, measured]
    }
}

#[test]
fn the_shadow_of_a_ball_ends_at_its_outline() {
    for (name, lamp) in [
        ("directional", Lamp::Directional([-0.6, -1.0, -0.35])),
        ("low directional", Lamp::Directional([-0.9, -0.4, 0.3])),
        ("point", Lamp::Point([1.5, 3.6, 1.2])),
        ("low point", Lamp::Point([1.8, 1.1, -0.6])),
    ] {
        let shadow = Shadow::render(lamp, 0.04);
        for part in [1.0, 0.1, 0.01] {
            let [wrong, measured] = shadow.wrong_pixels(part * shadow.step);
            println!("{name}: {wrong} wrong of {measured} beyond {part} of the points' spacing");
            // One spacing was to be reached; `full` surfaces are a thousandth of it from the ball.
            assert!(measured > 40_000, "{name}: {measured} pixels measured");
            assert!(wrong == 0, "{name}: {wrong} wrong beyond {part} of the points' spacing");
        }
    }
}

// ---- balls before a smooth environment --------------------------------------------------------------

const VIEW: View = View { eye: [0.9, 0.7, 2.4], target: [0.0; 3], fov: 50.0, size: SIZE };

/// Errors of the pixels within `share` of the unit ball's radius.
fn ball_errors(film: &Film, share: f64, expected: impl Fn(usize) -> V3) -> Vec<f64> {
    let pixels = (0..SIZE[0] * SIZE[1]).filter(|&pixel| VIEW.distance(pixel, [0.0; 3]) < share);
    let errors: Vec<f64> = pixels.map(|pixel| off(film, pixel, expected(pixel))).collect();
    assert!(errors.len() > 10_000, "{} pixels measured", errors.len());
    errors
}

fn report(name: &str, errors: &[f64], share: f64, limit: f64) -> f64 {
    let at = |share| percentile(errors.to_vec(), share);
    println!(
        "{name}: {} pixels; 50 % {:.2e}, 95 % {:.2e}, 99 % {:.2e}, worst {:.2e}; limit {limit:.0e} at {share}",
        errors.len(),
        at(0.5),
        at(0.95),
        at(0.99),
        at(1.0)
    );
    at(share)
}

/// What follows of Snell's law, a channel at a time.
fn seen(image: &Image, bodies: impl Fn(usize) -> Vec<Body>, pixel: usize) -> V3 {
    [0, 1, 2].map(|channel| {
        let way = follow(&bodies(channel), VIEW.eye, VIEW.through(pixel));
        environment_at(image, way.direction)[channel] * way.throughput[channel]
    })
}

const UNIT: Shape = Shape::Sphere([0.0; 3], 1.0);

#[test]
fn balls_of_mirror_and_glass_show_the_environment() {
    let image = sky();
    let set = [set_of(fibonacci_sphere(40_000))];
    let mirror = Matter::Mirror([1.0, 0.9, 0.8]);
    let glass = |index: f64| Matter::Glass(index, 0.0);
    for (name, material, matters) in [
        ("mirror", "kind = \"mirror\", reflectance = [1.0, 0.9, 0.8]", [mirror; 3]),
        ("glass", "kind = \"glass\"", [glass(1.5); 3]),
        (
            "dispersing glass",
            "kind = \"glass\", ior = [1.48, 1.5, 1.53]",
            [1.48, 1.5, 1.53].map(glass),
        ),
    ] {
        let text = format!(
            "{}{SKY}[[objects]]\npoints = \"ball.ply\"\nmaterial = {{ {material} }}\n",
            VIEW.text()
        );
        let film = render(&text, &set, Some(&image));
        let bodies = |channel: usize| vec![Body { shape: UNIT, matter: matters[channel] }];
        let errors = ball_errors(&film, INNER, |pixel| seen(&image, bodies, pixel));
        let p99 = report(name, &errors, 0.99, 2e-4);
        assert!(p99 < 2e-4, "{name}: {p99:e}");
    }
}

/// All pixels within 0.93 of the ball's radius: through glass beside the bubble, through both, and, from
/// half to three quarters of the radius, reflected totally at the bubble.
#[test]
fn a_bubble_in_glass_refracts_and_reflects_totally() {
    let image = sky();
    let text = format!(
        "{}{SKY}[[objects]]\npoints = \"ball.ply\"\nmaterial = {{ kind = \"glass\" }}\n\
         [[objects]]\npoints = \"bubble.ply\"\ntransform = {{ scale = 0.5 }}\n\
         material = {{ kind = \"glass\", ior = 1.0, priority = 1 }}\n",
        VIEW.text()
    );
    let glass = |radius, index| Body {
        shape: Shape::Sphere([0.0; 3], radius),
        matter: Matter::Glass(index, 0.0),
    };
    let bodies = |_| vec![glass(1.0, 1.5), glass(0.5, 1.0)];
    for count in [40_000, 10_000] {
        let sets = [set_of(fibonacci_sphere(40_000)), set_of(fibonacci_sphere(count))];
        let film = render(&text, &sets, Some(&image));
        let errors = ball_errors(&film, INNER, |pixel| seen(&image, bodies, pixel));
        let p95 = report(&format!("bubble of {count}"), &errors, 0.95, 4e-4);
        assert!(p95 < 4e-4, "{count}: {p95:e}");
    }
}

#[test]
fn absorption_follows_the_chord() {
    let (sigma, white) = ([0.3, 0.7, 1.5], "[background]\ncolor = [1.0, 1.0, 1.0]\n");
    let set = [set_of(fibonacci_sphere(40_000))];
    for index in [1.000_000_1, 1.5] {
        let text = format!(
            "{}{white}[[objects]]\npoints = \"ball.ply\"\n\
             material = {{ kind = \"glass\", ior = {index}, absorption = {sigma:?} }}\n",
            VIEW.text()
        );
        let film = render(&text, &set, None);
        let through = |pixel: usize| {
            sigma.map(|sigma| {
                let ball = Body { shape: UNIT, matter: Matter::Glass(index, sigma) };
                follow(&[ball], VIEW.eye, VIEW.through(pixel)).throughput[0]
            })
        };
        let errors = ball_errors(&film, INNER, through);
        let p99 = report(&format!("absorption, index {index}"), &errors, 0.99, 1e-4);
        assert!(p99 < 1e-4, "{index}: {p99:e}");
    }
}

/// The ball counts inside itself, water below the level, air above. The sheet of water ends 4 from the
/// ball's middle: ways that cross the level near that or beyond are left out, and what is seen within one
/// spacing of the water line on the ball.
#[test]
fn a_ball_half_under_water_follows_the_media_s_rules() {
    let image = sky();
    let view = View { eye: [0.5, 1.7, 3.0], target: [0.0; 3], fov: 42.0, size: SIZE };
    let text = format!(
        "{}{SKY}[[objects]]\npoints = \"water.ply\"\nmaterial = {{ kind = \"glass\", ior = 1.33 }}\n\
         [[objects]]\npoints = \"ball.ply\"\nmaterial = {{ kind = \"glass\", ior = 1.5, priority = 1 }}\n",
        view.text()
    );
    let (half, step) = (4.0, 0.03);
    let sets = [set_of(lattice(half, step, 0.0)), set_of(fibonacci_sphere(40_000))];
    let film = render(&text, &sets, Some(&image));
    let bodies = [
        Body { shape: Shape::Below(0.0), matter: Matter::Glass(1.33, 0.0) },
        Body { shape: UNIT, matter: Matter::Glass(1.5, 0.0) },
    ];
    let (mut errors, mut on_ball, mut left_out, mut banded) = (Vec::new(), Vec::new(), 0, 0);
    for pixel in 0..SIZE[0] * SIZE[1] {
        let way = follow(&bodies, view.eye, view.through(pixel));
        let beyond =
            |&(body, x): &(usize, V3)| body == 0 && x[0].abs().max(x[2].abs()) > half - 2.0 * step;
        if way.hits.is_empty() || way.hits.iter().any(beyond) {
            left_out += 1;
            continue;
        }
        let line = |x: V3| (x[0].hypot(x[2]) - 1.0).hypot(x[1]);
        if line(way.hits[0].1) < step {
            banded += 1;
            continue;
        }
        let error = off(&film, pixel, environment_at(&image, way.direction));
        errors.push(error);
        if way.hits.iter().any(|hit| hit.0 == 1) {
            on_ball.push(error);
        }
    }
    println!("water: {left_out} pixels left out, {banded} at the water line");
    let all = report("water and ball", &errors, 0.95, 1e-3);
    let ball = report("the ball, to its rim", &on_ball, 0.95, 1e-3);
    assert!(on_ball.len() > 15_000 && errors.len() > 50_000);
    assert!(all < 1e-3 && ball < 1e-3, "{all:e}, {ball:e}");
}

// ---- energy, Fresnel, bounces -----------------------------------------------------------------------

#[test]
fn before_white_all_that_absorbs_nothing_is_white() {
    let objects = "
[render]
fresnel = \"sample\"
max_bounces = 100
[background]
color = [1.0, 1.0, 1.0]
[[objects]]
points = \"mirror.ply\"
material = { kind = \"mirror\" }
transform = { translate = [-1.1, 0.0, 0.0] }
[[objects]]
points = \"glass.ply\"
material = { kind = \"glass\", ior = [1.4, 1.5, 1.7] }
transform = { translate = [1.1, 0.0, 0.0] }
[[objects]]
points = \"bubble.ply\"
material = { kind = \"glass\", ior = 1.0, priority = 1 }
transform = { translate = [1.1, 0.0, 0.0], scale = 0.5 }
";
    let view = View { eye: [0.3, 0.9, 5.0], target: [0.0; 3], fov: 40.0, size: [160, 120] };
    let text = format!("{}samples = 32\n{objects}", view.text());
    let sets = [20_000, 20_000, 10_000].map(|count| set_of(fibonacci_sphere(count)));
    let film = render(&text, &sets, None);
    let (mut least, mut most) = (f32::INFINITY, 0.0f32);
    for color in &film.color {
        let [r, g, b, _] = *color;
        least = least.min(r).min(g).min(b);
        most = most.max(r).max(g).max(b);
    }
    println!("white furnace: {least} to {most}");
    // Sums of 32 ones are exact, and nothing takes away.
    assert_eq!((least, most), (1.0, 1.0));
}

/// Cameras above the sheets, between them, and below: what the other sheet shades is black, what faces
/// the light is not.
#[test]
fn sheets_close_to_each_other_shade_each_other() {
    let step = 0.05;
    let bench = Bench::open();
    let mut measured = 0;
    for (gap, slant) in [(1.0, 0.0), (1.0, 3.0), (0.2, 0.3), (0.2, 3.0)] {
        let y = gap * step;
        let sets = [y, 0.0].map(|y| set_of(lattice(1.0, step, y)));
        for travels in [-1.0, 1.0] {
            for (eye, look, object) in
                [(1.0, -1.0, 0), (0.5 * y, 1.0, 0), (0.5 * y, -1.0, 1), (-1.0, 1.0, 1)]
            {
                let text = format!(
                    "[camera]\nprojection = \"orthographic\"\nheight = 1.0\n\
                     eye = [0.0, {eye:?}, 0.0]\ntarget = [0.0, {:?}, 0.0]\nup = [0.0, 0.0, -1.0]\n\
                     [image]\nsize = [160, 120]\n\
                     [[lights]]\nkind = \"directional\"\nirradiance = [1.0, 1.0, 1.0]\n\
                     direction = [{slant:?}, {travels:?}, {:?}]\n\
                     [[objects]]\npoints = \"upper.ply\"\n[[objects]]\npoints = \"lower.ply\"\n",
                    eye + look,
                    0.5 * slant
                );
                let film = bench.render(&plan_of(&text, &sets)).film;
                // Of four faces, the light meets the upper one's from above, or the lower one's from below.
                let lit = look == travels && object == i32::from(travels > 0.0);
                let wrong = film
                    .color
                    .iter()
                    .zip(&film.object)
                    .filter(|(color, seen)| **seen as i32 != object || (color[0] > 0.0) != lit);
                let wrong = wrong.count();
                assert!(
                    wrong == 0,
                    "gap {gap}, slant {slant}, light travels {travels}, camera looks {look} at {object}: \
                     {wrong} wrong"
                );
                measured += film.color.len();
            }
        }
    }
    println!("sheets: 0 wrong of {measured}");
}

/// The same for curved sheets: under a skin of glass of almost index 1, which shades and is not seen, a
/// ball is black; and a ball under it does not shade the skin.
#[test]
fn a_skin_shades_the_ball_under_it_and_not_itself() {
    let count = 10_000;
    let spacing = (4.0 * PI / f64::from(count)).sqrt();
    let sets = [0, 1].map(|_| set_of(fibonacci_sphere(count)));
    let bench = Bench::open();
    for gap in [1.0, 0.2] {
        for polynomial in ["full", "incomplete"] {
            let scene = |skin: &str, ball: &str| {
                format!(
                    "{}{}[[objects]]\npoints = \"skin.ply\"\nmaterial = {{ {skin} }}\n\
                     surface = {{ polynomial = \"{polynomial}\" }}\n{ball}",
                    VIEW.text(),
                    Lamp::Directional([-0.3, -1.0, -0.4]).text()
                )
            };
            let ball = format!(
                "[[objects]]\npoints = \"ball.ply\"\ntransform = {{ scale = {} }}\n\
                 surface = {{ polynomial = \"{polynomial}\" }}\n",
                1.0 - gap * spacing
            );
            let glass = scene("kind = \"glass\", ior = 1.000001", &ball);
            let glass = format!("[render]\nshadows = \"opaque\"\n{glass}");
            let lit = |film: &Film| film.color.iter().filter(|color| color[0] > 0.0).count();
            // Before white, whatever misses the ball under the skin would be white.
            let white = format!("[background]\ncolor = [1.0, 1.0, 1.0]\n{glass}");
            let film = bench.render(&plan_of(&white, &sets)).film;
            let inner = (0..film.color.len()).filter(|&p| VIEW.distance(p, [0.0; 3]) < INNER);
            let under = inner.filter(|&pixel| film.color[pixel][0] > 0.0).count();
            let diffuse = scene("albedo = [0.8, 0.8, 0.8]", "");
            let alone = bench.render(&plan_of(&diffuse, &sets[..1])).film;
            let diffuse = scene("albedo = [0.8, 0.8, 0.8]", &ball);
            let skin = bench.render(&plan_of(&diffuse, &sets)).film;
            let changed = (alone.color.iter().zip(&skin.color)).filter(|(a, b)| a != b).count();
            println!(
                "skin {gap} spacings off, {polynomial}: {under} lit under it, {changed} changed of {} lit",
                lit(&alone)
            );
            assert!(lit(&alone) > 20_000);
            assert_eq!((under, changed), (0, 0), "{gap}, {polynomial}");
        }
    }
}
