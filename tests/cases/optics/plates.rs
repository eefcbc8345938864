//! Plates and slabs: shares that are reflected, and ways through them.

use super::*;

/// A picture of parallel rays that meet the level y = 0 at this angle to its normal. Its up is no axis, which would be the
/// top of the environment.
fn slanted(degrees: f64, size: [usize; 2]) -> String {
    let (sin, cos) = degrees.to_radians().sin_cos();
    format!(
        "[camera]\nprojection = \"orthographic\"\nheight = 0.5\neye = [{}, {}, 0.1]\ntarget = [0.0, 0.0, 0.1]\n\
         up = [0.0, 1e-6, -1.0]\n[image]\nsize = {size:?}\n",
        3.0 * sin,
        3.0 * cos
    )
}

/// One surface reflects R, a plate, whose sheets reflect endlessly between them, 2R/(1 + R), and lets
/// (1 − R)/(1 + R) through: above it is white, below black.
#[test]
fn surfaces_and_plates_reflect_fresnels_share() {
    let image = Arc::new(environment_of(64, |d| [f64::from(u8::from(d[1] > 0.0)); 3]));
    let (size, samples) = ([64, 48], 64);
    for (degrees, index) in [(0.0f64, 1.5), (0.0, 2.4), (70.0, 1.5)] {
        for plate in [false, true] {
            let text = format!(
                "{}samples = {samples}\n[render]\nfresnel = \"sample\"\nseed = 3\nmax_bounces = 64\n{SKY}\
                 [[objects]]\npoints = \"sheets.ply\"\nmaterial = {{ kind = \"glass\", ior = {index:?} }}\n",
                slanted(degrees, size)
            );
            let mut sheets = lattice(4.0, 0.08, 0.0);
            if plate {
                sheets.extend(lattice(4.0, 0.08, -0.5));
            }
            let film = render(&text, &[set_of(sheets)], Some(&image));
            let r = fresnel(degrees.to_radians().cos(), 1.0, index);
            let share = if plate { 2.0 * r / (1.0 + r) } else { r };
            let count = (size[0] * size[1]) as f64;
            let mean = film.color.iter().map(|c| f64::from(c[0])).sum::<f64>() / count;
            let sigma = (share * (1.0 - share) / (count * f64::from(samples))).sqrt();
            println!(
                "{degrees}°, index {index}, plate {plate}: {mean:.6}, not {share:.6}: {:.2} sigma",
                (mean - share) / sigma
            );
            assert!(
                (mean - share).abs() < 3.0 * sigma,
                "{degrees}, {index}, {plate}: {mean}, not {share}"
            );
        }
    }
}

/// A ball of glass with a bubble: the mean over rays that are reflected or refracted by chance is what
/// Fresnel's equations say of all ways together, without a bias, and with no more than the spread of such a
/// choice.
#[test]
fn chance_gives_the_mean_of_all_ways() {
    let (image, samples) = (sky(), 64);
    let view = View { size: [120, 90], ..VIEW };
    // Rays within a tenth of a pixel, over which the picture changes little.
    let text = format!(
        "{}samples = {samples}\nfilter = \"box\"\nfilter_width = 0.1\n\
         [render]\nfresnel = \"sample\"\nmax_bounces = 100\n{SKY}\
         [[objects]]\npoints = \"ball.ply\"\nmaterial = {{ kind = \"glass\" }}\n\
         [[objects]]\npoints = \"bubble.ply\"\ntransform = {{ scale = 0.5 }}\n\
         material = {{ kind = \"glass\", ior = 1.0, priority = 1 }}\n",
        view.text()
    );
    let glass = |radius, index| Body {
        shape: Shape::Sphere([0.0; 3], radius),
        matter: Matter::Glass(index, 0.0),
    };
    let bodies = [glass(1.0, 1.5), glass(0.5, 1.0)];
    let sets = [40_000, 10_000].map(|count| set_of(fibonacci_sphere(count)));
    let film = render(&text, &sets, Some(&image));
    let (mut count, mut squares, mut bias, mut spread) = (0.0, 0.0, 0.0, 0.0);
    for pixel in 0..film.color.len() {
        let from_middle = view.distance(pixel, [0.0; 3]);
        // Where total reflection begins, at half the radius, the tenth of a pixel counts.
        if from_middle > INNER || (from_middle - 0.5).abs() < 0.02 {
            continue;
        }
        let ways = divided(&bodies, view.eye, view.through(pixel), 1e-7);
        let seen: Vec<(f64, f64)> =
            ways.iter().map(|&(d, share)| (environment_at(&image, d)[0], share)).collect();
        let mean = seen.iter().map(|(value, share)| value * share).sum::<f64>();
        let square = seen.iter().map(|(value, share)| value * value * share).sum::<f64>();
        let variance = (square - mean * mean) / f64::from(samples);
        let error = f64::from(film.color[pixel][0]) - mean;
        count += 1.0;
        squares += error * error / variance;
        bias += error;
        spread += variance;
    }
    let (rms, sigmas) = ((squares / count).sqrt(), bias / spread.sqrt());
    println!("chance: {count} pixels; {rms:.3} of the spread of chance, bias {sigmas:.2} sigma");
    // Even sequences do not err more than chance would; 1 is what independent numbers give.
    assert!(count > 3_000.0 && rms < 1.05 && sigmas.abs() < 3.0, "{count}, {rms}, {sigmas}");
}

