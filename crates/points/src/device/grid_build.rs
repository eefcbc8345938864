//! The uniform grid: count, scan, emit, sort, ranges (\[T\] §5).

use super::{
    PointCells, line,
    scan::Scan,
    sort::{Pairs, Sort, SortSpace},
};
use crate::BALL_MARGIN;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{
    GRID_CELLS, GRID_INFO, GRID_KEYS, GRID_OFFSETS, GRID_ORDER, GRID_POLYNOMIALS, GRID_SLOTS,
    GridInfo, GridParams, ListedPoint, OFFSETS_INFO, OFFSETS_KEYS, OFFSETS_OUT, OFFSETS_POINTS,
    OFFSETS_POLYNOMIALS, OFFSETS_SLOTS,
};
use kernels::spirv;
use std::sync::Arc;

/// What the build works on.
pub(crate) struct GridBuildIo<'a> {
    pub grid: &'a GridInfo,
    pub grid_info: &'a Buffer,
    pub polynomials: &'a Buffer,
    /// Slots by ordinal.
    pub order: &'a [u32],
}

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
    offsets: Kernel,
    list_points: Kernel,
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
        let offset = [OFFSETS_INFO, OFFSETS_KEYS, OFFSETS_OUT];
        let listed = [OFFSETS_SLOTS, OFFSETS_POLYNOMIALS, OFFSETS_POINTS];
        Ok(Self {
            device: Arc::clone(device),
            count: kernel("grid_count", &spirv::grid_count(), &counted)?,
            emit: kernel("grid_emit", &spirv::grid_emit(), &emitted)?,
            ranges: kernel("grid_ranges", &spirv::grid_ranges(), &ranged)?,
            offsets: kernel("cell_offsets", &spirv::cell_offsets(), &offset)?,
            list_points: kernel("list_points", &spirv::list_points(), &listed)?,
            scan: Scan::new(device)?,
            sort: Sort::new(device)?,
        })
    }

    /// Lists the points whose trust ball meets each cell, in the order of `order` (slots by ordinal).
    pub fn run(&self, io: &GridBuildIo<'_>) -> Result<GridLists, GpuError> {
        let mut rec = Recorder::new(&self.device)?;
        let bytes = u64::from(io.grid.cell_count()) * 8;
        let cells = Buffer::new(&self.device, "cells", bytes)?;
        rec.fill(&cells, 0, bytes, 0);
        let Some((pairs, params)) = self.sorted_pairs(&mut rec, io, BALL_MARGIN)? else {
            rec.submit()?;
            return Ok(GridLists { cells, slots: Buffer::new(&self.device, "cell slots", 16)? });
        };
        rec.pass("grid_ranges", &self.ranges)
            .buffer(GRID_INFO, io.grid_info)
            .buffer(GRID_KEYS, &pairs.keys)
            .buffer(GRID_CELLS, &cells)
            .push(&params)
            .dispatch(line(params.pair_count));
        rec.submit()?;
        Ok(GridLists { cells, slots: pairs.slots })
    }

    /// Lists the points that carry a surface by the cell they lie in, in the order of `order`.
    pub fn list_points(&self, io: &GridBuildIo<'_>) -> Result<Option<PointCells>, GpuError> {
        let mut rec = Recorder::new(&self.device)?;
        let Some((pairs, params)) = self.sorted_pairs(&mut rec, io, 0.0)? else {
            return Ok(None);
        };
        let entries = io.grid.cell_count() + 1;
        let offsets = Buffer::new(&self.device, "point cell offsets", u64::from(entries) * 4)?;
        rec.pass("cell_offsets", &self.offsets)
            .buffer(OFFSETS_INFO, io.grid_info)
            .buffer(OFFSETS_KEYS, &pairs.keys)
            .buffer(OFFSETS_OUT, &offsets)
            .push(&params)
            .dispatch(line(entries));
        let bytes = u64::from(params.pair_count) * size_of::<ListedPoint>() as u64;
        let points = Buffer::new(&self.device, "listed points", bytes)?;
        rec.pass("list_points", &self.list_points)
            .buffer(OFFSETS_SLOTS, &pairs.slots)
            .buffer(OFFSETS_POLYNOMIALS, io.polynomials)
            .buffer(OFFSETS_POINTS, &points)
            .push(&params)
            .dispatch(line(params.pair_count));
        rec.submit()?;
        Ok(Some(PointCells { offsets, points }))
    }

    /// Pairs of cell and point, sorted by cell; the sort is recorded and not yet submitted. `None`
    /// where there is no pair.
    fn sorted_pairs(
        &self,
        rec: &mut Recorder,
        io: &GridBuildIo<'_>,
        ball_scale: f32,
    ) -> Result<Option<(Pairs, GridParams)>, GpuError> {
        let device = &self.device;
        let point_count = io.order.len() as u32;
        let order = Buffer::from_slice(device, "point order", io.order)?;
        let offsets = Buffer::new(device, "pair offsets", (u64::from(point_count) + 1) * 4)?;
        let levels = Scan::levels(device, point_count + 1)?;
        let params = GridParams { point_count, pair_count: 0, ball_scale };
        rec.fill(&offsets, u64::from(point_count) * 4, 4, 0);
        rec.pass("grid_count", &self.count)
            .buffer(GRID_INFO, io.grid_info)
            .buffer(GRID_POLYNOMIALS, io.polynomials)
            .buffer(GRID_ORDER, &order)
            .buffer(GRID_OFFSETS, &offsets)
            .push(&params)
            .dispatch(line(point_count));
        self.scan.record(rec, &offsets, point_count + 1, &levels);
        rec.submit()?;
        let mut total = [0u32];
        offsets.read(u64::from(point_count) * 4, &mut total)?;
        let [pair_count] = total;
        if pair_count == 0 {
            return Ok(None);
        }
        let params = GridParams { pair_count, ..params };
        let mut pairs = Pairs::new(device, pair_count)?;
        let mut space = SortSpace::new(device, pair_count)?;
        rec.pass("grid_emit", &self.emit)
            .buffer(GRID_INFO, io.grid_info)
            .buffer(GRID_POLYNOMIALS, io.polynomials)
            .buffer(GRID_ORDER, &order)
            .buffer(GRID_OFFSETS, &offsets)
            .buffer(GRID_KEYS, &pairs.keys)
            .buffer(GRID_SLOTS, &pairs.slots)
            .push(&params)
            .dispatch(line(pair_count));
        let largest = io.grid.cell_count();
        self.sort.record(rec, &self.scan, &mut pairs, &mut space, pair_count, largest);
        Ok(Some((pairs, params)))
    }
}
