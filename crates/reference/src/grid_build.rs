//! Twin of the grid build: `grid_count`, `grid_emit`, `grid_emit_large`, the scan, the sort and `grid_ranges`.
//!
//! A prefix sum and a stable sort have but one result, so the twin takes the library's.

use crate::grid::{Ball, Grid};
use crate::polynomial::Polynomial;
use crate::real::Real;
use crate::refine::PointCells;
use kernels::layout::{GridInfo, MOST_SKIPPED};
use points::{Grids, Watch};

/// Points that are listed between two reports.
const REPORTED: usize = 1 << 16;

/// The points of each cell.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CellLists {
    /// First and past-the-last entry of each cell in `slots`; of an empty cell both are 0, or, in
    /// large grids, its distance, in cells along any axis, to the next that is not, at most `MOST_SKIPPED`.
    pub cells: Vec<[u32; 2]>,
    /// Slots, cell after cell, in the order of (object, place in the file) within a cell.
    pub slots: Vec<u32>,
}

/// Lists the points that carry a surface by the cell they lie in, grid after grid, in the order of `order`.
#[must_use]
pub fn list_points<R: Real>(
    grids: &Grids,
    polynomials: &[Polynomial<R>],
    order: &[u32],
) -> PointCells {
    let mut all = PointCells::default();
    for (at, level) in grids.levels.iter().enumerate() {
        let own = list_in(&Grid::from(&level.grid), polynomials, &grids.order_of(at, order));
        all.offsets.resize(level.first_offset as usize, 0);
        let first = all.slots.len() as u32;
        all.offsets.extend(own.offsets.into_iter().map(|offset| first + offset));
        all.slots.extend(own.slots);
    }
    all
}

fn list_in<R: Real>(grid: &Grid<R>, polynomials: &[Polynomial<R>], order: &[u32]) -> PointCells {
    let mut pairs: Vec<(u32, u32)> = order
        .iter()
        .map(|&slot| (&polynomials[slot as usize], slot))
        .filter(|(p, _)| p.trust > R::of(0.0))
        .map(|(p, slot)| (grid.cell_id(grid.cell_of(p.center)), slot))
        .collect();
    pairs.sort_by_key(|pair| pair.0);
    let offsets = (0..=grid.cell_count())
        .map(|cell| pairs.partition_point(|pair| pair.0 < cell) as u32)
        .collect();
    PointCells { offsets, slots: pairs.into_iter().map(|pair| pair.1).collect() }
}

/// Lists the points whose trust ball meets each cell, grid after grid. `order` holds slots by ordinal. The watcher sees
/// how many points are listed.
#[must_use]
pub fn build_grids<R: Real>(
    grids: &Grids,
    polynomials: &[Polynomial<R>],
    order: &[u32],
    watch: &dyn Watch,
) -> CellLists {
    let mut all = CellLists::default();
    let mut listed = 0;
    for (at, level) in grids.levels.iter().enumerate() {
        let order = grids.order_of(at, order);
        let mut own =
            build_grid(&level.grid, polynomials, &order, &|more| watch.done(listed + more));
        listed += order.len() as u64;
        watch.done(listed);
        let first = all.slots.len() as u32;
        for range in own.cells.iter_mut().filter(|range| range[0] < range[1]) {
            *range = range.map(|entry| first + entry);
        }
        if grids.skip_cells() {
            skip_cells(level.grid.resolution, &mut own.cells);
        }
        all.cells.resize(level.first_cell as usize, [0, 0]);
        all.cells.extend(own.cells);
        all.slots.extend(own.slots);
    }
    all
}

/// Calls `done` now and then with the number of points that are listed.
fn build_grid<R: Real>(
    info: &GridInfo,
    polynomials: &[Polynomial<R>],
    order: &[u32],
    done: &dyn Fn(u64),
) -> CellLists {
    let grid = Grid::<R>::from(info);
    let mut pairs: Vec<(u32, u32)> = Vec::new();
    for (nth, &slot) in order.iter().enumerate() {
        // Half of the work is yet to come: the sort.
        if nth % REPORTED == 0 {
            done(nth as u64 / 2);
        }
        let polynomial = &polynomials[slot as usize];
        if polynomial.trust > R::of(0.0) {
            let ball = Ball::new(polynomial.center, polynomial.trust);
            let [low, high] = grid.cells_around(&ball);
            for z in low[2]..=high[2] {
                for y in low[1]..=high[1] {
                    let row = (low[0]..=high[0]).map(|x| [x, y, z]);
                    let met = row.filter(|&cell| grid.ball_meets_cell(cell, &ball));
                    pairs.extend(met.map(|cell| (grid.cell_id(cell), slot)));
                }
            }
        }
    }
    pairs.sort_by_key(|pair| pair.0);
    let mut cells = vec![[0, 0]; grid.cell_count() as usize];
    for (at, &(cell, _)) in pairs.iter().enumerate() {
        let range = &mut cells[cell as usize];
        if range[1] == 0 {
            range[0] = at as u32;
        }
        range[1] = at as u32 + 1;
    }
    CellLists { cells, slots: pairs.into_iter().map(|pair| pair.1).collect() }
}

/// Twin of `skip_cells`: the range of an empty cell begins, and ends, at its distance to the next that is not.
fn skip_cells([width, height, depth]: [u32; 3], cells: &mut [[u32; 2]]) {
    let far = |range: &[u32; 2]| if range[0] < range[1] { 0 } else { MOST_SKIPPED };
    let mut reaches: Vec<u32> = cells.iter().map(far).collect();
    for (stride, resolution) in [(1, width), (width, height), (width * height, depth)] {
        reaches = (0..reaches.len() as u32)
            .map(|cell| {
                let at = cell / stride % resolution;
                let low = at.saturating_sub(MOST_SKIPPED - 1);
                let high = (at + MOST_SKIPPED - 1).min(resolution - 1);
                let reach = |other: u32| {
                    let beside = reaches[(cell + other * stride - at * stride) as usize];
                    at.abs_diff(other).max(beside)
                };
                (low..=high).map(reach).fold(MOST_SKIPPED, u32::min)
            })
            .collect();
    }
    for (range, reach) in cells.iter_mut().zip(reaches) {
        if reach > 0 {
            *range = [reach; 2];
        }
    }
}
