//! Twin of `glsl/shared/materials/cloud.glsl`: a volume that scatters light where it goes on.

use super::{Drawn, Place, Sent};
use crate::direction::{about_axis, on_circle};
use crate::real::{Real, V3};
use std::f64::consts::FRAC_1_PI;

const NEARLY_EVEN: f64 = 1e-2;

/// The share of light that is scattered by an angle of this cosine, per steradian.
pub(crate) fn phase<R: Real>(g: R, cosine: R) -> R {
    let one = R::of(1.0);
    let square = ((one + g * g) - (R::of(2.0) * g) * cosine).max(R::of(1e-6));
    ((one - g * g) / (square * square.sqrt())) * R::of(0.25 * FRAC_1_PI)
}

fn g_of<R: Real>(place: &Place<'_, R>) -> R {
    R::of_f32(place.info.weight_scale)
}

pub(super) fn density<R: Real>(place: &Place<'_, R>, towards: V3<R>) -> R {
    phase(g_of(place), place.d.dot(towards))
}

pub(super) fn lobe<R: Real>(place: &Place<'_, R>, towards: V3<R>) -> V3<R> {
    V3::splat(density(place, towards))
}

pub(super) fn direction<R: Real>(place: &Place<'_, R>, u: [R; 2]) -> V3<R> {
    let (one, two) = (R::of(1.0), R::of(2.0));
    let g: R = g_of(place);
    let s = two * u[0] - one;
    let cosine = if g.abs() < R::of(NEARLY_EVEN) {
        s + (one - s * s) * (R::of(1.5) * g - (two * g * g) * s)
    } else {
        let ratio = (one - g * g) / (one + g * s);
        ((one + g * g) - ratio * ratio) / (two * g)
    };
    let cosine = cosine.max(-one).min(one);
    let sine = (one - cosine * cosine).max(R::of(0.0)).sqrt();
    about_axis(place.d, on_circle(u[1]).map(|at| sine * at), cosine)
}

pub(super) fn sent_on<R: Real>(place: &Place<'_, R>, drawn: &Drawn<R>) -> Sent<R> {
    Sent { direction: direction(place, drawn.place), weight: V3::splat(R::of(1.0)), reflects: true }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::sample_2d;
    use bytemuck::Zeroable;
    use kernels::layout::ObjectInfo;

    /// The mean cosine of what is drawn is g, also where the series and the closed form meet, and the density is that of
    /// the draws: the mean of 1 / density over directions is the sphere's solid angle, where no direction is rare.
    #[test]
    fn directions_are_drawn_by_the_phase_function() {
        for g in [0.0f32, 0.004, -0.0099, 0.0101, 0.3, -0.7, 0.9] {
            let info = ObjectInfo { weight_scale: g, ..ObjectInfo::zeroed() };
            let d = V3([0.48, -0.6, 0.64]);
            let place = Place { d, normal: V3([1.0; 3]), info: &info };
            let count = 1 << 14;
            let (mut mean, mut solid) = (0.0, 0.0);
            for i in 0..count {
                let towards = direction::<f64>(&place, sample_2d([1, 2], i, 3, 4));
                assert!((towards.dot(towards) - 1.0).abs() < 1e-12);
                mean += towards.dot(d) / f64::from(count);
                solid += 1.0 / density(&place, towards) / f64::from(count);
            }
            // A net of 2^14 places: a smooth function's mean is off by less than 1e-4 of its range; f32 rounds g to 6e-8.
            assert!((mean - f64::from(g)).abs() < 2e-4, "{mean}, not {g}");
            if g.abs() < 0.8 {
                let sphere = 4.0 * std::f64::consts::PI;
                assert!((solid / sphere - 1.0).abs() < 2e-3, "{solid} with {g}");
            }
        }
    }
}
