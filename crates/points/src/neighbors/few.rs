//! Neighbours of a few points, without a tree.

use super::squared_distance;
use kernels::layout::{NONE, Point};
use rayon::prelude::*;

/// Points of a run, by which few points look for their neighbours.
const RUN: usize = 1024;

/// The same lists for a few points of an object, by a look at all the others, block after block: without a tree, whose
/// making takes as long as many hundred such looks where points that follow each other lie together.
#[must_use]
pub fn nearest_of_few(
    points: &[Point],
    first_slot: u32,
    few: std::ops::Range<usize>,
    k: usize,
) -> Vec<u32> {
    let mut lists = vec![NONE; few.len() * k];
    let boxes: Vec<_> = points.par_chunks(RUN).map(box_around).collect();
    lists.par_chunks_mut(k).zip(few).for_each(|(list, at)| {
        let center = points[at].position;
        let mut blocks: Vec<(f32, usize)> =
            boxes.iter().map(|[low, high]| distance_to_box(*low, *high, center)).zip(0..).collect();
        blocks.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut found: Vec<Candidate> = Vec::with_capacity(k + 1);
        for (distance, block) in blocks {
            if found.len() == k && found.last().is_some_and(|worst| distance > worst.0) {
                break;
            }
            let first = block * RUN;
            let members = &points[first..points.len().min(first + RUN)];
            for (place, point) in (first..).zip(members).filter(|(place, _)| *place != at) {
                let square = squared_distance(center, point.position);
                insert(&mut found, k, (square, point.index, place as u32));
            }
        }
        for (entry, &(_, _, place)) in list.iter_mut().zip(&found) {
            *entry = first_slot + place;
        }
    });
    lists
}

/// Lowest and highest corner of the box around some points.
fn box_around(points: &[Point]) -> [[f32; 3]; 2] {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for point in points {
        for axis in 0..3 {
            low[axis] = low[axis].min(point.position[axis]);
            high[axis] = high[axis].max(point.position[axis]);
        }
    }
    [low, high]
}

/// d² of what is nearest in a box.
fn distance_to_box(low: [f32; 3], high: [f32; 3], p: [f32; 3]) -> f32 {
    let [x, y, z] = [0, 1, 2].map(|axis| (low[axis] - p[axis]).max(p[axis] - high[axis]).max(0.0));
    (x * x + y * y) + z * z
}

/// One candidate: (d², place in the file, place in memory).
type Candidate = (f32, u32, u32);

/// Keeps the k least candidates in order.
fn insert(found: &mut Vec<Candidate>, k: usize, candidate: Candidate) {
    let key = |f: &Candidate| (f.0, f.1);
    if found.len() == k {
        if found.last().is_none_or(|worst| key(&candidate) >= key(worst)) {
            return;
        }
        found.pop();
    }
    let place = found.partition_point(|f| key(f) < key(&candidate));
    found.insert(place, candidate);
}
