//! What the median distance is where it is known, and by looking at all pairs.

use super::*;

fn random(i: u32) -> f64 {
    // SplitMix64.
    let mixed = (u64::from(i) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((mixed ^ mixed >> 31) >> 11) as f64 / 9_007_199_254_740_992.0
}

fn cloud(count: u32) -> Vec<[f64; 3]> {
    (0..count).map(|i| [100.0 * random(3 * i), random(3 * i + 1), random(3 * i + 2)]).collect()
}

/// Every pair looked at.
fn brute(positions: &[[f64; 3]]) -> f64 {
    let mut positions = positions.to_vec();
    positions.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap());
    positions.dedup();
    let nearest = |p: &[f64; 3]| {
        let others = positions.iter().filter(|other| *other != p);
        others.map(|other| distance(p, other)).fold(f64::INFINITY, f64::min)
    };
    let mut distances: Vec<f64> = positions.iter().map(nearest).collect();
    distances.sort_unstable_by(f64::total_cmp);
    let half = distances.len() / 2;
    if distances.len() % 2 == 1 {
        distances[half]
    } else {
        0.5 * distances[half - 1] + 0.5 * distances[half]
    }
}

/// A sphere's points at all scales, moved as far as f64 still tells them apart to a thousandth, with nothing, one
/// stray or a few.
#[test]
fn the_spacing_is_right_at_every_scale_and_whatever_strays() {
    let sphere: Vec<[f64; 3]> = (0..2001)
        .map(|i| {
            let (z, turn) =
                (f64::from(2 * i + 1) / 2001.0 - 1.0, 2.399_963_229_728_653 * f64::from(i));
            let radius = (1.0 - z * z).sqrt();
            [radius * turn.cos(), radius * turn.sin(), z]
        })
        .collect();
    let expected = brute(&sphere);
    for exponent in [-300, -150, -40, -12, -6, 0, 3, 9, 12, 15, 30, 150, 300] {
        let scale = 10f64.powi(exponent);
        for offset in [0.0, 1e3, 1e7] {
            let moved = |p: &[f64; 3]| p.map(|x| scale * (x + offset));
            let mut points: Vec<[f64; 3]> = sphere.iter().map(moved).collect();
            for stray in [0.0, 1e9, -1e30, 1e300] {
                points.push([stray, stray, -stray]);
                // Half a step of f64 at the offset for either point; strays move the median by a few ranks.
                let found = median_spacing(&points).unwrap();
                let error = (found / (scale * expected) - 1.0).abs();
                let bound = 1e-9 + offset * f64::EPSILON / expected + 0.004;
                assert!(error < bound, "1e{exponent}, {offset}, {stray}: {found}, off by {error}");
            }
        }
    }
}

#[test]
fn all_positions_up_to_the_sample_are_looked_at() {
    for count in [2, 3, 9, 17, 1000, 1001] {
        let points = cloud(count);
        assert_eq!(median_spacing(&points), Some(brute(&points)), "{count}");
    }
}

/// Half of the places twelve times: they count once like all others.
#[test]
fn coincident_points_are_one_position() {
    let once = cloud(1000);
    let mut points = once.clone();
    for _ in 0..11 {
        points.extend_from_slice(&once[..500]);
    }
    assert_eq!(median_spacing(&points), median_spacing(&once));
    assert_eq!(median_spacing(&[[1.0, 0.0, -2.0]; 50]), None);
    assert_eq!((median_spacing(&[[1.0; 3]]), median_spacing(&[])), (None, None));
    assert_eq!(median_spacing(&[[0.0; 3], [-0.0, 0.0, 0.0], [0.0, 0.0, 5.0]]), Some(5.0));
    assert_eq!(median_spacing(&[[0.0; 3], [5e-324, 0.0, 0.0]]), Some(5e-324));
}

/// The distances of a sample's positions are those among all points: not one of them is missed.
#[test]
fn the_neighbours_of_a_sample_are_found_among_all_points() {
    // More positions than are sampled, of a density that varies a thousandfold, in survey coordinates, and strays.
    let mut points: Vec<[f64; 3]> = (0..300_000)
        .map(|i| {
            let r = 100.0 * random(3 * i).powi(3);
            let turn = std::f64::consts::TAU * random(3 * i + 1);
            [4.9e6 + r * turn.cos(), 6e5 + r * turn.sin(), 0.01 * random(3 * i + 2)]
        })
        .collect();
    points.extend([[0.0; 3], [1e15, 0.0, 0.0], [1e30, -1e30, 0.0]]);
    let mut distinct = Distinct::new();
    points.iter().for_each(|point| distinct.see(point));
    assert!(!distinct.sample_is_whole());
    let mut nearest = Nearest::new(distinct);
    points.iter().for_each(|point| nearest.see(point));
    let tree = Tree::new(points.clone());
    let (centres, distances) = (nearest.balls.centres().to_vec(), nearest.balls.into_distances());
    assert_eq!(centres.len(), QUERIES);
    assert_eq!(distances, tree.distances(&centres));

    // The median of the sample is off by 1.25 / sqrt(QUERIES) = 1.4 % of the spread of the distances, which is twice their median
    // here: three times that.
    let mut all = tree.distances(&points);
    let (_, &mut expected, _) = all.select_nth_unstable_by(points.len() / 2, f64::total_cmp);
    let found = median_spacing(&points).unwrap();
    assert!((found / expected - 1.0).abs() < 0.08, "{found}, not {expected}");
}
