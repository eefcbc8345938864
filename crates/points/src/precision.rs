//! Whether the steps between numbers of 32 bits are coarse beside the distances of points.
//!
//! Steps of f32 grow with a number's size: 6e-5 at 1000, 0.5 at 4.6 million. Where they are more than a
//! hundredth of the distance to the nearest other point, surfaces show them as terraces. A few points spread
//! over the set are asked, each whether another one lies within a hundred of its own steps: that takes one look at
//! each point, and needs no spacing.

use rayon::prelude::*;

/// Steps that are coarse beside the distances of points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coarse {
    /// Median distance between numbers that follow each other in f32.
    pub step: f64,
    /// Median distance to the nearest other point, of points for which steps are coarse.
    pub spacing: f64,
}

/// Points that are asked: the bits of a word.
const ASKED: usize = 64;
/// Steps may be this part of a spacing.
const FINE: f64 = 0.01;
/// Positions within so many steps of each other are copies, unless there are more than a few of them.
const COPY: f64 = 2.0;
const FEW_COPIES: u32 = 8;
/// Points that a thread looks at together.
const PART: usize = 1 << 14;

/// The distance from `|value|` to the next number of f32. Infinite beyond f32's range.
#[must_use]
pub fn single_step(value: f64) -> f64 {
    let single = (value as f32).abs();
    if single >= f32::MAX {
        return f64::INFINITY;
    }
    f64::from(f32::from_bits(single.to_bits() + 1)) - f64::from(single)
}

/// Steps that are coarse for at least half of the points that are asked. `step_at` says how long a step of f32 is
/// at the position of this place in `positions`, in the same unit, and 0 where it rounds nothing.
///
/// Positions that are equal are one, and so are few that differ by a step or two: copies that were rounded otherwise.
/// `None` where steps are fine, or there is no second position.
#[must_use]
pub fn coarse(positions: &[[f64; 3]], step_at: impl Fn(usize) -> f64) -> Option<Coarse> {
    let stride = positions.len().div_ceil(ASKED).max(1);
    let asked = (0..positions.len()).step_by(stride).map(|i| (positions[i], step_at(i)));
    let asked: Vec<([f64; 3], f64)> = asked.collect();
    // The distance within which another point makes a step coarse.
    let reaches: Vec<f64> = asked.iter().map(|(_, step)| step / FINE).collect();
    if reaches.iter().filter(|&&reach| reach > 0.0).count() * 2 < asked.len() {
        return None;
    }
    let slabs = Slabs::new(&asked, &reaches);
    let none = || vec![Nearest::default(); asked.len()];
    let nearest = positions.par_chunks(PART).map(|part| {
        let mut nearest = none();
        for p in part {
            let mut near = slabs.near(p[0]);
            while near != 0 {
                let i = near.trailing_zeros() as usize;
                near &= near - 1;
                let (position, step) = &asked[i];
                nearest[i].see(distance(position, p), COPY * step);
            }
        }
        nearest
    });
    let nearest = nearest.reduce(none, |mut a, b| {
        a.iter_mut().zip(&b).for_each(|(a, b)| a.join(b));
        a
    });
    let is_coarse = |&i: &usize| nearest[i].is_within(reaches[i]);
    let found = (0..asked.len()).filter(is_coarse);
    let mut found: Vec<(f64, f64)> = found.map(|i| (nearest[i].of_all, asked[i].1)).collect();
    if found.is_empty() || found.len() * 2 < asked.len() {
        return None;
    }
    let half = found.len() / 2;
    found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let spacing = found[half].0;
    found.sort_unstable_by(|a, b| a.1.total_cmp(&b.1));
    Some(Coarse { step: found[half].1, spacing })
}

/// The same for the rounding of `position(i)`, which is in the unit of `positions` times `scale`, to f32: 0 where
/// hardly any of the points that are asked is rounded, such as those of a lattice of whole numbers.
#[must_use]
pub fn coarse_rounding(
    positions: &[[f64; 3]],
    scale: f64,
    position: impl Fn(usize) -> [f64; 3],
) -> Option<Coarse> {
    // What f64 rounds of sums is less.
    const ROUNDED: f64 = 1e-6;
    let stride = positions.len().div_ceil(ASKED).max(1);
    let largest_step = |i: usize| position(i).map(single_step).into_iter().fold(0.0, f64::max);
    let is_moved = |i: &usize| {
        let limit = ROUNDED * largest_step(*i);
        position(*i).iter().any(|&x| (f64::from(x as f32) - x).abs() > limit)
    };
    let asked = || (0..positions.len()).step_by(stride);
    if asked().filter(is_moved).count() * 10 < asked().count() {
        return None;
    }
    let coarse = coarse(positions, |i| largest_step(i) / scale)?;
    Some(Coarse { step: coarse.step * scale, spacing: coarse.spacing * scale })
}

