//! Brent's minimisation in one dimension with derivatives: Brent, *Algorithms for Minimization
//! without Derivatives* (1973), ch. 5, with the secant step of *Numerical Recipes*, 10.3.

/// Every other step at least halves the bracket or its secant step: 2⁻⁶⁴ of π/2 is below rounding.
const MAX_STEPS: usize = 128;
/// Values nearer than this, relative, differ by the rounding of a long sum: there the slopes decide.
/// Without them a minimum is found to √ε = 1e-8 only, since values are flat around it.
const VALUE_NOISE: f64 = 1e-13;

/// A point of a function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sample {
    pub(super) at: f64,
    pub(super) value: f64,
    pub(super) slope: f64,
}

impl Sample {
    fn is_better_than(&self, other: &Self) -> bool {
        let noise = VALUE_NOISE * self.value.abs().max(other.value.abs());
        if (self.value - other.value).abs() > noise {
            self.value < other.value
        } else {
            self.slope.abs() <= other.slope.abs()
        }
    }

    /// From here to where the line through two slopes is zero.
    fn secant_step(&self, other: &Self) -> Option<f64> {
        (self.slope != other.slope)
            .then(|| (other.at - self.at) * self.slope / (self.slope - other.slope))
    }
}

/// The minimum of f on [`low`, `high`] next to `start`, to an absolute `tolerance` in the argument;
/// f gives value and slope. Where f falls up to an end, that end itself.
pub(super) fn minimise(
    f: impl Fn(f64) -> (f64, f64),
    [low, high]: [f64; 2],
    start: f64,
    tolerance: f64,
) -> Sample {
    let sample = |at: f64| {
        let (value, slope) = f(at);
        Sample { at, value, slope }
    };
    let (mut a, mut b) = (low, high);
    let mut x = sample(start.clamp(low, high));
    let (mut second, mut third) = (x, x);
    let (mut step, mut step_before) = (0.0f64, 0.0f64);
    for _ in 0..MAX_STEPS {
        let middle = 0.5 * (a + b);
        if (x.at - middle).abs() <= 2.0 * tolerance - 0.5 * (b - a) {
            break;
        }
        let inside_downhill = |d: &f64| (a - x.at - d) * (x.at + d - b) > 0.0 && x.slope * d <= 0.0;
        let secant = [&second, &third]
            .into_iter()
            .filter_map(|other| x.secant_step(other))
            .filter(inside_downhill)
            .min_by(|p, q| p.abs().total_cmp(&q.abs()))
            .filter(|d| step_before.abs() > tolerance && d.abs() <= 0.5 * step_before.abs());
        step_before = step;
        if let Some(d) = secant {
            let u = x.at + d;
            let beside_an_end = u - a < 2.0 * tolerance || b - u < 2.0 * tolerance;
            step = if beside_an_end { tolerance.copysign(middle - x.at) } else { d };
        } else {
            step_before = if x.slope >= 0.0 { a - x.at } else { b - x.at };
            step = 0.5 * step_before;
        }
        let smallest = step.abs() < tolerance;
        let d = if smallest { tolerance.copysign(step) } else { step };
        let u = sample((x.at + d).clamp(low, high));
        if u.is_better_than(&x) {
            *(if u.at >= x.at { &mut a } else { &mut b }) = x.at;
            (third, second, x) = (second, x, u);
        } else {
            if smallest {
                break;
            }
            *(if u.at < x.at { &mut a } else { &mut b }) = u.at;
            if u.is_better_than(&second) || second.at == x.at {
                (third, second) = (second, u);
            } else if u.is_better_than(&third) || third.at == x.at || third.at == second.at {
                third = u;
            }
        }
    }
    [low, high]
        .into_iter()
        .filter(|end| (x.at - end).abs() <= 4.0 * tolerance && x.at != *end)
        .map(sample)
        .find(|end| end.value < x.value)
        .unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: f64 = 1e-12;

    fn found(f: impl Fn(f64) -> (f64, f64), ends: [f64; 2], start: f64) -> f64 {
        minimise(f, ends, start, TOLERANCE).at
    }

    #[test]
    fn minima_of_known_functions_are_found() {
        let parabola = |x: f64| ((x - 0.3) * (x - 0.3) + 7.0, 2.0 * (x - 0.3));
        let cosine = |x: f64| (x.cos(), -x.sin());
        let gaussian = |x: f64| {
            let e = (-(x - 0.1) * (x - 0.1)).exp();
            (-e, 2.0 * (x - 0.1) * e)
        };
        // The slope of a quartic vanishes to third order: |slope| < 1e-31 says |x| < 3e-11.
        let quartic = |x: f64| (x.powi(4), 4.0 * x.powi(3));
        for start in [-0.9, -0.5, 0.0, 0.2, 0.5, 1.0] {
            for (name, at, expected, tolerance) in [
                ("parabola", found(parabola, [-1.0, 1.0], start), 0.3, 2.0 * TOLERANCE),
                ("cosine", found(cosine, [1.0, 5.0], 3.0 + start), std::f64::consts::PI, 2e-12),
                ("gaussian", found(gaussian, [-1.0, 1.0], start), 0.1, 2.0 * TOLERANCE),
                ("quartic", found(quartic, [-1.0, 1.3], start), 0.0, 1e-10),
            ] {
                assert!((at - expected).abs() <= tolerance, "{name} from {start}: {at}");
            }
        }
    }

    /// With values alone, 1 + x² cannot be told from 1 for |x| < 1e-8.
    #[test]
    fn slopes_place_a_minimum_where_values_are_flat() {
        let at = found(|x| (1.0 + (x - 0.2).powi(2), 2.0 * (x - 0.2)), [-0.5, 0.5], 0.0);
        assert!((at - 0.2).abs() <= 2.0 * TOLERANCE, "{:e}", at - 0.2);
    }

    #[test]
    fn a_function_that_falls_to_an_end_is_least_there() {
        for start in [-0.5, 0.0, 0.1, 0.5] {
            assert_eq!(found(|x| (x, 1.0), [-0.5, 0.5], start), -0.5);
            assert_eq!(found(|x| (-x, -1.0), [-0.5, 0.5], start), 0.5);
            let beyond = |x: f64| ((x - 0.7).powi(2), 2.0 * (x - 0.7));
            assert_eq!(found(beyond, [-0.5, 0.5], start), 0.5);
        }
    }

    #[test]
    fn what_is_not_a_number_ends() {
        let sample = minimise(|_| (f64::NAN, f64::NAN), [-0.5, 0.5], 0.0, TOLERANCE);
        assert!((-0.5..=0.5).contains(&sample.at));
    }
}
