//! Media however thin or dense: colour, coverage and alpha against closed forms over many decades of extinction,
//! emission with and without extinction, and the twin's bits.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "measured figures, for whoever asks with --nocapture")]

use film::Film;
use harness::{
    Bench, assert_same_bits, assert_same_film, plan_of, render_twin, set_of, with_attribute,
};
use plan::Plan;
use points::{PointSet, Unwatched};
use reference::Reference;

/// A lattice over the cube of side 2.
fn block(field: impl Fn([f64; 3]) -> f64) -> PointSet {
    let side = 12u32;
    let at = |i: u32| -1.0 + 2.0 * f64::from(i) / f64::from(side - 1);
    let places = (0..side.pow(3)).map(|i| [i % side, i / side % side, i / (side * side)].map(at));
    with_attribute(set_of(places.collect()), "s", field)
}

/// Parallel rays along -z through the block.
fn scene(stop: &str, step: f64, more: &str) -> String {
    format!(
        "[image]\nsize = [4, 3]\n[camera]\neye = [0.0, 0.0, 4.0]\ntarget = [0.0, 0.0, 0.0]\n\
         projection = \"orthographic\"\nheight = 1.6\n[[objects]]\npoints = \"block.ply\"\n{more}\n\
         [objects.volume]\nscalar = \"s\"\nradius = 0.3\nstep = {step}\ntransfer = [{{ value = 0.0, {stop} }}]\n"
    )
}

fn in_f64(plan: &Plan) -> Film {
    let reference = Reference::<f64>::new(plan, &Unwatched).expect("nobody interrupts");
    reference.frame(plan, &Unwatched).expect("nobody interrupts").finish()
}

/// The length of each pixel's way, as many steps of it as count, by the picture of a moderate extinction in f64.
fn lengths(step: f64, more: &str) -> Vec<f64> {
    let film = in_f64(&plan_of(
        &scene("color = [1.0, 1.0, 1.0], extinction = 0.4", step, more),
        &[block(|_| 1.0)],
    ));
    film.color.iter().map(|color| -(-f64::from(color[3])).ln_1p() / 0.4).collect()
}

/// What is found over what is expected, less 1; both 0 are the same.
fn off(found: f32, expected: f64) -> f64 {
    if expected == 0.0 { f64::from(found).abs() } else { (f64::from(found) / expected - 1.0).abs() }
}

/// f32 has 6e-8 of each number; 1e-5 is what is promised, over 15 decades of extinction and with 9 to 26 000 steps.
#[test]
fn slabs_follow_beer_and_lambert_over_fifteen_decades() {
    let bench = Bench::open();
    let color = [0.8, 0.3, 2.0];
    for step in [0.3, 0.01, 1e-4] {
        let lengths = lengths(step, "");
        assert!(lengths.iter().all(|length| (length - 2.5).abs() < 0.4), "{lengths:?}");
        let mut worst = 0.0f64;
        for decade in -10..=4 {
            let extinction = 10f64.powi(decade);
            let stop = format!("color = {color:?}, extinction = {extinction:e}");
            let plan = plan_of(&scene(&stop, step, ""), &[block(|_| 1.0)]);
            let on_device = bench.render(&plan);
            assert_same_bits("slab", &on_device, &render_twin(&plan));
            for (pixel, length) in on_device.film.color.iter().zip(&lengths) {
                let coverage = -(-extinction * length).exp_m1();
                worst = worst.max(off(pixel[3], coverage));
                for channel in 0..3 {
                    worst = worst.max(off(pixel[channel], color[channel] * coverage));
                }
            }
        }
        println!("step {step}: off by {worst:.1e}");
        assert!(worst < 1e-5, "step {step}: {worst}");
    }
}

