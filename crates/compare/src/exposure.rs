//! The exposures at which HDR-FLIP looks at two pictures, and what it sees: Andersson et al. 2021, cited
//! as [H] in [`flip`](crate::flip_ldr)'s module.

use rayon::prelude::*;

/// Luminances below are taken for this, as in the authors' program: its median of black is not 0.
const DARKEST: f32 = f32::EPSILON;
/// The tone curve's value that bounds the exposures, [H] Section 3.
const BOUND: f64 = 0.85;
/// Numerator, then denominator of the tone curve: those of x², x and 1. Narkowicz's fit of ACES, whose
/// input is scaled by 0.6.
const CURVE: [[f64; 3]; 2] = [[0.36 * 2.51, 0.6 * 0.03, 0.0], [0.36 * 2.43, 0.6 * 0.59, 0.14]];

/// A series of exposures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Exposures {
    /// The first and the last, in stops.
    pub range: [f64; 2],
    /// How many, at equal steps.
    pub count: usize,
}

impl Exposures {
    /// From the one at which the brightest pixel of the reference is almost white to the one at which
    /// its median is. Where the reference is black, the test decides; where both are, there is one
    /// exposure. What is infinite or no number decides nothing.
    pub fn of(reference: &[[f32; 3]], test: &[[f32; 3]]) -> Self {
        let decided = [reference, test]
            .into_iter()
            .map(luminances)
            .find(|found| found.iter().any(|luminance| *luminance > 0.0));
        let Some(mut luminances) = decided else {
            return Self { range: [0.0; 2], count: 1 };
        };
        let middle = luminances.len() / 2;
        let median = luminances.select_nth_unstable_by(middle, f32::total_cmp).1.max(DARKEST);
        let brightest = luminances.iter().copied().fold(median, f32::max);
        let stops = |luminance: f32| (almost_white() / f64::from(luminance)).log2();
        let range = [stops(brightest), stops(median)];
        Self { range, count: ((range[1] - range[0]).ceil() as usize).max(2) }
    }

    /// Each exposure in stops.
    pub fn stops(self) -> impl Iterator<Item = f64> {
        let [first, last] = self.range;
        let steps = (self.count - 1).max(1) as f64;
        (0..self.count).map(move |i| first + (last - first) * i as f64 / steps)
    }
}

fn luminances(pixels: &[[f32; 3]]) -> Vec<f32> {
    let luminance = |[r, g, b]: &[f32; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
    pixels.par_iter().map(luminance).filter(|luminance| luminance.is_finite()).collect()
}

/// Where the tone curve is [`BOUND`]: the larger root of a quadratic.
fn almost_white() -> f64 {
    let [a, b, c] = [0, 1, 2].map(|i| CURVE[0][i] - BOUND * CURVE[1][i]);
    let half = -0.5 * b / a;
    half + (half * half - c / a).sqrt()
}

/// What a linear value times an exposure's factor becomes on the screen, still linear, 0 to 1. Negative values are
/// black.
#[inline(always)]
pub(crate) fn tone_mapped_by(c: f32, factor: f64) -> f32 {
    // f64 holds the square of any f32 at any of the exposures; what is infinite is white.
    let x = (f64::from(c).max(0.0) * factor).min(1e100);
    let [[a, b, c], [d, e, f]] = CURVE;
    (((a * x + b) * x + c) / ((d * x + e) * x + f)).clamp(0.0, 1.0) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tone_mapped(c: f32, stops: f64) -> f32 {
        tone_mapped_by(c, stops.exp2())
    }

    #[test]
    fn the_bound_is_a_value_of_the_curve() {
        assert!((f64::from(tone_mapped(almost_white() as f32, 0.0)) - BOUND).abs() < 1e-7);
        assert_eq!(tone_mapped(f32::INFINITY, -100.0), 1.0);
        assert_eq!(tone_mapped(-1.0, 3.0), 0.0);
        assert_eq!(tone_mapped(0.0, 300.0), 0.0);
    }

    /// The numbers are the exposures that the authors' program, version 1.7, reports for these
    /// pictures; it computes in f32.
    #[test]
    fn exposures_are_those_of_the_authors_program() {
        let pixels = |luminances: &[(f32, usize)]| -> Vec<[f32; 3]> {
            luminances.iter().flat_map(|&(l, count)| vec![[l; 3]; count]).collect()
        };
        for (reference, range, count) in [
            (pixels(&[(2.0, 8), (0.0, 24)]), [0.083_297_2, 24.083_297_7], 24),
            (pixels(&[(2.0, 8), (1e-9, 24)]), [0.083_297_2, 24.083_297_7], 24),
            (pixels(&[(1.0, 8), (4.0, 8)]), [-0.916_702_8, -0.916_702_8], 2),
            (pixels(&[(0.5, 9), (0.3, 23)]), [2.083_297_3, 2.820_262_7], 2),
        ] {
            let found = Exposures::of(&reference, &reference);
            assert_eq!(found.count, count, "{found:?}");
            for (found, expected) in found.range.into_iter().zip(range) {
                assert!((found - expected).abs() < 2e-6, "{found} against {expected}");
            }
        }
        let black = pixels(&[(0.0, 4)]);
        assert_eq!(Exposures::of(&black, &black).count, 1);
        let bright = pixels(&[(f32::MAX, 1), (0.0, 3)]);
        assert_eq!(Exposures::of(&black, &bright).count, 151, "128 + 23 stops, and no more");
        let infinite = pixels(&[(f32::INFINITY, 1), (0.5, 2), (0.3, 4)]);
        assert_eq!(Exposures::of(&infinite, &black).count, 2);
    }
}
