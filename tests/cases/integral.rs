//! The integral of a scalar along rays, and the channels of volumes: `value`, and `Zv`, where half of the light is lost.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "measured figures, for whoever asks with --nocapture")]

use film::Film;
use harness::{Bench, assert_same_bits, plan_of, random, render_twin, set_of, with_attribute};
use plan::{Extra, Plan};
use points::PointSet;

/// A lattice over the cube of side 2.
fn block(field: impl Fn([f64; 3]) -> f64) -> PointSet {
    let side = 12u32;
    let at = |i: u32| -1.0 + 2.0 * f64::from(i) / f64::from(side - 1);
    let places = (0..side.pow(3)).map(|i| [i % side, i / side % side, i / (side * side)].map(at));
    with_attribute(set_of(places.collect()), "s", field)
}

/// Parallel rays along -z.
fn view(height: f64) -> String {
    format!(
        "[image]\nsize = [16, 12]\n[background]\ncolor = [0.125, 0.25, 0.5]\n[camera]\neye = [0.0, 0.0, 4.0]\n\
         target = [0.0, 0.0, 0.0]\nprojection = \"orthographic\"\nheight = {height}\n"
    )
}

fn with_extras(text: &str, sets: &[PointSet]) -> Plan {
    let mut plan = plan_of(text, sets);
    plan.extras = vec![Extra::Volume, Extra::Value];
    plan
}

fn render(name: &str, plan: &Plan) -> Film {
    let on_device = Bench::open().render(plan);
    let twin = render_twin(plan);
    assert_same_bits(name, &on_device, &twin);
    assert_eq!(on_device.film.extra, twin.film.extra, "{name}");
    on_device.film
}

fn channel<'a>(film: &'a Film, name: &str) -> &'a [f32] {
    let found = film.extra.iter().find(|(channel, _)| channel == name);
    &found.expect("a channel").1
}

const BACKGROUND: [f32; 3] = [0.125, 0.25, 0.5];

/// Σ s ℓ of a field that is linear along the ray, so that the trapezoids are exact: with what a constant has for a length.
/// Where nothing is met: 0, a coverage of 0 and the background; else the map's colour, opaque.
#[test]
fn the_integral_is_the_column_of_the_scalar() {
    let of = |mode: &str, more: &str, field: fn([f64; 3]) -> f64| {
        let text = format!(
            "{}[[objects]]\npoints = \"b.ply\"\n[objects.volume]\nscalar = \"s\"\nradius = 0.25\nmode = \"{mode}\"\n{more}\n",
            view(4.0)
        );
        render(mode, &with_extras(&text, &[block(field)]))
    };
    let map = "color_map = \"gray\"\nvalue_range = [0.0, 10.0]";
    let constant = of("integral", map, |_| 3.0);
    let ones = of("integral", map, |_| 1.0);
    let (threes, lengths) = (channel(&constant, "value"), channel(&ones, "value"));
    let mut met = 0;
    for at in 0..threes.len() {
        let pixel = constant.color[at];
        if lengths[at] == 0.0 {
            assert_eq!((threes[at], pixel[3]), (0.0, 0.0));
            assert_eq!(pixel[..3], BACKGROUND);
            continue;
        }
        met += 1;
        assert!(
            (threes[at] / lengths[at] - 3.0).abs() < 1e-5,
            "{} for {}",
            threes[at],
            lengths[at]
        );
        assert!(pixel[3] == 1.0 && pixel[0] > 0.0, "{pixel:?}");
    }
    assert!((20..150).contains(&met), "{met} pixels");
    // In the middle the block is 2 long, and its reach up to a radius longer at either side.
    let middle = lengths[6 * 16 + 8];
    assert!((2.2..2.5).contains(&middle), "{middle}");
    let depths = channel(&constant, "Zv");
    assert!(
        depths.iter().all(|depth| *depth == f32::INFINITY),
        "nothing is lost along an integral"
    );

    // The mean and the greatest scalar, as the same channel.
    let field = |p: [f64; 3]| 1.0 + 0.2 * p[0];
    let stops = "transfer = [{ value = 0.0, color = [1.0, 1.0, 1.0], extinction = 1.0 }]";
    let (mean, most) = (of("average", stops, field), of("maximum", stops, field));
    let integral = of("integral", stops, field);
    for (at, length) in lengths.iter().enumerate() {
        let [mean, most, whole] = [&mean, &most, &integral].map(|film| channel(film, "value")[at]);
        // The field is even along each ray, up to the weights at the border.
        assert!((whole - mean * length).abs() < 1e-4, "{whole} for {mean} by {length}");
        assert!(most >= mean - 1e-5 && most < 1.3, "{most}, {mean}");
    }
    // Stops give an integral an optical depth: 1.
    let covered = integral.color[6 * 16 + 8][3];
    assert!((f64::from(covered) + (-1f64).exp_m1()).abs() < 1e-6, "{covered}");
}

