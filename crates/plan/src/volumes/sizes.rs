//! Grids by size: where points reach unevenly, those of each power of two have a grid of their own.

use super::cells::{Ranges, grid_over};
use super::{Lengths, MOST_POWERS, Volumes};
use kernels::layout::{
    BLOCK_PLACES, CELL_FINER, CELL_LOOK, CELL_NOTHING, STRIDE_STEPS, VOLUME_SPH, VolumeCell,
    VolumeInfo, VolumePoint,
};
use std::ops::Range;

/// Levels are kept in so many bits that this is the greatest.
const MOST_LEVEL: u32 = 24;
/// A stretch of steps stays clear of smaller points by as much.
const STRIDE: f32 = STRIDE_STEPS as f32;
/// Parts of the smallest reach of a class that a step is.
const STEPS_A_REACH: f32 = 4.0;

/// Points by the power of two of their reach, times the least.
pub(super) struct Classes {
    /// Coarsest first: indices of points in their order, the greatest reach, and the least that a point of the class may
    /// have.
    of: Vec<(Vec<u32>, f32, f32)>,
}

impl Classes {
    pub(super) fn of(reaches: &[f32]) -> Self {
        let least = reaches.iter().copied().fold(f32::INFINITY, f32::min);
        let power =
            |reach: f32| (f64::from(reach) / f64::from(least)).log2().floor().max(0.0) as usize;
        let count = reaches.iter().map(|&reach| power(reach) + 1).max().unwrap_or(0);
        let bound = |power: usize| (f64::from(least) * (power as f64).exp2()) as f32;
        let mut of: Vec<(Vec<u32>, f32, f32)> =
            (0..count).rev().map(|power| (Vec::new(), 0.0, bound(power))).collect();
        for (at, &reach) in reaches.iter().enumerate() {
            let class = &mut of[count - 1 - power(reach)];
            class.0.push(at as u32);
            class.1 = class.1.max(reach);
        }
        of.retain(|class| !class.0.is_empty());
        Self { of }
    }

    /// Lengths of steps among points of each class, where the scene leaves them to the program.
    fn step(&self, class: usize) -> f32 {
        self.of[class].2 / STEPS_A_REACH
    }
}

/// Of the edge of a cell, against a reach: more make more rows, fewer make more points to pass over. Measured on the oxygen
/// post: 1.2 times slower at 1, 1.07 at 3.
const CELLS_A_REACH: f32 = 1.5;
/// Cells of a grid, at most, by its points: with 8 bytes each beside the 20 of a point, no more than 32 bytes a point.
const CELLS_A_POINT: f64 = 1.4;

/// A point with its inverse length.
type Listed = (VolumePoint, f32);

impl Volumes {
    /// Lists the points of a volume in grids by size and returns it with those, and the lengths of steps among the points
    /// of each; `given` are all steps, where the scene says so. `reaches` is of each point.
    pub(super) fn list_by_size(
        &mut self,
        mut info: VolumeInfo,
        points: &[Listed],
        reaches: &[f32],
        given: Option<f32>,
    ) -> (VolumeInfo, Vec<f32>) {
        let classes = Classes::of(reaches);
        let steps: Vec<f32> = (0..classes.of.len())
            .map(|class| given.unwrap_or_else(|| classes.step(class)))
            .collect();
        info.first_size = self.sizes.len() as u32;
        info.size_count = classes.of.len() as u32;
        for class in 0..classes.of.len() {
            let (own, greatest, _) = &classes.of[class];
            let place = |&at: &u32| points[at as usize].0.position;
            // As far as a stretch of the steps in the grid before may go; before the first, of its own.
            let beyond = STRIDE * steps[class.saturating_sub(1)];
            let covered = classes.of[class..].iter().flat_map(|(own, ..)| own).map(place);
            let most = (CELLS_A_POINT * own.len() as f64) as usize;
            let edge = greatest / CELLS_A_REACH;
            let (grid, high) = grid_over(covered, edge, greatest + beyond, Some(most));
            let first_cell = self.cells.len() as u32;
            let size =
                VolumeInfo { grid, high, first_cell, square_radius: greatest * greatest, ..info };
            let subset = own.iter().map(|&at| points[at as usize]);
            let first = self.push_points(&grid, &subset.collect::<Vec<_>>());
            let kinds = self.kinds_by_size(&size, points, &classes, class, steps[class]);
            let cells = first.into_iter().zip(kinds);
            self.cells.extend(cells.map(|(first, counts)| VolumeCell { first, counts }));
            self.sizes.push(size);
        }
        let coarsest = self.sizes[info.first_size as usize];
        let mean_square = reaches.iter().map(|&reach| f64::from(reach).powi(2)).sum::<f64>()
            / reaches.len() as f64;
        let main = VolumeInfo {
            grid: coarsest.grid,
            high: coarsest.high,
            first_cell: coarsest.first_cell,
            square_radius: mean_square as f32,
            ..info
        };
        (main, steps)
    }

