//! Rolling land with a ring of hills around it, and a square piece of dunes, y up.
//!
//! The land's points lie on a golden-angle spiral in the ground plane: evenly within `NEAR`, and with a
//! density that falls as distance^-2.5 beyond: nearly as fast as the ground that a pixel covers
//! grows, seen from somewhere above the middle.

use crate::color::{mix, oklch};
use crate::sphere::{GOLDEN_TURN, turn};
use crate::vector::Vector;

/// Where the density begins to fall, and where the land ends.
const NEAR: f64 = 4.0;
const FAR: f64 = 30.0;

/// Waves of the ground: wave vector, amplitude, phase.
type Wave = ([f64; 2], f64, f64);
const SWELL: [Wave; 4] = [
    ([0.9, 0.5], 0.11, 0.3),
    ([-0.6, 1.3], 0.09, 1.7),
    ([1.9, -0.5], 0.05, 4.1),
    ([0.6, 2.5], 0.035, 2.6),
];
const HILLS: [Wave; 3] =
    [([0.16, 0.06], 0.9, 0.9), ([-0.08, 0.19], 0.7, 2.2), ([0.24, -0.13], 0.4, 5.0)];

fn waves(waves: &[Wave], x: f64, z: f64) -> f64 {
    waves.iter().map(|&(k, amplitude, phase)| amplitude * (k[0] * x + k[1] * z + phase).sin()).sum()
}

/// 0 up to `from`, 1 beyond `to`, without a kink.
pub fn smooth_step(from: f64, to: f64, value: f64) -> f64 {
    let t = ((value - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// How much of the ring of hills there is.
fn ring(distance: f64) -> f64 {
    smooth_step(5.0, 20.0, distance) * (1.0 - 0.5 * smooth_step(20.0, FAR, distance))
}

/// Height of the ground.
pub fn height(x: f64, z: f64) -> f64 {
    waves(&SWELL, x, z) + ring(x.hypot(z)) * (1.9 + waves(&HILLS, x, z))
}

/// Colour of the ground, linear: green in the hollows, straw on the crests, blue in the distance.
fn color(x: f64, z: f64) -> [f64; 3] {
    let distance = x.hypot(z);
    let low = oklch(0.44, 0.085, 0.48);
    let middle = oklch(0.62, 0.120, 0.355);
    let high = oklch(0.86, 0.095, 0.25);
    let level = waves(&SWELL, x, z) + 0.25 * ring(distance) * waves(&HILLS, x, z);
    let band = (level + 0.20) / 0.21;
    let near = mix(mix(low, middle, band), high, band - 1.0);
    mix(near, oklch(0.60, 0.085, 0.72), 0.94 * smooth_step(4.0, 19.0, distance))
}

/// `count` points of the land, with their colours.
pub fn points(count: u32) -> Vec<(Vector, [f64; 3])> {
    // Points within r, as a multiple of those within NEAR: (r / NEAR)^2 up to there, beyond it
    // 1 + 4 (1 - sqrt(NEAR / r)), the integral of a density that falls as r^-2.5.
    let all = 1.0 + 4.0 * (1.0 - (NEAR / FAR).sqrt());
    (0..count)
        .map(|i| {
            let within = all * (f64::from(i) + 0.5) / f64::from(count);
            let distance = if within <= 1.0 {
                NEAR * within.sqrt()
            } else {
                NEAR / (1.0 - 0.25 * (within - 1.0)).powi(2)
            };
            let (sin, cos) = turn(f64::from(i) * GOLDEN_TURN).sin_cos();
            let [x, z] = [distance * cos, distance * sin];
            let y = height(x, z);
            ([x, y, z], color(x, z))
        })
        .collect()
}

/// Half the side of the dunes.
pub const DUNES: f64 = 4.0;
const DUNE_WAVES: [Wave; 6] = [
    ([0.9, 0.35], 0.16, 0.4),
    ([-0.5, 1.1], 0.13, 2.0),
    ([1.7, -0.9], 0.06, 4.4),
    ([0.8, 2.3], 0.04, 2.6),
    ([3.1, 1.2], 0.015, 1.1),
    ([-1.4, 3.4], 0.012, 3.3),
];

/// Height of the dunes: level around the middle, where something can stand.
pub fn dunes(x: f64, z: f64) -> f64 {
    let level = smooth_step(0.35, 1.9, x.hypot(z));
    level * waves(&DUNE_WAVES, x, z) + 0.30 * smooth_step(1.8, 5.5, x.hypot(z))
}

/// `count` points of the square from -`half` to `half` at the height of `ground`: a golden-angle
/// lattice, which is even on a square too.
pub fn square(half: f64, ground: impl Fn(f64, f64) -> f64, count: u32) -> Vec<Vector> {
    (0..count)
        .map(|i| {
            let turns = (f64::from(i) + 0.5) * GOLDEN_TURN;
            let x = half * (2.0 * (turns - turns.floor()) - 1.0);
            let z = half * (2.0 * (f64::from(i) + 0.5) / f64::from(count) - 1.0);
            [x, ground(x, z), z]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_on_the_ground_within_its_radius() {
        for ([x, y, z], _) in points(1000) {
            assert!(x.hypot(z) <= FAR, "({x}, {z})");
            assert!((y - height(x, z)).abs() < 1e-12, "({x}, {z})");
        }
    }
}