/// Axes along which a file's numbers are those of f32 and use its last digit, which shows that they were
/// rounded to it.
#[must_use]
pub fn single_axes(positions: &[[f64; 3]]) -> [bool; 3] {
    let stride = positions.len().div_ceil(ASKED).max(1);
    let asked: Vec<&[f64; 3]> = positions.iter().step_by(stride).collect();
    [0, 1, 2].map(|axis| {
        let values = || asked.iter().map(|p| p[axis]);
        let odd = values().filter(|&value| (value as f32).to_bits() & 1 == 1).count();
        values().all(|value| f64::from(value as f32) == value)
            && values().any(|value| Some(value) != values().next())
            && odd * 10 >= asked.len()
    })
}

/// What is nearest to a point.
#[derive(Clone)]
struct Nearest {
    /// Distance to the nearest position that is not the same.
    of_all: f64,
    /// To the nearest that is no copy.
    of_others: f64,
    /// How many copies there are.
    copies: u32,
}

impl Default for Nearest {
    fn default() -> Self {
        Self { of_all: f64::INFINITY, of_others: f64::INFINITY, copies: 0 }
    }
}

impl Nearest {
    /// A copy is within `as_copy`.
    fn see(&mut self, distance: f64, as_copy: f64) {
        if distance > 0.0 {
            self.of_all = self.of_all.min(distance);
            match distance > as_copy {
                true => self.of_others = self.of_others.min(distance),
                false => self.copies += 1,
            }
        }
    }

    fn join(&mut self, other: &Self) {
        self.of_all = self.of_all.min(other.of_all);
        self.of_others = self.of_others.min(other.of_others);
        self.copies += other.copies;
    }

    fn is_within(&self, reach: f64) -> bool {
        let of = if self.copies > FEW_COPIES { self.of_all } else { self.of_others };
        of < reach
    }
}

/// Which of the points that are asked may have another one at this x within their reach.
struct Slabs {
    /// Ends of reaches, ascending.
    ends: Vec<f64>,
    /// From each end to the next, the points as bits.
    near: Vec<u64>,
}

impl Slabs {
    fn new(asked: &[([f64; 3], f64)], reaches: &[f64]) -> Self {
        let ranges: Vec<[f64; 2]> = (asked.iter().zip(reaches))
            // An ulp more, for what the sums round.
            .map(|((p, _), reach)| [(p[0] - reach).next_down(), (p[0] + reach).next_up()])
            .collect();
        let mut ends: Vec<f64> = ranges.iter().flatten().copied().collect();
        ends.sort_unstable_by(f64::total_cmp);
        let bits = |end: &f64| {
            let inside = (0..).zip(&ranges).filter(|(_, [low, high])| low <= end && end <= high);
            inside.fold(0, |bits, (i, _)| bits | 1u64 << i)
        };
        let near = ends.iter().map(bits).collect();
        Self { ends, near }
    }

    fn near(&self, x: f64) -> u64 {
        match self.ends.partition_point(|&end| end <= x) {
            0 => 0,
            after => self.near[after - 1],
        }
    }
}

