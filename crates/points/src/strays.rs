//! Strays: the few points of a set that lie far from all others, and the bulk, which is the rest.
//!
//! One stray return of a scanner, or a row of zeros among survey coordinates, must not decide how a set is framed,
//! where its origin lies and what its lengths are. What makes a stray is the density around it, not a distance: with
//! r the distance of a point to its [`NEIGHBORS`]-th nearest other, s the same of that neighbour, d the distance
//! to its nearest other, and m the median of r over the set, a point is a stray where
//!
//! * r > 8 m and r > 10 s, or
//! * r > 4 m and d > 3 s,
//!
//! and again without those that are found, until none is. So a cluster of up to [`NEIGHBORS`] points can be stray and
//! a larger one cannot, since its points have each other for neighbours; nor can the sparse surroundings of a dense
//! scan, whose neighbours are as sparse as they are. Where more than a twentieth of the points would be stray, the
//! set has no bulk, and none is.
//!
//! Sparse surroundings that a dense part lies in have it for a neighbour where it begins, and would have a hole there:
//! what is found is taken back where it belongs to more than [`NEIGHBORS`] points as sparse as it is that are not.
//!
//! In a set of fewer than 34 points, which has no density to speak of, r is the distance to the last of the nearest half,
//! and a stray is one point with d > 100 m and d > 100 times r of the nearest.
//!
//! Points at equal positions count once here. The factors are from forty real and simulated sets: none of the models,
//! grids and terrains has a stray, the airborne scan 2 of 110 000, the terrestrial scan 65 of 518 862.

mod apart;
mod boxes;
mod outskirts;
mod steps;

pub use apart::Apart;
pub(crate) use apart::{filter, size_of};

use crate::cloud::{bounds_of, middle};
use crate::curve::{is_copy, key_of, sort_along_curve};
use crate::strays::boxes::{Around, Boxes, EMPTY, join, square};
use crate::strays::steps::{BOUNDED, PLACED, SORTED, Steps};
use crate::watch::{Unwatched, Watch};
use kernels::layout::Point;
use rayon::prelude::*;
use std::collections::HashSet;

/// The neighbour whose distance measures density; the largest cluster that can be stray.
const NEIGHBORS: usize = 16;
/// Fewer points have no bulk.
const FEWEST: usize = 8;
/// Fewer points have no density that could be measured.
const SMALL: usize = 2 * NEIGHBORS + 2;
/// How far off a stray of so few points lies.
const FAR: f64 = 100.0;
/// At most this share of a set is stray.
const MOST: usize = 20;
/// Points by which the median of r is measured.
const MEASURED: usize = 256;
/// Places along the curve, on either side of a point, that bound its r from above before it is searched for.
const WINDOW: usize = 2 * NEIGHBORS;
/// Points that follow each other on the curve and are looked at together first.
const RUN: usize = NEIGHBORS + 4;
/// Points whose neighbours are searched for, at most: those with the largest bounds.
const SEARCHED: usize = 1 << 19;
/// Rounds at most. Each takes away what kept others from being found, and a second is rare.
const ROUNDS: usize = 16;
/// Pairs of points that are compared to know what is searched for anew; where there are more, everything is.
const COMPARED: usize = 1 << 24;
/// Coordinates are clamped here. Squares are taken in f64, which bears them.
const FARTHEST_SEEN: f64 = 1e30;
/// Points that one thread takes at once.
const PART: usize = 1 << 12;
/// Points that are looked at, and searches that are made, before progress is shown.
const SHOWN: usize = 1 << 20;
const SEARCHES_SHOWN: usize = 1 << 14;

/// The strays of one set of points.
#[derive(Debug, Clone, PartialEq)]
pub struct Strays {
    /// Their places in the set, ascending.
    pub places: Vec<u32>,
    /// Lowest and highest corner of the box around all other points.
    pub bulk: [[f64; 3]; 2],
    /// How far the farthest stray lies from that box; 0 where none lies outside.
    pub farthest: f64,
    /// The median distance of a point to its 16th nearest other; 0 where there are too few points for strays.
    pub reach: f64,
    /// All places along a Hilbert curve, for [`ObjectPoints::order`](crate::ObjectPoints::order).
    pub order: Vec<u32>,
}

