//! Twin of `glsl/shared/gap.glsl`: how far a point's polynomial must reach to meet its neighbours'.

use crate::real::Real;

const UNBOUNDED: f64 = 1e6;
const GAP_MARGIN: f64 = 1.15;

/// Cosine and sine of every 15 degrees, as the kernel has them.
#[rustfmt::skip]
#[expect(clippy::approx_constant, reason = "the kernel's digits")]
const DIRECTIONS: [[f64; 2]; 24] = [
    [1.000000000, 0.0],
    [0.965925826, 0.258819045],
    [0.866025404, 0.500000000],
    [0.707106781, 0.707106781],
    [0.500000000, 0.866025404],
    [0.258819045, 0.965925826],
    [0.0, 1.000000000],
    [-0.258819045, 0.965925826],
    [-0.500000000, 0.866025404],
    [-0.707106781, 0.707106781],
    [-0.866025404, 0.500000000],
    [-0.965925826, 0.258819045],
    [-1.000000000, 0.0],
    [-0.965925826, -0.258819045],
    [-0.866025404, -0.500000000],
    [-0.707106781, -0.707106781],
    [-0.500000000, -0.866025404],
    [-0.258819045, -0.965925826],
    [0.0, -1.000000000],
    [0.258819045, -0.965925826],
    [0.500000000, -0.866025404],
    [0.707106781, -0.707106781],
    [0.866025404, -0.500000000],
    [0.965925826, -0.258819045],
];

/// How far a point's Voronoi cell reaches in 24 directions, in units of h. `neighbors` are places in
/// the tangent plane, in the same units.
pub fn cell_extents<R: Real>(neighbors: impl Iterator<Item = [R; 2]>) -> [R; 24] {
    let tiny = R::of(1e-6);
    let mut extents = [R::of(UNBOUNDED); 24];
    for q in neighbors {
        let half_square = R::of(0.5) * (q[0] * q[0] + q[1] * q[1]);
        for (extent, e) in extents.iter_mut().zip(DIRECTIONS) {
            let along = q[0] * R::of(e[0]) + q[1] * R::of(e[1]);
            if along > tiny {
                *extent = extent.min(half_square / along.max(tiny));
            }
        }
    }
    extents
}

/// The extent of the surface over such a cell, in units of h, with a margin: the farthest of the directions;
/// 0 where the cell is open or reaches beyond h, at a rim. Coefficients A B C E F D.
pub fn reach_needed<R: Real>(extents: &[R; 24], c: &[R; 6]) -> R {
    let zero = R::of(0.0);
    let mut square = zero;
    for (&extent, e) in extents.iter().zip(DIRECTIONS) {
        let (x, y) = (extent * R::of(e[0]), extent * R::of(e[1]));
        let g = c[0] * x * x + c[1] * y * y + c[2] * x * y + c[3] * x + c[4] * y + c[5];
        if extent > R::of(1.0) {
            return zero;
        }
        square = square.max(extent * extent + g * g);
    }
    R::of(GAP_MARGIN) * square.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Neighbours at (±1/2, 0) and (0, ±1/2): the cell is the square with corners at (±1/4, ±1/4).
    #[test]
    fn a_square_cell_reaches_to_its_corners() {
        let square = [[0.5, 0.0], [-0.5, 0.0], [0.0, 0.5], [0.0, -0.5]];
        let reach: f64 = reach_needed(&cell_extents(square.into_iter()), &[0.0; 6]);
        assert!((reach - 1.15 * 0.25 * 2f64.sqrt()).abs() < 1e-9, "{reach}");
    }

    /// Half a plane without neighbours is a rim: it asks for nothing.
    #[test]
    fn a_rim_is_no_gap() {
        let half: [[f64; 2]; 3] = [[-0.2, 0.0], [-0.15, 0.2], [-0.15, -0.2]];
        assert_eq!(reach_needed(&cell_extents(half.into_iter()), &[0.0; 6]), 0.0);
        assert_eq!(reach_needed(&cell_extents([].into_iter()), &[0.0f64; 6]), 0.0);
    }

    /// Lines of a scan: close along the line, far across.
    #[test]
    fn sparse_lines_ask_for_half_their_distance() {
        let lines = (-7..=7).filter(|i| *i != 0).map(|i| [f64::from(i) * 0.1, 0.0]);
        let across = [[0.0, 0.95], [0.0, -0.95]];
        let reach: f64 = reach_needed(&cell_extents(lines.chain(across)), &[0.0; 6]);
        assert!(reach > 1.15 * 0.475 && reach < 0.6, "{reach}");
    }
}
