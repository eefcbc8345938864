//! Exact k nearest neighbours, on the CPU.
//!
//! Neighbours are ordered by (d², place in the file) with d² = (dx·dx + dy·dy) + dz·dz in f32: on
//! grids and terrains ties are the rule, and the order must not depend on the search. A k-d tree
//! with a bounding box a node; the distance to a box is computed with the operations of d², and
//! rounding is monotone, so no neighbour is pruned by rounding. Points that coincide share a leaf of
//! which a query reads at most k + 1, so a million identical points cost no more than others.

pub use crate::spacing::median_spacing;

use kernels::layout::{NONE, Point};
use rayon::prelude::*;

/// Points in a leaf, at most, unless they coincide.
const LEAF: usize = 8;

/// A search structure over the points of one object.
#[derive(Debug)]
pub struct NeighborSearch<'a> {
    points: &'a [Point],
    first_slot: u32,
    /// Places in `points`, leaf after leaf; within a leaf by place in the file.
    members: Vec<u32>,
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    low: [f32; 3],
    high: [f32; 3],
    /// A leaf's members, or the node's two children.
    content: Content,
}

#[derive(Debug, Clone, Copy)]
enum Content {
    Leaf { first: u32, count: u32 },
    Children([u32; 2]),
}

/// One candidate: (d², place in the file, place in memory).
type Found = (f32, u32, u32);

impl<'a> NeighborSearch<'a> {
    /// Builds the tree over the points of one object, whose first slot is `first_slot`.
    #[must_use]
    pub fn new(points: &'a [Point], first_slot: u32) -> Self {
        let mut members: Vec<u32> = (0..points.len() as u32).collect();
        let mut nodes = Vec::with_capacity(points.len() / 2 + 1);
        if !points.is_empty() {
            build(points, &mut members, 0, &mut nodes);
        }
        Self { points, first_slot, members, nodes }
    }

    /// The k nearest others of each point of `range` (places in the slice of points), nearest first,
    /// k entries a point: slots, `NONE` where there are fewer than k others.
    #[must_use]
    pub fn nearest(&self, range: std::ops::Range<usize>, k: usize) -> Vec<u32> {
        let mut lists = vec![NONE; range.len() * k];
        lists.par_chunks_mut(k).enumerate().for_each_init(
            || (Vec::with_capacity(k + 1), Vec::with_capacity(64)),
            |(found, stack), (i, list)| {
                self.query(range.start + i, k, found, stack);
                for (entry, &(_, _, place)) in list.iter_mut().zip(found.iter()) {
                    *entry = self.first_slot + place;
                }
            },
        );
        lists
    }

    /// The feature size of each point, smoothed: the mean of its own distance to the farthest of k
    /// neighbours and of theirs, in the units of the positions. A point apart from dense ones gets
    /// a size like theirs, and no surface that spans the gap.
    #[must_use]
    pub fn smoothed_sizes(&self, k: usize) -> Vec<f32> {
        let lists = self.nearest(0..self.points.len(), k);
        let neighbors = |list: &'_ [u32]| -> Vec<usize> {
            let slots = list.iter().take_while(|&&slot| slot != NONE);
            slots.map(|slot| (slot - self.first_slot) as usize).collect()
        };
        let reach: Vec<f32> = lists
            .par_chunks(k)
            .zip(self.points)
            .map(|(list, point)| {
                let farthest = neighbors(list).last().map(|&other| self.points[other].position);
                farthest.map_or(0.0, |other| squared_distance(point.position, other).sqrt())
            })
            .collect();
        lists
            .par_chunks(k)
            .zip(&reach)
            .map(|(list, own)| {
                let others = neighbors(list);
                others.iter().fold(*own, |sum, &other| sum + reach[other])
                    / (others.len() + 1) as f32
            })
            .collect()
    }

    fn query(&self, at: usize, k: usize, found: &mut Vec<Found>, stack: &mut Vec<(f32, u32)>) {
        found.clear();
        stack.clear();
        stack.push((0.0, 0));
        let center = self.points[at].position;
        while let Some((distance, node)) = stack.pop() {
            if found.len() == k && found.last().is_some_and(|worst| distance > worst.0) {
                continue;
            }
            let node = &self.nodes[node as usize];
            match node.content {
                Content::Leaf { first, count } => {
                    let members = &self.members[first as usize..(first + count) as usize];
                    let coincide = node.low == node.high;
                    let members =
                        &members[..if coincide { members.len().min(k + 1) } else { members.len() }];
                    for &member in members.iter().filter(|&&member| member as usize != at) {
                        let point = &self.points[member as usize];
                        insert(
                            found,
                            k,
                            (squared_distance(center, point.position), point.index, member),
                        );
                    }
                }
                Content::Children(children) => {
                    let [near, far] =
                        children.map(|child| (self.distance_to_box(child, center), child));
                    let (near, far) = if far.0 < near.0 { (far, near) } else { (near, far) };
                    stack.extend([far, near]);
                }
            }
        }
    }

    fn distance_to_box(&self, node: u32, p: [f32; 3]) -> f32 {
        let Node { low, high, .. } = self.nodes[node as usize];
        distance_to_box(low, high, p)
    }
}