/// A field that varies, against the reference in f64: over as many decades, the relative error of each pixel.
#[test]
fn varying_fields_agree_with_f64_over_fifteen_decades() {
    let bench = Bench::open();
    let field = |[x, y, z]: [f64; 3]| 0.5 + 0.4 * (2.0 * x).sin() * (1.5 * y).cos() + 0.1 * z;
    for decade in -10..=4 {
        let high = 10f64.powi(decade);
        let stops = format!(
            "color = [0.1, 0.9, 0.3], extinction = 0.0 }},\n{{ value = 0.4, color = [1.0, 0.2, 0.5], \
             extinction = {high:e} }},\n{{ value = 1.0, color = [0.2, 0.2, 1.0], extinction = {:e}",
            0.1 * high
        );
        let plan = plan_of(&scene(&stops, 0.005, ""), &[block(field)]);
        let (found, expected) = (bench.render(&plan).film, in_f64(&plan));
        for (found, expected) in found.color.iter().zip(&expected.color) {
            for (found, expected) in found.iter().zip(expected) {
                let off = off(*found, f64::from(*expected));
                assert!(off < 1e-5, "extinction {high:e}: {found} for {expected}");
            }
        }
    }
}

/// Several volumes, one seen through another: coverage 1 - exp(-Σ σℓ), also with eight samples a pixel.
#[test]
fn depths_of_several_volumes_and_of_samples_add_up() {
    let bench = Bench::open();
    let one = scene("color = [1.0, 1.0, 1.0], extinction = 1e-9", 0.02, "");
    let other = one[one.find("[[objects]]").expect("an object")..].replace("1e-9", "3e-9");
    let shifted =
        other.replacen("\"block.ply\"", "\"block.ply\"\ntransform.translate = [0.0, 0.0, -1.0]", 1);
    let text = format!("{one}{shifted}").replace("[4, 3]", "[4, 3]\nsamples = 8");
    let plan = plan_of(&text, &[block(|_| 1.0), block(|_| 1.0)]);
    let on_device = bench.render(&plan);
    assert_same_bits("several", &on_device, &render_twin(&plan));
    let expected = in_f64(&plan);
    for (found, expected) in on_device.film.color.iter().zip(&expected.color) {
        // The block and the border of its reach: 2.6 at most, 2 at least.
        assert!((8e-9..10.4e-9).contains(&found[3]), "{found:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!(off(*found, f64::from(*expected)) < 1e-5, "{found} for {expected}");
        }
    }
}

/// Emission is radiance per length: ε ℓ where nothing is absorbed, with a coverage of 0 and over whatever is behind;
/// ε (1 - exp(-σℓ)) / σ beside an extinction, and the colour's share beside it.
#[test]
fn an_emitting_slab_follows_its_closed_form() {
    let bench = Bench::open();
    let (emission, color) = ([0.5, 2.0, 1e-7], [0.7, 0.1, 1.0]);
    let lengths = lengths(0.03, "");
    for extinction in [0.0, 1e-12, 1e-8, 1e-3, 0.4, 30.0, 1e4] {
        for behind in [0.0, 0.25] {
            let stop =
                format!("color = {color:?}, extinction = {extinction:e}, emission = {emission:?}");
            let text = format!(
                "[background]\ncolor = [{behind}, {behind}, {behind}]\n{}",
                scene(&stop, 0.03, "")
            );
            let plan = plan_of(&text, &[block(|_| 1.0)]);
            let on_device = bench.render(&plan);
            assert_same_bits("emission", &on_device, &render_twin(&plan));
            for (pixel, length) in on_device.film.color.iter().zip(&lengths) {
                let coverage = -(-extinction * length).exp_m1();
                assert!(off(pixel[3], coverage) < 1e-5, "{extinction}: {pixel:?}");
                let mean = if extinction > 0.0 { coverage / extinction } else { *length };
                for channel in 0..3 {
                    let own = emission[channel] * mean + color[channel] * coverage;
                    let expected = own + behind * (1.0 - coverage);
                    assert!(off(pixel[channel], expected) < 1e-5, "{extinction}: {pixel:?}");
                }
            }
        }
    }
}

