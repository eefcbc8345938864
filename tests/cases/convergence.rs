//! Error against number of points, in f64: the tables of docs/convergence.md.
//!
//! The twin's parts are called one by one, because a film would round positions to f32. What stays
//! f32 is the points themselves: no error falls much below half an ulp of a coordinate, 3e-8.
#![allow(clippy::expect_used, clippy::print_stdout, reason = "tests panic and print")]

use harness::{fibonacci_sphere, plan_of, set_of};
use points::Unwatched;
use reference::Reference;
use reference::camera_rays::{Ray, camera_ray};
use reference::grid::Grid;
use reference::grid_trace::grid_trace;
use reference::real::V3;
use reference::refine::{Refined, Surroundings, resume};
use reference::surface_hit::{Hit, surface_hit};
use std::fmt::Write;

const SIZE: [u32; 2] = [160, 120];
/// Four times the points halve their spacing.
const COUNTS: [u32; 4] = [2_500, 10_000, 40_000, 160_000];
/// Cosine between ray and normal where a ray passes a sphere's middle at 0.95 of its radius.
const GRAZING: f64 = 0.31;

/// A surface known in closed form.
struct Shape {
    name: &'static str,
    eye: [f64; 3],
    /// Even points.
    points: fn(u32) -> Vec<[f64; 3]>,
    /// Distance to the surface, and the normal where it is nearest.
    nearest: fn(V3<f64>) -> (f64, V3<f64>),
}

const SPHERE: Shape = Shape {
    name: "sphere",
    eye: [0.9, 0.7, 2.4],
    points: fibonacci_sphere,
    nearest: |x| ((x.dot(x).sqrt() - 1.0).abs(), x.normalize()),
};

/// Radii 1 and [`TUBE`], around the y axis, seen from above. The inner half is saddle-shaped.
const TORUS: Shape = Shape {
    name: "torus",
    eye: [0.6, 2.6, 1.9],
    points: even_torus,
    nearest: |x| {
        let ring = V3([x.x(), 0.0, x.z()]).normalize();
        let from_ring = x - ring;
        ((from_ring.dot(from_ring).sqrt() - TUBE).abs(), from_ring.normalize())
    },
};
const TUBE: f64 = 0.4;

/// The golden lattice on the torus, every point with the same area. Going around the tube it does
/// not close; that seam lies at the bottom, where no ray gets.
fn even_torus(count: u32) -> Vec<[f64; 3]> {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    (0..count)
        .map(|i| {
            let share = std::f64::consts::TAU * (f64::from(i) + 0.5) / f64::from(count);
            // Area from the bottom up to the angle b: b - TUBE sin b, over 2π. Newton's method.
            let b = (0..50).fold(share, |b, _| {
                b - (b - TUBE * b.sin() - share) / (1.0 - TUBE * b.cos())
            });
            // Here b = 0 is the innermost line; a quarter turn makes it the bottom.
            let (sin, cos) = (golden * f64::from(i)).sin_cos();
            let ring = 1.0 - TUBE * b.cos();
            [ring * cos, TUBE * b.sin(), ring * sin]
        })
        .collect()
}
