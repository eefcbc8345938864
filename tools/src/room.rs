//! A room as a laser scanner finds it, y up: points only where one of two scanners sees a surface, dense
//! near them, sparse far away, none behind things.
//!
//! Ceiling and front wall are left out, so that a camera can look in.

use crate::color::{mix, oklch};
use crate::figure::{ellipsoid, hare, rod, rounded_box};
use crate::noise::random;
use crate::sphere::fibonacci;
use crate::vector::{Vector, add_scaled, scale};

/// Half the room's sizes; its floor is at 0, its front at +z.
const HALF: Vector = [2.2, 1.3, 1.8];
/// Where the scanners stand.
const SCANNERS: [Vector; 2] = [[-1.25, 1.45, 1.30], [1.35, 1.25, 1.10]];
/// How far off a scanned point may be, along its ray.
const NOISE: f64 = 0.0015;
/// A scanner takes this many rays a point that is kept.
const RAYS: u32 = 3;

/// Distance to the nearest thing, and its colour.
fn nearest(p: Vector) -> (f64, [f64; 3]) {
    let inner = [0, 1, 2].map(|axis| {
        let center = if axis == 1 { HALF[1] } else { 0.0 };
        HALF[axis] - (p[axis] - center).abs()
    });
    let wall = inner[0].min(inner[2]);
    let from_middle = |x, y, z| add_scaled(p, -1.0, [x, y, z]);
    let on_table = scale(1.0 / 0.42, add_scaled(p, -1.0, [0.15, 0.745, -0.55]));
    let mut things = [
        (wall, wall_color(p)),
        (inner[1], floor_color(p)),
        (table(from_middle(0.1, 0.0, -0.55)), oklch(0.58, 0.07, 0.15)),
        (0.42 * hare([on_table[0], on_table[1], on_table[2]]), oklch(0.80, 0.03, 0.20)),
        (ellipsoid(p, [-1.15, 0.26, -0.65], [0.26; 3]), oklch(0.60, 0.17, 0.08)),
        (lamp(from_middle(1.65, 0.0, -1.2)), oklch(0.72, 0.11, 0.26)),
        (rounded_box(from_middle(-1.25, 1.35, -1.8), [0.45, 0.32, 0.03], 0.015), picture(p)),
    ];
    things.sort_by(|a, b| a.0.total_cmp(&b.0));
    things[0]
}

fn table(p: Vector) -> f64 {
    let leg = [(p[0] * p[0]).sqrt(), p[1], (p[2] * p[2]).sqrt()];
    let top = rounded_box(add_scaled(p, -1.0, [0.0, 0.72, 0.0]), [0.72, 0.03, 0.42], 0.02);
    top.min(rod(leg, [0.62, 0.02, 0.33], [0.62, 0.70, 0.33], [0.03, 0.04], 1.0))
}

fn lamp(p: Vector) -> f64 {
    let stem = rod(p, [0.0, 0.0, 0.0], [0.0, 1.45, 0.0], [0.03, 0.03], 1.0);
    let foot = ellipsoid(p, [0.0, 0.02, 0.0], [0.20, 0.04, 0.20]);
    stem.min(foot).min(ellipsoid(p, [0.0, 1.55, 0.0], [0.26, 0.20, 0.26]))
}

fn wall_color(p: Vector) -> [f64; 3] {
    if p[1] < 0.12 { oklch(0.85, 0.01, 0.2) } else { oklch(0.80, 0.045, 0.58) }
}

/// Boards along x.
fn floor_color(p: Vector) -> [f64; 3] {
    let board = (p[2] / 0.24).floor();
    let part = ((p[0] + 0.9 * random(board, 5.0)) / 1.1).floor();
    oklch(0.56 + 0.10 * random(board, part), 0.065, 0.17)
}

fn picture(p: Vector) -> [f64; 3] {
    let (x, y) = (p[0] + 1.25, p[1] - 1.35);
    if x.abs() > 0.40 || y.abs() > 0.27 {
        return oklch(0.35, 0.03, 0.15);
    }
    let hill = 0.10 * (1.0 - 16.0 * (x - 0.1) * (x - 0.1)).max(-0.5) - 0.06;
    if y < hill {
        oklch(0.55, 0.12, 0.38)
    } else {
        mix([0.9, 0.7, 0.4], [0.2, 0.4, 0.8], 2.5 * y + 0.3)
    }
}

/// Where a scanner's ray meets something that is kept, by steps of the distance to the nearest thing.
fn scan(from: Vector, direction: Vector, ray: u32) -> Option<(Vector, [f64; 3])> {
    let mut t = 0.0;
    for _ in 0..200 {
        let p = add_scaled(from, t, direction);
        let (distance, color) = nearest(p);
        if distance < 1e-5 {
            let kept = p[1] < 2.0 * HALF[1] - 1e-3 && p[2] < HALF[2] - 1e-3;
            let off = NOISE * (2.0 * random(f64::from(ray), t.floor()) - 1.0);
            return kept.then(|| (add_scaled(p, off, direction), color));
        }
        // The parts are only about the distance.
        t += 0.7 * distance;
    }
    None
}

/// `count` points with their colours.
pub fn points(count: u32) -> Vec<(Vector, [f64; 3])> {
    let directions = fibonacci(RAYS * count);
    let seen = (0..).zip(&directions).filter_map(|(ray, &direction)| {
        let scanner = SCANNERS[ray as usize % SCANNERS.len()];
        scan(scanner, direction, ray)
    });
    crate::implicit::thinned(&seen.collect::<Vec<_>>(), count)
}
