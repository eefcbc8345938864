//! The reconstruction filter, as a table to draw places from.
//!
//! A pixel's samples are placed as the filter weighs, so that each counts alike (Ernst, Stamminger and
//! Greiner, Filter Importance Sampling, 2006): every pixel stands alone, whatever the filter's width.

use kernels::layout::FILTER_INTERVALS;
use scene::Filter;

/// The Gaussian's width over its standard deviation.
const GAUSSIAN_CUT: f64 = 6.0;
/// Steps of the integral within one interval of the table, at least: it errs by their square.
const STEPS: usize = 64 * FILTER_INTERVALS as usize;

/// Where the filter's integral takes equal steps along one axis, in pixels from the pixel's centre: the
/// inverse of its distribution function at i / `FILTER_INTERVALS`. `width` is that of the whole filter.
pub(crate) fn steps(filter: Filter, width: Option<f64>) -> Vec<f32> {
    let half = 0.5 * width.unwrap_or(default_width(filter));
    let weight = |x: f64| match filter {
        Filter::Box => 1.0,
        Filter::Triangle => 1.0 - x,
        Filter::Gaussian => (-0.5 * (0.5 * GAUSSIAN_CUT * x).powi(2)).exp(),
    };
    // Over the right half alone, x from 0 to 1, by the trapezoidal rule; the left is its mirror image.
    let step = 1.0 / STEPS as f64;
    let mut integral = vec![0.0];
    for i in 0..STEPS {
        let (a, b) = (weight(i as f64 * step), weight((i + 1) as f64 * step));
        integral.push(integral[i] + 0.5 * (a + b));
    }
    let intervals = FILTER_INTERVALS as usize;
    let total = integral[STEPS];
    let mut right = vec![0.0];
    let mut at = 0;
    for i in 1..=intervals / 2 {
        let wanted = total * i as f64 / (intervals / 2) as f64;
        while at + 1 < STEPS && integral[at + 1] < wanted {
            at += 1;
        }
        let within = (wanted - integral[at]) / (integral[at + 1] - integral[at]);
        right.push((half * (at as f64 + within.min(1.0)) * step) as f32);
    }
    right.iter().skip(1).rev().map(|x| -x).chain(right.iter().copied()).collect()
}

/// Pixels that the whole filter is wide.
fn default_width(filter: Filter) -> f64 {
    match filter {
        Filter::Box => 1.0,
        Filter::Triangle => 2.0,
        Filter::Gaussian => 3.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean of x² over the table, linear between its entries: (a² + ab + b²)/3 over an interval.
    fn variance(steps: &[f32]) -> f64 {
        let square = |ends: &[f32]| {
            let (a, b) = (f64::from(ends[0]), f64::from(ends[1]));
            (a * a + a * b + b * b) / 3.0
        };
        steps.windows(2).map(square).sum::<f64>() / f64::from(FILTER_INTERVALS)
    }

    #[test]
    fn filters_have_their_widths_and_variances() {
        // A Gaussian cut at 3 σ has the variance σ² (1 - 6 φ(3) / (2 Φ(3) - 1)).
        let cut = 1.0 - 6.0 * 0.004_431_848_411_938 / 0.997_300_203_936_74;
        for (filter, half, expected) in [
            (Filter::Box, 0.5, 1.0 / 12.0),
            (Filter::Triangle, 1.0, 1.0 / 6.0),
            (Filter::Gaussian, 1.5, 0.25 * cut),
        ] {
            let table = steps(filter, None);
            assert_eq!(table.len(), FILTER_INTERVALS as usize + 1);
            assert!((table[0] + half).abs() < 1e-6 && (table[1024] - half).abs() < 1e-6);
            assert_eq!(table[512], 0.0);
            assert!(table.windows(2).all(|pair| pair[0] < pair[1]), "{filter:?} ascends");
            assert!((0..=1024).all(|i| table[i] == -table[1024 - i]), "{filter:?} is even");
            // The table is linear within its last intervals, where the density falls.
            let found = variance(&table);
            assert!((found / expected - 1.0).abs() < 3e-4, "{filter:?}: {found}, {expected}");
            let wide = steps(filter, Some(8.0 * f64::from(half)));
            assert!((variance(&wide) / found - 16.0).abs() < 1e-4);
        }
        // Closed form of the triangle: 1 - sqrt(2 (1 - u)) for u of a half and more.
        let table = steps(Filter::Triangle, None);
        for (i, &place) in (0..).zip(&table[512..]) {
            let expected = 1.0 - (1.0 - f64::from(i) / 512.0).sqrt();
            assert!((f64::from(place) - expected).abs() < 1e-4, "{i}");
        }
    }
}
