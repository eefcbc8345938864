//! Twin of `glsl/shared/fit.glsl`: from normal equations to the polynomial in world form.

use crate::least_squares::NormalEquations;
use crate::polynomial::Polynomial;
use crate::real::{Real, V3};
use kernels::layout::{FIT_FULL, FIT_INCOMPLETE, FIT_NO_SURFACE, FIT_PLANE};

const MAX_SLOPE: f64 = 1.0;
const MAX_OFFSET: f64 = 0.3;
const MAX_CURVATURE: f64 = 2.0;
/// Middle eigenvalue of the covariance over the largest: under it, points lie on a line.
pub(crate) const COLLINEAR: f64 = 1e-6;

fn enough_points(kind: u32, distinct: u32) -> bool {
    let needed = match kind {
        FIT_FULL => 6,
        FIT_INCOMPLETE => 4,
        _ => 3,
    };
    distinct >= needed
}

/// Limits that stop spikes on scans; coefficients A B C E F D in units of h.
fn within_limits<R: Real>(c: &[R; 6]) -> bool {
    let mean = R::of(0.5) * (c[0] + c[1]);
    let half_difference = R::of(0.5) * (c[0] - c[1]);
    let spread = (half_difference * half_difference + R::of(0.25) * c[2] * c[2]).sqrt();
    mean.abs() + spread <= R::of(MAX_CURVATURE)
        && c[5].abs() <= R::of(MAX_OFFSET)
        && (c[3] * c[3] + c[4] * c[4]).sqrt() <= R::of(MAX_SLOPE)
}

/// Coefficients A B C E F D of the first kind, from `first` down, that is not singular, and that
/// kind.
#[must_use]
pub fn fit_coefficients<R: Real>(
    equations: &NormalEquations<R>,
    first: u32,
    distinct: u32,
) -> (u32, [R; 6]) {
    [FIT_FULL, FIT_INCOMPLETE, FIT_PLANE]
        .into_iter()
        .filter(|&kind| kind <= first)
        .find_map(|kind| {
            let (regular, solution) = equations.solve(kind);
            (regular && enough_points(kind, distinct) && within_limits(&solution))
                .then_some((kind, solution))
        })
        .unwrap_or((FIT_NO_SURFACE, [R::of(0.0); 6]))
}

/// The plane that a polynomial is a height field over.
#[derive(Debug, Clone, Copy)]
pub struct Frame<R> {
    /// Unit normal.
    pub n: V3<R>,
    /// First axis.
    pub u: V3<R>,
    /// Second axis: n × u.
    pub v: V3<R>,
}

impl<R: Real> Frame<R> {
    /// The polynomial over the plane through `center`, coefficients in units of h, without trust
    /// radius, object and index.
    #[must_use]
    pub fn to_world(&self, center: V3<R>, h: R, inverse_h: R, c: &[R; 6]) -> Polynomial<R> {
        let Self { n, u, v } = *self;
        let (a, b) = (c[0] * inverse_h, c[1] * inverse_h);
        let half_c = R::of(0.5) * (c[2] * inverse_h);
        let au = u.times(a) + v.times(half_c);
        let bv = u.times(half_c) + v.times(b);
        let curvature = |i: usize, j: usize| u.0[i] * au.0[j] + v.0[i] * bv.0[j];
        Polynomial {
            center,
            trust: R::of(0.0),
            gradient: (n - u.times(c[3])) - v.times(c[4]),
            offset: c[5] * h,
            diagonal: V3([curvature(0, 0), curvature(1, 1), curvature(2, 2)]),
            off: V3([curvature(0, 1), curvature(0, 2), curvature(1, 2)]),
            object: 0,
            index: 0,
        }
    }
}
