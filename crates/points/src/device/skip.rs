//! How far each empty cell is from the next with points: the passes `mark_occupied`, `grow_marks` and
//! `skip_cells`.

use super::line;
use super::work::Work;
use gpu::{Buffer, Device, GpuError};
use kernels::layout::{
    CELLS, GRID_INFO, GridLevel, MOST_SKIPPED, SKIP_BESIDE, SKIP_FAR, SKIP_MARKS_IN,
    SKIP_MARKS_OUT, SKIP_NEAR, SKIP_OCCUPIED,
};
use kernels::spirv;
use std::sync::Arc;

/// Writes the distances into the ranges of a grid's empty cells, so that rays leave all empty cells around one at once.
pub(crate) fn skip_cells(
    device: &Arc<Device>,
    rec: &mut Work,
    level: &GridLevel,
    grid_info: &Buffer,
    cells: &Buffer,
) -> Result<(), GpuError> {
    let [width, height, depth] = level.grid.resolution;
    let first = u64::from(level.first_cell) * 8;
    let bytes = u64::from(level.grid.cell_count()) * 8;
    let words = width.div_ceil(u32::BITS) * height * depth;
    let marks: Vec<Buffer> = (0..MOST_SKIPPED)
        .map(|_| Buffer::new(device, "marks of cells", u64::from(words) * 4))
        .collect::<Result<_, _>>()?;
    rec.pass(spirv::mark_occupied())
        .buffer(GRID_INFO, grid_info)
        .buffer_part(CELLS, cells, first, bytes)
        .buffer(SKIP_MARKS_OUT, &marks[0])
        .dispatch(line(words));
    for grown in marks.windows(2) {
        rec.pass(spirv::grow_marks())
            .buffer(GRID_INFO, grid_info)
            .buffer(SKIP_MARKS_IN, &grown[0])
            .buffer(SKIP_MARKS_OUT, &grown[1])
            .dispatch(line(words));
    }
    let bindings = [SKIP_OCCUPIED, SKIP_BESIDE, SKIP_NEAR, SKIP_FAR];
    let pass = rec
        .pass(spirv::skip_cells())
        .buffer(GRID_INFO, grid_info)
        .buffer_part(CELLS, cells, first, bytes);
    let pass =
        bindings.into_iter().zip(&marks).fold(pass, |pass, (at, marks)| pass.buffer(at, marks));
    pass.dispatch(line(words));
    rec.submit()
}