/// A stop with an emission needs no colour and no extinction; lights do not change what is emitted; and what is
/// emitted beside it shows where the extinction is 0, also from cells in which nothing else does.
#[test]
fn emission_stands_without_extinction_and_without_light() {
    let bench = Bench::open();
    let alone =
        bench.render(&plan_of(&scene("emission = [0.5, 0.25, 0.0]", 0.03, ""), &[block(|_| 1.0)]));
    for (pixel, length) in alone.film.color.iter().zip(lengths(0.03, "")) {
        assert!(off(pixel[0], 0.5 * length) < 1e-5 && pixel[3] == 0.0, "{pixel:?}");
    }
    let lit = scene("emission = [0.5, 0.25, 0.0]", 0.03, "")
        .replace("scalar =", "shading = \"scatter\"\nscalar =");
    let light = "[[lights]]\nkind = \"directional\"\ndirection = [0.0, 0.0, -1.0]\nirradiance = [9.0, 9.0, 9.0]\n";
    let plan = plan_of(&format!("{light}{lit}"), &[block(|_| 1.0)]);
    let on_device = bench.render(&plan);
    assert_same_bits("lit emission", &on_device, &render_twin(&plan));
    assert_same_film("lights", &alone.film, &on_device.film);

    // Fog below 0.5, a glow above, and both in single steps.
    let stops = "color = [0.1, 0.1, 0.1], extinction = 1.0 },\n{ value = 0.5, emission = [0.0, 0.0, 0.0] },\n\
                 { value = 0.6, emission = [3.0, 2.0, 1.0]";
    let field = |p: [f64; 3]| 0.5 + 0.5 * p[2];
    let mut plan = plan_of(&scene(stops, 0.03, ""), &[block(field)]);
    let whole = bench.render(&plan);
    assert_same_bits("glow", &whole, &render_twin(&plan));
    assert!(whole.film.color.iter().all(|pixel| pixel[0] > 1.0 && pixel[3] > 0.05), "both show");
    let skipped = plan.volumes.cells.iter().filter(|cell| cell.counts == 0).count();
    for cell in &mut plan.volumes.cells {
        cell.counts = 1;
    }
    assert!(skipped > 0);
    assert_same_film("skipping", &whole.film, &bench.render(&plan).film);
}

/// Inside a medium that absorbs with a, an emission ε and an extinction σ give ε (1 - exp(-(σ + a)ℓ)) / (σ + a) and the
/// like of the colour, whatever the step: within one, both are followed.
#[test]
fn the_medium_around_absorbs_what_is_emitted_whatever_the_step() {
    let bench = Bench::open();
    let absorption: [f64; 3] = [1.5, 1e-8, 0.0];
    // A cube of glass of index 1: its points are its surface, and the volume ends at it.
    let mut places = Vec::new();
    let side = 33;
    let at = |i: u32| -1.0 + 2.0 * f64::from(i) / f64::from(side - 1);
    for i in 0..side * side {
        let (u, v) = (at(i % side), at(i / side));
        places.extend([[u, v, 1.0], [u, v, -1.0]]);
    }
    let skin = places.len();
    places.extend(block(|_| 1.0).positions.iter().filter(|p| p[2].abs() < 0.95));
    let inner = places.len() - skin;
    let set = with_attribute(set_of(places), "s", |_| 1.0);
    let set = with_attribute(set, "skin", |p| f64::from(p[2].abs() > 0.99));
    assert!(inner > 0);
    let glass =
        format!("material = {{ kind = \"glass\", ior = 1.0, absorption = {absorption:?} }}");
    for (step, extinction) in [(0.5, 0.7), (0.01, 0.7), (0.5, 1e-7)] {
        let stop = format!(
            "color = [0.4, 0.4, 0.4], extinction = {extinction:e}, emission = [0.3, 0.3, 0.3]"
        );
        let text = scene(&stop, step, &glass).replace("scalar =", "boundary = \"skin\"\nscalar =");
        let plan = plan_of(&text, std::slice::from_ref(&set));
        let on_device = bench.render(&plan);
        assert_same_bits("medium", &on_device, &render_twin(&plan));
        for pixel in &on_device.film.color {
            for channel in 0..3 {
                let both = extinction + absorption[channel];
                let source = 0.4 * extinction + 0.3;
                let expected = source * -(-both * 2.0).exp_m1() / both;
                // The faces are planes to 1e-6.
                assert!(off(pixel[channel], expected) < 1e-5, "{step}: {pixel:?} for {expected}");
            }
        }
    }
}

