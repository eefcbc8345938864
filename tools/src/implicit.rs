//! Even points on a surface that is where a function is zero.
//!
//! Points that lie in a thin shell around the surface are moved onto it, then push each other away for a
//! while. Only sums, products, quotients and square roots are used: every platform gives the same points.

use crate::vector::{Vector, add_scaled, dot, length, scale};
use std::collections::HashMap;

/// Step of the differences that stand for derivatives.
const DELTA: f64 = 1e-5;
/// How often the points push each other.
const ROUNDS: u32 = 24;
/// Distance at which they no longer do, in mean spacings.
const REACH: f64 = 1.6;

/// One step of Newton's method along the gradient, which comes from f at the corners of a tetrahedron.
fn nearer(f: &impl Fn(Vector) -> f64, p: Vector) -> Vector {
    let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let slope = corners.iter().fold([0.0; 3], |sum, &corner| {
        add_scaled(sum, f(add_scaled(p, DELTA, corner)) / (4.0 * DELTA), corner)
    });
    add_scaled(p, -f(p) / dot(slope, slope).max(1e-6), slope)
}

/// A point moved onto the surface, and how far that was.
fn onto(f: &impl Fn(Vector) -> f64, p: Vector) -> (Vector, f64) {
    let moved = (0..4).fold(p, |p, _| nearer(f, p));
    (moved, length(add_scaled(moved, -1.0, p)))
}

/// `count` points on the surface f = 0 within the box from `low` to `high`, which contains it.
pub fn even_points(
    f: impl Fn(Vector) -> f64,
    low: Vector,
    high: Vector,
    count: u32,
) -> Vec<Vector> {
    let mut points = thinned(&candidates(&f, low, high, count), count);
    // A point has the area of its hexagon: the spacing of the best packing follows from its mean.
    let spacing = (2.0 * area(&f, low, high) / (3.0_f64.sqrt() * f64::from(count))).sqrt();
    for _ in 0..ROUNDS {
        let pushes = pushes(&points, REACH * spacing);
        for (point, push) in points.iter_mut().zip(pushes) {
            *point = nearer(&f, add_scaled(*point, 0.4 * spacing, push));
        }
    }
    points.into_iter().map(|point| onto(&f, point).0).collect()
}

/// Place i of a sequence that fills the unit cube evenly: multiples of the powers of 1/g, where g is the
/// root of g^4 = g + 1. Martin Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018.
fn place(i: u32, low: Vector, high: Vector) -> Vector {
    let g = 1.220_744_084_605_759_5;
    let steps = [1.0 / g, 1.0 / (g * g), 1.0 / (g * g * g)];
    [0, 1, 2].map(|axis| {
        let turns = (f64::from(i) + 0.5) * steps[axis];
        low[axis] + (turns - turns.floor()) * (high[axis] - low[axis])
    })
}

/// Half the thickness of the shell that candidates come from, and the share of the box that it fills.
fn shell(low: Vector, high: Vector) -> f64 {
    let size = add_scaled(high, -1.0, low);
    0.01 * size[0].min(size[1]).min(size[2])
}

/// Points moved onto the surface from the shell around it, which is as thick everywhere: where there is
/// twice the area, there are twice the points.
fn candidates(f: &impl Fn(Vector) -> f64, low: Vector, high: Vector, count: u32) -> Vec<Vector> {
    let reach = shell(low, high);
    let wanted = 3 * count as usize;
    let mut found = Vec::new();
    for i in 0.. {
        if found.len() >= wanted {
            break;
        }
        let p = place(i, low, high);
        // Cheap first: f is about the distance, within a factor.
        if f(p).abs() < 4.0 * reach {
            let (moved, distance) = onto(f, p);
            if distance < reach {
                found.push(moved);
            }
        }
    }
    found
}

/// `count` of the points, at equal steps.
pub fn thinned<T: Copy>(points: &[T], count: u32) -> Vec<T> {
    let step = |i: u32| u64::from(i) * points.len() as u64 / u64::from(count);
    (0..count).filter_map(|i| points.get(usize::try_from(step(i)).ok()?).copied()).collect()
}

/// The surface's area, from the share of the box that the shell fills.
fn area(f: &impl Fn(Vector) -> f64, low: Vector, high: Vector) -> f64 {
    let tries = 100_000;
    let reach = shell(low, high);
    let inside = (0..tries)
        .map(|i| place(i, low, high))
        .filter(|&p| f(p).abs() < 4.0 * reach && onto(f, p).1 < reach)
        .count();
    let size = add_scaled(high, -1.0, low);
    #[expect(clippy::cast_precision_loss, reason = "at most the number of tries")]
    let share = inside as f64 / f64::from(tries);
    share * size[0] * size[1] * size[2] / (2.0 * reach)
}

/// For each point, where its neighbours within `reach` push it: strongest the nearer they are.
fn pushes(points: &[Vector], reach: f64) -> Vec<Vector> {
    #[expect(clippy::cast_possible_truncation, reason = "a few thousand cells an axis")]
    let cell = |p: Vector| p.map(|x| (x / reach).floor() as i32);
    let mut cells: HashMap<[i32; 3], Vec<usize>> = HashMap::new();
    for (i, &p) in points.iter().enumerate() {
        cells.entry(cell(p)).or_default().push(i);
    }
    let push = |(i, &p): (usize, &Vector)| {
        let [x, y, z] = cell(p);
        let mut sum = [0.0; 3];
        for n in 0..27 {
            let near = [x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1];
            for &j in cells.get(&near).map_or(&[][..], Vec::as_slice) {
                let away = add_scaled(p, -1.0, points[j]);
                let distance = length(away);
                if j != i && distance > 0.0 && distance < reach {
                    let weight = 1.0 - distance / reach;
                    sum = add_scaled(sum, weight * weight / distance, away);
                }
            }
        }
        scale(0.5, sum)
    };
    points.iter().enumerate().map(push).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The best packing of n points on the sphere has nearest distances near √(8π/√3 n) = 3.81/√n.
    #[test]
    fn points_of_a_sphere_lie_on_it_about_as_far_apart_as_in_the_best_packing() {
        let points = even_points(|p| length(p) - 1.0, [-1.1; 3], [1.1; 3], 1000);
        for &p in &points {
            assert!((length(p) - 1.0).abs() < 1e-9, "|p| = {}", length(p));
            let nearest = points
                .iter()
                .map(|&q| length(add_scaled(p, -1.0, q)))
                .filter(|&d| d > 0.0)
                .fold(f64::INFINITY, f64::min);
            let relative = nearest * 1000.0_f64.sqrt() / 3.81;
            assert!((0.65..1.1).contains(&relative), "nearest / best = {relative}");
        }
    }
}