impl Strays {
    /// Finds the strays among finite positions. `origin` must lie near the bulk: [`rough_origin`] does.
    ///
    /// # Panics
    /// Without points, or with more than 2³².
    #[must_use]
    pub fn find(positions: &[[f64; 3]], origin: [f64; 3]) -> Self {
        let found = Self::find_watched(positions, origin, &Unwatched, 0);
        found.unwrap_or_else(|| unreachable!("nobody asks for an end"))
    }

    /// As [`find`](Self::find), in a stage of `watch` of which `before` points are done; `None` where it asks for an
    /// end.
    ///
    /// # Panics
    /// As [`find`](Self::find).
    #[must_use]
    pub fn find_watched(
        positions: &[[f64; 3]],
        origin: [f64; 3],
        watch: &dyn Watch,
        before: u64,
    ) -> Option<Self> {
        let steps = Steps { watch, before, points: positions.len() as u64 };
        assert!(u32::try_from(positions.len()).is_ok(), "places are of 32 bits");
        let local: Vec<Point> = positions
            .par_iter()
            .with_min_len(PART)
            .map(|p| Point {
                position: [0, 1, 2].map(|axis| {
                    (p[axis] - origin[axis]).clamp(-FARTHEST_SEEN, FARTHEST_SEEN) as f32
                }),
                index: 0,
            })
            .collect();
        let mut on_curve: Vec<(u64, u32)> = (0..local.len() as u32).map(|i| (0, i)).collect();
        steps.reach(PLACED)?;
        sort_along_curve(&local, &mut on_curve);
        steps.reach(SORTED)?;
        let order: Vec<u32> = on_curve.par_iter().map(|&(_, place)| place).collect();
        let position = |place: &u32| local[*place as usize].position;
        let mut on_curve: Vec<[f32; 3]> =
            order.par_iter().with_min_len(PART).map(position).collect();
        // Of points at one position, the first.
        on_curve.dedup_by(|b, a| is_copy(*a, *b));
        let (stray, reach) = stray_places(&on_curve, &steps)?;
        let mut places = Vec::new();
        if !stray.is_empty() {
            let found: HashSet<[u32; 3]> =
                stray.iter().map(|&at| key_of(on_curve[at as usize])).collect();
            // All copies share their fate.
            let is_stray = |place: &u32| found.contains(&key_of(position(place)));
            places = (0..local.len() as u32).filter(is_stray).collect();
        }
        let bulk = bulk_of(positions, &places);
        let mut strays = Self { places, bulk, farthest: 0.0, reach, order };
        let distances = strays.places.iter().map(|&at| strays.distance(&positions[at as usize]));
        strays.farthest = distances.fold(0.0, f64::max);
        Some(strays)
    }

    /// How far a point lies from the box around the bulk; 0 inside.
    #[must_use]
    pub fn distance(&self, p: &[f64; 3]) -> f64 {
        let [low, high] = self.bulk;
        let away = |axis: usize| (low[axis] - p[axis]).max(p[axis] - high[axis]).max(0.0);
        // Not squared: coordinates may be as large as f64 has them.
        away(0).hypot(away(1)).hypot(away(2))
    }

    /// The strays of an object, in words. `in_file` are its positions as its file has them.
    #[must_use]
    pub fn apart(&self, object: usize, in_file: &[[f64; 3]]) -> Apart {
        Apart {
            count: self.places.len() as u64,
            is_counted: true,
            of: in_file.len() as u64,
            farthest: self.farthest,
            size: size_of(self.bulk),
            is_volume: false,
            is_drawn: false,
            filter: (self.farthest > 0.0).then(|| filter(object, bulk_of(in_file, &self.places))),
        }
    }
}

