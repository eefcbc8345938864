//! Where the grids lie and how fine they are (\[T\] §5).
//!
//! Plain data, made from the trust balls of the fitted points. The paper gives one grid, of 20³ cells for
//! 35 000 points; measurement (docs/benchmarks.md) puts the best edge at two to three trust radii, which
//! is a little finer, and with even points is the same rule: it follows their number.
//!
//! One grid cannot be fine for a statue and coarse for the landscape around it. Where the sizes of trust
//! balls differ much, each size has its own grid, over no more than the place where such balls are: a
//! hierarchical grid (Ericson, Real-Time Collision Detection, 2005, section 7.2). A ray goes through one after
//! another, the finest first.

use kernels::layout::{FitOutcome, GridInfo, GridLevel, MOST_LEVELS, Point};
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::VecDeque;

/// Radius that the grid lists a point with, over its trust radius: rounding then loses no cell that a
/// hit lies in.
pub const BALL_MARGIN: f32 = 1.0001;

/// Edge of a cell over the median trust radius.
const EDGE_PER_TRUST: f64 = 2.5;
/// Cells a point, at most: 8 bytes each.
const CELLS_PER_POINT: f64 = 8.0;
/// Pairs of cell and point a point, at most, before the exact test; even sets have about six.
const PAIRS_PER_POINT: f64 = 48.0;
/// Bytes a point of both, at most: with the 64 of its polynomial, and the 10 of the tree where there is one, tracing holds
/// 100. Of the pairs before the exact test, so many are listed.
const BYTES_PER_POINT: f64 = 36.0;
const BYTES_BESIDE_TREE: f64 = 25.5;
const LISTED_PAIRS: f64 = 0.9;
/// Cells along the longest axis of a grid that lists nothing.
const COARSE: u32 = 32;
/// Few points may still have this many cells and pairs.
const ALWAYS_ALLOWED: f64 = 65_536.0;
/// Neither cells (8 bytes) nor pairs (4 bytes) may outgrow one binding of 128 MiB, whatever the number of points.
const CELLS_ALLOWED: f64 = 16_000_000.0;
const PAIRS_ALLOWED: f64 = 32_000_000.0;

/// Cells from which on it pays that rays leave empty ones together: the search for distances, and more work a step.
const SKIPPING_CELLS: u32 = 150_000;

/// A grid is too coarse where its cells are so much wider than those that its small balls would have alone, and where
/// most of these have over so many others in their cell; on an even surface it is some twelve.
const TOO_COARSE: f64 = 1.5;
const CROWDED: u32 = 64;
/// Small balls: those up to the radius of this one of all, or of one in a hundred where that is less.
const SMALL_BALLS: usize = 256;
/// Radii of one grid differ by this much, and up to the emptiest radius within this range.
const ONE_SIZE: f64 = 4.0;
const VALLEY: [f64; 2] = [2.0, 8.0];
/// Part of a grid's length that must be empty for two to be made of it, and in how many parts it is looked for.
const GAP: f64 = 0.1;
const GAP_BINS: usize = 256;
/// Giants are fewer than one in so many balls.
const FEW_GIANTS: usize = 64;
/// Parts of the cells and offsets of all grids begin at multiples of this many, so that they can be bound.
const FIRST_CELL: u32 = 64;

/// Trust balls: centre and radius.
type Ball = ([f32; 3], f32);
/// Balls from which on cells and pairs of a part of them say how fine a grid may be, before those of all do.
const MANY: usize = 1 << 20;
const PART: usize = 16;

/// The grids of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Grids {
    /// One, or several where sizes of trust balls differ: then the finest first.
    pub levels: Vec<GridLevel>,
    /// Slots of each, ascending, where there are several.
    slots: Vec<Vec<u32>>,
}

impl Grids {
    fn new(mut groups: Vec<(GridInfo, Vec<u32>)>) -> Self {
        let key = |info: &GridInfo| (info.edge.to_bits(), info.origin.map(f32::to_bits));
        groups.sort_by_key(|(info, _)| key(info));
        let mut levels: Vec<GridLevel> = Vec::new();
        let (mut first_cell, mut first_offset) = (0, 0);
        for (grid, slots) in &groups {
            let cells = grid.cell_count();
            levels.push(GridLevel {
                grid: *grid,
                first_cell,
                first_offset,
                first_slot: slots.first().map_or(0, |&slot| slot),
                end_slot: slots.last().map_or(0, |&slot| slot + 1),
            });
            first_cell += cells.next_multiple_of(FIRST_CELL);
            first_offset += (cells + 1).next_multiple_of(FIRST_CELL);
        }
        Self { levels, slots: groups.into_iter().map(|(_, slots)| slots).collect() }
    }