/// One particle of smoothed particle hydrodynamics: A (m/ρ) / (π h³) times the integral of its kernel, at any distance.
#[test]
fn the_column_of_a_particle_is_that_of_its_kernel() {
    let set = with_attribute(set_of(vec![[0.0, 0.0, 0.0]]), "rho", |_| 1.0);
    let (h, mass) = (0.5, 2.0);
    let text = format!(
        "{}[[objects]]\npoints = \"p.ply\"\n[objects.volume]\nscalar = \"rho\"\nkernel = \"sph\"\nsmoothing_length = {h}\n\
         mass = {mass}\nstep = 0.01\nmode = \"integral\"\ncolor_map = \"gray\"\nvalue_range = \"auto\"\n",
        view(2.4)
    );
    let plan = with_extras(&text, &[set]);
    let film = render("particle", &plan);
    let kernel = |d: f64| {
        let (near, far) = ((1.0 - d / h).max(0.0), (2.0 - d / h).max(0.0));
        (0.25 * far.powi(3) - near.powi(3)) * mass / (std::f64::consts::PI * h.powi(3))
    };
    let mut worst = 0.0f64;
    for (at, value) in channel(&film, "value").iter().enumerate() {
        let x = (at as f64 % 16.0 + 0.5 - 8.0) * 0.2;
        let y = ((at / 16) as f64 + 0.5 - 6.0) * 0.2;
        let steps = 20_000;
        let along = |i: i32| (f64::from(i) + 0.5) * 2.4 / f64::from(steps) - 1.2;
        let sum: f64 = (0..steps).map(|i| kernel((x * x + y * y + along(i).powi(2)).sqrt())).sum();
        worst = worst.max((f64::from(*value) - sum * 2.4 / f64::from(steps)).abs());
    }
    println!("column of a particle: off by {worst:.1e}");
    // Trapezoids of steps of h/50; the greatest column is 3.8.
    assert!(worst < 1e-3, "{worst}");
}

/// `auto` is from the data: no ray exceeds it, and it is the same for every camera.
#[test]
fn no_ray_exceeds_the_automatic_range() {
    let mut seed = 3;
    let positions: Vec<[f64; 3]> =
        (0..3_000).map(|_| [0; 3].map(|_| 2.0 * random(&mut seed) - 1.0)).collect();
    let set = with_attribute(set_of(positions), "s", |p| 2.0 * p[0] + p[1] * p[2]);
    for kernel in
        ["kernel = \"shepard\"", "kernel = \"sum\"", "kernel = \"sph\"\nsmoothing_length = 0.15"]
    {
        let mut ranges = Vec::new();
        for eye in ["[0.0, 0.0, 4.0]", "[3.0, 0.4, 0.3]", "[1.0, 1.0, 1.0]"] {
            let text = format!(
                "[image]\nsize = [24, 18]\n[camera]\neye = {eye}\ntarget = [0.0, 0.0, 0.0]\nvertical_fov = 40.0\n\
                 [[objects]]\npoints = \"b.ply\"\n[objects.volume]\nscalar = \"s\"\nmode = \"integral\"\n{kernel}\n\
                 color_map = \"viridis\"\nvalue_range = \"auto\"\n"
            );
            let plan = with_extras(&text, std::slice::from_ref(&set));
            let stops = &plan.volumes.stops;
            let range = [stops[0].value, stops[stops.len() - 1].value];
            let film = render(kernel, &plan);
            for value in channel(&film, "value") {
                assert!(*value >= range[0] && *value <= range[1], "{kernel}: {value} in {range:?}");
            }
            ranges.push(range);
        }
        assert!(
            ranges[0][0] < 0.0 && ranges[0][1] > 0.0 && ranges.iter().all(|of| *of == ranges[0])
        );
    }
}