/// Where f32 resolves most of the points of some sets: the middle of the box around all, or, where that is far larger
/// than what the inner nine tenths of them take up along each axis, the middle of these; `None` without points.
#[must_use]
pub fn rough_origin(sets: &[&[[f64; 3]]]) -> Option<[f64; 3]> {
    const SAMPLE: usize = 4096;
    const FAR_LARGER: f64 = 256.0;
    let [low, high] = bounds_of(sets.iter().copied())?;
    let sample: Vec<[f64; 3]> = sets
        .iter()
        .flat_map(|set| set.iter().step_by(set.len().div_ceil(SAMPLE).max(1)).copied())
        .collect();
    let inner = [0, 1, 2].map(|axis| {
        let mut values: Vec<f64> = sample.iter().map(|p| p[axis]).collect();
        values.sort_unstable_by(f64::total_cmp);
        // One at either end of a few.
        let rim = (values.len() / 20).max(usize::from(values.len() >= FEWEST));
        [values[rim], values[values.len() - 1 - rim]]
    });
    let half = |[low, high]: [f64; 2]| 0.5 * high - 0.5 * low;
    let largest = |spans: [[f64; 2]; 3]| spans.map(half).into_iter().fold(0.0, f64::max);
    let whole = [0, 1, 2].map(|axis| [low[axis], high[axis]]);
    let spans = if largest(whole) > FAR_LARGER * largest(inner) { inner } else { whole };
    Some(spans.map(|[low, high]| middle(low, high)))
}

/// The box around all points but some, whose places ascend.
fn bulk_of(positions: &[[f64; 3]], left_out: &[u32]) -> [[f64; 3]; 2] {
    let mut first = 0;
    let mut runs: Vec<&[[f64; 3]]> = Vec::new();
    for end in left_out.iter().map(|&place| place as usize).chain([positions.len()]) {
        runs.push(&positions[first..end]);
        first = end + 1;
    }
    bounds_of(runs).unwrap_or_default()
}

