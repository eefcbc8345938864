//! The sky's radiance by direction (Hošek and Wilkie 2012, equations 8 and 11).

use super::color::LUMINOUS_WIDTH;
use super::data::{self, SKY_NUMBERS, TURBIDITIES};
use glam::DVec3;
use scene::Sky;
use std::f64::consts::FRAC_PI_2;

/// A sky whose sun is at one place.
pub(super) struct Dome {
    sun: DVec3,
    channels: [Channel; 3],
}

/// The coefficients of one channel, the paper's A to I, with those of χ and of √cos θ in the order of its program.
struct Channel {
    course: [f64; SKY_NUMBERS],
    radiance: f64,
}

impl Dome {
    /// `sun` is the unit vector towards it.
    pub(super) fn new(sky: &Sky, sun: DVec3) -> Self {
        let along = (sun.y.clamp(0.0, 1.0).asin() / FRAC_PI_2).cbrt();
        let below = (sky.turbidity as usize).clamp(1, TURBIDITIES - 1);
        let part = sky.turbidity - below as f64;
        let channel = |channel: usize| {
            let value = |number: Option<usize>| {
                let at = |turbidity: usize, albedo: usize| {
                    bezier(data::sky(turbidity, albedo, channel, number), along)
                };
                let mix = |a: f64, b: f64, share: f64| a + share * (b - a);
                let of =
                    |turbidity: usize| mix(at(turbidity, 0), at(turbidity, 1), sky.ground[channel]);
                mix(of(below - 1), of(below), part)
            };
            let course = std::array::from_fn(|number| value(Some(number)));
            Channel { course, radiance: value(None) / LUMINOUS_WIDTH }
        };
        Self { sun, channels: [0, 1, 2].map(channel) }
    }

    /// The radiance in a direction of unit length; below the horizon, as if it were on it. Where a channel
    /// would be negative, as the model has it at low suns, it is 0.
    pub(super) fn radiance(&self, direction: DVec3) -> [f64; 3] {
        let up = direction.y.max(0.0);
        let cosine = self.sun.dot(direction).clamp(-1.0, 1.0);
        let angle = cosine.acos();
        [0, 1, 2].map(|channel| self.channels[channel].at(up, cosine, angle).max(0.0))
    }
}

impl Channel {
    /// `up` is cos θ from the zenith; `cosine` and `angle` are those from the sun.
    fn at(&self, up: f64, cosine: f64, angle: f64) -> f64 {
        let [a, b, c, d, e, f, g, i, h] = self.course;
        let base = 1.0 + h * h - 2.0 * h * cosine;
        let chi = (1.0 + cosine * cosine) / (base * base.sqrt());
        let darkening = 1.0 + a * (b / (up + 0.01)).exp();
        let glow = c + d * (e * angle).exp() + f * cosine * cosine + g * chi + i * up.sqrt();
        darkening * glow * self.radiance
    }
}

/// A Bézier curve of degree five.
fn bezier(points: [f64; 6], t: f64) -> f64 {
    let s = 1.0 - t;
    let choose = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    (0..6).map(|k| choose[k] * s.powi(5 - k as i32) * t.powi(k as i32) * points[k]).sum()
}
