//! What a ray shows: colours along its way, or one scalar of all of it.

use super::*;

/// A map of colours shows what stops written out from it would: its ends, its middle, and the extinction, linear
/// over the attribute's own range.
#[test]
fn a_color_map_is_a_transfer_function() {
    let set = cloud(4_000);
    let with = |keys: &str| {
        let scene = volume_scene("[32, 24]", 0.2, 0.05).replace(TRANSFER, keys);
        plan_of(&scene, std::slice::from_ref(&set))
    };
    let values = || set.attribute("s").expect("values").iter();
    let (low, high) = (values().fold(9.0, f64::min), values().fold(-9.0, f64::max));
    let stops = with("color_map = \"magma\"\nextinction = [0.0, 5.0]").volumes.stops;
    let (first, last) = (stops[0], stops[stops.len() - 1]);
    assert_eq!([first.value, last.value], [low as f32, high as f32]);
    assert_eq!(
        [first.extinction, stops[stops.len() / 2].extinction, last.extinction],
        [0.0, 2.5, 5.0]
    );
    let byte = |stop: layout::VolumeStop| stop.color.map(film::srgb_byte);
    assert_eq!([byte(first), byte(last)], [[0, 0, 4], [252, 253, 191]]);

    let gray = "color_map = \"gray\"\nvalue_range = [0.2, 0.8]\nextinction = 3";
    let plan = with(gray);
    let stops: String = (plan.volumes.stops.iter())
        .map(|s| {
            format!(
                "{{ value = {:?}, color = {:?}, extinction = {:?} }},\n",
                s.value, s.color, s.extinction
            )
        })
        .collect();
    let bench = Bench::open();
    let film = bench.render(&plan).film;
    assert_same_film("stops", &film, &bench.render(&with(&format!("transfer = [\n{stops}]"))).film);
    assert!(film.color.iter().any(|c| c[0] > 0.1 && c[0] == c[1] && c[1] == c[2]));
}

/// The greatest scalar on each ray as a layer of one radius, the mean scalar all along it, against a direct
/// evaluation of the same samples in f64; and the twin's bits.
#[test]
fn maximum_and_average_show_one_scalar_of_the_whole_ray() {
    let (radius, step) = (0.25, 0.01);
    let set = cloud(3_000);
    let values: Vec<f64> = set.attribute("s").expect("values").iter().collect();
    let bench = Bench::open();
    let films = ["maximum", "average"].map(|mode| {
        let text = volume_scene("[24, 18]", radius, step)
            .replace("scalar = ", &format!("mode = \"{mode}\"\nscalar = "));
        let plan = plan_of(&text, std::slice::from_ref(&set));
        let on_device = bench.render(&plan);
        assert_same_bits(mode, &on_device, &render_twin(&plan));
        on_device.film
    });
    let mut worst = [0.0f64; 2];
    for j in (1..18).step_by(4) {
        for i in (1..24).step_by(4) {
            let d = direction(i, j);
            let [enter, leave] = way(&set, radius, d);
            let scalars: Vec<f64> = (0..)
                .map(|k| enter + (f64::from(k) + 1.0) * step)
                .take_while(|t| *t < leave)
                .filter_map(|t| direct(&set, &values, [0, 1, 2].map(|a| EYE[a] + t * d[a]), radius))
                .collect();
            if scalars.is_empty() {
                continue;
            }
            let length = scalars.len() as f64;
            let greatest = scalars.iter().copied().fold(f64::MIN, f64::max);
            let mean = scalars.iter().sum::<f64>() / length;
            for (mode, (scalar, way)) in
                [(greatest, radius), (mean, length * step)].into_iter().enumerate()
            {
                let (color, sigma) = transfer(scalar);
                let alpha = 1.0 - (-sigma * way).exp();
                let seen = films[mode].color[(j * 24 + i) as usize];
                for c in 0..3 {
                    worst[mode] = worst[mode].max((f64::from(seen[c]) - alpha * color[c]).abs());
                }
                worst[mode] = worst[mode].max((f64::from(seen[3]) - alpha).abs());
            }
        }
    }
    println!("maximum, average: worst {worst:.5?}");
    // A sample at the edge of a point's reach may count on one side alone: one step of the mean.
    assert!(worst[0] < 1e-3 && worst[1] < 1e-2, "{worst:?}");
}

/// Where the scalar is one number, its mean is a fog: the same as emission and extinction.
#[test]
fn the_average_of_a_constant_is_its_fog() {
    let set = with_attribute(set_of(cloud(3_000).positions), "s", |_| 0.7);
    let film = |mode: &str| {
        let text = volume_scene("[48, 36]", 0.3, 0.05)
            .replace("scalar = ", &format!("mode = \"{mode}\"\nscalar = "));
        Bench::open().render(&plan_of(&text, std::slice::from_ref(&set))).film
    };
    let (average, emission) = (film("average"), film("emission"));
    let off = (average.color.as_flattened().iter().zip(emission.color.as_flattened()))
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f32::max);
    // Sixty products of f32.
    assert!(off < 1e-5, "{off}");
    assert!(average.color.iter().any(|c| c[3] > 0.9));
}

/// A mode that shows one scalar of the whole ray does not add to another volume.
#[test]
fn a_mode_that_needs_the_only_volume_says_so() {
    let object = "[[objects]]\npoints = \"cloud.ply\"\n[objects.volume]\nscalar = \"s\"\ncolor_map = \"gray\"\n\
                  extinction = 1\n";
    let text = format!("{object}mode = \"maximum\"\n{object}");
    let scene = Scene::from_toml(&text, Path::new("s.toml"), &[]).expect("a valid scene");
    let set = Arc::new(cloud(100));
    let error = Plan::new(&scene, &[Arc::clone(&set), set], &SceneImages::default(), None, Up::Y)
        .expect_err("two volumes");
    assert!(error.to_string().contains("the scene's only volume, but there are 2"), "{error}");
}