/// Which of some distinct positions along a curve are stray, ascending, and the median of r.
fn stray_places(points: &[[f32; 3]], steps: &Steps<'_>) -> Option<(Vec<u32>, f64)> {
    let count = points.len();
    if count < FEWEST {
        return Some((Vec::new(), 0.0));
    }
    let tree = Boxes::new(points);
    let mut gone = Gone { flags: vec![false; count], count: 0 };
    let mut measured: Vec<f64> = (0..MEASURED.min(count))
        .into_par_iter()
        .map(|i| {
            tree.around((i * count / MEASURED.min(count)) as u32, &gone, f64::INFINITY).farthest
        })
        .collect();
    measured.sort_unstable_by(f64::total_cmp);
    let median = measured[measured.len() / 2];
    let enough = 4.0 * median;
    // Most runs of points lie so close together that each has enough of the others within reach.
    let is_dense = |run: &[[f32; 3]]| {
        let [low, high] = run.iter().map(|&p| [p, p]).fold(EMPTY, join);
        run.len() > NEIGHBORS && square(low, high) <= enough * enough
    };
    let runs = count.div_ceil(RUN);
    let mut sparse: Vec<(f64, u32)> = Vec::new();
    for first in (0..runs).step_by(SHOWN / RUN) {
        let some = (first..runs.min(first + SHOWN / RUN)).into_par_iter();
        sparse.par_extend(
            some.with_min_len(PART / RUN)
                .map(|run| run * RUN..count.min((run + 1) * RUN))
                .filter(|run| !is_dense(&points[run.clone()]))
                .flat_map_iter(|run| run.map(|at| (bound_of(points, at, enough), at as u32)))
                .filter(|(bound, _)| *bound > enough),
        );
        steps.reach(SORTED + (BOUNDED - SORTED) * (first as f64 / runs as f64))?;
    }
    if sparse.len() > SEARCHED {
        sparse.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        sparse.truncate(SEARCHED);
    }
    sparse.sort_unstable_by_key(|&(_, at)| at);
    let mut left: Vec<(u32, Around)> = Vec::new();
    for (few, done) in sparse.chunks(SEARCHES_SHOWN).zip((0..).step_by(SEARCHES_SHOWN)) {
        left.par_extend(
            few.par_iter()
                .map(|&(bound, at)| (at, tree.around(at, &gone, bound)))
                .filter(|(_, own)| own.farthest > enough),
        );
        // Later rounds are rare, and stand at the end.
        steps.reach(BOUNDED + (1.0 - BOUNDED) * (done as f64 / sparse.len() as f64))?;
    }
    // The s of each: that of most is known, since what lies among sparse points is sparse.
    let s_of = |own: &Around, left: &[(u32, Around)], gone: &Gone| match left
        .binary_search_by_key(&own.last, |(at, _)| *at)
    {
        Ok(known) => left[known].1.farthest,
        Err(_) => tree.around(own.last, gone, f64::INFINITY).farthest,
    };
    let mut s: Vec<f64> = left.par_iter().map(|(_, own)| s_of(own, &left, &gone)).collect();
    for _ in 0..ROUNDS {
        let is_stray = |&((_, own), &s): &(&(u32, Around), &f64)| {
            let (r, d) = (own.farthest, own.nearest);
            if count < SMALL {
                let nearest = tree.around(own.first, &gone, f64::INFINITY);
                return d > FAR * median && d > FAR * nearest.farthest;
            }
            (r > 8.0 * median && r > 10.0 * s) || d > 3.0 * s
        };
        let found: Vec<u32> =
            left.iter().zip(&s).filter(is_stray).map(|((at, _), _)| *at).collect();
        if found.is_empty() {
            break;
        }
        for &at in &found {
            gone.flags[at as usize] = true;
        }
        gone.count += found.len();
        if gone.count > (count / MOST).max(1) || count - gone.count < FEWEST {
            return Some((Vec::new(), median));
        }
        // What those were near to is searched for anew.
        let are_few = found.len() * left.len() <= COMPARED;
        let lost = |at: u32, reach: f64| {
            if !are_few {
                return true;
            }
            let center = points[at as usize];
            let reach = reach * reach * (1.0 + 1e-9);
            found.iter().any(|&gone| square(points[gone as usize], center) <= reach)
        };
        let mut keep = left.iter().map(|(at, _)| !gone.flags[*at as usize]);
        s.retain(|_| keep.next().unwrap_or_default());
        left.retain(|(at, _)| !gone.flags[*at as usize]);
        left.par_iter_mut().filter(|(at, own)| lost(*at, own.farthest)).for_each(|(at, own)| {
            *own = tree.around(*at, &gone, f64::INFINITY);
        });
        s.par_iter_mut()
            .zip(&left)
            .filter(|(s, (at, own))| lost(own.last, **s) || lost(*at, own.farthest))
            .for_each(|(s, (_, own))| *s = s_of(own, &left, &gone));
    }
    outskirts::take_back(&tree, &mut gone, enough);
    Some(((0..count as u32).filter(|&at| gone.flags[at as usize]).collect(), median))
}

/// Points that are left out of a search.
struct Gone {
    flags: Vec<bool>,
    count: usize,
}

/// An upper bound of the distance to the [`NEIGHBORS`]-th nearest other: that among those beside a point on the
/// curve. Those of the nearest places do where they are within `enough`.
fn bound_of(points: &[[f32; 3]], at: usize, enough: f64) -> f64 {
    let around = |reach: usize| {
        let first = at.saturating_sub(reach).min(points.len().saturating_sub(2 * reach + 1));
        &points[first..points.len().min(first + 2 * reach + 1)]
    };
    // Squares of f32 may be infinite, and then are not enough. The point itself is at no distance.
    let [x, y, z] = points[at];
    let near = around(NEIGHBORS / 2).iter().fold(0.0, |most: f32, p| {
        let [x, y, z] = [p[0] - x, p[1] - y, p[2] - z];
        most.max(x * x + y * y + z * z)
    });
    let near = f64::from(near).sqrt();
    if near <= enough || points.len() < SMALL {
        return near;
    }
    let mut squares: Vec<f64> = around(WINDOW).iter().map(|&p| square(points[at], p)).collect();
    let (_, &mut farthest, _) = squares.select_nth_unstable_by(NEIGHBORS, f64::total_cmp);
    farthest.sqrt()
}

#[cfg(test)]
mod tests;
