//! Exact k nearest neighbours, on the CPU.
//!
//! Neighbours are ordered by (d², place in the file) with d² = (dx·dx + dy·dy) + dz·dz in f32: on
//! grids and terrains ties are the rule, and the order must not depend on the search. A k-d tree
//! with a bounding box a node; the distance to a box is computed with the operations of d², and
//! rounding is monotone, so no neighbour is pruned by rounding. A box also holds the least place in the
//! file of its points, by which it is pruned where it is as far as the last neighbour: so a million
//! points in one place, which lie there in the order of the file, cost no more than others.
//!
//! Eight points are a block, eight blocks a node, eight nodes one of the next level, and so on; the distances to
//! eight points or boxes are computed together. A query begins with a bound: the distance within which the last
//! query's neighbours lie. Points that follow each other should therefore lie close together, as those of a
//! [`Cloud`](crate::Cloud) do; the lists do not depend on it.

mod few;
mod tree;

pub use crate::spacing::median_spacing;
pub use few::nearest_of_few;

use kernels::layout::{NONE, Point};
use rayon::prelude::*;
use tree::{Tree, WIDTH};

/// Queries that one thread takes at once.
const QUERIES: usize = 1 << 9;

/// A search structure over the points of one object.
#[derive(Debug)]
pub struct NeighborSearch<'a> {
    points: &'a [Point],
    first_slot: u32,
    tree: Tree,
    /// Where in the tree each point lies, `NONE` where it was removed; empty until the first is.
    lanes: Vec<u32>,
}

/// (d², place in the file) as one number in their order: d² is not negative.
fn key(square: f32, index: u32) -> u64 {
    u64::from(square.to_bits()) << 32 | u64::from(index)
}

/// Above the keys of all points, but not above those of what is empty.
const EVERYTHING: u64 = (f32::INFINITY.to_bits() as u64) << 32 | u32::MAX as u64;

/// A neighbour, or a candidate.
#[derive(Debug, Clone, Copy)]
struct Found {
    key: u64,
    /// In memory.
    place: u32,
}

/// A node or block to visit.
#[derive(Debug, Clone, Copy)]
struct Visit {
    /// Least key that a point of it can have.
    bound: u64,
    /// 0: a block.
    level: u32,
    nth: u32,
}

/// The state of a query, kept from one to the next for its memory and its neighbours.
struct Query {
    k: usize,
    /// In order, up to k.
    found: Vec<Found>,
    /// The nearest last.
    visits: Vec<Visit>,
    /// The point whose neighbours were found last.
    last: Option<u32>,
    /// Only keys below this are of interest.
    limit: u64,
}

impl Query {
    fn new(k: usize) -> Self {
        Self {
            k,
            found: Vec::with_capacity(k),
            visits: Vec::with_capacity(64),
            last: None,
            limit: EVERYTHING,
        }
    }

    /// Empties it, after a bound for the neighbours of another point was found from those of the last: that
    /// one and all but one of those are k others within it.
    fn begin(&mut self, points: &[Point], at: u32) {
        self.limit = EVERYTHING;
        if let (Some(last), true) = (self.last, self.found.len() == self.k) {
            let center = points[at as usize].position;
            let square = |place: u32| squared_distance(center, points[place as usize].position);
            // That point itself may be among them, at no distance.
            let mut farthest = square(last);
            for found in &self.found {
                let square = square(found.place);
                farthest = if square > farthest { square } else { farthest };
            }
            self.limit = self.limit.min((u64::from(farthest.to_bits()) + 1) << 32);
        }
        self.found.clear();
        self.visits.clear();
        self.last = Some(at);
    }

    fn insert(&mut self, candidate: Found) {
        if self.found.len() < self.k {
            self.found.push(candidate);
        }
        let found = &mut self.found[..];
        let mut to = 0;
        for at in (1..found.len()).rev() {
            if found[at - 1].key <= candidate.key {
                to = at;
                break;
            }
            found[at] = found[at - 1];
        }
        found[to] = candidate;
        if found.len() == self.k {
            self.limit = self.limit.min(found[self.k - 1].key);
        }
    }

    /// Adds what is to be visited before all that was added earlier, from place `first` of the list on in order.
    fn visit(&mut self, first: usize, next: Visit) {
        self.visits.push(next);
        let added = &mut self.visits[first..];
        let mut to = 0;
        for at in (1..added.len()).rev() {
            if added[at - 1].bound >= next.bound {
                to = at;
                break;
            }
            added[at] = added[at - 1];
        }
        added[to] = next;
    }
}