/// Where glass has an alpha for each channel, thin fog beside it has its digits there, too.
#[test]
fn alpha_by_channel_has_the_digits_of_the_coverage() {
    let glass = "[[objects]]\npoints = \"far.ply\"\ntransform.translate = [9.0, 9.0, 0.0]\n\
                 material = { kind = \"glass\", ior = [1.4, 1.5, 1.6] }\n";
    for extinction in ["1e-10", "1e-5", "3.0"] {
        let stop = format!("color = [1.0, 0.5, 0.25], extinction = {extinction}");
        let text = format!("{}{glass}", scene(&stop, 0.03, ""))
            .replace("[4, 3]", "[4, 3]\ntransparent = true");
        let plan = plan_of(&text, &[block(|_| 1.0), block(|_| 1.0)]);
        let on_device = Bench::open().render(&plan).film;
        assert_same_film("alpha", &on_device, &render_twin(&plan).film);
        let alpha = on_device.channel_alpha.as_ref().expect("AR, AG, AB");
        for (pixel, alpha) in on_device.color.iter().zip(alpha) {
            // The same to the last bits: products and sums of two numbers.
            let near = alpha.iter().all(|of| (of / pixel[3] - 1.0).abs() < 1e-6);
            assert!(near && pixel[3] > 0.0, "{extinction}: {alpha:?} beside {}", pixel[3]);
        }
    }
}

/// The light that thin fog leaves to a floor, 1 - σℓ, and that dense fog leaves, exp(-σℓ): shadows follow the same depth.
#[test]
fn shadows_follow_the_depth() {
    let floor = "[[objects]]\npoints = \"floor.ply\"\n[objects.surface]\nkind = \"discs\"\nradius = 0.5\n\
                 [objects.material]\nalbedo = [1.0, 1.0, 1.0]\n";
    let light = "[[lights]]\nkind = \"directional\"\ndirection = [0.0, 0.0, -1.0]\nirradiance = [3.14159265, 3.14159265, 3.14159265]\n";
    let floor_points = set_of(
        (0..400)
            .map(|i| [f64::from(i % 20) * 0.2 - 2.0, f64::from(i / 20) * 0.2 - 2.0, -1.8])
            .collect(),
    );
    for extinction in [1e-6, 0.4, 5.0, 20.0] {
        let stop = format!("color = [0.0, 0.0, 0.0], extinction = {extinction:e}");
        let text = format!("{light}{}{floor}", scene(&stop, 0.02, ""));
        let plan = plan_of(&text, &[block(|_| 1.0), floor_points.clone()]);
        let on_device = Bench::open().render(&plan);
        assert_same_bits("shadow", &on_device, &render_twin(&plan));
        let expected = in_f64(&plan);
        for (found, expected) in on_device.film.color.iter().zip(&expected.color) {
            // Twice through a depth of 50, of which f32 has 4e-6.
            assert!(off(found[0], f64::from(expected[0])) < 2e-5, "{found:?} for {expected:?}");
        }
        // There and back, 2.3 to 2.6 each.
        let through = f64::from(on_device.film.color[5][0]).ln() / (-2.0 * extinction);
        assert!(extinction < 1e-3 || (2.2..2.7).contains(&through), "{through}");
    }
}
