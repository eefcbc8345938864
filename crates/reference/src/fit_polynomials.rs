//! Twin of `fit_polynomials`: the local polynomial of each point (method, section 1).

use crate::eigen::eigen_symmetric;
use crate::fit::{COLLINEAR, Frame, fit_coefficients};
use crate::gap::{cell_extents, reach_needed};
use crate::least_squares::NormalEquations;
use crate::polynomial::Polynomial;
use crate::real::{Real, V3};
use crate::rim;
use kernels::layout::{FIT_NO_SURFACE, FitParams, NONE, Point, Rim};

const SMALLEST_FEATURE: f64 = 1e-15;

/// Offsets of a point's neighbours from it, nearest first.
struct Neighborhood<'a> {
    points: &'a [Point],
    list: &'a [u32],
    center: [f32; 3],
}

impl Neighborhood<'_> {
    fn offset<R: Real>(&self, j: usize) -> V3<R> {
        V3::of_f32(self.points[self.list[j] as usize].position) - V3::of_f32(self.center)
    }

    /// Distinct positions, the point included; counted up to 6.
    fn count_distinct(&self) -> u32 {
        let mut seen = vec![self.center];
        for &neighbor in self.list {
            let position = self.points[neighbor as usize].position;
            if seen.len() < 6 && !seen.contains(&position) {
                seen.push(position);
            }
        }
        seen.len() as u32
    }
}

/// What becomes of one point.
#[derive(Debug, Clone, Copy)]
pub struct Fitted<R> {
    /// Its surface.
    pub polynomial: Polynomial<R>,
    /// One of `FIT_*`.
    pub kind: u32,
    /// h.
    pub feature_size: R,
    /// Zeros where the point does not lie at a rim, or none is asked for.
    pub rim: Rim,
}

/// Fits the polynomial of one point. `list` holds its neighbours' slots, nearest
/// first, `NONE` after the last; `size` is its h, where that is smoothed.
#[must_use]
pub fn fit_polynomial<R: Real>(
    points: &[Point],
    slot: usize,
    list: &[u32],
    params: &FitParams,
    size: Option<f32>,
) -> Fitted<R> {
    let (zero, one) = (R::of(0.0), R::of(1.0));
    let count = list.iter().position(|&neighbor| neighbor == NONE).unwrap_or(list.len());
    let center = points[slot].position;
    let around = Neighborhood { points, list: &list[..count], center };
    let farthest = if count > 0 { around.offset::<R>(count - 1) } else { V3::splat(zero) };
    let reach = farthest.dot(farthest).sqrt();
    let h = match size {
        Some(size) => R::of_f32(size),
        None if params.feature_size > 0.0 => R::of_f32(params.feature_size),
        None => reach,
    };
    let smallest = R::of(SMALLEST_FEATURE);
    let spread_out = h > smallest && reach > smallest;
    let inverse_h = one / if spread_out { h } else { one };
    let scale = R::of_f32(params.weight_scale);
    let weight_square = scale * scale;
    let samples = || {
        (0..count).map(|j| {
            let y = around.offset::<R>(j).times(inverse_h);
            (y, (-y.dot(y) * weight_square).exp_negative())
        })
    };

    let (mut total, mut sum) = (one, V3::splat(zero));
    for (y, weight) in samples() {
        total = total + weight;
        sum = sum + y.times(weight);
    }
    let mean = sum.over(total);
    let pairs = |a: V3<R>, b: V3<R>| V3([a.x() * b.y(), a.x() * b.z(), a.y() * b.z()]);
    let (mut diagonal, mut off) = (mean * mean, pairs(mean, mean));
    for (y, weight) in samples() {
        let c = y - mean;
        let wc = c.times(weight);
        diagonal = diagonal + wc * c;
        off = off + pairs(wc, c);
    }
    let eigen = eigen_symmetric(diagonal, off);
    let n = eigen.smallest.normalize();
    let u = eigen.largest;
    let v = n.cross(u);

    let mut equations = NormalEquations::default();
    equations.add_sample(zero, zero, zero, one);
    for (y, weight) in samples() {
        equations.add_sample(y.dot(u), y.dot(v), y.dot(n), weight);
    }

    let distinct = around.count_distinct();
    let spans_plane = eigen.values.y() > R::of(COLLINEAR) * eigen.values.z();
    let first = if spread_out && spans_plane { params.polynomial } else { FIT_NO_SURFACE };
    let (kind, coefficients) = fit_coefficients(&equations, first, distinct);
    let frame = Frame { n, u, v };
    let mut polynomial = frame.to_world(V3::of_f32(center), h, inverse_h, &coefficients);
    let mut ratio = R::of_f32(params.trust);
    let mut openness = zero;
    let finds_rims = params.rim_limit > 0.0;
    if (params.close_gaps != 0 || finds_rims) && kind != FIT_NO_SURFACE {
        let extents = cell_extents(samples().map(|(y, _)| [y.dot(u), y.dot(v)]));
        if params.close_gaps != 0 {
            ratio = ratio.max(reach_needed(&extents, &coefficients).min(one));
        }
        openness = extents.into_iter().fold(zero, R::max) * (h / reach);
    }
    polynomial.trust = if kind == FIT_NO_SURFACE { zero } else { ratio * h };
    polynomial.object = params.object;
    polynomial.index = points[slot].index;

    let (mean_u, mean_v) = (mean.dot(u), mean.dot(v));
    let away = (mean_u * mean_u + mean_v * mean_v).sqrt();
    let mut rim = Rim::default();
    if finds_rims && openness > R::of(rim::OPEN) && away > R::of(rim::SHORTEST) {
        let outward = -(u.times(mean_u) + v.times(mean_v)).over(away);
        let inverse_reach = one / reach;
        let neighbors = || (0..count).map(|j| around.offset::<R>(j).times(inverse_reach));
        let s = rim::reach_of_rim(neighbors, outward, R::of_f32(params.rim_limit));
        rim = Rim {
            outward: outward.0.map(R::to_f32),
            reach: (s * reach).to_f32(),
            openness: openness.to_f32(),
        };
    }
    Fitted { polynomial, kind, feature_size: h, rim }
}
