//! Eq. 3 in f64, each point measured at each place.

use crate::cells::Cells;
use crate::way::End;
use kernels::layout::VolumeInfo;

/// What rounding may move a point by, in cells.
const MARGIN: f64 = 1e-3;

/// The mean of the points in reach of x.
pub fn end_at(info: &VolumeInfo, cells: &Cells, x: [f64; 3]) -> End {
    let square_radius = f64::from(info.square_radius);
    let width = f64::from(info.inverse_width);
    let reach = square_radius.sqrt() * f64::from(cells.inverse_edge) + MARGIN;
    let mut range = [[0; 2]; 3];
    for i in 0..3 {
        let at = (x[i] - f64::from(cells.origin[i])) * f64::from(cells.inverse_edge);
        let last = cells.resolution[i] as f64 - 1.0;
        range[i] = [at - reach, at + reach].map(|edge| edge.clamp(0.0, last) as usize);
    }
    let [xs, ys, zs] = range;
    let (mut numerator, mut denominator) = (0.0, 0.0);
    for z in zs[0]..=zs[1] {
        for y in ys[0]..=ys[1] {
            let row = cells.resolution[0] * (y + cells.resolution[1] * z);
            let [a, b] = [cells.first[row + xs[0]], cells.first[row + xs[1] + 1]];
            for i in a as usize..b as usize {
                let off = [cells.x[i], cells.y[i], cells.z[i]];
                let square: f64 = (0..3).map(|k| (f64::from(off[k]) - x[k]).powi(2)).sum();
                if square <= square_radius {
                    let weight = (-square * width).exp();
                    numerator += weight * f64::from(cells.scalar[i]);
                    denominator += weight;
                }
            }
        }
    }
    if denominator > 0.0 { End::At(numerator / denominator) } else { End::Unreached }
}
