//! Reaches of points that are far closer along lines or in sheets than across them, as the nodes of grids around a body
//! are.
//!
//! All 16 neighbours of such a point may be of its own line, and what they are apart says nothing of the gap to the next.
//! So the set is thinned to one point a cube, of edges that double from one set to the next and follow the points' own
//! reaches, until the neighbours lie to all sides: their reach is that of all points which they stand for.

use super::reach::{NEIGHBORS, smoothed};
use crate::neighborhoods::{at_most, length, vectors};
use kernels::layout::Point;
use points::NeighborSearch;
use rayon::prelude::*;
use std::collections::HashMap;

/// The smallest of the three variances of neighbours around a point, by the greatest: at random it is less once in more
/// than a million points, along a line it is 0.
const FLAT: f64 = 0.03;
/// Times that edges are doubled: gaps are spanned of up to some 2^this times what points are apart.
const DOUBLINGS: i32 = 4;
/// The reach of points that are apart by 1, to all sides: (16 · 3/4π)^⅓.
const REACH_OF_SPACING: f64 = 1.563;
/// Part of the points that have to lie so for any of it to be done.
const FEWEST: f64 = 1e-3;

/// The reaches of all points, from what their 16 neighbours say, `plain`. `is_volume` says whether they fill space; points of
/// a skin keep theirs.
pub(super) fn reaches(
    points: &[Point],
    lists: &[u32],
    each: usize,
    plain: Vec<f64>,
    is_volume: impl FnOnce() -> bool,
) -> Vec<f64> {
    if each < NEIGHBORS {
        return plain;
    }
    let flat = flat_ones(points, lists, each);
    let mut left: Vec<u32> = (0..points.len() as u32).filter(|&at| flat[at as usize]).collect();
    if (left.len() as f64) < FEWEST * points.len() as f64 || left.is_empty() || !is_volume() {
        return plain;
    }
    let mut wider = plain.clone();
    for doubling in 1..=DOUBLINGS {
        let thinned = Thinned::of(points, &plain, doubling);
        if thinned.points.len() <= NEIGHBORS {
            break;
        }
        let each = at_most(NEIGHBORS, thinned.points.len());
        let search = NeighborSearch::new(&thinned.points, 0);
        let lists = search.nearest(0..thinned.points.len(), each);
        let farthest: Vec<f64> = (lists.par_chunks(each).enumerate())
            .map(|(at, list)| vectors(&thinned.points, at, list).map(length).fold(0.0, f64::max))
            .collect();
        let reaches = smoothed(&farthest, &lists, each);
        let flat = flat_ones(&thinned.points, &lists, each);
        let most = f64::from(1 << DOUBLINGS);
        left.retain(|&at| {
            let stands_for = thinned.of[at as usize] as usize;
            let own = plain[at as usize];
            wider[at as usize] = reaches[stands_for].clamp(own, most * own);
            flat[stands_for]
        });
        if left.is_empty() {
            break;
        }
    }
    // Points beside those that were widened reach on average as far as the ones around them.
    let means = smoothed(&wider, lists, each);
    let is_beside = |at: usize| {
        let changed = |other: usize| wider[other] > plain[other];
        let list = lists[at * each..(at + 1) * each].iter();
        changed(at)
            || list.filter(|other| (**other as usize) < plain.len()).any(|&i| changed(i as usize))
    };
    (0..plain.len()).map(|at| if is_beside(at) { means[at] } else { plain[at] }).collect()
}

/// One point a cube.
struct Thinned {
    points: Vec<Point>,
    /// By point of the whole set, which of these stands for it.
    of: Vec<u32>,
}

impl Thinned {
    /// Edges are what points would be apart whose reach is each point's own, doubled so many times, in powers of two.
    fn of(points: &[Point], reaches: &[f64], doublings: i32) -> Self {
        let mut found: HashMap<(i32, [i64; 3]), u32> = HashMap::new();
        let mut thinned = Self { points: Vec::new(), of: Vec::with_capacity(points.len()) };
        for (point, reach) in points.iter().zip(reaches) {
            let power = (reach / REACH_OF_SPACING).log2().round() as i32 + doublings;
            let inverse = f64::from(-power).exp2();
            let cube = point.position.map(|x| (f64::from(x) * inverse).floor() as i64);
            let next = thinned.points.len() as u32;
            let at = *found.entry((power, cube)).or_insert(next);
            if at == next {
                thinned.points.push(*point);
            }
            thinned.of.push(at);
        }
        thinned
    }
}

/// Which points have all their neighbours about one line or plane.
fn flat_ones(points: &[Point], lists: &[u32], each: usize) -> Vec<bool> {
    let is_flat = |(at, list): (usize, &[u32])| {
        let mut moments = [0.0; 6];
        for [x, y, z] in vectors(points, at, list) {
            for (sum, term) in moments.iter_mut().zip([x * x, y * y, z * z, x * y, x * z, y * z]) {
                *sum += term;
            }
        }
        let [least, greatest] = outer_eigenvalues(moments);
        least < FLAT * greatest
    };
    lists.par_chunks(each).enumerate().map(is_flat).collect()
}

/// The least and the greatest eigenvalue of a symmetric matrix of xx, yy, zz, xy, xz, yz (Smith, Eigenvalues of a
/// symmetric 3 × 3 matrix, Communications of the ACM 4, 1961).
fn outer_eigenvalues([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> [f64; 2] {
    let mean = (xx + yy + zz) / 3.0;
    let off = xy * xy + xz * xz + yz * yz;
    let [a, b, c] = [xx - mean, yy - mean, zz - mean];
    let p = ((a * a + b * b + c * c + 2.0 * off) / 6.0).sqrt();
    if p <= 0.0 {
        return [mean; 2];
    }
    let [a, b, c, d, e, f] = [a, b, c, xy, xz, yz].map(|x| x / p);
    let half_determinant = 0.5 * (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e));
    let angle = half_determinant.clamp(-1.0, 1.0).acos() / 3.0;
    let of = |angle: f64| mean + 2.0 * p * angle.cos();
    [of(angle + std::f64::consts::TAU / 3.0), of(angle)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvalues_are_those_of_known_matrices() {
        // Rotated by half a radian about z.
        let (sin, cos) = 0.5f64.sin_cos();
        let [u, v] = [5.0, 1.0];
        let turned = [
            u * cos * cos + v * sin * sin,
            u * sin * sin + v * cos * cos,
            2.0,
            (u - v) * sin * cos,
            0.0,
            0.0,
        ];
        for (matrix, expected) in [
            ([1.0, 2.0, 3.0, 0.0, 0.0, 0.0], [1.0, 3.0]),
            ([4.0, 4.0, 4.0, 0.0, 0.0, 0.0], [4.0, 4.0]),
            (turned, [1.0, 5.0]),
        ] {
            let found = outer_eigenvalues(matrix);
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
            }
        }
    }
}