    /// One alone.
    #[must_use]
    pub fn single(grid: GridInfo) -> Self {
        Self::new(vec![(grid, Vec::new())])
    }

    /// Where the points are, in one coarse grid that lists none of them: for rays that do not go through it.
    #[must_use]
    pub fn around(points: &[Point], outcomes: &[FitOutcome]) -> Self {
        let balls = points.par_iter().zip(outcomes).with_min_len(1 << 14);
        let none = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
        let joined = |a: [[f32; 3]; 2], b: [[f32; 3]; 2]| {
            let of =
                |side: usize, f: fn(f32, f32) -> f32| [0, 1, 2].map(|i| f(a[side][i], b[side][i]));
            [of(0, f32::min), of(1, f32::max)]
        };
        let ball = |(point, outcome): (&Point, &FitOutcome)| match outcome.trust > 0.0 {
            true => [-1.001, 1.001].map(|by| point.position.map(|x| x + by * outcome.trust)),
            false => none,
        };
        let bounds = balls.map(ball).reduce(|| none, joined);
        if bounds == none {
            return Self::single(EMPTY);
        }
        let corners = bounds.map(|corner| (corner, 0.0));
        let alone = Share { of_all: 1.0, budget: BYTES_PER_POINT };
        Self::single(plan_grid(&corners, 0.0, COARSE, alone))
    }

    /// Cells of all, and between them those that are none.
    #[must_use]
    pub fn cell_count(&self) -> u32 {
        self.levels.last().map_or(0, |last| last.first_cell + last.grid.cell_count())
    }

    /// Whether empty cells tell how far they are from others.
    #[must_use]
    pub fn skip_cells(&self) -> bool {
        self.cell_count() >= SKIPPING_CELLS
    }

    /// Edge of the finest one's cells.
    #[must_use]
    pub fn finest_edge(&self) -> f32 {
        self.levels[0].grid.edge
    }

    /// Whether there are several.
    #[must_use]
    pub fn are_several(&self) -> bool {
        self.levels.len() > 1
    }

    /// The slots of one grid, in the order that all of `order` have.
    #[must_use]
    pub fn order_of<'a>(&self, level: usize, order: &'a [u32]) -> Cow<'a, [u32]> {
        if !self.are_several() {
            return Cow::Borrowed(order);
        }
        let mut listed = vec![false; order.len()];
        for &slot in &self.slots[level] {
            listed[slot as usize] = true;
        }
        Cow::Owned(order.iter().copied().filter(|&slot| listed[slot as usize]).collect())
    }

    /// The box around all of them, as a grid.
    #[must_use]
    pub fn whole(&self) -> GridInfo {
        let [first, _, ..] = self.levels[..] else { return self.levels[0].grid };
        let [mut low, mut high] = [first.grid.origin; 2];
        for GridLevel { grid, .. } in &self.levels {
            low = [0, 1, 2].map(|axis| low[axis].min(grid.origin[axis]));
            let end = |axis: usize| grid.origin[axis] + grid.resolution[axis] as f32 * grid.edge;
            high = [0, 1, 2].map(|axis| high[axis].max(end(axis)));
        }
        let extent = [0, 1, 2].map(|axis| high[axis] - low[axis]);
        let edge = extent.into_iter().fold(0.0, f32::max);
        let inverse_edge = 1.0 / edge;
        GridInfo { origin: low, edge, resolution: [1; 3], inverse_edge }
    }
}

const EMPTY: GridInfo =
    GridInfo { origin: [-0.5; 3], edge: 1.0, resolution: [1; 3], inverse_edge: 1.0 };

