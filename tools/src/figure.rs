//! A hare that sits, y up, nose to +x, about 1.5 high, and a slab: smooth closed solids.
//!
//! Each part is a function that is about the distance to its surface, negative inside; parts flow into
//! each other where they meet.

use crate::vector::{Vector, add_scaled, dot, length};

/// Corners of a box around the hare.
pub const HARE_BOX: [Vector; 2] = [[-0.75, -0.03, -0.55], [0.80, 1.60, 0.55]];
/// Half the slab's sizes, its rounded edges included, and their radius.
const SLAB: Vector = [2.0, 0.5, 1.5];
const SLAB_EDGE: f64 = 0.18;
/// Corners of a box around the slab.
pub const SLAB_BOX: [Vector; 2] = [[-2.1, -0.6, -1.6], [2.1, 0.6, 1.6]];

/// About the distance to an ellipsoid. Inigo Quilez, "Ellipsoid SDF".
pub fn ellipsoid(p: Vector, center: Vector, radii: Vector) -> f64 {
    let q = add_scaled(p, -1.0, center);
    let once = length([q[0] / radii[0], q[1] / radii[1], q[2] / radii[2]]);
    let twice = [0, 1, 2].map(|i| q[i] / (radii[i] * radii[i]));
    once * (once - 1.0) / length(twice).max(1e-9)
}

/// The distance to a rod from a to b whose radius goes from `ra` to `rb`, flattened along z.
pub fn rod(p: Vector, a: Vector, b: Vector, [ra, rb]: [f64; 2], flat: f64) -> f64 {
    let [pa, ba] = [add_scaled(p, -1.0, a), add_scaled(b, -1.0, a)];
    let t = (dot(pa, ba) / dot(ba, ba)).clamp(0.0, 1.0);
    let away = add_scaled(pa, -t, ba);
    length([away[0], away[1], away[2] * flat]) - (ra + (rb - ra) * t * t * (3.0 - 2.0 * t))
}

/// The union of two solids whose seam is rounded over a length k.
fn join(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - h * h * h * k / 6.0
}

/// Below zero inside the hare.
pub fn hare(p: Vector) -> f64 {
    // Left and right are alike.
    let p = [p[0], p[1], (p[2] * p[2] + 1e-6).sqrt()];
    let body = ellipsoid(p, [-0.12, 0.36, 0.0], [0.47, 0.35, 0.34]);
    let chest = ellipsoid(p, [0.22, 0.48, 0.0], [0.24, 0.33, 0.23]);
    let haunch = ellipsoid(p, [-0.22, 0.26, 0.24], [0.30, 0.26, 0.14]);
    let head = ellipsoid(p, [0.40, 0.88, 0.0], [0.26, 0.20, 0.19]);
    let muzzle = ellipsoid(p, [0.57, 0.82, 0.0], [0.14, 0.11, 0.12]);
    let cheek = ellipsoid(p, [0.45, 0.82, 0.11], [0.11, 0.10, 0.08]);
    let tail = ellipsoid(p, [-0.58, 0.30, 0.0], [0.12, 0.12, 0.11]);
    let ear = rod(p, [0.30, 1.00, 0.09], [0.06, 1.44, 0.17], [0.07, 0.10], 1.7);
    let foreleg = rod(p, [0.28, 0.42, 0.12], [0.40, 0.075, 0.13], [0.10, 0.07], 1.0);
    let paw = ellipsoid(p, [0.45, 0.065, 0.13], [0.13, 0.065, 0.075]);
    let foot = ellipsoid(p, [-0.02, 0.065, 0.27], [0.27, 0.065, 0.095]);
    [
        (chest, 0.20),
        (haunch, 0.08),
        (head, 0.16),
        (muzzle, 0.10),
        (cheek, 0.08),
        (tail, 0.05),
        (ear, 0.07),
        (foreleg, 0.10),
        (paw, 0.06),
        (foot, 0.06),
    ]
    .into_iter()
    .fold(body, |whole, (part, k)| join(whole, part, k))
}

/// The distance to a box of half sizes `half`, whose edges are rounded with radius `edge`.
pub fn rounded_box(p: Vector, half: Vector, edge: f64) -> f64 {
    let q = [0, 1, 2].map(|i| p[i].abs() - half[i] + edge);
    let outside = length(q.map(|x| x.max(0.0)));
    let inside = q[0].max(q[1]).max(q[2]).min(0.0);
    outside + inside - edge
}

/// The distance to the slab.
pub fn slab(p: Vector) -> f64 {
    rounded_box(p, SLAB, SLAB_EDGE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a lattice over each side of the boxes: a solid that reached through would be cut open.
    #[test]
    fn solids_lie_inside_their_boxes() {
        let [hare, slab]: [fn(Vector) -> f64; 2] = [hare, slab];
        for (solid, [low, high]) in [(hare, HARE_BOX), (slab, SLAB_BOX)] {
            for side in 0..6 {
                for n in 0..10_000 {
                    let across = [f64::from(n % 100) / 99.0, f64::from(n / 100) / 99.0];
                    let mut p = low;
                    for (axis, value) in [(side + 1) % 3, (side + 2) % 3].into_iter().zip(across) {
                        p[axis] = low[axis] + value * (high[axis] - low[axis]);
                    }
                    p[side % 3] = if side < 3 { low[side % 3] } else { high[side % 3] };
                    assert!(solid(p) > 0.0, "{p:?}");
                }
            }
        }
    }
}
