//! Twin of `glsl/shared/light.glsl`: a place on a light, and what arrives from there.

use crate::direction::about_axis;
use crate::real::{NO_HIT, Real, V3};
use crate::sampler::concentric_disc;
use kernels::layout::{LIGHT_DIRECTIONAL, LIGHT_POINT, Light};

/// Between a place and the centre, as weights see it.
const LEAST_COSINE: f64 = 1e-3;
/// So that nothing overflows next to a light.
const MOST_LIGHT: f64 = 1e30;

/// What arrives at a point from one place on a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightSample<R> {
    /// Unit.
    pub towards: V3<R>,
    /// To the light's surface along it; [`NO_HIT`] where it is infinitely far.
    pub distance: R,
    /// Irradiance, to be multiplied by max(0, n · towards).
    pub arriving: V3<R>,
}

/// What arrives at x from the place on the light that u in the unit square stands for; (½, ½) is its
/// centre.
#[must_use]
pub fn sample_light<R: Real>(light: &Light, x: V3<R>, u: [R; 2]) -> LightSample<R> {
    let (zero, one) = (R::of(0.0), R::of(1.0));
    let is_point = light.kind == LIGHT_POINT;
    let vector = V3::of_f32(light.vector);
    let extent = R::of_f32(light.extent);
    let away = vector - x;
    let square = away.dot(away);
    let center_distance = square.sqrt();
    let to_center = if square > zero { away.over(center_distance) } else { V3([zero, zero, one]) };
    let axis = if is_point { to_center } else { vector };
    let least = extent * extent;
    let within = square <= least;
    let seen = if within { one } else { extent / center_distance };
    let sine = if is_point { seen } else { extent };

    let s = concentric_disc(u).map(|s| sine * s);
    let sines = s[0] * s[0] + s[1] * s[1];
    let cosine = (one - sines).max(zero).sqrt();
    let towards = if sines > zero { about_axis(axis, s, cosine) } else { axis };

    let foot = center_distance * cosine;
    let half_chord = (least - square * sines).max(zero).sqrt();
    let entry = (if within { foot + half_chord } else { foot - half_chord }).max(zero);

    let divisor = if is_point { square.max(least) } else { one };
    let arriving = if divisor <= zero {
        V3::splat(zero)
    } else {
        let facing = V3::of_f32(light.strength).over(divisor);
        let most = V3::splat(R::of(MOST_LIGHT));
        facing.over(cosine.max(R::of(LEAST_COSINE))).zip(most, R::min)
    };
    LightSample { towards, distance: if is_point { entry } else { R::of(NO_HIT) }, arriving }
}

/// Squared, of what rays may meet.
const LEAST_EXTENT: f64 = 1e-12;