/// The grids over all trust balls; a single empty cell where no point carries a surface.
///
/// `resolution` is the number of cells along the longest axis of a single grid, or 0: grids are chosen from the
/// points. Either way edges grow until cells and pairs stay within bounds, which are narrower `beside_tree`.
#[must_use]
pub fn plan_grids(
    points: &[Point],
    outcomes: &[FitOutcome],
    resolution: u32,
    beside_tree: bool,
) -> Grids {
    let budget = if beside_tree { BYTES_BESIDE_TREE } else { BYTES_PER_POINT };
    let carries = |outcome: &FitOutcome| outcome.trust > 0.0;
    let balls: Vec<Ball> = points
        .par_iter()
        .zip(outcomes)
        .with_min_len(1 << 14)
        .filter(|(_, outcome)| carries(outcome))
        .map(|(point, outcome)| (point.position, outcome.trust))
        .collect();
    if balls.is_empty() {
        return Grids::single(EMPTY);
    }
    let mut radii: Vec<f32> = balls.iter().map(|ball| ball.1).collect();
    if resolution > 0 {
        return Grids::single(plan_grid(&balls, 0.0, resolution, Share { of_all: 1.0, budget }));
    }
    let slots = || {
        let all = (0..).zip(outcomes).filter(|(_, outcome)| carries(outcome));
        all.map(|(slot, _)| slot).collect()
    };
    if let Some(radius) = radius_of_giants(&balls) {
        let all = Group { slots: slots(), balls };
        let [rest, giants] = all.parted(&|ball| f64::from(ball.1) <= radius);
        return Grids::new(split(vec![rest, giants], budget));
    }
    let (grid, is_fine) = plan_fine(&balls, &mut radii, Share { of_all: 1.0, budget });
    if is_fine {
        return Grids::single(grid);
    }
    Grids::new(split(vec![Group { slots: slots(), balls }], budget))
}

/// The radius over which balls are giants, where there are some, and few: they reach past all centres, such as the ground
/// below a scene. A grid around them has everything else in a few cells, and they say nothing about the size of cells.
fn radius_of_giants(balls: &[Ball]) -> Option<f64> {
    let none = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let [low, high] = balls.iter().fold(none, |[low, high], (center, _)| {
        let at = center.map(f64::from);
        let of = |a: [f64; 3], f: fn(f64, f64) -> f64| [0, 1, 2].map(|i| f(a[i], at[i]));
        [of(low, f64::min), of(high, f64::max)]
    });
    let diagonal = (0..3).map(|i| (high[i] - low[i]).powi(2)).sum::<f64>().sqrt();
    let giants = balls.iter().filter(|ball| f64::from(ball.1) > diagonal).count();
    (giants > 0 && giants * FEW_GIANTS <= balls.len()).then_some(diagonal)
}

/// What a grid may take of all that all may.
#[derive(Clone, Copy)]
struct Share {
    of_all: f64,
    /// Bytes a point.
    budget: f64,
}

/// Balls that one grid may hold, and the slots of their points, ascending.
#[derive(Default)]
struct Group {
    balls: Vec<Ball>,
    slots: Vec<u32>,
}

impl Group {
    /// The balls for which this is true, and the others.
    fn parted(self, is_first: &dyn Fn(&Ball) -> bool) -> [Self; 2] {
        let mut parts = [Self::default(), Self::default()];
        for (ball, slot) in self.balls.into_iter().zip(self.slots) {
            let part = &mut parts[usize::from(!is_first(&ball))];
            part.balls.push(ball);
            part.slots.push(slot);
        }
        parts
    }
}

/// Parts balls by size, then by place, until no grid is too coarse, or none can be parted, or there are many.
fn split(all: Vec<Group>, budget: f64) -> Vec<(GridInfo, Vec<u32>)> {
    let count = all.iter().map(|group| group.balls.len()).sum::<usize>() as f64;
    let (mut done, mut groups) = (Vec::new(), VecDeque::from(all));
    while let Some(group) = groups.pop_front() {
        let mut radii: Vec<f32> = group.balls.iter().map(|ball| ball.1).collect();
        let share = Share { of_all: radii.len() as f64 / count, budget };
        let (grid, is_fine) = plan_fine(&group.balls, &mut radii, share);
        let may_part = done.len() + groups.len() + 2 <= MOST_LEVELS as usize;
        if !may_part || is_fine {
            done.push((grid, group.slots));
        } else if let Some(radius) = radius_between(&mut radii) {
            groups.extend(group.parted(&|ball| f64::from(ball.1) < radius));
        } else if let Some((axis, place)) = widest_gap(&group.balls) {
            groups.extend(group.parted(&|ball| f64::from(ball.0[axis]) < place));
        } else {
            done.push((grid, group.slots));
        }
    }
    done
}

