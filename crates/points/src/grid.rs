//! Where the uniform grid lies and how fine it is (\[T\] §5).
//!
//! Plain data, made from the trust balls of the fitted points. The paper gives 20³ cells for 35 000
//! points; measurement (docs/benchmarks.md) puts the best edge at two to three trust radii, which
//! is a little finer, and with even points is the same rule: it follows their number.

use kernels::layout::{FitOutcome, GridInfo, Point};
use rayon::prelude::*;

/// Radius that the grid lists a point with, over its trust radius: rounding then loses no cell that a
/// hit lies in.
pub const BALL_MARGIN: f32 = 1.0001;

/// Edge of a cell over the median trust radius.
const EDGE_PER_TRUST: f64 = 2.5;
/// Cells a point, at most: 8 bytes each.
const CELLS_PER_POINT: f64 = 8.0;
/// Pairs of cell and point a point, at most, before the exact test; even sets have about six.
const PAIRS_PER_POINT: f64 = 48.0;
/// Few points may still have this many cells and pairs.
const ALWAYS_ALLOWED: f64 = 65_536.0;
/// Neither cells (8 bytes) nor pairs (4 bytes) may outgrow one binding of 128 MiB, whatever the number of points.
const CELLS_ALLOWED: f64 = 16_000_000.0;
const PAIRS_ALLOWED: f64 = 32_000_000.0;

const EMPTY: GridInfo =
    GridInfo { origin: [-0.5; 3], edge: 1.0, resolution: [1; 3], inverse_edge: 1.0 };

/// The grid over all trust balls; a single empty cell where no point carries a surface.
///
/// `resolution` is the number of cells along the longest axis, or 0: chosen from the points. Either
/// way the edge grows until cells and pairs stay within bounds.
#[must_use]
pub fn plan_grid(points: &[Point], outcomes: &[FitOutcome], resolution: u32) -> GridInfo {
    let balls: Vec<([f64; 3], f64)> = points
        .par_iter()
        .zip(outcomes)
        .with_min_len(1 << 14)
        .filter(|(_, outcome)| outcome.trust > 0.0)
        .map(|(point, outcome)| (point.position.map(f64::from), f64::from(outcome.trust)))
        .collect();
    let mut radii: Vec<f64> = balls.iter().map(|ball| ball.1).collect();
    if radii.is_empty() {
        return EMPTY;
    }
    let half = radii.len() / 2;
    let median = *radii.select_nth_unstable_by(half, f64::total_cmp).1;
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for (center, radius) in &balls {
        for axis in 0..3 {
            low[axis] = low[axis].min(center[axis] - radius * 1.001);
            high[axis] = high[axis].max(center[axis] + radius * 1.001);
        }
    }
    let extent = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    let longest = extent[0].max(extent[1]).max(extent[2]);
    let mut edge = match resolution {
        0 => EDGE_PER_TRUST * median,
        cells => longest * 1.000_02 / f64::from(cells),
    };
    // A coordinate's rounding must stay small beside a cell.
    edge = edge.max(longest * 1e-5);
    let allowed =
        |per_point: f64, most: f64| (per_point * balls.len() as f64).clamp(ALWAYS_ALLOWED, most);
    while cell_count(extent, edge) > allowed(CELLS_PER_POINT, CELLS_ALLOWED)
        || pair_count(&balls, low, edge) > allowed(PAIRS_PER_POINT, PAIRS_ALLOWED)
    {
        edge *= 1.1;
        if edge > 2.0 * longest {
            break;
        }
    }
    GridInfo {
        origin: low.map(|x| x as f32),
        edge: edge as f32,
        resolution: extent.map(|length| cells_along(length, edge) as u32),
        inverse_edge: 1.0 / edge as f32,
    }
}

fn cells_along(length: f64, edge: f64) -> f64 {
    (length * 1.000_01 / edge).ceil().max(1.0)
}

fn cell_count(extent: [f64; 3], edge: f64) -> f64 {
    extent.iter().map(|&length| cells_along(length, edge)).product()
}

/// Cells around all balls, as `grid_count` counts them, up to rounding.
fn pair_count(balls: &[([f64; 3], f64)], low: [f64; 3], edge: f64) -> f64 {
    let cells = |(center, radius): &([f64; 3], f64)| -> f64 {
        (0..3)
            .map(|axis| {
                let from = ((center[axis] - radius - low[axis]) / edge).floor();
                ((center[axis] + radius - low[axis]) / edge).floor() - from + 1.0
            })
            .product()
    };
    // Whole numbers, so that their order does not matter.
    balls.par_iter().with_min_len(1 << 14).map(cells).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(balls: &[([f32; 3], f32)], resolution: u32) -> GridInfo {
        let points: Vec<Point> =
            balls.iter().map(|&(position, _)| Point { position, index: 0 }).collect();
        let outcomes: Vec<FitOutcome> = balls
            .iter()
            .map(|&(_, trust)| FitOutcome { trust, kind: 3, feature_size: trust })
            .collect();
        plan_grid(&points, &outcomes, resolution)
    }

    #[test]
    fn no_surface_one_empty_cell() {
        assert_eq!(plan(&[], 0), EMPTY);
        assert_eq!(plan(&[([0.0; 3], 0.0)], 0), EMPTY);
    }

    #[test]
    fn the_grid_holds_every_ball() {
        let balls = [([0.0, 0.0, 0.0], 1.0), ([10.0, 2.0, -3.0], 0.5), ([4.0, 4.0, 4.0], 0.25)];
        for resolution in [0, 1, 7, 100] {
            let grid = plan(&balls, resolution);
            for (center, trust) in balls {
                let inside = |axis: usize| {
                    let end = grid.origin[axis] + grid.edge * grid.resolution[axis] as f32;
                    grid.origin[axis] < center[axis] - trust && end > center[axis] + trust
                };
                assert!((0..3).all(inside), "{grid:?}");
            }
        }
        assert_eq!(plan(&balls, 7).resolution.iter().max(), Some(&7));
    }

    /// A far outlier with a huge ball must not fill memory with cells or pairs.
    #[test]
    fn outliers_make_the_grid_coarser_and_no_larger() {
        let mut balls: Vec<([f32; 3], f32)> = (0..10_000)
            .map(|i| ([(i % 100) as f32 * 0.01, (i / 100) as f32 * 0.01, 0.0], 0.02))
            .collect();
        balls.push(([1e6, 1e6, 1e6], 1e6));
        let grid = plan(&balls, 0);
        assert!(f64::from(grid.cell_count()) <= CELLS_PER_POINT * 10_001.0, "{grid:?}");
    }
}
