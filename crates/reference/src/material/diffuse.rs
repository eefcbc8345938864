//! Twin of `glsl/shared/materials/diffuse.glsl`: Lambert's law.

use super::Place;
use crate::real::{Real, V3};

pub(super) fn lobe<R: Real>(place: &Place<'_, R>, towards: V3<R>) -> V3<R> {
    V3::splat(place.normal.dot(towards).max(R::of(0.0)))
}

pub(super) fn scattered<R: Real>(light: V3<R>, albedo: V3<R>) -> V3<R> {
    albedo * light.times(R::of(std::f64::consts::FRAC_1_PI))
}