/// From inside a fog to a floor D away: exp(-σ Zv) = (1 + exp(-σ D)) / 2, whatever the step. Rays of the picture's edge
/// go aslant, and depths are along the viewing axis. Where nothing is lost: infinite.
#[test]
fn zv_is_where_half_of_the_loss_has_happened_whatever_the_step() {
    let floor = set_of(
        (0..400)
            .map(|i| [f64::from(i % 20) * 0.1 - 0.95, f64::from(i / 20) * 0.1 - 0.95, -0.5])
            .collect(),
    );
    for (extinction, step) in
        [(1e-9, 0.01), (0.3, 0.4), (0.3, 0.003), (4.0, 0.4), (60.0, 0.02), (0.0, 0.02)]
    {
        for samples in [1, 4] {
            let text = format!(
                "[image]\nsize = [8, 6]\nsamples = {samples}\n[camera]\neye = [0.0, 0.0, 0.9]\ntarget = [0.0, 0.0, 0.0]\n\
                 vertical_fov = 40.0\n[[objects]]\npoints = \"fog.ply\"\n[objects.volume]\nscalar = \"s\"\nradius = 0.3\n\
                 step = {step}\ntransfer = [{{ value = 0.0, color = [1.0, 1.0, 1.0], extinction = {extinction:e} }}]\n\
                 [[objects]]\npoints = \"floor.ply\"\n[objects.surface]\nkind = \"discs\"\nradius = 0.2\n"
            );
            let plan = with_extras(&text, &[block(|_| 1.0), floor.clone()]);
            let film = render("Zv", &plan);
            for (at, depth) in channel(&film, "Zv").iter().enumerate() {
                let z = f64::from(film.depth[at]);
                assert!((z - 1.4).abs() < 1e-5, "the floor: {z}");
                if extinction == 0.0 {
                    assert_eq!(*depth, f32::INFINITY);
                    continue;
                }
                let position = film.position[at].map(f64::from);
                let slant = (position[0].powi(2) + position[1].powi(2) + 1.4 * 1.4).sqrt() / 1.4;
                let sigma = extinction * slant;
                let expected = -(0.5 * (-sigma * 1.4).exp_m1()).ln_1p() / sigma;
                // Roundings of places, 1e-7 of 1.4.
                let off = (f64::from(*depth) / expected - 1.0).abs();
                assert!(off < 1e-5, "{extinction}, {step}: {depth} for {expected}");
            }
        }
    }
}

/// A camera ray beside all fog, and one in a scene without volumes, have an infinite Zv and a value of 0.
#[test]
fn beside_all_fog_zv_is_infinite_and_the_value_zero() {
    let fog = "[objects.volume]\nscalar = \"s\"\nradius = 0.25\ntransfer = [{ value = 0.0, color = [1, 1, 1], extinction = 1 }]\n";
    for volume in [fog, "[objects.surface]\nkind = \"spheres\"\n"] {
        let text = format!("{}[[objects]]\npoints = \"b.ply\"\n{volume}", view(5.0));
        let film = render("beside", &with_extras(&text, &[block(|_| 1.0)]));
        let met = |at: usize| film.color[at][3] > 0.0 && film.object[at] < 0.0;
        for (at, depth) in channel(&film, "Zv").iter().enumerate() {
            assert_eq!(depth.is_finite(), met(at), "pixel {at}: {depth}");
        }
        assert!(channel(&film, "value").iter().all(|value| *value == 0.0));
    }
}