/// Squares of numbers from 1e-150 to 1e150 are numbers.
fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|axis| b[axis] - a[axis]);
    (x * x + y * y + z * z).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Even points of a sphere of this radius about a centre.
    fn ball(count: u32, radius: f64, center: [f64; 3]) -> Vec<[f64; 3]> {
        let lattice = |i: u32| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let (sin, cos) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
            let r = (1.0 - z * z).sqrt();
            [center[0] + radius * r * cos, center[1] + radius * r * sin, center[2] + radius * z]
        };
        (0..count).map(lattice).collect()
    }

    fn rounding(positions: &[[f64; 3]], origin: [f64; 3]) -> Option<Coarse> {
        coarse_rounding(positions, 1.0, |i| [0, 1, 2].map(|axis| positions[i][axis] - origin[axis]))
    }

    #[test]
    fn a_step_is_the_distance_to_the_next_number() {
        assert_eq!(single_step(1.0), 2f64.powi(-23));
        assert_eq!(single_step(-4.6e6), 0.5);
        assert_eq!(single_step(1000.0), 2f64.powi(-14));
        assert_eq!(single_step(0.0), 2f64.powi(-149));
        assert_eq!(single_step(1e39), f64::INFINITY);
    }

    /// 20 000 points of a unit sphere are 0.02 apart or a little more: steps are fine up to 2e-4, which f32 has at
    /// about 2000.
    #[test]
    fn a_distance_of_a_hundred_steps_is_the_limit_at_any_scale() {
        for exponent in (-12..=15).step_by(3) {
            let unit = 10f64.powi(exponent);
            let at =
                |offset: f64| rounding(&ball(20_000, unit, [offset * unit, 0.0, 0.0]), [0.0; 3]);
            for fine in [0.0, 100.0, 700.0] {
                assert_eq!(at(fine), None, "{fine} of 1e{exponent}");
            }
            for poor in [5e3, 1e5, 1e7] {
                let found = at(poor).unwrap_or_else(|| panic!("{poor} of 1e{exponent}"));
                assert!((0.015..0.03).contains(&(found.spacing / unit)), "{found:?}");
                assert_eq!(found.step, single_step(poor * unit), "{poor} of 1e{exponent}");
            }
        }
    }

    #[test]
    fn strays_and_copies_decide_nothing() {
        let mut positions = ball(20_000, 1.0, [0.0; 3]);
        positions[7] = [1e9, 0.0, 0.0];
        assert_eq!(rounding(&positions, [0.0; 3]), None);
        // From the stray's side, all others are far.
        assert!(rounding(&positions, [5e8, 0.0, 0.0]).is_some());
        let copies: Vec<[f64; 3]> = positions.iter().flat_map(|&p| [p; 8]).collect();
        assert_eq!(rounding(&copies, [0.0; 3]), None);
        assert!(rounding(&copies, [1e6, 0.0, 0.0]).is_some());
        // What another program rounded otherwise is a copy as well.
        let nearly: Vec<[f64; 3]> =
            positions.iter().flat_map(|&p| [p, p.map(|x| x + 1e-9), p.map(|x| x - 2e-9)]).collect();
        assert_eq!(rounding(&nearly, [0.0; 3]), None);
        assert!(rounding(&nearly, [1e6, 0.0, 0.0]).is_some());
        for few in [&positions[..0], &positions[..1], &[positions[0]; 9]] {
            assert_eq!(rounding(few, [1e6, 0.0, 0.0]), None);
        }
    }

    /// Half of the points in a dense ball here, half in one there: the box is no measure.
    #[test]
    fn two_dense_parts_far_apart_are_coarse() {
        let mut positions = ball(10_000, 1.0, [0.0; 3]);
        positions.extend(ball(10_000, 1.0, [1e5, 0.0, 0.0]));
        assert!(rounding(&positions, [5e4, 0.0, 0.0]).is_some());
    }

    #[test]
    fn numbers_that_f32_holds_are_not_rounded() {
        let lattice: Vec<[f64; 3]> =
            (0..10_000).map(|i| [4e6 + f64::from(i % 100), f64::from(i / 100), 0.0]).collect();
        assert_eq!(rounding(&lattice, [0.0; 3]), None);
    }

    #[test]
    fn the_scale_is_that_of_the_positions_that_are_rounded() {
        let positions = ball(20_000, 1.0, [0.0; 3]);
        let placed = |i: usize| positions[i].map(|x| 50.0 * x + 1e6);
        let found = coarse_rounding(&positions, 50.0, placed).expect("coarse");
        assert_eq!(found.step, 0.0625);
        assert!((0.75..1.5).contains(&found.spacing), "{found:?}");
    }

    #[test]
    fn numbers_rounded_to_f32_show_it() {
        let exact = ball(1000, 5.0, [5e5, 4.6e6, 200.0]);
        assert_eq!(single_axes(&exact), [false; 3]);
        let rounded: Vec<[f64; 3]> = exact.iter().map(|p| p.map(|x| f64::from(x as f32))).collect();
        assert_eq!(single_axes(&rounded), [true; 3]);
        let whole: Vec<[f64; 3]> = exact.iter().map(|p| p.map(f64::round)).collect();
        assert_eq!(single_axes(&whole), [false; 3], "whole numbers below 2^23 have fractions left");
        let plane: Vec<[f64; 3]> = rounded.iter().map(|p| [p[0], 4_600_000.5, p[2]]).collect();
        assert_eq!(single_axes(&plane), [true, false, true], "one number shows nothing");
        assert_eq!(single_axes(&[]), [false; 3]);
    }
}
