//! Twin of `grid_trace`: a ray's way through the grid to its nearest hit (\[T\] §5).
//!
//! The kernel may stop after any cell and go on in the next pass with the same bits, so the twin
//! goes the whole way at once.

use crate::batch::{BATCH, test_batch};
use crate::camera_rays::Ray;
use crate::grid::{Grid, empty_around, nearest_crossing};
use crate::grid_build::CellLists;
use crate::polynomial::Polynomial;
use crate::real::{NO_HIT, Real};
use kernels::layout::NONE;

/// Follows one ray until it ends, at the nearest hit or, where `any_hit`, at the first that is found.
pub fn grid_trace<R: Real>(
    ray: &mut Ray<R>,
    grid: &Grid<R>,
    lists: &CellLists,
    polynomials: &[Polynomial<R>],
    any_hit: bool,
) {
    let (o, d) = (ray.origin, ray.direction);
    let sheet = polynomials.get(ray.left as usize).map(|left| (left.normal_at(o), left.object));
    if ray.cell == NONE {
        return;
    }
    let mut next = Some(grid.cell_of_id(ray.cell));
    while let Some(at) = next {
        let later = ray.after > R::of(0.0);
        let mut within = grid.way_through(at, o, d);
        within[0] = if later || ray.cells == 0 { R::of(-NO_HIT) } else { within[0] };
        within[1] = if later { R::of(NO_HIT) } else { within[1] };
        let [first, end] = lists.cells[grid.cell_id(at) as usize].map(|at| at as usize);
        let mut start = first;
        while start < end {
            let stop = end.min(start / 4 * 4 + BATCH); // slots are read four at a time
            let batch = &lists.slots[start..stop];
            start = stop;
            test_batch(ray, batch, polynomials, Some(within), sheet);
            if any_hit && ray.hit_slot != NONE {
                ray.cell = NONE;
                return;
            }
        }
        let around = empty_around(lists.cells[grid.cell_id(at) as usize]);
        let exits = grid.crossings(at, around, o, d);
        let ends = ray.hit_t <= nearest_crossing(exits);
        next = if ends { None } else { grid.step(at, around, exits, o, d) };
        ray.cells += u32::from(next.is_some());
    }
    ray.cell = NONE;
}