impl<'a> NeighborSearch<'a> {
    /// Builds the tree over the points of one object, whose first slot is `first_slot`.
    #[must_use]
    pub fn new(points: &'a [Point], first_slot: u32) -> Self {
        Self { points, first_slot, tree: Tree::new(points), lanes: Vec::new() }
    }

    /// Leaves points out of all lists from now on; they themselves get none.
    pub fn remove(&mut self, places: &[u32]) {
        if self.lanes.is_empty() {
            self.lanes = self.tree.lanes(self.points.len());
        }
        for &place in places {
            let lane = std::mem::replace(&mut self.lanes[place as usize], NONE);
            self.tree.remove(lane);
        }
    }

    /// The k nearest others of each point of `range` (places in the slice of points), nearest first,
    /// k entries a point: slots, `NONE` where there are fewer than k others.
    #[must_use]
    pub fn nearest(&self, range: std::ops::Range<usize>, k: usize) -> Vec<u32> {
        let place = |at: usize| (range.start + at) as u32;
        self.lists(range.len(), place, k)
    }

    /// The same of some points.
    ///
    /// # Panics
    /// Where one of them was removed.
    #[must_use]
    pub fn nearest_of(&self, places: &[u32], k: usize) -> Vec<u32> {
        self.lists(places.len(), |at| places[at], k)
    }

    fn lists(&self, count: usize, place: impl Fn(usize) -> u32 + Sync, k: usize) -> Vec<u32> {
        let mut lists = vec![NONE; count * k];
        lists.par_chunks_mut(k * QUERIES).enumerate().for_each(|(part, lists)| {
            let mut query = Query::new(k);
            for (at, list) in (part * QUERIES..).zip(lists.chunks_mut(k)) {
                self.find(&mut query, place(at), list);
            }
        });
        lists
    }

    /// The distance of a point to the last of its list, 0 where that is empty.
    #[must_use]
    pub fn reach(&self, at: usize, list: &[u32]) -> f32 {
        let farthest = self.listed(list).last().map(|other| self.points[other].position);
        farthest.map_or(0.0, |far| squared_distance(self.points[at].position, far).sqrt())
    }

    /// The feature size of a point, smoothed: the mean of the [reaches](Self::reach) of it and of its list. A
    /// point apart from dense ones gets a size like theirs, and no surface that spans the gap.
    #[must_use]
    pub fn smoothed_size(&self, at: usize, list: &[u32], reaches: &[f32]) -> f32 {
        let sum = self.listed(list).fold(reaches[at], |sum, other| sum + reaches[other]);
        sum / (self.listed(list).count() + 1) as f32
    }

    /// Places of the points in a list.
    fn listed(&self, list: &[u32]) -> impl Iterator<Item = usize> {
        let slots = list.iter().take_while(|&&slot| slot != NONE);
        slots.map(|slot| (slot - self.first_slot) as usize)
    }

    fn find(&self, query: &mut Query, at: u32, list: &mut [u32]) {
        let is_left = self.lanes.get(at as usize).is_none_or(|&lane| lane != NONE);
        assert!(is_left, "the neighbours of a point that was removed");
        query.begin(self.points, at);
        let center = self.points[at as usize].position;
        query.visits.push(Visit { bound: 0, level: self.tree.levels.len() as u32, nth: 0 });
        while let Some(Visit { bound, level, nth }) = query.visits.pop() {
            if bound >= query.limit {
                continue;
            }
            if level == 0 {
                let block = &self.tree.blocks[nth as usize];
                let squares = block.distances(center);
                for lane in lanes_within(&squares, query.limit) {
                    let key = key(squares[lane], block.index[lane]);
                    let place = block.place[lane];
                    if key < query.limit && place != at {
                        query.insert(Found { key, place });
                    }
                }
            } else {
                let boxes = &self.tree.levels[level as usize - 1][nth as usize];
                let squares = boxes.distances(center);
                let first = query.visits.len();
                for lane in lanes_within(&squares, query.limit) {
                    let bound = key(squares[lane], boxes.least[lane]);
                    if bound < query.limit {
                        let nth = nth * WIDTH as u32 + lane as u32;
                        query.visit(first, Visit { bound, level: level - 1, nth });
                    }
                }
            }
        }
        for (entry, found) in list.iter_mut().zip(&query.found) {
            *entry = self.first_slot + found.place;
        }
    }
}

