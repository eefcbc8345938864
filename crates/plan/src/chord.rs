//! How deep a volume is, optically: what `extinction = "auto"` scales its transfer function by.
//!
//! The depth is measured along lines through the box around the object's bulk, parallel to the three axes and as dense
//! along each. Their median, each line with the area that it stands for, is that of a ray through the volume from anywhere:
//! the one in the middle of all chords, which in a ball is √2 of its radius long. Everything scales with the scene, so a
//! picture does not depend on its unit.

use crate::{Volumes, field};
use kernels::layout::VolumeInfo;
use rayon::prelude::*;

/// Optical depth across the median chord.
const DEPTH: f64 = 2.0;
/// Lines along the longer side of a face of the box.
const LINES: usize = 24;
/// Samples along the longest line.
const MOST_SAMPLES: f64 = 512.0;
/// Of the deepest line: what is less deep passes the volume by.
const LEAST: f64 = 0.01;

/// What all extinctions of a volume, which is listed in `volumes`, have to be multiplied by; `None` where nothing has any.
/// `bounds` is the box around the object's bulk, in the space of the volume's points.
pub(crate) fn factor(volumes: &Volumes, info: &VolumeInfo, bounds: [[f64; 3]; 2]) -> Option<f64> {
    let mut depths: Vec<(f64, f64)> = (0..3)
        .flat_map(|axis| lines(bounds, axis))
        .par_bridge()
        .map(|line| (line.depth(volumes, info, bounds), line.area))
        .collect();
    depths.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let deepest = depths.last()?.0;
    if !(deepest > 0.0 && deepest.is_finite()) {
        return None;
    }
    let crossing = || depths.iter().filter(|(depth, _)| *depth >= LEAST * deepest);
    let half = 0.5 * crossing().map(|(_, area)| area).sum::<f64>();
    let mut below = 0.0;
    let median = crossing().find(|(_, area)| {
        below += area;
        below >= half
    });
    median.map(|(depth, _)| DEPTH / depth)
}

/// A line along an axis.
struct Line {
    axis: usize,
    /// Where it passes; what this has along the axis means nothing.
    at: [f64; 3],
    /// Of the face that it stands for.
    area: f64,
}

/// Evenly spaced over a face of the box, in the middles of rectangles.
fn lines([low, high]: [[f64; 3]; 2], axis: usize) -> Vec<Line> {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let sides = [u, v].map(|side| high[side] - low[side]);
    let longer = sides[0].max(sides[1]);
    // Flat faces have lines as well, of no area: only if all are flat do they count.
    let counts = sides.map(|side| match longer > 0.0 {
        true => (LINES as f64 * side / longer).ceil().max(1.0) as usize,
        false => 1,
    });
    let least = 1e-9 * (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    let steps = [0, 1].map(|i| sides[i] / counts[i] as f64);
    let area = steps[0].max(least) * steps[1].max(least);
    let place = |i: usize, j: usize| {
        let mut at = [0.0; 3];
        at[u] = low[u] + (i as f64 + 0.5) * steps[0];
        at[v] = low[v] + (j as f64 + 0.5) * steps[1];
        Line { axis, at, area }
    };
    (0..counts[0])
        .flat_map(|i| (0..counts[1]).map(move |j| (i, j)))
        .map(|(i, j)| place(i, j))
        .collect()
}

impl Line {
    /// Σ σ·step, in steps of a quarter of a point's reach where these are not too many; where points have reaches of their
    /// own, in as many as there may be.
    fn depth(&self, volumes: &Volumes, info: &VolumeInfo, [low, high]: [[f64; 3]; 2]) -> f64 {
        let radius = f64::from(info.square_radius).sqrt();
        let (from, to) = (low[self.axis] - radius, high[self.axis] + radius);
        let samples = match info.size_count {
            0 => ((to - from) / (0.25 * radius)).ceil().clamp(1.0, MOST_SAMPLES),
            _ => MOST_SAMPLES,
        };
        let step = (to - from) / samples;
        let mut x = self.at;
        (0..samples as usize)
            .map(|i| {
                x[self.axis] = from + (i as f64 + 0.5) * step;
                let scalar = field::at(volumes, info, x).map(|(scalar, _)| scalar);
                scalar.map_or(0.0, |scalar| extinction(volumes, info, scalar))
            })
            .sum::<f64>()
            * step
    }
}

/// The transfer function's extinction.
fn extinction(volumes: &Volumes, info: &VolumeInfo, scalar: f64) -> f64 {
    let first = info.first_stop as usize;
    let stops = &volumes.stops[first..first + info.stop_count as usize];
    let above = stops[1..].partition_point(|stop| f64::from(stop.value) <= scalar);
    let (from, to) = (&stops[above], &stops[(above + 1).min(stops.len() - 1)]);
    let span = f64::from(to.value) - f64::from(from.value);
    let part = match span > 0.0 {
        true => ((scalar - f64::from(from.value)) / span).clamp(0.0, 1.0),
        false => 0.0,
    };
    let [a, b] = [from, to].map(|stop| f64::from(stop.extinction));
    a + part * (b - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_as_dense_along_all_axes() {
        let bounds = [[0.0; 3], [24.0, 12.0, 1.0]];
        let counts = [0, 1, 2].map(|axis| lines(bounds, axis).len());
        assert_eq!(counts, [24 * 2, 24, 24 * 12]);
        for axis in 0..3 {
            let area: f64 = lines(bounds, axis).iter().map(|line| line.area).sum();
            let expected = 288.0 / bounds[1][axis];
            assert!((area - expected).abs() < 1e-9, "{axis}: {area}");
        }
        // A flat box is crossed from the one side that it has.
        let flat = [[0.0; 3], [2.0, 2.0, 0.0]];
        let area = |axis: usize| lines(flat, axis).iter().map(|line| line.area).sum::<f64>();
        assert!(area(2) > 3.99 && area(0) < 1e-6 && area(1) < 1e-6);
    }
}
