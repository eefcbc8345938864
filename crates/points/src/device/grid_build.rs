//! The grids: count, scan, emit, sort, ranges (\[T\] §5).
//!
//! Pairs of cell and point are sorted slab by slab, some layers of cells along z at a time, so that no buffer
//! but the finished list grows with the scene. Slabs follow each other as their cells do: any number of them
//! gives the same list.

use super::work::Work;
use super::{
    PointCells, line,
    scan::Scan,
    sort::{Pairs, Sort, SortSpace},
};
use crate::BALL_MARGIN;
use bytemuck::Zeroable;
use gpu::{Buffer, Device, GpuError};
use kernels::layout::{
    CELL_OFFSETS, CELLS, GRID_BALLS, GRID_INFO, GRID_KEYS, GRID_LARGE, GRID_OFFSETS, GRID_ORDER,
    GRID_SLOTS, GridLevel, GridParams, LISTED_POINTS, ListedPoint, POLYNOMIALS,
};
use kernels::spirv::{self, Lists, Module};
use std::borrow::Cow;
use std::sync::Arc;

/// What the build of one grid works on.
pub(crate) struct GridToBuild<'a> {
    pub level: GridLevel,
    /// Of it alone.
    pub grid_info: Buffer,
    pub polynomials: &'a Buffer,
    /// Its slots by ordinal.
    pub order: Cow<'a, [u32]>,
    /// Whether any ball may meet so many cells that its pairs are emitted one by one.
    pub any_large: bool,
}

/// Pairs of one slab, unless it is a single layer: so many in any case; so many a point where the device has room, since
/// each slab looks at all points; and no more than one binding holds.
const SLAB_PAIRS: u64 = 7_000_000;
const SLAB_PAIRS_PER_POINT: u64 = 3;
const MOST_SLAB_PAIRS: u64 = 32_000_000;
/// What a pair takes while it is sorted, and a point while its pairs are: bytes.
const SORTED_PAIR_BYTES: u64 = 24;
pub(crate) const LISTED_POINT_BYTES: u64 = 28;

/// Pairs that a build sorts in one go, at most, with so many bytes of the device's memory left.
pub(crate) fn slab_pairs(points: u64, left: u64) -> u32 {
    let room = left.saturating_sub(points * LISTED_POINT_BYTES) / SORTED_PAIR_BYTES;
    (points * SLAB_PAIRS_PER_POINT).min(room).clamp(SLAB_PAIRS, MOST_SLAB_PAIRS) as u32
}

/// Bytes of a trust ball, and how many are put in order by a dispatch: what it writes fits into any binding.
const BALL_BYTES: u64 = 16;
const BALLS_AT_ONCE: u32 = 1 << 22;

/// What all slabs of a build share.
struct Counting {
    order: Buffer,
    /// In that order.
    balls: Buffer,
    offsets: Buffer,
    /// Of large balls alone; one word where there are none.
    large_offsets: Buffer,
    levels: Vec<Buffer>,
}

/// Some layers of the grid, with the pairs of all and of large balls alone.
#[derive(Debug, Clone, Copy)]
struct Slab {
    first_layer: u32,
    end_layer: u32,
    pairs: u32,
    large_pairs: u32,
}

/// The points of each cell.
pub(crate) struct GridLists {
    pub cells: Buffer,
    pub slots: Buffer,
}

pub(crate) struct GridBuild {
    device: Arc<Device>,
    /// How polynomials and balls are read.
    lists: Lists,
    /// Pairs of one slab, at most, unless it is a single layer.
    slab_pairs: u32,
}

impl GridBuild {
    /// `lists`: how polynomials are read. For `slab_pairs` at most sorted in one go.
    pub fn new(device: &Arc<Device>, lists: Lists, slab_pairs: u32) -> Self {
        Self { device: Arc::clone(device), lists, slab_pairs }
    }

