//! Twin of `grid_trace`: a ray's way through the grid to its nearest hit (\[T\] §5).
//!
//! The kernel may stop after any cell and go on in the next pass with the same bits, so the twin
//! goes the whole way at once.

use crate::batch::{BATCH, test_batch};
use crate::camera_rays::Ray;
use crate::grid::{Grid, nearest_crossing};
use crate::grid_build::CellLists;
use crate::polynomial::Polynomial;
use crate::real::Real;
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
    while ray.cell != NONE {
        let [first, end] = lists.cells[ray.cell as usize].map(|at| at as usize);
        for batch in lists.slots[first..end].chunks(BATCH) {
            test_batch(ray, batch, polynomials, sheet);
            if any_hit && ray.hit_slot != NONE {
                ray.cell = NONE;
                return;
            }
        }
        let at = grid.cell_of_id(ray.cell);
        let exits = grid.crossings(at, o, d);
        let ends = ray.hit_t <= nearest_crossing(exits);
        ray.cell = if ends { NONE } else { grid.step(at, exits, d) };
        ray.cells += u32::from(ray.cell != NONE);
    }
}