/// The lanes whose keys may be below the limit.
fn lanes_within(squares: &[f32; WIDTH], limit: u64) -> impl Iterator<Item = usize> {
    let farthest = f32::from_bits((limit >> 32) as u32);
    let mut bits = [0u32; WIDTH];
    for (lane, (bit, square)) in bits.iter_mut().zip(squares).enumerate() {
        *bit = if *square <= farthest { 1 << lane } else { 0 };
    }
    let mut near = bits.iter().fold(0, |all, bit| all | bit);
    std::iter::from_fn(move || {
        let lane = near.trailing_zeros() as usize;
        near &= near.wrapping_sub(1);
        (lane < WIDTH).then_some(lane)
    })
}

/// d² as every neighbour search of the project computes it.
fn squared_distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let [x, y, z] = [0, 1, 2].map(|axis| b[axis] - a[axis]);
    (x * x + y * y) + z * z
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A generator of pseudo-random numbers in [0, 1): tests need the same points every time.
    fn random(seed: &mut u64) -> f32 {
        *seed =
            seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 40) as f32 / (1u64 << 24) as f32
    }

    fn points(positions: impl IntoIterator<Item = [f32; 3]>) -> Vec<Point> {
        positions
            .into_iter()
            .enumerate()
            .map(|(i, position)| Point { position, index: i as u32 })
            .collect()
    }

    fn brute_force(points: &[Point], at: usize, k: usize) -> Vec<u32> {
        let mut all: Vec<(f32, u32, u32)> = (0..points.len())
            .filter(|&i| i != at)
            .map(|i| {
                (
                    squared_distance(points[at].position, points[i].position),
                    points[i].index,
                    i as u32,
                )
            })
            .collect();
        all.sort_by(|a, b| a.partial_cmp(b).expect("finite"));
        let mut list: Vec<u32> = all.iter().take(k).map(|found| found.2).collect();
        list.resize(k, NONE);
        list
    }

    fn check(points: &[Point], k: usize) {
        let lists = NeighborSearch::new(points, 0).nearest(0..points.len(), k);
        assert_eq!(lists, nearest_of_few(points, 0, 0..points.len(), k), "with and without a tree");
        for (at, list) in lists.chunks(k).enumerate() {
            assert_eq!(list, brute_force(points, at, k), "neighbours of point {at}, k = {k}");
        }
    }

    #[test]
    fn agrees_with_brute_force_also_where_ties_are_the_rule() {
        let mut seed = 1;
        check(&points((0..500).map(|_| [0; 3].map(|_| random(&mut seed)))), 16);
        check(&points((0..400).map(|i| [(i % 20) as f32, (i / 20) as f32, 0.0])), 16); // a terrain
        check(&points((0..300).map(|i| [i as f32, 0.0, 0.0])), 5); // collinear
        check(&points((0..100).map(|_| [1.0, 2.0, 3.0])), 16); // identical
        check(&points((0..300).map(|i| [(i % 3) as f32, 0.0, (i % 2) as f32])), 64); // six places
        check(
            &points(
                (0..200).map(|i| if i == 77 { [1e6; 3] } else { [random(&mut seed), 0.0, 1.0] }),
            ),
            16,
        );
        for few in 1..6 {
            check(&points((0..few).map(|i| [i as f32, 1.0, 0.0])), 16);
        }
    }

    /// In an order that has nothing to do with where they lie, as no cloud has them.
    #[test]
    fn the_order_of_points_in_memory_changes_no_list() {
        let mut seed = 11;
        for scale in [|x: f32| x, |x: f32| (18.0 * (x - 1.0)).exp(), |x: f32| (4.0 * x).floor()] {
            let mut set = points((0..700).map(|_| [0; 3].map(|_| scale(random(&mut seed)))));
            for (at, point) in set.iter_mut().enumerate() {
                point.index = (at as u32 * 257) % 1_009; // a prime, so that each is another
            }
            check(&set, 16);
            check(&set, 40);
        }
    }

    #[test]
    fn points_that_were_removed_are_in_no_list() {
        let mut seed = 5;
        let mut set = points((0..600).map(|_| [0; 3].map(|_| random(&mut seed))));
        set.extend(points([[0.5; 3]; 100]));
        for (index, point) in (0..).zip(&mut set) {
            point.index = index;
        }
        let mut search = NeighborSearch::new(&set, 30);
        let mut left: Vec<u32> = (0..700).collect();
        while left.len() > 50 {
            let (gone, kept) = left.iter().partition::<Vec<u32>, _>(|_| random(&mut seed) < 0.3);
            search.remove(&gone);
            left = kept;
            let others: Vec<Point> = left.iter().map(|&place| set[place as usize]).collect();
            let expected = (0..left.len()).flat_map(|at| brute_force(&others, at, 16));
            let expected: Vec<u32> = expected.map(|nth| left[nth as usize] + 30).collect();
            assert_eq!(search.nearest_of(&left, 16), expected, "{} left", left.len());
        }
        search.remove(&left[1..]);
        assert_eq!(search.nearest_of(&left[..1], 2), [NONE; 2]);
    }

    /// Blocks that are far, near, and the last, which is not whole; many at the same distance.
    #[test]
    fn few_points_find_the_same_block_after_block() {
        let mut seed = 3;
        let line = points((0..5_000).map(|i| [i as f32, random(&mut seed), random(&mut seed)]));
        let anywhere = points((0..5_000).map(|_| [0; 3].map(|_| random(&mut seed))));
        let lattice = points((0..5_000).map(|i| [(i % 70) as f32, (i / 70) as f32, 0.0]));
        for set in [line, anywhere, lattice] {
            let tree = NeighborSearch::new(&set, 7);
            for first in [0, 1_020, 2_500, 4_992] {
                let range = first..first + 8;
                let few = nearest_of_few(&set, 7, range.clone(), 16);
                assert_eq!(few, tree.nearest(range, 16), "from {first}");
            }
        }
    }

    #[test]
    fn coinciding_points_do_not_make_queries_long() {
        // 200 000 × 200 000 comparisons would take minutes.
        let same = points((0..200_000).map(|_| [0.25; 3]));
        let lists = NeighborSearch::new(&same, 0).nearest(0..same.len(), 4);
        assert_eq!(lists[..8], [1, 2, 3, 4, 0, 2, 3, 4]);
        // Among others, so that the median lies among them; and so near that all of their d² are 0.
        let mut seed = 9;
        let others = (0..100_000)
            .map(|i| if i % 2 == 0 { [0.25; 3] } else { [0; 3].map(|_| random(&mut seed)) });
        let near =
            (0..100_000).map(|i| [1e-30 * (i % 1_000) as f32, 1e-30 * (i / 1_000) as f32, 0.0]);
        for set in [points(others), points(near)] {
            let lists = NeighborSearch::new(&set, 0).nearest(0..set.len(), 16);
            for at in (0..set.len()).step_by(9_973) {
                assert_eq!(lists[at * 16..][..16], brute_force(&set, at, 16), "point {at}");
            }
        }
    }

    /// Beside a dense line, a point far off has a reach of 100 but a smoothed size near the others'.
    #[test]
    fn smoothed_sizes_follow_the_neighbours() {
        let mut line: Vec<[f32; 3]> = (0..50).map(|i| [i as f32, 0.0, 0.0]).collect();
        line.push([25.0, 100.0, 0.0]);
        let line = points(line);
        let search = NeighborSearch::new(&line, 0);
        let lists = search.nearest(0..51, 4);
        let lists: Vec<&[u32]> = lists.chunks(4).collect();
        let reaches: Vec<f32> = (0..51).map(|at| search.reach(at, lists[at])).collect();
        let sizes = [0, 25, 50].map(|at| search.smoothed_size(at, lists[at], &reaches));
        assert_eq!(sizes[1], 2.0);
        // Itself at 100 and a bit, its four neighbours at 2 each.
        assert!((sizes[2] - (100.02 + 8.0) / 5.0).abs() < 0.1, "{}", sizes[2]);
    }

    #[test]
    fn median_spacing_of_a_unit_grid_is_one() {
        let grid: Vec<[f64; 3]> =
            (0..100).map(|i| [5e6 + f64::from(i % 10), f64::from(i / 10), 7.0]).collect();
        assert_eq!(median_spacing(&grid), Some(1.0));
        assert_eq!(median_spacing(&grid[..1]), None);
    }
}
