//! Diagnostics: what a render did at each pixel, as further channels of an EXR.
//!
//! They are computed here, on the CPU, from what the kernels write for every pixel anyway. So a
//! picture is the same with and without them, and device and reference cannot disagree about more
//! than what they wrote.

use kernels::layout::{FilmPixel, FitOutcome, Point};

/// What diagnostics of hits say where nothing was hit.
const NOTHING: f32 = -1.0;
/// The part of a pixel's last count that is for its iterations.
const ITERATIONS: u32 = 0xffff;

/// One diagnostic channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Diagnostic {
    /// Which point was hit.
    Point,
    /// Points tested.
    Tests,
    /// Borders between cells crossed.
    Cells,
    /// Iterations of the refinement.
    Iterations,
    /// How far out in its trust ball the hit lies.
    Trust,
    /// How the point's polynomial was fitted.
    Fit,
}

/// What diagnostics look up the point of a hit in, by slot.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fitted<'a> {
    pub points: &'a [Point],
    pub outcomes: &'a [FitOutcome],
}

impl Diagnostic {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 6] =
        [Self::Point, Self::Tests, Self::Cells, Self::Iterations, Self::Trust, Self::Fit];

    /// The channel's name, in files and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Tests => "tests",
            Self::Cells => "cells",
            Self::Iterations => "iterations",
            Self::Trust => "trust",
            Self::Fit => "fit",
        }
    }

    /// What its values mean, in half a sentence.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Point => "place in its file of the point that was hit, from 0, or -1",
            Self::Tests => "points that the pixel's rays were tested against",
            Self::Cells => "borders between grid cells that the pixel's rays crossed",
            Self::Iterations => "iterations of the refinement; 0 where hits are taken as they are",
            Self::Trust => {
                "distance of the hit from its point over the trust radius, 0 to 1, or -1"
            }
            Self::Fit => {
                "polynomial of the point that was hit: 1 plane, 2 incomplete, 3 full, or what else it is \
                 drawn as: 4 disc, 5 sphere, or -1"
            }
        }
    }

    /// The diagnostic of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|diagnostic| diagnostic.name() == name)
    }

    /// Its value at one pixel. Integers beyond 2²⁴ are rounded to the nearest float.
    pub(crate) fn value(self, pixel: &FilmPixel, fitted: Fitted<'_>) -> f32 {
        let [tests, cells, slot, packed] = pixel.counts;
        let of_hit = |value: fn(&FilmPixel, &Point, &FitOutcome) -> f32| {
            // A slot of NONE is beyond every list.
            let (point, outcome) =
                (fitted.points.get(slot as usize), fitted.outcomes.get(slot as usize));
            point.zip(outcome).map_or(NOTHING, |(point, outcome)| value(pixel, point, outcome))
        };
        match self {
            Self::Point => of_hit(|_, point, _| point.index as f32),
            Self::Tests => tests as f32,
            Self::Cells => cells as f32,
            Self::Iterations => (packed & ITERATIONS) as f32,
            Self::Trust => of_hit(trust_fraction),
            Self::Fit => of_hit(|_, _, outcome| outcome.kind as f32),
        }
    }
}

/// |x − p| / b. The hit lies within b, but its position was rounded since.
fn trust_fraction(pixel: &FilmPixel, point: &Point, outcome: &FitOutcome) -> f32 {
    let square: f64 = (0..3)
        .map(|axis| f64::from(pixel.position_depth[axis]) - f64::from(point.position[axis]))
        .map(|along| along * along)
        .sum();
    (square.sqrt() / f64::from(outcome.trust)).min(1.0) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::layout::{FIT_INCOMPLETE, NONE};

    const STANDARD: [&str; 12] =
        ["R", "G", "B", "A", "Z", "P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z", "object"];

    #[test]
    fn names_are_distinct_and_no_standard_channels() {
        for diagnostic in Diagnostic::ALL {
            assert_eq!(Diagnostic::named(diagnostic.name()), Some(diagnostic));
            assert!(!STANDARD.contains(&diagnostic.name()));
        }
        assert_eq!(Diagnostic::named("object"), None);
    }

    fn values(pixel: &FilmPixel) -> [f32; 6] {
        let points = [7, 16_777_217].map(|index| Point { position: [1.0, 2.0, 3.0], index });
        let outcomes = [FitOutcome { trust: 0.5, kind: FIT_INCOMPLETE, feature_size: 1.0 }; 2];
        let fitted = Fitted { points: &points, outcomes: &outcomes };
        Diagnostic::ALL.map(|diagnostic| diagnostic.value(pixel, fitted))
    }

    #[test]
    fn a_hit_says_which_point_and_where_in_its_trust_ball() {
        let mut pixel = FilmPixel {
            color: [0.0; 4],
            position_depth: [1.0, 2.0, 3.25, 9.0],
            normal_object: [0.0, 0.0, 1.0, 0.0],
            counts: [40, 5, 0, 0],
            alpha: [1.0; 3],
            along: 0.0,
        };
        assert_eq!(values(&pixel), [7.0, 40.0, 5.0, 0.0, 0.5, 2.0]);
        pixel.counts[2] = 1;
        assert_eq!(values(&pixel)[0], 16_777_216.0, "2^24 + 1 is no float");
        pixel.position_depth[2] = 3.500_000_2;
        assert_eq!(values(&pixel)[4], 1.0, "rounding does not leave the ball");
    }

    #[test]
    fn a_miss_has_counts_alone() {
        let pixel = FilmPixel {
            color: [0.0; 4],
            position_depth: [0.0, 0.0, 0.0, f32::INFINITY],
            normal_object: [0.0, 0.0, 0.0, -1.0],
            counts: [40, 5, NONE, 0],
            alpha: [0.0; 3],
            along: 0.0,
        };
        assert_eq!(values(&pixel), [-1.0, 40.0, 5.0, 0.0, -1.0, -1.0]);
    }
}
