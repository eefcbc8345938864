//! Twin of `glsl/shared/materials/diffuse.glsl`: Lambert's law.

use super::{Drawn, Place, Sent};
use crate::direction::about_axis;
use crate::real::{Real, V3};
use crate::sampler::concentric_disc;
use std::f64::consts::FRAC_1_PI;

pub(super) fn lobe<R: Real>(place: &Place<'_, R>, towards: V3<R>) -> V3<R> {
    V3::splat(place.normal.dot(towards).max(R::of(0.0)))
}

pub(super) fn scattered<R: Real>(light: V3<R>, albedo: V3<R>) -> V3<R> {
    albedo * light.times(R::of(FRAC_1_PI))
}

/// The direction that u in the unit square stands for, by the lobe's share of all that is scattered.
pub(super) fn direction<R: Real>(place: &Place<'_, R>, u: [R; 2]) -> V3<R> {
    let s = concentric_disc(u);
    let cosine = (R::of(1.0) - (s[0] * s[0] + s[1] * s[1])).max(R::of(0.0)).sqrt();
    about_axis(place.normal, s, cosine)
}

/// How densely that draws directions, per steradian.
pub(super) fn density<R: Real>(place: &Place<'_, R>, towards: V3<R>) -> R {
    place.normal.dot(towards).max(R::of(0.0)) * R::of(FRAC_1_PI)
}

/// A ray that carries on what light scatters from all sides. The albedo of the place is not in its weight.
pub(super) fn sent_on<R: Real>(place: &Place<'_, R>, drawn: &Drawn<R>) -> Sent<R> {
    Sent { direction: direction(place, drawn.place), weight: V3::splat(R::of(1.0)), reflects: true }
}
