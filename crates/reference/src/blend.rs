//! Twin of `glsl/shared/blend.glsl` and of what `surface_hit` does with it.

use crate::around::points_around;
use crate::grid_build::CellLists;
use crate::levels::Levels;
use crate::polynomial::Polynomial;
use crate::real::{Real, V3};
use std::ops::Range;

const OTHER_SHEET: f64 = 0.1;
const MOST_BLENDED: usize = 4096;

/// The weight of p at x, not under 0, and its unit normal there.
pub(crate) fn weight_at<R: Real>(p: &Polynomial<R>, x: V3<R>) -> (R, V3<R>) {
    let (zero, one) = (R::of(0.0), R::of(1.0));
    let b = p.trust;
    let y = x - p.center;
    let curved = p.apply_curvature(y);
    let gradient = p.gradient - curved.times(R::of(2.0));
    let steepness = gradient.dot(gradient).sqrt();
    let height = (p.gradient.dot(y) - p.offset) - y.dot(curved);
    let inner = one - y.dot(y) / (b * b);
    let apart = height / (steepness * (R::of(OTHER_SHEET) * b));
    let sheet = one - apart * apart;
    let weight = if inner > zero && sheet > zero { (inner * inner) * sheet } else { zero };
    (weight, gradient.over(steepness))
}

/// The unit normal of p at x, turned to the side of `towards`, times its weight.
fn weighted_normal<R: Real>(p: &Polynomial<R>, x: V3<R>, towards: V3<R>) -> V3<R> {
    let zero = R::of(0.0);
    let (weight, normal) = weight_at(p, x);
    normal.times(if normal.dot(towards) < zero { -weight } else { weight })
}

/// The mean of the normals of the polynomials of an object around x, by their weights.
pub fn blended_normal<R: Real>(
    levels: &Levels<R>,
    lists: &CellLists,
    polynomials: &[Polynomial<R>],
    x: V3<R>,
    normal: V3<R>,
    slots: Range<u32>,
) -> V3<R> {
    points_around(levels, lists, polynomials, x, slots.clone(), MOST_BLENDED)
        .iter()
        .filter(|slot| slots.contains(slot))
        .map(|&slot| &polynomials[slot as usize])
        .fold(normal.times(R::of(1e-6)), |sum, p| sum + weighted_normal(p, x, normal))
        .normalize()
}