/// The radiance of a light with an extent, where a ray meets it before `end`; 0 where it does not, and of all other
/// lights.
#[must_use]
pub fn met_of<R: Real>(light: &Light, origin: V3<R>, direction: V3<R>, end: R) -> V3<R> {
    let zero = R::of(0.0);
    let is_point = light.kind == LIGHT_POINT;
    let extent = R::of_f32(light.extent);
    let square_extent = extent * extent;
    let has_extent =
        square_extent > R::of(LEAST_EXTENT) && (is_point || light.kind == LIGHT_DIRECTIONAL);
    let vector = V3::of_f32(light.vector);
    let axis = if is_point { vector - origin } else { vector };
    let square = axis.dot(axis);
    let along = axis.dot(direction);
    let off = axis.cross(direction);
    let square_off = off.dot(off);
    let within = square <= square_extent;
    let half_chord = (square_extent - square_off).max(zero).sqrt();
    let entry = if within { along + half_chord } else { along - half_chord };
    let meets = has_extent && square_off <= square_extent && (along > zero || (is_point && within));
    let before = if is_point { entry < end } else { end >= R::of(NO_HIT) };
    if !(meets && before) {
        return V3::splat(zero);
    }
    V3::of_f32(light.strength).over(R::of(std::f64::consts::PI) * square_extent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::sample_2d;

    const CENTER: [f64; 2] = [0.5; 2];

    fn sun(towards: [f64; 3], degrees: f64) -> Light {
        let extent = (0.5 * degrees).to_radians().sin() as f32;
        let vector = V3(towards).normalize().to_f32();
        Light { vector, kind: LIGHT_DIRECTIONAL, strength: [3.0, 2.0, 1.0], extent }
    }

    fn ball(position: [f32; 3], radius: f32) -> Light {
        Light { vector: position, kind: LIGHT_POINT, strength: [5.0, 6.0, 7.0], extent: radius }
    }

    /// The mean of the first 4096 samples on a surface with normal n.
    fn mean(light: &Light, x: [f64; 3], n: [f64; 3]) -> f64 {
        let samples = 4096;
        let sum: f64 = (0..samples)
            .map(|i| {
                let sample = sample_light::<f64>(light, V3(x), sample_2d([3, 4], i, 0, 4096));
                sample.arriving.x() * sample.towards.dot(V3(n)).max(0.0)
            })
            .sum();
        sum / f64::from(samples)
    }

    /// A hard light, and the centre of a soft one: E along the direction, or I/r² from the place.
    #[test]
    fn the_centre_gives_what_a_hard_light_gives() {
        for light in [sun([0.6, 0.0, 0.8], 0.0), sun([0.6, 0.0, 0.8], 40.0)] {
            let sample = sample_light::<f32>(&light, V3([7.0, -2.0, 1.0]), [0.5; 2]);
            assert_eq!(sample.towards.0, light.vector);
            assert_eq!(sample.arriving.0, light.strength);
            assert_eq!(sample.distance, NO_HIT as f32);
        }
        for (radius, distance) in [(0.0, 2.0), (0.5, 1.5)] {
            let light = ball([0.0, 2.0, 0.0], radius);
            let sample = sample_light::<f32>(&light, V3([0.0; 3]), [0.5; 2]);
            assert_eq!(sample.towards.0, [0.0, 1.0, 0.0]);
            assert_eq!(sample.arriving.0, [1.25, 1.5, 1.75]);
            assert_eq!(sample.distance, distance);
        }
        // A hard light is hard wherever it is asked.
        let light = sun([0.6, 0.0, 0.8], 0.0);
        let [a, b] = [[0.1, 0.9], [0.5; 2]].map(|u| sample_light(&light, V3([0.0f32; 3]), u));
        assert_eq!(a, b);
    }

    /// A surface that faces a light gets E from every place on it, not only in the mean.
    #[test]
    fn a_facing_surface_gets_the_irradiance_exactly() {
        let (n, x) = ([0.6, 0.0, 0.8], [1.2, 0.0, 1.6]);
        for light in [sun(n, 0.53), sun(n, 60.0), sun(n, 170.0)] {
            let e = mean(&light, x, V3::of_f32(light.vector).0);
            assert!((e - 3.0).abs() < 1e-6, "{e}, and the axis is rounded to f32");
        }
        // Four units away from the origin towards n, so two from x.
        for radius in [0.01, 0.5, 1.9] {
            let light = ball([2.4, 0.0, 3.2], radius);
            let e = mean(&light, x, n);
            assert!((e - 1.25).abs() < 1e-6, "{e} with radius {radius}");
        }
    }

    /// While the whole disc is above the horizon, a tilted surface gets E cos; where all of it is below,
    /// nothing; where the horizon halves it, the integral over the half above.
    #[test]
    fn a_tilted_surface_gets_the_projected_area() {
        let light = sun([0.0, 0.0, 1.0], 40.0);
        for degrees in [0.0f64, 30.0, 60.0, 69.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            // The mean of a smooth function over a (0, 2)-net of 4096: far below one in a thousand.
            let e = mean(&light, [0.0; 3], [sin, 0.0, cos]);
            assert!((e - 3.0 * cos).abs() < 1e-3, "{e} at {degrees}");
        }
        assert_eq!(mean(&light, [0.0; 3], [0.94, 0.0, -0.3420]), 0.0);
        // Edge on, over the disc's rings: the mean of max(0, cos φ) is 1/π, each place weighted by 1/cos.
        let sine = 20f64.to_radians().sin();
        let steps = 100_000;
        let ring = |r: f64| {
            2.0 * r * (sine * r / (1.0 - sine * sine * r * r).sqrt()) * std::f64::consts::FRAC_1_PI
        };
        let expected: f64 = 3.0
            * (0..steps).map(|i| ring((f64::from(i) + 0.5) / f64::from(steps))).sum::<f64>()
            / f64::from(steps);
        let e = mean(&light, [0.0; 3], [1.0, 0.0, 0.0]);
        assert!((e - expected).abs() < 1e-3, "{e}, expected {expected}");
        let light = ball([0.0, 0.0, 2.0], 0.5);
        let e = mean(&light, [0.0; 3], [0.6, 0.0, 0.8]);
        assert!((e - 0.8 * 1.25).abs() < 1e-3, "{e}");
    }

    /// Every place lies on the sphere, on the near side from outside and anywhere from inside, where
    /// the light is as strong as at the radius.
    #[test]
    fn places_lie_on_the_sphere() {
        let light = ball([1.0, 2.0, -1.0], 0.75);
        for x in [[4.0, 2.0, 5.0], [1.0, 2.0, -0.2], [1.3, 2.1, -0.9], [1.0, 2.0, -1.0]] {
            for i in 0..256 {
                let u = sample_2d([1, 1], i, 0, 4096);
                let LightSample { towards, distance, arriving } = sample_light(&light, V3(x), u);
                assert!((towards.dot(towards) - 1.0).abs() < 1e-12);
                let from_center = (V3(x) + towards.times(distance)) - V3::of_f32(light.vector);
                let radius = from_center.dot(from_center).sqrt();
                assert!((radius - 0.75).abs() < 1e-6, "{radius} from {x:?}");
                let facing = V3::of_f32(light.vector) - V3(x);
                let most = 5.0 / facing.dot(facing).max(0.75 * 0.75) / LEAST_COSINE;
                assert!(arriving.x() <= most * 1.000_001 && arriving.x() > 0.0);
            }
        }
    }

    #[test]
    fn nothing_is_infinite_next_to_a_light() {
        let hard = ball([0.0; 3], 0.0);
        assert_eq!(sample_light(&hard, V3([0.0f32; 3]), [0.5; 2]).arriving.0, [0.0; 3]);
        for x in [1e-30f32, 1e-19, 1e-10] {
            for light in [hard, ball([0.0; 3], 1e-12)] {
                for u in [[0.0, 0.0], [0.5, 0.5], [0.0, 0.99]] {
                    let sample = sample_light(&light, V3([x, 0.0, 0.0]), u);
                    let all = [sample.towards.0, sample.arriving.0, [sample.distance; 3]];
                    assert!(all.as_flattened().iter().all(|v| v.is_finite()), "{x}: {sample:?}");
                }
            }
        }
        assert!(
            sample_light(&sun([0.0, 1.0, 0.0], 179.9), V3([0.0; 3]), CENTER).arriving.x() > 0.0
        );
    }
}
