//! Numbers for how far values are apart.

use crate::picture::Rect;

/// The percentages for which [`Measures::percentiles`] has a value.
pub const PERCENTILES: [u32; 3] = [50, 95, 99];

/// How far two planes, or several pairs of planes together, are apart.
///
/// The difference of two values is |a − b|: 0 for equal infinities and for NaN on both sides, infinite
/// for NaN against a number and for anything finite against an infinity.
#[derive(Debug, Clone, PartialEq)]
pub struct Measures {
    /// How many pairs of values were compared.
    pub values: usize,
    /// How many of them differ.
    pub differing: usize,
    /// In how many of them one is NaN and the other is not.
    pub nan: usize,
    /// The largest difference.
    pub max_abs: f64,
    /// The mean of the differences.
    pub mean: f64,
    /// The root of the mean of their squares.
    pub rmse: f64,
    /// 20 log₁₀ (peak / rmse) in decibels: infinite for equal planes, minus infinity for an infinite
    /// difference.
    pub psnr: f64,
    /// 1, or the largest finite |value| of either plane if that is larger.
    pub peak: f64,
    /// For each of [`PERCENTILES`] the smallest difference that at least so many per cent do not
    /// exceed.
    pub percentiles: [f64; PERCENTILES.len()],
    /// Where the difference is largest: the first such place, row by row.
    pub worst: Worst,
}

/// A place with its two values.
#[derive(Debug, Clone, PartialEq)]
pub struct Worst {
    /// The channel.
    pub channel: String,
    /// Column, from the left edge of the display window.
    pub x: i64,
    /// Row, from its upper edge, downwards.
    pub y: i64,
    /// Value of the first picture.
    pub a: f64,
    /// Value of the second picture.
    pub b: f64,
}

/// The values of one channel, row by row.
pub(crate) struct Values<'a> {
    pub channel: &'a str,
    pub a: Vec<f64>,
    pub b: Vec<f64>,
}

/// The difference of two values, as [`Measures`] defines it.
#[must_use]
pub fn difference(a: f64, b: f64) -> f64 {
    match (a.is_nan(), b.is_nan()) {
        (true, true) => 0.0,
        (false, false) if a == b => 0.0,
        (false, false) => (a - b).abs(),
        _ => f64::INFINITY,
    }
}

impl Measures {
    /// Of at least one channel with at least one pixel.
    pub(crate) fn of<'a>(channels: impl Iterator<Item = Values<'a>>, region: Rect) -> Self {
        let mut differences = Vec::new();
        let (mut sum, mut squares, mut nan, mut peak) = (0.0, 0.0, 0, 1.0f64);
        let mut largest: Option<(f64, Worst)> = None;
        for Values { channel, a, b } in channels {
            for (place, (&a, &b)) in region.places().zip(a.iter().zip(&b)) {
                let d = difference(a, b);
                differences.push(d);
                sum += d;
                squares += d * d;
                nan += usize::from(a.is_nan() != b.is_nan());
                for value in [a, b].map(f64::abs).into_iter().filter(|value| value.is_finite()) {
                    peak = peak.max(value);
                }
                if largest.as_ref().is_none_or(|(most, _)| d > *most) {
                    let [x, y] = place;
                    largest = Some((d, Worst { channel: channel.to_owned(), x, y, a, b }));
                }
            }
        }
        let Some((max_abs, worst)) = largest else { unreachable!("compare: no value to measure") };
        let count = differences.len() as f64;
        let rmse = (squares / count).sqrt();
        Self {
            values: differences.len(),
            differing: differences.iter().filter(|d| **d > 0.0).count(),
            nan,
            max_abs,
            mean: sum / count,
            rmse,
            psnr: if rmse > 0.0 { 20.0 * (peak / rmse).log10() } else { f64::INFINITY },
            peak,
            percentiles: percentiles(&mut differences),
            worst,
        }
    }
}

/// For each of [`PERCENTILES`] the smallest of `values` that at least so many per cent do not exceed:
/// the nearest rank. There is at least one value, and none is NaN.
pub(crate) fn percentiles<T: Copy + PartialOrd>(values: &mut [T]) -> [T; PERCENTILES.len()] {
    PERCENTILES.map(|percent| {
        let rank = (values.len() * percent as usize).div_ceil(100).max(1) - 1;
        let order = |a: &T, b: &T| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal);
        *values.select_nth_unstable_by(rank, order).1
    })
}
