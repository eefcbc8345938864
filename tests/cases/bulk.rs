//! A few bad points, and points given twice, change no pixel.

#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use harness::{
    Bench, assert_same_film, fibonacci_sphere, moved, plan_of, random, render_twin, set_of,
    with_attribute,
};
use points::{Attribute, PointSet, Values};

const SCENE: &str = "image.size = [64, 48]\n[[lights]]\nkind = \"directional\"\ndirection = [0.3, -1, -0.5]\n\
                     irradiance = [3, 3, 3]\n";
/// The same with a volume.
fn fog(kernel: &str) -> String {
    format!(
        "{SCENE}[[objects]]\npoints = \"generated.ply\"\n[objects.volume]\nscalar = \"s\"\n{kernel}\n\
         transfer = [{{ value = 0, color = [1, 1, 1], extinction = 0 }}, {{ value = 1, color = [1, 0, 0], extinction = 1 }}]\n"
    )
}

fn with(positions: &[[f64; 3]], more: &[[f64; 3]]) -> PointSet {
    set_of([positions, more].concat())
}

/// Far off, inside, several in one place, and beyond what f32 bears: framed, centred and shaded as without them.
#[test]
fn strays_change_no_pixel() {
    let sphere = fibonacci_sphere(3000);
    let clean = plan_of(SCENE, &[set_of(sphere.clone())]);
    let expected = render_twin(&clean).film;
    for (name, strays) in [
        ("one far off", vec![[500.0, 300.0, 100.0]]),
        ("one at 1e30", vec![[1e30, 0.0, -1e30]]),
        ("one inside", vec![[0.0; 3]]),
        (
            "a few here and there",
            vec![[4.0, 0.0, 0.0], [0.0, 7.0, 1.0], [-3.0, -3.0, 9.0], [0.1, 0.0, 0.0]],
        ),
        ("sixteen in one place", vec![[30.0, 0.0, 0.0]; 16]),
        ("one far off, which hides one near", vec![[1e30; 3], [5.0, 0.0, 0.0]]),
    ] {
        let plan = plan_of(SCENE, &[with(&sphere, &strays)]);
        assert_eq!(plan.apart.len(), 1, "{name}");
        assert_eq!(plan.apart[0].1.count, strays.len() as u64, "{name}");
        assert_eq!(plan.cloud.origin, clean.cloud.origin, "{name}");
        assert_same_film(name, &render_twin(&plan).film, &expected);
    }
    assert_eq!(clean.apart, []);
}

/// Multiples of 2^-20 lie as exactly at a northing of 4.6 million.
#[test]
fn a_zero_among_survey_coordinates_changes_no_pixel() {
    let even = |x: f64| (x * 1_048_576.0).round() / 1_048_576.0;
    let sphere: Vec<[f64; 3]> = fibonacci_sphere(3000).iter().map(|p| p.map(even)).collect();
    let survey = moved(&sphere, [500_000.0, 4_600_000.0, 200.0]);
    let clean = plan_of(SCENE, &[set_of(survey.clone())]);
    let plan = plan_of(SCENE, &[with(&survey, &[[0.0; 3]])]);
    assert_eq!(plan.cloud.origin, clean.cloud.origin);
    assert_same_film("with (0, 0, 0)", &render_twin(&plan).film, &render_twin(&clean).film);
}

/// Nor may what stands in several objects count as strays: a scene of two is framed on both.
#[test]
fn a_small_object_far_off_is_no_stray() {
    let text = format!("{SCENE}[[objects]]\npoints = \"a.ply\"\n[[objects]]\npoints = \"b.ply\"\n");
    let few = moved(&fibonacci_sphere(40), [50.0, 0.0, 0.0]);
    let plan = plan_of(&text, &[set_of(fibonacci_sphere(3000)), set_of(few)]);
    assert_eq!(plan.apart, []);
    assert!(plan.cloud.bounds[1][0] > 50.0);
}

/// Each eight times, one after another or set after set; a part of them twelve times; all on the device as well.
#[test]
fn copies_change_no_pixel() {
    let sphere = fibonacci_sphere(2000);
    let expected = render_twin(&plan_of(SCENE, &[set_of(sphere.clone())])).film;
    let eight: Vec<[f64; 3]> = sphere.iter().flat_map(|&p| [p; 8]).collect();
    let sets = sphere.repeat(8);
    let half = [&sphere[..], &sphere[..1000].repeat(11)].concat();
    let bench = Bench::open();
    for (name, positions) in [("eight times", eight), ("eight sets", sets), ("half", half)] {
        let plan = plan_of(SCENE, &[set_of(positions)]);
        assert_eq!(plan.cloud.points.len(), 2000, "{name}");
        assert_same_film(name, &render_twin(&plan).film, &expected);
        assert_same_film(name, &bench.render(&plan).film, &expected);
    }
}

