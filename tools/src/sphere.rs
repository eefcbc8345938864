//! Even points on the unit sphere.

use crate::vector::Vector;
use std::f64::consts::{PI, TAU};

/// The fraction of a turn that leaves the largest gaps least wide: 1 over the golden ratio.
pub const GOLDEN_TURN: f64 = 0.618_033_988_749_894_8;

/// The Fibonacci spiral: equal steps along y, which cut the sphere into belts of equal area.
pub fn fibonacci(count: u32) -> Vec<Vector> {
    (0..count)
        .map(|i| {
            let y = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(count);
            let belt = (1.0 - y * y).sqrt();
            let (sin, cos) = turn(f64::from(i) * GOLDEN_TURN).sin_cos();
            [belt * cos, y, belt * sin]
        })
        .collect()
}

/// A number of turns as an angle from -π to π, where sine and cosine are most exact.
pub fn turn(turns: f64) -> f64 {
    let angle = TAU * (turns - turns.floor());
    if angle > PI { angle - TAU } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::{add_scaled, length};

    /// The best packing of n points on the sphere has nearest distances near √(8π/√3 n) = 3.81/√n.
    #[test]
    fn nearest_points_are_about_as_far_as_in_the_best_packing() {
        let points = fibonacci(1000);
        for &p in &points {
            assert!((length(p) - 1.0).abs() < 1e-12, "|p| = {}", length(p));
            let nearest = points
                .iter()
                .map(|&q| length(add_scaled(p, -1.0, q)))
                .filter(|&d| d > 0.0)
                .fold(f64::INFINITY, f64::min);
            let relative = nearest * 1000.0_f64.sqrt() / 3.81;
            assert!((0.7..1.0).contains(&relative), "nearest / best = {relative}");
        }
    }
}
