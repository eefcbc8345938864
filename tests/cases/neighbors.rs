//! The device finds the neighbours that the search on the host finds, ties included.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use harness::{Bench, fibonacci_sphere, grid_points, random, wavy_sheet};
use points::device::nearest_others;
use points::{Cloud, NeighborSearch, ObjectPoints};

/// Fails unless every list is the host's; returns how many points were left to it.
fn check(name: &str, objects: &[Vec<[f64; 3]>], k: u32) -> u64 {
    let indices: Vec<Vec<u32>> =
        objects.iter().map(|positions| (0..positions.len() as u32).collect()).collect();
    let objects: Vec<ObjectPoints<'_>> = (objects.iter().zip(&indices))
        .map(|(positions, file_index)| ObjectPoints::new(positions, file_index))
        .collect();
    let cloud = Cloud::new(&objects).expect("a cloud");
    let (lists, on_host) = Bench::open()
        .with_device(|device| nearest_others(device, &cloud, k).expect("lists of the device"));
    let k = k as usize;
    for object in &cloud.objects {
        let range = object.range();
        let search = NeighborSearch::new(&cloud.points[range.clone()], object.first_slot);
        let expected = search.nearest(0..range.len(), k);
        for (at, expected) in range.clone().zip(expected.chunks(k)) {
            let found = &lists[at * k..(at + 1) * k];
            assert_eq!(found, expected, "{name}: neighbours of the point in slot {at}, k = {k}");
        }
    }
    on_host
}

fn cloud_of(count: u32, seed: u64, scale: impl Fn(f64) -> f64) -> Vec<[f64; 3]> {
    let mut seed = seed;
    (0..count).map(|_| [0; 3].map(|_| scale(random(&mut seed)))).collect()
}

/// Even, random, on lattices where ties are the rule, and in one place; each for few and for many.
#[test]
fn lists_are_those_of_the_host_for_any_k() {
    let line = |way: [f64; 3]| (0..3_000).map(|i| way.map(|x| x * f64::from(i))).collect();
    let lattice = (0..9_261).map(|i| [i % 21, i / 21 % 21, i / 441].map(f64::from)).collect();
    let sets: Vec<(&str, Vec<[f64; 3]>)> = vec![
        ("sphere", fibonacci_sphere(20_000)),
        ("terrain", grid_points(150)),
        ("sheet", wavy_sheet(5_000)),
        ("lattice", lattice),
        ("volume", cloud_of(10_000, 1, |x| x)),
        ("axis", line([1.0, 0.0, 0.0])),
        ("slanted line", line([0.1, -0.37, 1.3])),
        ("pairs", fibonacci_sphere(2_000).into_iter().flat_map(|p| [p, p]).collect()),
        ("seven places", (0..4_000).map(|i| [f64::from(i % 7), 1.0, f64::from(i % 2)]).collect()),
    ];
    for (name, positions) in sets {
        for k in [1, 3, 8, 16, 17, 64, 65, 256] {
            let on_host = check(name, std::slice::from_ref(&positions), k);
            assert!(k <= 64 || on_host == positions.len() as u64, "{name}: {on_host} at k = {k}");
        }
    }
}

/// Densities over eight orders of magnitude.
#[test]
fn uneven_sets_are_searched_on_the_device() {
    let sets = [
        ("cube root", cloud_of(20_000, 5, |x| x.powi(9))),
        ("exponential", cloud_of(20_000, 9, |x| (18.0 * (x - 1.0)).exp())),
    ];
    for (name, positions) in sets {
        let count = positions.len() as u64;
        for k in [16, 40] {
            let on_host = check(name, std::slice::from_ref(&positions), k);
            assert!(on_host <= count / 50, "{name}: {on_host} of {count} points left to the host");
        }
    }
}

/// A hundred thousand points in one place, of which any list holds the first of the file, and the same in
/// a scene with other points.
#[test]
fn points_in_one_place_cost_no_more_than_others() {
    let same = vec![[0.1, 0.2, 0.3]; 100_000];
    assert_eq!(check("one place", std::slice::from_ref(&same), 16), 0);
    let mut mixed = fibonacci_sphere(10_000);
    mixed.splice(3_000..3_000, same);
    mixed.extend(fibonacci_sphere(10_000));
    check("one place and a sphere", &[mixed], 16);
}

/// Points so far out that the others are one place of the curve, and their balls hold the whole set. At 10^6
/// f32 merges the others into few places, which leaves one point in a hundred to the host.
#[test]
fn outliers_leave_the_lists_of_others_as_they_are() {
    for far in [1e3, 1e6, 1e9] {
        let mut positions = fibonacci_sphere(30_000);
        positions.insert(11, [far, -far, 0.5 * far]);
        positions.push([-0.7 * far, far, far]);
        let on_host = check("outliers", &[positions], 16);
        assert!(on_host <= 300, "{far}: {on_host} points left to the host");
    }
}

/// Fewer points than neighbours are asked for cannot be: a plan asks for at most all others.
#[test]
fn few_points_and_several_objects_have_their_own_lists() {
    for count in 2..20u32 {
        let line: Vec<[f64; 3]> = (0..count).map(|i| [f64::from(i), 0.5, 0.0]).collect();
        check("few", &[line.clone(), fibonacci_sphere(count), line], count - 1);
    }
    check("one", &[vec![[1.0, 2.0, 3.0]]], 1);
    check("objects", &[fibonacci_sphere(3_001), wavy_sheet(777), grid_points(40)], 16);
}
