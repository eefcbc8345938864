//! How fast errors fall.

use super::*;
use harness::analytic::length;

/// With n samples, errors fall as n^-½ or faster: 4 times as many halve them. Of 700 pixels, the ratio of two roots of mean
/// squares has a deviation of under 4 %; three of them are left.
#[test]
fn four_times_as_many_samples_halve_the_error() {
    let view = View { eye: [0.5, 4.5, 6.5], target: [0.0; 3], fov: 40.0, size: [40, 30] };
    let middle = [0.0, 2.0, 0.0];
    let inside =
        View { eye: [0.3, 0.1, 0.2], target: [-1.0, 0.2, -0.4], fov: 70.0, size: [32, 32] };
    let ball = fibonacci_sphere(4_000);
    let scene = |view: &View, integrator: &str, more: &str| {
        format!(
            "{}filter_width = 0.2\nsamples = 16\n[render]\nintegrator = \"{integrator}\"\nmax_bounces = 16\n{more}",
            view.text()
        )
    };
    let black = "[background]\ncolor = [1.0, 1.0, 1.0]\n\
                 [[objects]]\npoints = \"plane.ply\"\nmaterial = { albedo = [0.7, 0.7, 0.7] }\n\
                 [[objects]]\npoints = \"ball.ply\"\nmaterial = { albedo = [0.0, 0.0, 0.0] }\n";
    let lamp = "[[lights]]\nkind = \"point\"\nposition = [0.0, 0.0, 0.0]\nintensity = [1.0, 1.0, 1.0]\n\
                [[objects]]\npoints = \"sphere.ply\"\nmaterial = { albedo = [0.5, 0.5, 0.5] }\n";
    let open = [set_of(lattice(5.0, 0.1, 0.0)), set_of(moved(&ball, middle))];
    let closed = [set_of(ball)];
    let seen = |pixel: usize| {
        let x = on_level(&view, pixel, 0.0)?;
        let away = add(middle, x, -1.0);
        let clear = view.distance(pixel, middle) > 1.05 && x[0].abs().max(x[2].abs()) < 4.5;
        clear.then(|| [0.7 * (1.0 - away[1] / length(away).powi(3)); 3])
    };
    let series = 0.5 * FRAC_1_PI * (1.0 - 0.5f64.powi(17)) / 0.5;
    let rms = |plan: &Plan, expected: &dyn Fn(usize) -> Option<V3>| {
        let film = Bench::open().render(plan).film;
        let pixels = (0..film.color.len()).filter_map(|pixel| Some((pixel, expected(pixel)?)));
        let squares: Vec<f64> = pixels
            .map(|(pixel, expected)| (f64::from(film.color[pixel][0]) / expected[0] - 1.0).powi(2))
            .collect();
        assert!(squares.len() > 700, "{} pixels", squares.len());
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let inner = |_: usize| Some([series; 3]);
    for (name, text, sets, expected) in [
        ("sky", scene(&view, "sky", black), &open[..], &seen as &dyn Fn(usize) -> Option<V3>),
        ("path", scene(&view, "path", black), &open[..], &seen),
        ("closed", scene(&inside, "path", lamp), &closed[..], &inner),
    ] {
        let mut plan = plan(&text, sets, None);
        let errors = [16, 64, 256].map(|samples| {
            sample(&mut plan, samples, 0);
            rms(&plan, expected)
        });
        println!("{name}: relative errors of 16, 64 and 256 samples {errors:?}");
        for pair in errors.windows(2) {
            assert!(pair[1] < 0.56 * pair[0], "{name}: {errors:?}");
        }
    }
}
