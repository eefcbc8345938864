//! What is computed in parallel does not depend on how many threads there are, and skips only what is equal.

use super::*;

/// The same numbers everywhere, between -1 and 1.
fn noise(count: usize, seed: u32) -> Vec<f32> {
    let mut state = seed;
    let next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    std::iter::repeat_with(next).take(count).collect()
}

/// Several blocks of rows, and tiles that end inside of the picture's borders.
const SIZE: [u32; 2] = [700, 300];

fn pair() -> Pair {
    let count = (SIZE[0] * SIZE[1]) as usize;
    let planes = |seed: u32, also: f32| -> Vec<(&str, Vec<f32>)> {
        let plane = |channel: u32| -> Vec<f32> {
            let own = noise(count, 7 + channel);
            let other = noise(count, seed + channel);
            own.iter().zip(other).map(|(a, b)| 0.5 + 0.3 * a + also * b).collect()
        };
        vec![("R", plane(0)), ("G", plane(1)), ("B", plane(2))]
    };
    Pair::new(picture(SIZE, &planes(7, 0.0)), picture(SIZE, &planes(90, 1e-3))).unwrap()
}

#[test]
fn measures_and_flip_do_not_depend_on_the_number_of_threads() {
    let pair = pair();
    let colors = ["R", "G", "B"].map(str::to_owned);
    let region = pair.region(&["R"]).unwrap();
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| (pair.measure(&["R", "G", "B"], region), pair.flip(&colors, region)))
    };
    let one = of(1);
    assert!(one.0.differing > 600_000 && one.1.0.mean > 0.0, "{:?}", one.0);
    for threads in [2, 3, 8] {
        assert!(of(threads) == one, "{threads} threads");
    }
}

/// Sums of differences in the order of the file, in f64, as they were before blocks: rounding differs in the last
/// digits, 1e-16 of each of the 210 000 values at most.
#[test]
fn measures_are_those_of_one_look_after_the_other() {
    let pair = pair();
    let region = pair.region(&["R"]).unwrap();
    let [a, b] = pair.planes("R").map(|plane| plane.values(region).collect::<Vec<f64>>());
    let mut all: Vec<f64> = a.iter().zip(&b).map(|(a, b)| difference(*a, *b)).collect();
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    let rmse = (all.iter().map(|d| d * d).sum::<f64>() / all.len() as f64).sqrt();
    let found = pair.measure(&["R"], region);
    assert!((found.mean / mean - 1.0).abs() < 1e-11, "{} against {mean}", found.mean);
    assert!((found.rmse / rmse - 1.0).abs() < 1e-11, "{} against {rmse}", found.rmse);
    let at = all.iter().position(|d| *d == found.max_abs).unwrap() as i64;
    assert_eq!([found.worst.x, found.worst.y], [at % 700, at / 700], "the first of the largest");
    all.sort_unstable_by(f64::total_cmp);
    let ranks = [0.5, 0.95, 0.99].map(|part: f64| (part * all.len() as f64).ceil() as usize - 1);
    assert_eq!(found.percentiles, ranks.map(|rank| all[rank]), "exact, of 210 000 values");
    assert_eq!(found.max_abs, all[all.len() - 1]);
}

/// A change of one pixel is seen as far as filters reach, also across borders of tiles, and not beyond.
#[test]
fn tiles_that_are_the_same_are_0_and_others_are_as_in_a_picture_without_tiles() {
    let size = SIZE.map(|side| side as usize);
    let count = size[0] * size[1];
    let grey: Vec<[f32; 3]> = noise(count, 5).iter().map(|v| [0.5 + 0.2 * v; 3]).collect();
    let place = |x: usize, y: usize| y * size[0] + x;
    for (x, y) in [(127, 127), (128, 128), (0, 0), (699, 299), (390, 131)] {
        let mut changed = grey.clone();
        changed[place(x, y)] = [1.0, 0.0, 0.0];
        let map = flip_ldr(&grey, &changed, size);
        // The same pixels around the change as a picture of its own, whose borders are farther away than filters
        // reach, or the same.
        let [left, top] = [x.saturating_sub(40), y.saturating_sub(40)];
        let [right, bottom] = [(x + 41).min(size[0]), (y + 41).min(size[1])];
        let part = |pixels: &[[f32; 3]]| -> Vec<[f32; 3]> {
            (top..bottom).flat_map(|y| pixels[place(left, y)..place(right, y)].to_vec()).collect()
        };
        let alone = flip_ldr(&part(&grey), &part(&changed), [right - left, bottom - top]);
        for row in top..bottom {
            for column in left..right {
                let inside = [row.abs_diff(y), column.abs_diff(x)].iter().all(|away| *away <= 20);
                let found = map[place(column, row)];
                let expected = alone[(row - top) * (right - left) + column - left];
                if inside {
                    assert_eq!(found, expected, "{column},{row} around {x},{y}");
                } else {
                    assert_eq!(found, 0.0, "{column},{row} around {x},{y}");
                }
            }
        }
        let seen = map.iter().filter(|value| **value > 0.0).count();
        assert!(
            (50..=441).contains(&seen),
            "{seen} pixels around {x},{y}: filters reach 10 pixels"
        );
    }
}

#[test]
fn a_picture_over_itself_differs_by_nothing() {
    let planes = [("R", vec![0.25, f32::NAN]), ("G", vec![0.5; 2]), ("B", vec![3.0; 2])];
    let pair = Pair::same(picture([2, 1], &planes)).unwrap();
    let m = pair.measure(&["R", "G", "B"], whole(2, 1));
    assert_eq!((m.max_abs, m.differing, m.nan, m.peak, m.values), (0.0, 0, 0, 3.0, 6));
    assert_eq!((m.worst.x, m.worst.y, m.worst.a), (0, 0, 0.25));
    assert!(pair.tally("R", whole(2, 1)).is_equal());
}