/// One grid over these balls, which are so large a share of all, and whether it is fine enough: for most of them, or
/// where small ones crowd, for those.
fn plan_fine(balls: &[Ball], radii: &mut [f32], share: Share) -> (GridInfo, bool) {
    let least = small(radii);
    let grid = plan_grid(balls, median(radii), 0, share);
    if !is_too_coarse(&grid, balls, least) {
        return (grid, true);
    }
    let finer = plan_grid(balls, least, 0, share);
    let is_fine = !is_too_coarse(&finer, balls, least);
    (if is_fine { finer } else { grid }, is_fine)
}

fn nth(radii: &mut [f32], n: usize) -> f64 {
    f64::from(*radii.select_nth_unstable_by(n, f32::total_cmp).1)
}

fn median(radii: &mut [f32]) -> f64 {
    nth(radii, radii.len() / 2)
}

/// The radius of small balls.
fn small(radii: &mut [f32]) -> f64 {
    nth(radii, (radii.len() / 100).min(SMALL_BALLS))
}

/// Whether small balls crowd in cells that are made for larger ones. `radius` is theirs.
fn is_too_coarse(grid: &GridInfo, balls: &[Ball], radius: f64) -> bool {
    if f64::from(grid.edge) <= TOO_COARSE * EDGE_PER_TRUST * radius {
        return false;
    }
    let [nx, ny, _] = grid.resolution.map(|n| n as usize);
    let cell_of = |center: &[f32; 3]| {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let at =
                (f64::from(center[axis]) - f64::from(grid.origin[axis])) / f64::from(grid.edge);
            (at as usize).min(grid.resolution[axis] as usize - 1)
        });
        x + nx * (y + ny * z)
    };
    let mut counts = vec![0u32; grid.cell_count() as usize];
    for (center, _) in balls {
        counts[cell_of(center)] += 1;
    }
    let mut crowds: Vec<u32> = (balls.iter().filter(|ball| f64::from(ball.1) <= radius))
        .map(|(center, _)| counts[cell_of(center)])
        .collect();
    let half = crowds.len() / 2;
    *crowds.select_nth_unstable(half).1 > CROWDED
}

/// The radius that parts small balls from others, where there are others: where the fewest are, in the middle of
/// those places, by the logarithm.
fn radius_between(radii: &mut [f32]) -> Option<f64> {
    const BINS: usize = 32;
    let least = small(radii);
    let large = nth(radii, radii.len() - 1 - (radii.len() / 100).min(SMALL_BALLS));
    if large <= ONE_SIZE * least {
        return None;
    }
    let [from, to] = [VALLEY[0] * least, (VALLEY[1] * least).min(large)].map(f64::ln);
    let mut counts = [0u32; BINS];
    for radius in radii.iter() {
        let at = (f64::from(*radius).ln() - from) / (to - from) * BINS as f64;
        if at >= 0.0 && at < BINS as f64 {
            counts[at as usize] += 1;
        }
    }
    let fewest = *counts.iter().min()?;
    let bins: Vec<usize> = (0..BINS).filter(|&bin| counts[bin] == fewest).collect();
    let middle = bins[bins.len() / 2] as f64 + 0.5;
    Some((from + (to - from) * middle / BINS as f64).exp())
}

