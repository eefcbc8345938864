//! Twin of `grid_trace`: a ray's way through the grid to its nearest hit (\[T\] §5).
//!
//! The kernel may stop after any cell and go on in the next pass with the same bits, so the twin
//! goes the whole way at once.

use crate::batch::{BATCH, test_batch};
use crate::camera_rays::Ray;
use crate::grid::{empty_around, nearest_exit};
use crate::grid_build::CellLists;
use crate::levels::{Level, Levels};
use crate::polynomial::Polynomial;
use crate::real::{NO_HIT, Real};
use kernels::layout::{NONE, RAY_STARTS};

/// Follows one ray until it ends, at the nearest hit or, where `any_hit`, at the first that is found.
pub fn grid_trace<R: Real>(
    ray: &mut Ray<R>,
    levels: &Levels<R>,
    lists: &CellLists,
    polynomials: &[Polynomial<R>],
    any_hit: bool,
) {
    let (o, d) = (ray.origin, ray.direction);
    let sheet = polynomials.get(ray.left as usize).map(|left| (left.normal_at(o), left.object));
    if ray.cell == RAY_STARTS {
        ray.cell = levels.enter(o, d, ray.after);
    }
    let mut entry = ray.cell; // where it came into the grid that it is in
    while ray.cell != NONE {
        let (at_level, Level { grid, info }) = levels.of_cell(ray.cell);
        let at = grid.cell_of_id(ray.cell - info.first_cell);
        let later = ray.after > R::of(0.0);
        let enters = if levels.are_several() { ray.cell == entry } else { ray.cells == 0 };
        let mut within = grid.way_through(at, o, d);
        within[0] = if later || enters { R::of(-NO_HIT) } else { within[0] };
        within[1] = if later { R::of(NO_HIT) } else { within[1] };
        let range = lists.cells[ray.cell as usize];
        let [first, end] = range.map(|at| at as usize);
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
        let around = empty_around(range);
        let exits = grid.exits_of(at, around, o, d);
        let ends = ray.hit_t <= nearest_exit(exits);
        let next = if ends { None } else { grid.step(at, around, exits, o, d) };
        ray.cell = next.map_or(NONE, |next| info.first_cell + grid.cell_id(next));
        if ray.cell == NONE {
            entry = levels.enter_from(at_level + 1, o, d, [ray.after, ray.hit_t]);
            ray.cell = entry;
        }
        ray.cells += u32::from(ray.cell != NONE);
    }
}