    /// What every list of balls takes.
    pub fn modules(lists: Lists) -> Vec<&'static Module> {
        let own = [
            spirv::order_balls(lists),
            spirv::grid_count(lists),
            spirv::grid_emit(lists),
            spirv::grid_ranges(),
        ];
        [&own[..], &Scan::modules(), &Sort::modules()].concat()
    }

    /// Where nobody asks for them: something to bind, which is not read.
    pub fn no_lists(&self) -> Result<GridLists, GpuError> {
        let empty = |name| Buffer::new(&self.device, name, 16);
        Ok(GridLists { cells: empty("cells")?, slots: empty("cell slots")? })
    }

    /// Lists the points whose trust ball meets each cell of each grid, in the order of `order` (slots by ordinal).
    pub fn run(&self, rec: &mut Work, levels: &[GridToBuild<'_>]) -> Result<GridLists, GpuError> {
        let device = &self.device;
        let last = levels.last().map_or(0, |io| io.level.first_cell + io.level.grid.cell_count());
        let bytes = u64::from(last) * 8;
        let cells = Buffer::paged(device, "cells", bytes)?;
        rec.fill(&cells, 0, bytes, 0);
        let counted = self.counted(rec, levels, BALL_MARGIN)?;
        let pairs: u32 = counted.iter().map(|(_, whole)| whole.pairs).sum();
        if pairs == 0 {
            rec.submit()?;
            return Ok(GridLists { cells, slots: Buffer::new(device, "cell slots", 16)? });
        }
        if let ([io], [(counting, whole)]) = (levels, &counted[..])
            && whole.is_sorted_at_once(self.slab_pairs)
        {
            let pairs = self.sorted_pairs(rec, io, counting, whole, BALL_MARGIN)?;
            self.record_ranges(rec, io, &pairs, whole, 0, &cells);
            rec.submit()?;
            return Ok(GridLists { cells, slots: pairs.slots });
        }
        let slots = Buffer::paged(device, "cell slots", u64::from(pairs).next_multiple_of(4) * 4)?;
        // Slots are read four at a time, also behind the last.
        let end = u64::from(pairs) * 4;
        if slots.bytes() > end {
            rec.fill(&slots, end, slots.bytes() - end, 0);
        }
        let mut first_pair = 0;
        for (io, (counting, whole)) in levels.iter().zip(&counted) {
            let mut left = if whole.is_sorted_at_once(self.slab_pairs) {
                vec![whole.layers()]
            } else {
                whole.parts(self.slab_pairs)
            };
            while let Some(layers) = left.pop() {
                let slab = self.count(rec, io, counting, layers, BALL_MARGIN)?;
                if !slab.is_sorted_at_once(self.slab_pairs) {
                    left.extend(slab.parts(self.slab_pairs));
                } else if slab.pairs > 0 {
                    let pairs = self.sorted_pairs(rec, io, counting, &slab, BALL_MARGIN)?;
                    self.record_ranges(rec, io, &pairs, &slab, first_pair, &cells);
                    let bytes = u64::from(slab.pairs) * 4;
                    rec.copy(&pairs.slots, 0, &slots, u64::from(first_pair) * 4, bytes);
                    rec.submit()?;
                    first_pair += slab.pairs;
                }
            }
        }
        Ok(GridLists { cells, slots })
    }

    /// Lists the points that carry a surface by the cell they lie in, in the order of `order`.
    pub fn list_points(
        &self,
        rec: &mut Work,
        levels: &[GridToBuild<'_>],
    ) -> Result<Option<PointCells>, GpuError> {
        let device = &self.device;
        let counted = self.counted(rec, levels, 0.0)?;
        let listed: u32 = counted.iter().map(|(_, whole)| whole.pairs).sum();
        if listed == 0 {
            return Ok(None);
        }
        let entries = |level: &GridLevel| u64::from(level.grid.cell_count()) + 1;
        let last =
            levels.last().map_or(0, |io| u64::from(io.level.first_offset) + entries(&io.level));
        let offsets = Buffer::new(device, "point cell offsets", last * 4)?;
        let bytes = u64::from(listed) * size_of::<ListedPoint>() as u64;
        let points = Buffer::new(device, "listed points", bytes)?;
        let mut first_pair = 0;
        for (io, (counting, whole)) in levels.iter().zip(&counted) {
            let pairs = self.sorted_pairs(rec, io, counting, whole, 0.0)?;
            let params = GridParams { first_pair, ..whole.params(io, 0.0) };
            let entries = entries(&io.level);
            rec.pass(spirv::cell_offsets())
                .buffer(GRID_INFO, &io.grid_info)
                .buffer(GRID_KEYS, &pairs.keys)
                .buffer_part(
                    CELL_OFFSETS,
                    &offsets,
                    u64::from(io.level.first_offset) * 4,
                    entries * 4,
                )
                .push(&params)
                .dispatch(line(entries as u32));
            rec.pass(spirv::list_points(self.lists))
                .buffer(GRID_SLOTS, &pairs.slots)
                .buffer(POLYNOMIALS, io.polynomials)
                .buffer(LISTED_POINTS, &points)
                .push(&params)
                .dispatch(line(whole.pairs));
            rec.submit()?;
            first_pair += whole.pairs;
        }
        Ok(Some(PointCells { offsets, points }))
    }

    /// The pairs of each grid, counted.
    fn counted(
        &self,
        rec: &mut Work,
        levels: &[GridToBuild<'_>],
        ball_scale: f32,
    ) -> Result<Vec<(Counting, Slab)>, GpuError> {
        let mut counted = Vec::new();
        for io in levels {
            let counting = self.counting(rec, io)?;
            let layers = [0, io.level.grid.resolution[2]];
            let whole = self.count(rec, io, &counting, layers, ball_scale)?;
            counted.push((counting, whole));
        }
        Ok(counted)
    }

    fn counting(&self, rec: &mut Work, io: &GridToBuild<'_>) -> Result<Counting, GpuError> {
        let device = &self.device;
        let points = io.order.len() as u32;
        let bytes = (u64::from(points) + 1) * 4;
        let of = |asked: bool| if asked { bytes } else { 4 };
        let counting = Counting {
            order: Buffer::from_slice(device, "point order", &io.order)?,
            balls: Buffer::paged(device, "ordered balls", u64::from(points) * BALL_BYTES)?,
            offsets: Buffer::new(device, "pair offsets", bytes)?,
            large_offsets: Buffer::new(device, "large pair offsets", of(io.any_large))?,
            levels: Scan::levels(device, points + 1)?,
        };
        for first_pair in (0..points).step_by(BALLS_AT_ONCE as usize) {
            let point_count = BALLS_AT_ONCE.min(points - first_pair);
            let [at, bytes] =
                [first_pair, point_count].map(|points| u64::from(points) * BALL_BYTES);
            rec.pass(spirv::order_balls(self.lists))
                .buffer(POLYNOMIALS, io.polynomials)
                .buffer(GRID_ORDER, &counting.order)
                .buffer_part(GRID_BALLS, &counting.balls, at, bytes)
                .push(&GridParams { point_count, first_pair, ..GridParams::zeroed() })
                .dispatch(line(point_count));
        }
        Ok(counting)
    }

    /// Counts the pairs of some layers, and leaves the offsets of each point's.
    fn count(
        &self,
        rec: &mut Work,
        io: &GridToBuild<'_>,
        counting: &Counting,
        [first_layer, end_layer]: [u32; 2],
        ball_scale: f32,
    ) -> Result<Slab, GpuError> {
        let points = io.order.len() as u32;
        let slab = Slab { first_layer, end_layer, pairs: 0, large_pairs: 0 };
        let Counting { balls, offsets, large_offsets, levels, .. } = counting;
        let end = u64::from(points) * 4;
        rec.fill(offsets, end, 4, 0);
        if io.any_large {
            rec.fill(large_offsets, end, 4, 0);
        }
        rec.pass(spirv::grid_count(self.lists))
            .buffer(GRID_INFO, &io.grid_info)
            .buffer(GRID_BALLS, balls)
            .buffer(GRID_OFFSETS, offsets)
            .buffer(GRID_LARGE, large_offsets)
            .push(&slab.params(io, ball_scale))
            .dispatch(line(points));
        Scan::record(rec, offsets, points + 1, levels);
        if io.any_large {
            Scan::record(rec, large_offsets, points + 1, levels);
        }
        rec.submit()?;
        let mut totals = [[0u32]; 2];
        offsets.read(end, &mut totals[0])?;
        if io.any_large {
            large_offsets.read(end, &mut totals[1])?;
        }
        let [[pairs], [large_pairs]] = totals;
        Ok(Slab { pairs, large_pairs, ..slab })
    }

    /// Pairs of cell and point of a slab that was counted last, sorted by cell. The sort is recorded and not
    /// yet submitted.
    fn sorted_pairs(
        &self,
        rec: &mut Work,
        io: &GridToBuild<'_>,
        counting: &Counting,
        slab: &Slab,
        ball_scale: f32,
    ) -> Result<Pairs, GpuError> {
        let device = &self.device;
        let mut pairs = Pairs::new(device, slab.pairs)?;
        let mut space = SortSpace::new(device, slab.pairs)?;
        let params = slab.params(io, ball_scale);
        rec.pass(spirv::grid_emit(self.lists))
            .buffer(GRID_INFO, &io.grid_info)
            .buffer(GRID_BALLS, &counting.balls)
            .buffer(GRID_ORDER, &counting.order)
            .buffer(GRID_OFFSETS, &counting.offsets)
            .buffer(GRID_KEYS, &pairs.keys)
            .buffer(GRID_SLOTS, &pairs.slots)
            .push(&params)
            .dispatch(line(params.point_count));
        if slab.large_pairs > 0 {
            rec.pass(spirv::grid_emit_large(self.lists))
                .buffer(GRID_INFO, &io.grid_info)
                .buffer(GRID_BALLS, &counting.balls)
                .buffer(GRID_ORDER, &counting.order)
                .buffer(GRID_OFFSETS, &counting.offsets)
                .buffer(GRID_LARGE, &counting.large_offsets)
                .buffer(GRID_KEYS, &pairs.keys)
                .buffer(GRID_SLOTS, &pairs.slots)
                .push(&GridParams { pair_count: slab.large_pairs, ..params })
                .dispatch(line(slab.large_pairs));
        }
        let [x, y, _] = io.level.grid.resolution;
        let largest = x * y * (slab.end_layer - slab.first_layer);
        Sort::record(rec, &mut pairs, &mut space, slab.pairs, largest);
        Ok(pairs)
    }

    fn record_ranges(
        &self,
        rec: &mut Work,
        io: &GridToBuild<'_>,
        pairs: &Pairs,
        slab: &Slab,
        first_pair: u32,
        cells: &Buffer,
    ) {
        let first = u64::from(io.level.first_cell);
        rec.pass(spirv::grid_ranges())
            .buffer(GRID_INFO, &io.grid_info)
            .buffer(GRID_KEYS, &pairs.keys)
            .buffer_part(CELLS, cells, first * 8, u64::from(io.level.grid.cell_count()) * 8)
            .push(&GridParams { first_pair, ..slab.params(io, BALL_MARGIN) })
            .dispatch(line(slab.pairs));
    }
}

impl Slab {
    fn is_sorted_at_once(&self, most: u32) -> bool {
        self.pairs <= most || self.end_layer - self.first_layer == 1
    }

    fn layers(&self) -> [u32; 2] {
        [self.first_layer, self.end_layer]
    }

    /// Its layers in parts that are likely to be small enough, the lowest last.
    fn parts(&self, most: u32) -> Vec<[u32; 2]> {
        let Self { first_layer: first, end_layer: end, pairs, .. } = *self;
        let parts = pairs.div_ceil(most).max(2);
        let layers = (end - first).div_ceil(parts);
        let starts = (first..end).step_by(layers as usize);
        starts.rev().map(|start| [start, end.min(start + layers)]).collect()
    }

    fn params(&self, io: &GridToBuild<'_>, ball_scale: f32) -> GridParams {
        GridParams {
            point_count: io.order.len() as u32,
            pair_count: self.pairs,
            ball_scale,
            first_layer: self.first_layer,
            end_layer: self.end_layer,
            first_pair: 0,
            any_large: u32::from(io.any_large),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slabs_are_as_large_as_points_memory_and_bindings_allow() {
        let heap = 2 << 30;
        assert_eq!(slab_pairs(1_000, heap), 7_000_000);
        assert_eq!(slab_pairs(5_000_000, heap), 15_000_000);
        assert_eq!(slab_pairs(100_000_000, 100 * heap), 32_000_000);
        let left = 10_000_000 * (28 + 24);
        assert_eq!(slab_pairs(10_000_000, left), 10_000_000, "one a point");
        assert_eq!(slab_pairs(10_000_000, 0), 7_000_000);
    }
}