/// Points of a ball's inside, and of a skin around it that is its surface.
fn ball_in_skin() -> PointSet {
    let fine = |i: i32| f64::from(i) * 0.125;
    let inner = (-8..=8)
        .flat_map(|x| (-8..=8).flat_map(move |y| (-8..=8).map(move |z| [x, y, z].map(fine))));
    let inner: Vec<[f64; 3]> =
        inner.filter(|p| p.iter().map(|c| c * c).sum::<f64>() < 0.95).collect();
    let count = inner.len();
    let skin = harness::fibonacci_sphere(6_000);
    let mut set = set_of(inner.into_iter().chain(skin).collect());
    let on_skin = (0..set.positions.len()).map(|i| f64::from(i >= count)).collect();
    let values = points::Values::F64(on_skin);
    set.attributes.push(points::Attribute { name: "skin".into(), values });
    with_attribute(set, "s", |_| 1.0)
}

/// The square of how far from the middle of the unit ball a ray along -z passes, of rays 0.2 apart.
fn square_beside(at: usize) -> f64 {
    let x = (at as f64 % 16.0 + 0.5 - 8.0) * 0.2;
    let y = ((at / 16) as f64 + 0.5 - 6.0) * 0.2;
    x * x + y * y
}

/// A volume inside a surface is what most volumes are: the ray's column and half-loss depth are those of its chord, of
/// index 1 also where no bounce may be spent; of another index, that of the refracted ray, along the viewing axis.
/// Chords of 6000 points err by 5e-6.
#[test]
fn volumes_in_skins_show_their_column_and_half_loss() {
    let sigma = 0.3;
    let map = "mode = \"integral\"\ncolor_map = \"gray\"\nvalue_range = [0.0, 3.0]".to_owned();
    let fog =
        format!("transfer = [{{ value = 0.0, color = [1.0, 1.0, 1.0], extinction = {sigma} }}]");
    for (name, more) in [("integral", &map), ("fog", &fog)] {
        for (ior, samples, bounces) in [(1.0, 1, 8), (1.0, 3, 8), (1.0, 1, 0), (1.33, 1, 8)] {
            let text = format!(
                "{}[[objects]]\npoints = \"b.ply\"\nmaterial = {{ kind = \"glass\", ior = {ior} }}\n\
                 [objects.volume]\nscalar = \"s\"\nboundary = \"skin\"\nradius = 0.25\nstep = 0.02\n{more}\n\
                 [render]\nmax_bounces = {bounces}\n",
                view(2.4).replace("[16, 12]", &format!("[16, 12]\nsamples = {samples}"))
            );
            let film = render(name, &with_extras(&text, &[ball_in_skin()]));
            let (values, depths) = (channel(&film, "value"), channel(&film, "Zv"));
            let (mut met, mut worst) = (0, 0.0f64);
            for at in 0..values.len() {
                let square = square_beside(at);
                if square > 0.95 {
                    continue;
                }
                met += 1;
                let sine = square.sqrt();
                let chord = 2.0 * (1.0 - square / (ior * ior)).sqrt();
                let [found, expected] = if name == "integral" {
                    assert_eq!(depths[at], f32::INFINITY);
                    [f64::from(values[at]), chord]
                } else {
                    assert_eq!(values[at], 0.0);
                    let lost = -(0.5 * (-sigma * chord).exp_m1()).ln_1p() / sigma;
                    let turned = (sine.asin() - (sine / ior).asin()).cos();
                    [f64::from(depths[at]), 4.0 - (1.0 - square).sqrt() + turned * lost]
                };
                worst = worst.max((found - expected).abs());
            }
            assert!(met > 40, "{met} rays through the ball");
            println!("{name}, ior {ior}, {samples} samples, {bounces} bounces: off by {worst:.1e}");
            assert!(worst < 1e-4, "{name}, {ior}, {samples}, {bounces}: {worst:e}");
        }
    }
}