/// What differs by less than f32 resolves is one position, whose first point gives the colour.
#[test]
fn the_first_of_coinciding_points_gives_the_colour() {
    let sphere = fibonacci_sphere(2000);
    let colored = |positions: Vec<[f64; 3]>, colors: Vec<[f32; 3]>| {
        let set = PointSet { colors: Some(colors), ..set_of(positions) };
        render_twin(&plan_of(SCENE, &[set])).film
    };
    let color = |i: usize| [0.1, 0.5, (i % 7) as f32 / 7.0];
    let expected = colored(sphere.clone(), (0..2000).map(color).collect());
    // Another box would be another origin.
    let is_within = |p: &[f64; 3]| p.iter().all(|x| x.abs() < 0.9);
    let near = sphere.iter().map(|&p| if is_within(&p) { p.map(|x| x + 1e-13) } else { p });
    let twice: Vec<[f64; 3]> = sphere.iter().copied().chain(near).collect();
    let colors = (0..4000).map(|i| if i < 2000 { color(i) } else { [1.0, 0.0, 0.0] }).collect();
    assert_same_film("colours of the first", &colored(twice, colors), &expected);
    let mapped = |set| {
        let text = format!(
            "{SCENE}[[objects]]\npoints = \"a.ply\"\n[objects.material]\nalbedo = \"attribute:t\"\n"
        );
        render_twin(&plan_of(&text, &[set])).film
    };
    let once = mapped(with_attribute(set_of(sphere.clone()), "t", |p| p[2]));
    let mut values: Vec<f64> = sphere.iter().map(|p| p[2]).collect();
    values.extend([1e6; 2000]);
    let values = Attribute { name: "t".to_owned(), values: Values::F64(values) };
    let copied = PointSet { attributes: vec![values], ..set_of(sphere.repeat(2)) };
    assert_same_film("the range of the first", &mapped(copied), &once);
}

/// A sum is over all particles, and a mean takes each: copies are no fewer.
#[test]
fn volumes_keep_coinciding_points() {
    let ball: Vec<[f64; 3]> = fibonacci_sphere(500);
    let volume = |positions: &[[f64; 3]], kernel| {
        let set = with_attribute(set_of(positions.to_vec()), "s", |_| 0.01);
        plan_of(&fog(&format!("radius = 0.3\nstep = 0.05\n{kernel}")), &[set])
    };
    let center = |plan| render_twin(&plan).film.color[24 * 64 + 32];
    for kernel in ["kernel = \"sum\"", "kernel = \"shepard\""] {
        assert_eq!(volume(&ball.repeat(4), kernel).volumes.points.len(), 2000, "{kernel}");
    }
    let sum = "kernel = \"sum\"";
    let (one, four) = (center(volume(&ball, sum)), center(volume(&ball.repeat(4), sum)));
    // Optical depth is linear in the sum: four times, but for what f32 and thin steps round.
    let depth = |alpha: f32| -f64::from(1.0 - alpha).ln();
    let ratio = depth(four[3]) / depth(one[3]);
    assert!((ratio - 4.0).abs() < 0.01, "{ratio}");
}

/// A droplet is a part of a volume, a point without company a thousand diagonals off is not.
#[test]
fn volumes_keep_strays_that_lie_near() {
    let sphere = fibonacci_sphere(3000);
    let set = with_attribute(with(&sphere, &[[2.5, 0.0, 0.0], [2000.0, 0.0, 0.0]]), "s", |_| 1.0);
    let plan = plan_of(&fog(""), &[set]);
    assert_eq!(plan.apart[0].1.count, 2);
    assert_eq!(plan.volumes.points.len(), 3001);
    let clean = plan_of(&fog(""), &[with_attribute(set_of(sphere), "s", |_| 1.0)]);
    assert_eq!(
        plan.volumes.infos[0].grid.edge, clean.volumes.infos[0].grid.edge,
        "lengths are the bulk's"
    );
}

/// Lengths are those of distinct points, and a stray leaves `drop_isolated` its measure.
#[test]
fn copies_and_strays_change_no_length() {
    let isolating =
        format!("{SCENE}[[objects]]\npoints = \"a.ply\"\n[objects.surface]\ndrop_isolated = 1\n");
    let mut seed = 11;
    let uneven: Vec<[f64; 3]> = (fibonacci_sphere(3000).into_iter())
        .filter(|p| random(&mut seed) < 0.05 + 0.9 * (p[2] > 0.3) as u8 as f64)
        .collect();
    let half = [&uneven[..], &uneven[..uneven.len() / 2].repeat(11)].concat();
    let clean = plan_of(&isolating, &[set_of(uneven.clone())]);
    assert!(clean.isolated[0] > 10, "{}", clean.isolated[0]);
    let expected = render_twin(&clean).film;
    for (name, set) in
        [("copies", set_of(half.clone())), ("a stray", with(&uneven, &[[1e30, 0.0, 0.0]]))]
    {
        let plan = plan_of(&isolating, &[set]);
        assert_same_film(name, &render_twin(&plan).film, &expected);
    }
    let lengths = |positions: &[[f64; 3]]| {
        let set = with_attribute(set_of(positions.to_vec()), "s", |_| 1.0);
        let plan = plan_of(&fog("boundary = \"auto\""), &[set]);
        // Cells may be as many as points, copies among them; lengths are those of the reaches and steps.
        let grids = plan.volumes.grids_of(&plan.volumes.infos[0]).iter();
        let reaches: Vec<_> = grids.map(|grid| (grid.square_radius, grid.level)).collect();
        (reaches, plan.volumes.step, plan.cloud.points.len())
    };
    assert_eq!(lengths(&half), lengths(&uneven));
}
