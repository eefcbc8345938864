//! Even points on a tube around a closed curve.
//!
//! The point at arc length s and angle θ from the curve's principal normal has the area element
//! r (1 - κ r cos θ) dθ ds. Steps of equal area are thus equal steps in s, and in θ - κ r sin θ.
//! Frenet's frame turns along the curve by its torsion; that turn is taken out again, so that the
//! lattice is not sheared, and the lattice's angle is chosen such that the last step meets the first.

use crate::sphere::{GOLDEN_TURN, turn};
use crate::vector::{Vector, add_scaled, cross, dot, length, unit};
use std::f64::consts::TAU;

/// Steps of the table of arc length and torsion.
const STEPS: u32 = 1 << 14;
/// Step of the differences that stand for derivatives.
const DELTA: f64 = 1e-3;

/// A point of a tube.
#[derive(Debug, Clone, Copy)]
pub struct TubePoint {
    /// Where it is.
    pub position: Vector,
    /// How far along the curve's length, from 0 to 1.
    pub along: f64,
}

/// The frame of a curve at one parameter.
struct Frenet {
    center: Vector,
    normal: Vector,
    binormal: Vector,
    curvature: f64,
}

fn frenet(curve: impl Fn(f64) -> Vector, t: f64) -> Frenet {
    let [a, b, c] = [curve(t - DELTA), curve(t), curve(t + DELTA)];
    let first = add_scaled(c, -1.0, a).map(|x| x / (2.0 * DELTA));
    let second = add_scaled(add_scaled(a, -2.0, b), 1.0, c).map(|x| x / (DELTA * DELTA));
    let turning = cross(first, second);
    let binormal = unit(turning);
    let speed = length(first);
    Frenet {
        center: b,
        normal: cross(binormal, unit(first)),
        binormal,
        curvature: length(turning) / (speed * speed * speed),
    }
}

/// θ with θ - e sin θ = m, for 0 <= e < 1: Kepler's equation, by Newton's method.
fn kepler(m: f64, e: f64) -> f64 {
    (0..12).fold(m + e * m.sin(), |theta, _| {
        theta - (theta - e * theta.sin() - m) / (1.0 - e * theta.cos())
    })
}

/// `count` points on the tube of `radius` around `curve`, which has period 2π and bends everywhere,
/// nowhere by as much as 1 / `radius`.
pub fn even_points(curve: impl Fn(f64) -> Vector, radius: f64, count: u32) -> Vec<TubePoint> {
    let parameter = |step: u32| TAU * f64::from(step) / f64::from(STEPS);
    let mut lengths = vec![0.0];
    let mut turns = vec![0.0];
    let (mut arc, mut torsion) = (0.0, 0.0);
    for step in 0..STEPS {
        let [here, next] = [step, step + 1].map(|s| frenet(&curve, parameter(s)));
        arc += length(add_scaled(next.center, -1.0, here.center));
        torsion += dot(next.normal, here.binormal).asin() / TAU;
        lengths.push(arc);
        turns.push(torsion);
    }
    let steps = f64::from(count);
    let golden = ((GOLDEN_TURN * steps - torsion).round() + torsion) / steps;

    let mut segment = 0;
    let mut points = Vec::new();
    for i in 0..count {
        let along = (f64::from(i) + 0.5) / steps;
        while segment + 2 < lengths.len() && lengths[segment + 1] < along * arc {
            segment += 1;
        }
        let [start, end] = [lengths[segment], lengths[segment + 1]];
        let part = (along * arc - start) / (end - start);
        #[expect(clippy::cast_precision_loss, reason = "at most STEPS")]
        let t = TAU * (segment as f64 + part) / f64::from(STEPS);
        let turned = turns[segment] + part * (turns[segment + 1] - turns[segment]);
        let frame = frenet(&curve, t);
        let m = turn((f64::from(i) + 0.5) * golden - turned);
        let (sin, cos) = kepler(m, frame.curvature * radius).sin_cos();
        let on_normal = add_scaled(frame.center, radius * cos, frame.normal);
        let position = add_scaled(on_normal, radius * sin, frame.binormal);
        points.push(TubePoint { position, along });
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nearest(points: &[TubePoint], p: Vector) -> f64 {
        points
            .iter()
            .map(|q| length(add_scaled(p, -1.0, q.position)))
            .filter(|&d| d > 0.0)
            .fold(f64::INFINITY, f64::min)
    }

    /// The area 4π²Rr over n is the square of the mean spacing; a golden lattice's nearest distance
    /// lies between 0.6 and 1.1 of that, seam and inner side included.
    #[test]
    fn torus_points_lie_on_the_torus_and_are_evenly_spaced() {
        let points = even_points(|t| [t.cos(), 0.0, t.sin()], 0.4, 4000);
        let spacing = (TAU * TAU * 0.4 / 4000.0).sqrt();
        for p in &points {
            let [x, y, z] = p.position;
            let distance = (x.hypot(z) - 1.0).hypot(y);
            assert!((distance - 0.4).abs() < 1e-9, "distance from the core = {distance}");
            let relative = nearest(&points, p.position) / spacing;
            assert!((0.6..1.1).contains(&relative), "nearest / spacing = {relative}");
        }
    }

    #[test]
    fn keplers_equation_is_solved() {
        for m in [-3.0, -0.5, 0.0, 1.0, 3.1] {
            let theta = kepler(m, 0.8);
            assert!((theta - 0.8 * theta.sin() - m).abs() < 1e-14, "m = {m}");
        }
    }
}
