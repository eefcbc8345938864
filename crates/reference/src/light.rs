//! Twin of `glsl/shared/light.glsl`: what a light sends to a point.

use crate::real::{NO_HIT, Real, V3};
use kernels::layout::{LIGHT_POINT, Light};

/// A way from a point to a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightSample<R> {
    /// Unit, to the light.
    pub towards: V3<R>,
    /// Of it, or [`NO_HIT`].
    pub distance: R,
    /// Irradiance on a surface that faces it.
    pub arriving: V3<R>,
}

/// What arrives at x.
#[must_use]
pub fn sample_light<R: Real>(light: &Light, x: V3<R>, _u: [R; 2]) -> LightSample<R> {
    let zero = R::of(0.0);
    let (vector, strength) = (V3::of_f32(light.vector), V3::of_f32(light.strength));
    if light.kind != LIGHT_POINT {
        return LightSample { towards: vector, distance: R::of(NO_HIT), arriving: strength };
    }
    let towards = vector - x;
    let square = towards.dot(towards);
    if square <= zero {
        return LightSample { towards: vector, distance: R::of(NO_HIT), arriving: V3::splat(zero) };
    }
    LightSample {
        towards: towards.over(square.sqrt()),
        distance: square.sqrt(),
        arriving: strength.over(square),
    }
}