#[test]
fn a_slab_absorbs_along_the_refracted_way() {
    for (degrees, index) in [(0.0f64, 1.000_000_1f64), (50.0, 1.000_000_1), (0.0, 1.5), (50.0, 1.5)]
    {
        let text = format!(
            "{}[background]\ncolor = [1.0, 1.0, 1.0]\n[[objects]]\npoints = \"slab.ply\"\n\
             material = {{ kind = \"glass\", ior = {index:?}, absorption = [0.5, 1.0, 2.0] }}\n",
            slanted(degrees, [64, 48])
        );
        let mut sheets = lattice(3.0, 0.06, 0.0);
        sheets.extend(lattice(3.0, 0.06, -0.7));
        let film = render(&text, &[set_of(sheets)], None);
        let way = 0.7 / (degrees.to_radians().sin() / index).asin().cos();
        let expected = [0.5, 1.0, 2.0].map(|sigma| (-sigma * way).exp());
        let errors: Vec<f64> =
            (0..film.color.len()).map(|pixel| off(&film, pixel, expected)).collect();
        let worst = report(&format!("slab, {degrees}°, index {index}"), &errors, 1.0, 1e-5);
        // A few roundings of 6e-8. (Of an index so near 1, f32 holds one bit.)
        assert!(worst < 1e-5, "{degrees}, {index}: {worst:e}");
    }
}

/// Between two mirrors: the camera's ray meets one, and after `max_bounces` more the background counts.
#[test]
fn after_max_bounces_the_background_counts() {
    let (reflectance, color): (V3, V3) = ([0.9, 0.7, 0.5], [0.2, 0.5, 1.0]);
    for bounces in [0, 1, 2, 8, 20] {
        let text = format!(
            "[camera]\neye = [0.0, 0.0, 0.0]\ntarget = [0.1, 1.0, 0.05]\nvertical_fov = 8.0\n\
             [image]\nsize = [64, 48]\n[render]\nmax_bounces = {bounces}\n[background]\ncolor = {color:?}\n\
             [[objects]]\npoints = \"above.ply\"\nmaterial = {{ kind = \"mirror\", reflectance = {reflectance:?} }}\n\
             [[objects]]\npoints = \"below.ply\"\nmaterial = {{ kind = \"mirror\", reflectance = {reflectance:?} }}\n"
        );
        let sets = [set_of(lattice(5.0, 0.1, 0.5)), set_of(lattice(5.0, 0.1, -0.5))];
        let film = render(&text, &sets, None);
        let expected = [0, 1, 2].map(|i| reflectance[i].powi(bounces + 1) * color[i]);
        let worst =
            (0..film.color.len()).map(|pixel| off(&film, pixel, expected)).fold(0.0, f64::max);
        println!("{bounces} bounces: worst {worst:.2e} of {expected:?}");
        // A rounding of 6e-8 for each factor.
        assert!(worst < 1e-6, "{bounces}: {worst:e}");
    }
}

// ---- thin sheets ------------------------------------------------------------------------------------