/// Points of a block, by which few points look for their neighbours.
const BLOCK: usize = 1024;

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
    let boxes: Vec<_> = points.par_chunks(BLOCK).map(box_around).collect();
    lists.par_chunks_mut(k).zip(few).for_each(|(list, at)| {
        let center = points[at].position;
        let mut blocks: Vec<(f32, usize)> =
            boxes.iter().map(|[low, high]| distance_to_box(*low, *high, center)).zip(0..).collect();
        blocks.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut found: Vec<Found> = Vec::with_capacity(k + 1);
        for (distance, block) in blocks {
            if found.len() == k && found.last().is_some_and(|worst| distance > worst.0) {
                break;
            }
            let first = block * BLOCK;
            let members = &points[first..points.len().min(first + BLOCK)];
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

/// d² as every neighbour search of the project computes it.
fn squared_distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let [x, y, z] = [0, 1, 2].map(|axis| b[axis] - a[axis]);
    (x * x + y * y) + z * z
}

/// Keeps the k least candidates in order.
fn insert(found: &mut Vec<Found>, k: usize, candidate: Found) {
    let key = |f: &Found| (f.0, f.1);
    if found.len() == k {
        if found.last().is_none_or(|worst| key(&candidate) >= key(worst)) {
            return;
        }
        found.pop();
    }
    let place = found.partition_point(|f| key(f) < key(&candidate));
    found.insert(place, candidate);
}

/// Builds the node over `members`, whose first is the `first` of the whole list; returns its place.
fn build(points: &[Point], members: &mut [u32], first: usize, nodes: &mut Vec<Node>) -> u32 {
    let position = |member: u32| points[member as usize].position;
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for &member in members.iter() {
        let p = position(member);
        for axis in 0..3 {
            low[axis] = low[axis].min(p[axis]);
            high[axis] = high[axis].max(p[axis]);
        }
    }
    let at = nodes.len();
    nodes.push(Node {
        low,
        high,
        content: Content::Leaf { first: first as u32, count: members.len() as u32 },
    });
    if members.len() <= LEAF || low == high {
        members.sort_unstable_by_key(|&member| points[member as usize].index);
        return at as u32;
    }
    let extent = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    let wider = if extent[1] > extent[0] { 1 } else { 0 };
    let axis = if extent[2] > extent[wider] { 2 } else { wider };
    let half = members.len() / 2;
    members.select_nth_unstable_by(half, |&a, &b| position(a)[axis].total_cmp(&position(b)[axis]));
    let (left, right) = members.split_at_mut(half);
    let left = build(points, left, first, nodes);
    let right = build(points, right, first + half, nodes);
    nodes[at].content = Content::Children([left, right]);
    at as u32
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
        let mut all: Vec<Found> = (0..points.len())
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
    }

    /// Beside a dense line, a point far off has a reach of 100 but a smoothed size near the others'.
    #[test]
    fn smoothed_sizes_follow_the_neighbours() {
        let mut line: Vec<[f32; 3]> = (0..50).map(|i| [i as f32, 0.0, 0.0]).collect();
        line.push([25.0, 100.0, 0.0]);
        let line = points(line);
        let sizes = NeighborSearch::new(&line, 0).smoothed_sizes(4);
        assert_eq!(sizes[25], 2.0);
        // Itself at 100 and a bit, its four neighbours at 2 each.
        assert!((sizes[50] - (100.02 + 8.0) / 5.0).abs() < 0.1, "{}", sizes[50]);
    }

    #[test]
    fn median_spacing_of_a_unit_grid_is_one() {
        let grid: Vec<[f64; 3]> =
            (0..100).map(|i| [5e6 + f64::from(i % 10), f64::from(i / 10), 7.0]).collect();
        assert_eq!(median_spacing(&grid), Some(1.0));
        assert_eq!(median_spacing(&grid[..1]), None);
    }
}