/// The middle of the widest stretch along an axis that no ball reaches, if it is worth two grids.
fn widest_gap(balls: &[Ball]) -> Option<(usize, f64)> {
    let [low, high] = bounds_of(balls);
    let mut widest = None;
    let mut width = GAP * (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    for axis in 0..3 {
        let bin = (high[axis] - low[axis]) / GAP_BINS as f64;
        let mut reached = [false; GAP_BINS];
        for (center, radius) in balls {
            let place = |x: f64| (((x - low[axis]) / bin) as usize).min(GAP_BINS - 1);
            let (center, radius) = (f64::from(center[axis]), f64::from(*radius));
            reached[place(center - radius)..=place(center + radius)].fill(true);
        }
        let mut first = 0;
        for (at, reached) in reached.into_iter().enumerate() {
            if reached {
                first = at + 1;
            } else if (at + 1 - first) as f64 * bin > width {
                width = (at + 1 - first) as f64 * bin;
                widest = Some((axis, low[axis] + 0.5 * (first + at + 1) as f64 * bin));
            }
        }
    }
    widest
}

/// Lowest and highest corner of the box around all balls.
fn bounds_of(balls: &[Ball]) -> [[f64; 3]; 2] {
    let of_some = |balls: &[Ball]| {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for (center, radius) in balls {
            let reach = f64::from(*radius) * 1.001;
            for axis in 0..3 {
                low[axis] = low[axis].min(f64::from(center[axis]) - reach);
                high[axis] = high[axis].max(f64::from(center[axis]) + reach);
            }
        }
        [low, high]
    };
    let joined = |a: [[f64; 3]; 2], b: [[f64; 3]; 2]| {
        let of = |side: usize, f: fn(f64, f64) -> f64| [0, 1, 2].map(|i| f(a[side][i], b[side][i]));
        [of(0, f64::min), of(1, f64::max)]
    };
    balls.par_chunks(1 << 14).map(of_some).reduce(|| of_some(&[]), joined)
}

/// One grid over these balls, for this radius, as far as so large a share of all may have cells and pairs.
fn plan_grid(balls: &[Ball], radius: f64, resolution: u32, share: Share) -> GridInfo {
    let [low, high] = bounds_of(balls);
    let extent = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    let longest = extent[0].max(extent[1]).max(extent[2]);
    let edge = match resolution {
        0 => EDGE_PER_TRUST * radius,
        cells => longest * 1.000_02 / f64::from(cells),
    };
    // A coordinate's rounding must stay small beside a cell.
    let edge = edge.max(longest * 1e-5);
    let allowed = |per_point: f64, most: f64| {
        (per_point * balls.len() as f64).min(share.of_all * most).max(ALWAYS_ALLOWED)
    };
    let most_bytes = match resolution {
        0 => (share.budget * balls.len() as f64).max(8.0 * ALWAYS_ALLOWED),
        _ => f64::INFINITY,
    };
    let is_too_fine = |edge: f64, pairs: &dyn Fn(f64) -> f64| {
        let cells = cell_count(extent, edge);
        if cells > allowed(CELLS_PER_POINT, CELLS_ALLOWED) || 8.0 * cells > most_bytes {
            return true;
        }
        let pairs = pairs(edge);
        let bytes = 8.0 * cells + 4.0 * LISTED_PAIRS * pairs;
        pairs > allowed(PAIRS_PER_POINT, PAIRS_ALLOWED) || bytes > most_bytes
    };
    let grown = |steps: u32| (0..steps).fold(edge, |edge, _| edge * 1.1);
    let settles = |steps: u32, pairs: &dyn Fn(f64) -> f64| {
        let edge = grown(steps);
        !is_too_fine(edge, pairs) || (steps > 0 && edge > 2.0 * longest)
    };
    let first_from = |steps: u32, pairs: &dyn Fn(f64) -> f64| {
        (steps..).find(|&steps| settles(steps, pairs)).unwrap_or(steps)
    };
    let all_pairs = |edge: f64| pair_count(balls, low, edge);
    let mut steps = 0;
    if balls.len() >= MANY {
        // A part of them says where to look.
        let part: Vec<Ball> = balls.iter().step_by(PART).copied().collect();
        let scale = balls.len() as f64 / part.len() as f64;
        steps = first_from(0, &|edge| scale * pair_count(&part, low, edge));
        while steps > 0 && settles(steps - 1, &all_pairs) {
            steps -= 1;
        }
    }
    let edge = grown(first_from(steps, &all_pairs));
    GridInfo {
        origin: low.map(|x| x as f32),
        edge: edge as f32,
        resolution: extent.map(|length| cells_along(length, edge) as u32),
        inverse_edge: 1.0 / edge as f32,
    }
}

fn cells_along(length: f64, edge: f64) -> f64 {
    (length * 1.000_01 / edge).ceil().max(1.0)
}

fn cell_count(extent: [f64; 3], edge: f64) -> f64 {
    extent.iter().map(|&length| cells_along(length, edge)).product()
}

/// Cells around all balls, as `grid_count` counts them, up to rounding.
fn pair_count(balls: &[Ball], low: [f64; 3], edge: f64) -> f64 {
    let cells = |(center, radius): &Ball| -> f64 {
        (0..3)
            .map(|axis| {
                let (center, radius) = (f64::from(center[axis]), f64::from(*radius));
                let from = ((center - radius - low[axis]) / edge).floor();
                ((center + radius - low[axis]) / edge).floor() - from + 1.0
            })
            .product()
    };
    // Whole numbers, so that their order does not matter.
    balls.par_iter().with_min_len(1 << 14).map(cells).sum()
}

#[cfg(test)]
mod tests;
