use super::*;

fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 53) as f64
}

/// Even points of the unit sphere.
fn sphere(count: u32) -> Vec<[f64; 3]> {
    let of = |i: u32| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let (sin, cos) = (2.399_963_23 * f64::from(i)).sin_cos();
        let r = (1.0 - z * z).sqrt();
        [r * cos, r * sin, z]
    };
    (0..count).map(of).collect()
}

fn strays(positions: &[[f64; 3]]) -> Strays {
    let found = Strays::find(positions, rough_origin(&[positions]).expect("points"));
    let mut order = found.order.clone();
    order.sort_unstable();
    assert!(order.into_iter().eq(0..positions.len() as u32), "the order names each point once");
    found
}

#[test]
fn one_stray_is_found_however_far_it_lies() {
    for far in [5.0, 1e3, 1e9, 1e15, 1e30, 1e300] {
        let mut points = sphere(5000);
        points.insert(1234, [far, -far, 0.5 * far]);
        let found = strays(&points);
        assert_eq!(found.places, [1234], "at {far:e}");
        assert!((found.farthest / (1.5 * far) - 1.0).abs() < 0.3, "{:e}", found.farthest);
        assert!(found.bulk.iter().flatten().all(|x| x.abs() <= 1.0));
    }
}

#[test]
fn a_zero_among_survey_coordinates_is_a_stray() {
    let mut points: Vec<[f64; 3]> = sphere(5000)
        .into_iter()
        .map(|p| [5e5 + 5.0 * p[0], 4.6e6 + 5.0 * p[1], 200.0 + 5.0 * p[2]])
        .collect();
    points.push([0.0; 3]);
    assert_eq!(strays(&points).places, [5000]);
}

/// From a normal distribution of three radii: those near the sphere may be taken for a part of it.
#[test]
fn floaters_around_a_model_are_strays() {
    for count in [2000, 20_000, 200_000] {
        let mut seed = 7;
        let mut points = sphere(count);
        let floaters: Vec<[f64; 3]> = (0..20)
            .map(|_| [0; 3].map(|_| (0..12).map(|_| random(&mut seed)).sum::<f64>() * 3.0 - 18.0))
            .collect();
        points.extend(&floaters);
        let found = strays(&points);
        let far = |p: &[f64; 3]| (p.iter().map(|x| x * x).sum::<f64>().sqrt() - 1.0).abs() > 1.0;
        let expected = floaters.iter().filter(|p| far(p)).count();
        assert!(found.places.len() >= expected && expected > 12, "{count}: {}", found.places.len());
        assert!(found.places.iter().all(|&place| place >= count));
    }
}

#[test]
fn a_cluster_of_sixteen_is_stray_and_one_of_seventeen_is_not() {
    for (size, stray) in [(1, true), (15, true), (16, true), (17, false), (40, false)] {
        let mut seed = 3;
        let mut points = sphere(5000);
        points.extend((0..size).map(|_| [40.0, 0.0, 0.0].map(|x| x + 0.01 * random(&mut seed))));
        let expected = if stray { size } else { 0 };
        assert_eq!(strays(&points).places.len(), expected, "a cluster of {size}");
    }
}

/// The spacing grows with the distance, as around a terrestrial scanner: a hundred times over the set.
#[test]
fn sparse_surroundings_are_no_strays() {
    let mut seed = 5;
    let scan: Vec<[f64; 3]> = (0..20_000)
        .map(|_| {
            let (r, turn) = (100f64.powf(random(&mut seed)), 6.3 * random(&mut seed));
            [r * turn.cos(), r * turn.sin(), 0.02 * r * random(&mut seed)]
        })
        .collect();
    assert_eq!(strays(&scan).places, [] as [u32; 0]);
}

#[test]
fn what_is_even_or_small_has_no_strays() {
    let mut seed = 9;
    let lattice = |n: u32| -> Vec<[f64; 3]> {
        (0..n * n).map(|i| [f64::from(i % n), f64::from(i / n), 0.0]).collect()
    };
    let solid: Vec<[f64; 3]> = (0..5000).map(|_| [0; 3].map(|_| random(&mut seed))).collect();
    let line: Vec<[f64; 3]> = (0..1000).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    let same = vec![[1.0; 3]; 1000];
    let two = vec![[0.0; 3], [1e9; 3]];
    for (name, set) in [
        ("lattice", lattice(70)),
        ("solid", solid),
        ("line", line),
        ("one place", same),
        ("two points", two),
    ] {
        assert_eq!(strays(&set).places, [] as [u32; 0], "{name}");
    }
}

