//! The uniform grid: count, scan, emit, sort, ranges (\[T\] §5).

use super::{
    line,
    scan::Scan,
    sort::{Pairs, Sort},
};
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{
    GRID_CELLS, GRID_INFO, GRID_KEYS, GRID_OFFSETS, GRID_ORDER, GRID_POLYNOMIALS, GRID_SLOTS,
    GridInfo, GridParams,
};
use kernels::spirv;
use std::sync::Arc;

/// The points of each cell.
pub(crate) struct GridLists {
    pub cells: Buffer,
    pub slots: Buffer,
}

pub(crate) struct GridBuild {
    device: Arc<Device>,
    count: Kernel,
    emit: Kernel,
    ranges: Kernel,
    scan: Scan,
    sort: Sort,
}

impl GridBuild {
    pub fn new(device: &Arc<Device>) -> Result<Self, GpuError> {
        let kernel = |name, module: &[u32], used: &[u32]| {
            let bindings: Vec<(u32, Binding)> =
                used.iter().map(|&binding| (binding, Binding::StorageBuffer)).collect();
            Kernel::new(device, name, module, &bindings, size_of::<GridParams>())
        };
        let counted = [GRID_INFO, GRID_POLYNOMIALS, GRID_ORDER, GRID_OFFSETS];
        let emitted =
            [GRID_INFO, GRID_POLYNOMIALS, GRID_ORDER, GRID_OFFSETS, GRID_KEYS, GRID_SLOTS];
        let ranged = [GRID_INFO, GRID_KEYS, GRID_CELLS];
        Ok(Self {
            device: Arc::clone(device),
            count: kernel("grid_count", &spirv::grid_count(), &counted)?,
            emit: kernel("grid_emit", &spirv::grid_emit(), &emitted)?,
            ranges: kernel("grid_ranges", &spirv::grid_ranges(), &ranged)?,
            scan: Scan::new(device)?,
            sort: Sort::new(device)?,
        })
    }

    /// Lists the points of each cell, in the order of `order` (slots by ordinal).
    pub fn run(
        &self,
        grid: &GridInfo,
        grid_info: &Buffer,
        polynomials: &Buffer,
        order: &[u32],
    ) -> Result<GridLists, GpuError> {
        let device = &self.device;
        let mut rec = Recorder::new(device)?;
        let point_count = order.len() as u32;
        let order = Buffer::from_slice(device, "point order", order)?;
        let offsets = Buffer::new(device, "pair offsets", (u64::from(point_count) + 1) * 4)?;
        let levels = Scan::levels(device, point_count + 1)?;
        let params = GridParams { point_count, pair_count: 0 };
        rec.fill(&offsets, u64::from(point_count) * 4, 4, 0);
        rec.pass("grid_count", &self.count)
            .buffer(GRID_INFO, grid_info)
            .buffer(GRID_POLYNOMIALS, polynomials)
            .buffer(GRID_ORDER, &order)
            .buffer(GRID_OFFSETS, &offsets)
            .push(&params)
            .dispatch(line(point_count));
        self.scan.record(&mut rec, &offsets, point_count + 1, &levels);
        rec.submit()?;
        let mut total = [0u32];
        offsets.read(u64::from(point_count) * 4, &mut total)?;
        let [pair_count] = total;

        let cells = Buffer::new(device, "cells", u64::from(grid.cell_count()) * 8)?;
        rec.fill(&cells, 0, u64::from(grid.cell_count()) * 8, 0);
        if pair_count == 0 {
            rec.submit()?;
            return Ok(GridLists { cells, slots: Buffer::new(device, "cell slots", 4)? });
        }
        let params = GridParams { point_count, pair_count };
        let pairs = Pairs::new(device, pair_count)?;
        rec.pass("grid_emit", &self.emit)
            .buffer(GRID_INFO, grid_info)
            .buffer(GRID_POLYNOMIALS, polynomials)
            .buffer(GRID_ORDER, &order)
            .buffer(GRID_OFFSETS, &offsets)
            .buffer(GRID_KEYS, &pairs.keys)
            .buffer(GRID_SLOTS, &pairs.slots)
            .push(&params)
            .dispatch(line(pair_count));
        let pairs =
            self.sort.run(device, &mut rec, &self.scan, pairs, pair_count, grid.cell_count())?;
        rec.pass("grid_ranges", &self.ranges)
            .buffer(GRID_INFO, grid_info)
            .buffer(GRID_KEYS, &pairs.keys)
            .buffer(GRID_CELLS, &cells)
            .push(&params)
            .dispatch(line(pair_count));
        rec.submit()?;
        Ok(GridLists { cells, slots: pairs.slots })
    }
}