    /// What may be seen from each cell of the grid of a class, by all points in reach of a stretch of steps from there; and
    /// whether smaller points are that near.
    fn kinds_by_size(
        &self,
        size: &VolumeInfo,
        points: &[Listed],
        classes: &Classes,
        class: usize,
        step: f32,
    ) -> Vec<u32> {
        let (mut all, mut finer) = (Ranges::none(&size.grid), Ranges::none(&size.grid));
        for (other, (own, greatest, _)) in classes.of.iter().enumerate() {
            let places = own.iter().map(|&at| &points[at as usize].0);
            let near = Ranges::around(&size.grid, places, greatest + STRIDE * step);
            if other > class {
                finer.merge(&near);
            }
            all.merge(&near);
        }
        let kinds = all.0.into_iter().zip(finer.0).map(|(all, finer)| {
            let kind = self.kind_of(size, all);
            if finer.count > 0 && kind == CELL_LOOK { kind | CELL_FINER } else { kind }
        });
        kinds.chain([CELL_NOTHING]).collect()
    }
}

impl Volumes {
    /// The grids of a volume: its own, or those by size.
    #[must_use]
    pub fn grids_of<'a>(&'a self, info: &'a VolumeInfo) -> &'a [VolumeInfo] {
        let first = info.first_size as usize;
        match info.size_count as usize {
            0 => std::slice::from_ref(info),
            count => &self.sizes[first..first + count],
        }
    }

    /// Where the points of a volume are among those of all.
    #[must_use]
    pub fn range_of(&self, info: &VolumeInfo) -> Range<usize> {
        let at = |cell: usize| self.cells[cell].first as usize;
        let grids = self.grids_of(info);
        let first = grids.first().map_or(0, |grid| grid.first_cell as usize);
        let last = |grid: &VolumeInfo| grid.first_cell as usize + grid.grid.cell_count() as usize;
        at(first)..at(grids.last().map_or(first, last))
    }

    /// 1 / 2ρ of a point, and the square of its reach: its own, or those of all.
    #[must_use]
    pub fn width_of(&self, info: &VolumeInfo, point: usize) -> [f64; 2] {
        if info.inverse_width > 0.0 {
            return [info.inverse_width, info.square_radius].map(f64::from);
        }
        let inverse = f64::from(self.inverse_lengths[point]);
        [2.0 * inverse * inverse, 1.0 / (inverse * inverse)]
    }

    /// The list of the volumes as a device has it: after them their grids by size.
    #[must_use]
    pub fn with_sizes(&self) -> Vec<VolumeInfo> {
        let count = self.infos.len() as u32;
        let of = |info: &VolumeInfo| VolumeInfo { first_size: count + info.first_size, ..*info };
        self.infos.iter().chain(&self.sizes).map(of).collect()
    }

    /// The shortest of all steps, and how long those of each grid are beside it, given what each volume asks for.
    pub(super) fn set_levels(&mut self, lengths: &[Lengths]) {
        let own = |of: &Lengths| match of.of_sizes.is_empty() {
            true => vec![of.step as f32],
            false => of.of_sizes.clone(),
        };
        let all = lengths.iter().flat_map(own);
        self.step = all.fold(f32::MAX, f32::min);
        if self.sizes.is_empty() {
            return;
        }
        self.mark_for_stretches(lengths);
        // A little over a power of two by rounding is that power.
        let shortest = f64::from(self.step);
        let level =
            |step: f32| ((f64::from(step) / shortest).log2() + 1e-6).floor().max(0.0) as u32;
        for (info, of) in self.infos.iter_mut().zip(lengths) {
            let first = info.first_size as usize;
            for (size, &step) in self.sizes[first..].iter_mut().zip(&of.of_sizes) {
                size.level = level(step).min(MOST_LEVEL);
            }
            let steps = own(of);
            info.level = steps.iter().map(|&step| level(step)).max().unwrap_or(0).min(MOST_LEVEL);
        }
    }

    /// Beside volumes with grids by size, marks of those with one grid hold for stretches of steps as well.
    fn mark_for_stretches(&mut self, lengths: &[Lengths]) {
        for (info, of) in self.infos.iter().zip(lengths).filter(|(info, _)| info.size_count == 0) {
            let around = info.square_radius.sqrt() + STRIDE * of.step as f32;
            let points = self.points[self.range_of(info)].iter();
            let ranges = Ranges::around(&info.grid, points, around);
            let kinds: Vec<u32> =
                ranges.0.into_iter().map(|near| self.kind_of(info, near)).collect();
            let cells = self.cells[info.first_cell as usize..].iter_mut();
            cells.zip(kinds).for_each(|(cell, kind)| cell.counts = kind);
        }
    }

    /// Places of a block: as many as leave all weights, from the first place on, in the range of floats with a few decades
    /// to spare, and square distances with their digits.
    pub(super) fn block_of(&self, info: &VolumeInfo) -> u32 {
        let fits = |places: u32| {
            self.grids_of(info).iter().all(|grid| {
                let reach = f64::from(grid.square_radius).sqrt();
                // The smallest points of a grid by size reach half as far as the greatest.
                let inverse_width = match info.inverse_width > 0.0 {
                    true => f64::from(info.inverse_width),
                    false => 8.0 / (reach * reach),
                };
                let step = f64::from(self.step) * f64::from(grid.level).exp2();
                let way = f64::from(places - 1) * step;
                let powers = inverse_width * (reach + way).powi(2) * std::f64::consts::LOG2_E;
                way <= 4.0 * reach && (powers <= MOST_POWERS || info.kernel == VOLUME_SPH)
            })
        };
        let halves = [BLOCK_PLACES, BLOCK_PLACES / 2, BLOCK_PLACES / 4];
        halves.into_iter().find(|&places| fits(places)).unwrap_or(1)
    }
}
