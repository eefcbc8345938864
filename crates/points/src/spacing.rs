//! The median distance of points to the nearest other.
//!
//! A search takes sixty bytes a point beside the positions, so large sets are searched slab by slab
//! along their longest axis, each with the points that lie near it on both sides. A distance under
//! the width of that margin is exact; the median of all is, if it is under it.

use crate::cloud::{Cloud, ObjectPoints};
use crate::neighbors::NeighborSearch;

/// Points that are searched at once, about.
const AT_ONCE: usize = 1 << 21;
/// Equal parts of the longest axis, of which slabs are made.
const PARTS: usize = 1 << 16;
/// Width of the margins over that of the slab, and over that of all.
const MARGIN: f64 = 0.125;
const LEAST_MARGIN: usize = PARTS / 256;

/// The median distance of points to the nearest other one; 0 for duplicates, `None` where there are
/// fewer than two points, or some lie too far apart to tell.
pub fn median_spacing(positions: &[[f64; 3]]) -> Option<f64> {
    if positions.len() > 2 * AT_ONCE {
        by_slabs(positions, AT_ONCE).or_else(|| whole(positions))
    } else {
        whole(positions)
    }
}

fn whole(positions: &[[f64; 3]]) -> Option<f64> {
    let mut distances = Vec::new();
    add_distances(positions, positions.len(), &mut distances)?;
    median(distances)
}

/// Adds the distances of the first `count` points to the nearest of the others.
fn add_distances(positions: &[[f64; 3]], count: usize, distances: &mut Vec<f64>) -> Option<()> {
    let file_index: Vec<u32> = (0..positions.len() as u32).collect();
    let object = ObjectPoints::new(positions, &file_index);
    let cloud = Cloud::new(&[object]).ok()?;
    let lists = NeighborSearch::new(&cloud.points, 0).nearest(0..cloud.points.len(), 1);
    let of_the_first = cloud.points.iter().zip(&lists).filter(|(p, _)| (p.index as usize) < count);
    distances.extend(of_the_first.filter_map(|(point, &neighbor)| {
        let other = cloud.points.get(neighbor as usize)?;
        let [a, b] = [point.index, other.index].map(|index| positions[index as usize]);
        Some([0, 1, 2].map(|axis| (b[axis] - a[axis]).powi(2)).iter().sum::<f64>().sqrt())
    }));
    Some(())
}

fn median(mut distances: Vec<f64>) -> Option<f64> {
    let half = distances.len() / 2;
    if distances.is_empty() {
        return None;
    }
    let odd = distances.len() % 2 == 1;
    let (below, &mut median, _) = distances.select_nth_unstable_by(half, f64::total_cmp);
    if odd {
        return Some(median);
    }
    let lower = below.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Some(0.5 * (lower + median))
}

/// `None` where the median is not under the narrowest margin.
fn by_slabs(positions: &[[f64; 3]], at_once: usize) -> Option<f64> {
    let [low, high] = crate::bounds_of([positions])?;
    let extent = |axis: &usize| high[*axis] - low[*axis];
    let axis = (0..3).max_by(|a, b| extent(a).total_cmp(&extent(b)))?;
    let scale = PARTS as f64 / extent(&axis);
    if !(scale.is_finite() && scale > 0.0) {
        return None;
    }
    let part = |p: &[f64; 3]| (((p[axis] - low[axis]) * scale) as usize).min(PARTS - 1);
    let mut counts = vec![0u32; PARTS];
    for position in positions {
        counts[part(position)] += 1;
    }
    let mut distances = Vec::new();
    distances.try_reserve_exact(positions.len()).ok()?;
    let mut narrowest = f64::INFINITY;
    let mut first = 0;
    while first < PARTS {
        let (mut end, mut count) = (first, 0);
        while end < PARTS && (end == first || count + counts[end] as usize <= at_once) {
            count += counts[end] as usize;
            end += 1;
        }
        // Parts on both sides.
        let margin = (((end - first) as f64 * MARGIN) as usize).max(LEAST_MARGIN);
        let near = first.saturating_sub(margin)..(end + margin).min(PARTS);
        let mut slab: Vec<[f64; 3]> = Vec::with_capacity(count);
        let (mut beside, slab_parts) = (Vec::new(), first..end);
        for position in positions {
            let part = part(position);
            if slab_parts.contains(&part) {
                slab.push(*position);
            } else if near.contains(&part) {
                beside.push(*position);
            }
        }
        if count > 0 {
            slab.append(&mut beside);
            let before = distances.len();
            add_distances(&slab, count, &mut distances)?;
            // A point alone with its margin has no distance yet: any is farther than that.
            distances.resize(before + count, f64::INFINITY);
            narrowest = narrowest.min(margin as f64 / scale);
        }
        first = end;
    }
    median(distances).filter(|&median| median < narrowest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud(count: u32) -> Vec<[f64; 3]> {
        let random =
            |i: u32| f64::from(i.wrapping_mul(2_654_435_761) ^ i >> 3) / f64::from(u32::MAX);
        (0..count)
            .map(|i| [4.9e6 + 100.0 * random(3 * i), random(3 * i + 1), random(3 * i + 2)])
            .collect()
    }

    #[test]
    fn slabs_have_the_median_of_the_whole() {
        let points = cloud(20_000);
        let expected = whole(&points).unwrap();
        for at_once in [1000, 3000, 19_999] {
            let found = by_slabs(&points, at_once).unwrap();
            // Each slab rounds about a centre of its own.
            assert!((found / expected - 1.0).abs() < 1e-5, "{found}, not {expected}");
        }
    }

    #[test]
    fn what_slabs_cannot_tell_is_left_to_the_whole() {
        // Two points in every thousandth part: each other's nearest, across what is no margin.
        let sparse: Vec<[f64; 3]> = (0..60).map(|i| [f64::from(i * i), 0.0, 0.0]).collect();
        assert_eq!(by_slabs(&sparse, 1), None);
        assert_eq!(by_slabs(&[[1.0; 3]; 50], 10), None);
        assert_eq!(whole(&[[1.0; 3]; 50]), Some(0.0));
        assert_eq!((whole(&[[1.0; 3]]), whole(&[])), (None, None));
    }
}
