//! The reference plane: Equation 1, and the covariance analysis that it starts from.

use super::conjugate_gradient::{minimise_direction, tangent};
use super::minimise::minimise;
use super::{PlaneSearch, theta};
use crate::eigen::eigen_symmetric;
use crate::real::V3;

/// t stays within ±h/2: the energy falls to zero far from all points, and that is no plane.
pub(super) const BRACKET: f64 = 0.5;
/// Both minimisations have ended when t and n move by less, in h and in radians. √ε = 1e-8 is what
/// values of the energy could tell, its slopes tell 1e-13 or so.
const SETTLED: f64 = 1e-10;
/// Of one minimisation, so that what is left of it cannot feign a move.
const TOLERANCE: f64 = 1e-12;
/// Rounds of the alternation. Noise of 0.3 h takes 14; what does not end has no plane.
const MAX_ROUNDS: u32 = 200;
/// The method's limit: a middle eigenvalue under this part of the largest is a line.
const COLLINEAR: f64 = 1e-6;
/// Sum of weights below which r is far from all points: one point at 3 h has e⁻⁹ = 1.234e-4.
const LEAST_WEIGHT: f64 = 1.2e-4;

/// Equation 1 about r, in units of h: `offsets` are (pᵢ − r)/h.
pub(super) struct PlaneEnergy<'a> {
    pub(super) offsets: &'a [V3<f64>],
}

/// Value and slopes of Equation 1.
pub(super) struct Energy {
    pub(super) value: f64,
    /// ∂/∂t at fixed n.
    pub(super) along_t: f64,
    /// ∂/∂n at fixed t, tangent to the unit sphere.
    pub(super) along_n: V3<f64>,
}

impl PlaneEnergy<'_> {
    /// Σ ⟨n, y − t n⟩² θ(|y − t n|) with a = ⟨n, y⟩ and |y − t n|² = |y|² − 2 t a + t², since n has
    /// unit length. So ∂/∂t = 2 Σ θ (a − t) ((a − t)² − 1), ∂/∂a = 2 θ (a − t) (1 + t (a − t)).
    pub(super) fn at(&self, t: f64, n: V3<f64>) -> Energy {
        let (mut value, mut along_t, mut along_n) = (0.0, 0.0, V3::splat(0.0));
        for &y in self.offsets {
            let a = n.dot(y);
            let height = a - t;
            let weight = theta(y.dot(y) - t * (2.0 * a - t));
            let pull = 2.0 * weight * height;
            value += weight * height * height;
            along_t += pull * (height * height - 1.0);
            along_n = along_n + y.times(pull * (1.0 + t * height));
        }
        Energy { value, along_t, along_n: tangent(along_n, n) }
    }
}

/// A plane through r + t h n.
#[derive(Debug, Clone, Copy)]
pub(super) struct ReferencePlane {
    /// In units of h.
    pub(super) t: f64,
    pub(super) n: V3<f64>,
    pub(super) rounds: u32,
}

/// The eigenvector of the smallest eigenvalue of the weighted covariance of the offsets about their
/// weighted mean (method, section 1, step 1); `None` where they span no plane.
pub(super) fn covariance_normal(offsets: &[V3<f64>]) -> Option<V3<f64>> {
    let (mut total, mut sum) = (0.0, V3::splat(0.0));
    for &y in offsets {
        let weight = theta(y.dot(y));
        total += weight;
        sum = sum + y.times(weight);
    }
    let near = total > LEAST_WEIGHT;
    if offsets.len() < 3 || !near {
        return None;
    }
    let mean = sum.over(total);
    let (mut diagonal, mut off) = (V3::splat(0.0), V3::splat(0.0));
    for &y in offsets {
        let c = y - mean;
        let wc = c.times(theta(y.dot(y)) / total);
        diagonal = diagonal + wc * c;
        off = off + V3([wc.x() * c.y(), wc.x() * c.z(), wc.y() * c.z()]);
    }
    let eigen = eigen_symmetric(diagonal, off);
    (eigen.values.y() > COLLINEAR * eigen.values.z()).then(|| eigen.smallest.normalize())
}

/// Minimises Equation 1 by turns: Brent's minimisation over t, conjugate gradient over n. `None`
/// where t ends at ±h/2, so that r is too far from the surface, and where there is no end.
pub(super) fn reference_plane(offsets: &[V3<f64>], search: PlaneSearch) -> Option<ReferencePlane> {
    let energy = PlaneEnergy { offsets };
    let mut n = covariance_normal(offsets)?;
    let mut t = 0.0;
    for rounds in 1..=MAX_ROUNDS {
        let over_t = |t: f64| {
            let e = energy.at(t, n);
            (e.value, e.along_t)
        };
        let (t_before, n_before) = (t, n);
        t = minimise(over_t, [-BRACKET, BRACKET], t, TOLERANCE).at;
        n = match search {
            PlaneSearch::FixedDistance => turn(&energy, t, n),
            PlaneSearch::FixedOrigin => {
                let q = n.times(t);
                let about_q: Vec<V3<f64>> = offsets.iter().map(|&y| y - q).collect();
                turn(&PlaneEnergy { offsets: &about_q }, 0.0, n)
            }
        };
        let turned = n - n_before;
        if (t - t_before).abs() <= SETTLED && turned.dot(turned).sqrt() <= SETTLED {
            return (t.abs() < BRACKET - SETTLED).then_some(ReferencePlane { t, n, rounds });
        }
    }
    None
}

/// n where the energy is least at this t.
fn turn(energy: &PlaneEnergy<'_>, t: f64, n: V3<f64>) -> V3<f64> {
    let over_n = |n: V3<f64>| {
        let e = energy.at(t, n);
        (e.value, e.along_n)
    };
    minimise_direction(over_n, n, TOLERANCE)
}