/// Each point eight times over: the same strays, and all their copies.
#[test]
fn copies_share_the_fate_of_their_position() {
    let mut points = sphere(2000);
    points.push([9.0, 0.0, 0.0]);
    let eight: Vec<[f64; 3]> = points.iter().flat_map(|&p| [p; 8]).collect();
    assert_eq!(strays(&points).places, [2000]);
    assert_eq!(strays(&eight).places, Vec::from_iter(16_000..16_008));
}

/// Progress rises to the count of points, from what was done before, and a request for an end is met in the middle.
#[test]
fn the_search_is_watched() {
    struct Look(std::sync::Mutex<Vec<u64>>, usize);
    impl Watch for Look {
        fn stage(&self, _: &'static str, _: u64) {}
        fn done(&self, units: u64) {
            self.0.lock().unwrap().push(units);
        }
        fn interrupted(&self) -> bool {
            self.0.lock().unwrap().len() > self.1
        }
    }
    let mut points = sphere(200_000);
    points.push([9.0, 0.0, 0.0]);
    let look = Look(Vec::new().into(), usize::MAX);
    let found = Strays::find_watched(&points, [0.0; 3], &look, 1000);
    assert_eq!(found, Some(Strays::find(&points, [0.0; 3])));
    let shown = look.0.into_inner().unwrap();
    assert!(shown.len() > 3 && shown.is_sorted(), "{shown:?}");
    assert!(shown.iter().all(|units| (1000..=201_001).contains(units)), "{shown:?}");
    for calls in 0..3 {
        let look = Look(Vec::new().into(), calls);
        assert_eq!(Strays::find_watched(&points, [0.0; 3], &look, 0), None, "{calls}");
    }
}

#[test]
fn the_filter_keeps_the_bulk_and_is_short() {
    let mut points = sphere(2000);
    points.push([9.0, 0.0, 0.0]);
    let apart = strays(&points).apart(2, &points);
    assert_eq!(
        apart.filter.expect("one lies outside"),
        "--set 'objects.2.filter.box={ min = [-1.00, -1.00, -1.00], max = [1.00, 1.00, 1.00] }'"
    );
    points.pop();
    points.push([0.0; 3]);
    assert_eq!(strays(&points).apart(0, &points).filter, None);
}

/// A dense ball on a sparse ground: the ground has no hole around it, and a point above it is stray all the same.
#[test]
fn sparse_surroundings_of_a_dense_part_have_no_hole() {
    for count in [300, 3000] {
        let mut seed = 5;
        let mut points: Vec<[f64; 3]> =
            sphere(20_000).iter().map(|p| p.map(|x| 0.05 * x)).collect();
        points
            .extend((0..count).map(|_| {
                [100.0 * random(&mut seed) - 50.0, 100.0 * random(&mut seed) - 50.0, 0.0]
            }));
        assert_eq!(strays(&points).places, [] as [u32; 0], "{count}");
        points.push([0.0, 0.0, 60.0]);
        assert_eq!(strays(&points).places, [20_000 + count], "{count}");
    }
}

/// Of a few points, one that lies a hundred times as far off as the others from each other.
#[test]
fn a_far_stray_among_a_few_points_is_found() {
    for count in 8..33 {
        for far in [1e4, 1e9, 1e30, 1e300] {
            let mut points = sphere(count);
            points.insert(3, [0.0, far, 0.0]);
            assert_eq!(strays(&points).places, [3], "{count} and one at {far:e}");
        }
        // Neither is what grows by a factor, nor what is near.
        let mut points = sphere(count);
        points.push([0.0, 20.0, 0.0]);
        assert_eq!(strays(&points).places, [] as [u32; 0], "{count} and one at 20");
        let growing: Vec<[f64; 3]> = (0..count as i32).map(|i| [2f64.powi(i), 0.0, 0.0]).collect();
        assert_eq!(strays(&growing).places, [] as [u32; 0], "{count} that grow");
    }
}
