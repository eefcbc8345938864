//! The points, cells and transfer functions of a volume, as kernels read them.

use super::cells::{Range, Ranges, cell_of, grid_over, sorted_into_cells};
use super::{Lengths, Volumes, has_emission};
use crate::field;
use crate::transfer::{scaled, stops_of};
use bytemuck::Zeroable;
use kernels::layout::{
    CELL_ABOVE, CELL_BELOW, CELL_LOOK, CELL_NOTHING, GridInfo, VOLUME_AVERAGE, VOLUME_EMISSION,
    VOLUME_EMITS, VOLUME_GRADIENT, VOLUME_INTEGRAL, VOLUME_ISOSURFACE, VOLUME_MAXIMUM,
    VOLUME_SCATTERS, VOLUME_SHEPARD, VOLUME_SPH, VOLUME_SUM, VolumeCell, VolumeInfo, VolumePoint,
    VolumeStop,
};
use scene::{Boundary, ExtinctionFactor, Object, Volume, VolumeKernel, VolumeMode, VolumeShading};

/// The greatest smoothing length of particles that have one grid, by the median.
const UNEVEN_LENGTHS: f32 = 4.0;

impl Volumes {
    /// Gives the last volume, which shows integrals, the stops of a transfer function up to what no ray exceeds, and
    /// returns that range.
    pub(super) fn bound_integral(&mut self, volume: &Volume) -> [f64; 2] {
        let Some(mut info) = self.infos.pop() else { return [0.0; 2] };
        let range = field::bound_of_integrals(self, &info);
        self.stops.truncate(info.first_stop as usize);
        self.stops.extend(stops_of(volume.transfer.as_ref(), volume.scale, || range));
        info.stop_count = self.stops.len() as u32 - info.first_stop;
        self.infos.push(info);
        range
    }

    pub(super) fn add(
        &mut self,
        index: u32,
        object: &Object,
        volume: &Volume,
        radius: f32,
        (points, stops): (Vec<(VolumePoint, f32)>, Vec<VolumeStop>),
    ) -> Lengths {
        let lengths = points.iter().filter(|(_, inverse)| *inverse > 0.0);
        let (sum, count) = lengths.fold((0.0, 0u32), |(sum, count), (_, inverse)| {
            (sum + 1.0 / f64::from(*inverse), count + 1)
        });
        let mean = (sum / f64::from(count.max(1))) as f32;
        let by_size = reaches_by_size(volume, &points);
        let is_own = by_size.is_some() && !matches!(volume.kernel, VolumeKernel::Sph { .. });
        let smoothing = match is_own {
            true => 0.25 * mean * mean,
            false => volume.smoothing.map_or(0.25 * radius * radius, |rho| rho as f32),
        };
        let step = match (volume.step, count) {
            (Some(step), _) => step as f32,
            (None, 0) => 0.25 * radius,
            (None, _) if is_own => 0.25 * mean,
            (None, _) => 0.5 * mean,
        };
        let first_stop = self.stops.len() as u32;
        self.stops.extend(stops);
        let kernel = match volume.kernel {
            VolumeKernel::Shepard => VOLUME_SHEPARD,
            VolumeKernel::Sum => VOLUME_SUM,
            VolumeKernel::Sph { .. } => VOLUME_SPH,
        };
        let info = VolumeInfo {
            first_stop,
            stop_count: self.stops.len() as u32 - first_stop,
            kernel,
            square_radius: radius * radius,
            inverse_width: if is_own { 0.0 } else { 1.0 / (2.0 * smoothing) },
            object: index,
            bounded: u32::from(volume.boundary != Boundary::None),
            mode: match volume.mode {
                VolumeMode::Emission => VOLUME_EMISSION,
                VolumeMode::Maximum => VOLUME_MAXIMUM,
                VolumeMode::Average => VOLUME_AVERAGE,
                VolumeMode::Integral => VOLUME_INTEGRAL,
                VolumeMode::Isosurface(_) => VOLUME_ISOSURFACE,
            },
            iso: match volume.mode {
                VolumeMode::Isosurface(iso) => iso as f32,
                _ => match volume.shading {
                    VolumeShading::Scatter { anisotropy } => anisotropy as f32,
                    _ => 0.0,
                },
            },
            slot: u32::from(self.stops[first_stop as usize..].iter().any(has_emission)),
            refracts: u32::from(
                matches!(volume.mode, VolumeMode::Isosurface(_))
                    && object.material.kind.has_inside(),
            ),
            shading: match volume.shading {
                VolumeShading::None => VOLUME_EMITS,
                VolumeShading::Gradient => VOLUME_GRADIENT,
                VolumeShading::Scatter { .. } => VOLUME_SCATTERS,
            },
            ..VolumeInfo::zeroed()
        };
        let lengths =
            Lengths { smoothing: smoothing.into(), step: step.into(), of_sizes: Vec::new() };
        if let Some(reaches) = by_size {
            let given = volume.step.map(|step| step as f32);
            let (info, steps) = self.list_by_size(info, &points, &reaches, given);
            self.infos.push(info);
            return Lengths { of_sizes: steps, ..lengths };
        }
        let places = points.iter().map(|(point, _)| point.position);
        let (grid, high) = grid_over(places, radius, radius, None);
        let info = VolumeInfo { grid, high, first_cell: self.cells.len() as u32, ..info };
        self.list(&info, &points, step);
        self.infos.push(info);
        lengths
    }

    /// Multiplies the extinctions of the last volume; `chosen` says by what where the scene leaves it to the program.
    pub(super) fn scale_extinctions(
        &mut self,
        factor: ExtinctionFactor,
        chosen: impl FnOnce(&Self, &VolumeInfo) -> Option<f64>,
    ) {
        let Some(info) = self.infos.last() else { return };
        let factor = match factor {
            ExtinctionFactor::Given(factor) => factor,
            ExtinctionFactor::Auto => chosen(self, info).unwrap_or(1.0),
        };
        let first = info.first_stop as usize;
        if factor != 1.0 {
            let scaled = scaled(self.stops.split_off(first), factor);
            self.stops.extend(scaled);
        }
    }

    /// Lists the points by cell, and says which cells may show anything.
    fn list(&mut self, info: &VolumeInfo, points: &[(VolumePoint, f32)], step: f32) {
        let first = self.push_points(&info.grid, points);
        // Of a place in the cell, and of the ends of the steps that end there.
        let around = info.square_radius.sqrt() + step;
        let ranges = Ranges::around(&info.grid, points.iter().map(|(point, _)| point), around);
        let kinds = ranges.0.into_iter().map(|range| self.kind_of(info, range));
        let kinds: Vec<u32> = kinds.chain([CELL_NOTHING]).collect();
        let cells = first.into_iter().zip(kinds);
        self.cells.extend(cells.map(|(first, counts)| VolumeCell { first, counts }));
    }

    /// Lists points by cell, in their order within one; returns where those of each cell begin in the points of all
    /// volumes, and after the last where they end.
    pub(super) fn push_points(
        &mut self,
        grid: &GridInfo,
        points: &[(VolumePoint, f32)],
    ) -> Vec<u32> {
        let base = self.points.len() as u32;
        let cells: Vec<usize> = points.iter().map(|(p, _)| cell_of(grid, p.position)).collect();
        let (order, mut first) = sorted_into_cells(&cells, grid.cell_count() as usize);
        let sorted = || order.iter().map(|&at| points[at as usize]);
        self.points.extend(sorted().map(|(point, _)| point));
        self.inverse_lengths.extend(sorted().map(|(_, inverse_length)| inverse_length));
        first.iter_mut().for_each(|at| *at += base);
        first
    }

    /// What may be seen where the scalars of the points in reach are in a range: something, where some value that they can
    /// have together has an extinction or an emission; or on which side of an isosurface all of it is. What counts for a
    /// place counts for the steps that end there, too: of a step with an end in a cell from which nothing is seen, nothing
    /// is seen.
    pub(super) fn kind_of(&self, info: &VolumeInfo, near: Range) -> u32 {
        let Range { low, high, count } = near;
        let (low, high) = match info.kernel {
            // No kernel is over 1.
            VOLUME_SUM | VOLUME_SPH => {
                ((low * count as f32).min(0.0), (high * count as f32).max(0.0))
            }
            _ => (low, high),
        };
        let margin = rounding(low, high);
        match info.mode {
            _ if count == 0 => CELL_NOTHING,
            VOLUME_ISOSURFACE if high + margin < info.iso => CELL_BELOW,
            VOLUME_ISOSURFACE if low - margin > info.iso => CELL_ABOVE,
            VOLUME_ISOSURFACE => CELL_LOOK,
            VOLUME_EMISSION if !self.shows(info, low, high) => CELL_NOTHING,
            // What cannot be seen counts too, where not each place is seen for itself.
            _ => CELL_LOOK,
        }
    }

    /// Whether the transfer function shows anything from `low` to `high`, and a rounding farther.
    fn shows(&self, info: &VolumeInfo, low: f32, high: f32) -> bool {
        let margin = rounding(low, high);
        let (low, high) = (low - margin, high + margin);
        let first = info.first_stop as usize;
        let stops = &self.stops[first..first + info.stop_count as usize];
        let sends = |stop: &VolumeStop| stop.extinction > 0.0 || has_emission(stop);
        let inside = stops.iter().any(|s| sends(s) && s.value >= low && s.value <= high);
        // Linear between stops: only its ends, and what the outer stops mean beyond them.
        let pieces = stops.windows(2).any(|pair| {
            pair[0].value <= high
                && pair[1].value >= low
                && (sends(&pair[0]) && pair[1].value > low
                    || sends(&pair[1]) && pair[0].value < high)
        });
        let (Some(least), Some(last)) = (stops.first(), stops.last()) else { return false };
        inside
            || pieces
            || (low <= least.value && sends(least))
            || (high >= last.value && sends(last))
    }
}

/// How far each point reaches, where that is uneven enough for grids by size: where they have reaches of their own, or
/// smoothing lengths of which the greatest is far over the one in the middle.
fn reaches_by_size(volume: &Volume, points: &[(VolumePoint, f32)]) -> Option<Vec<f32>> {
    let is_sph = matches!(volume.kernel, VolumeKernel::Sph { .. });
    let reach = |inverse: f32| if is_sph { 2.0 / inverse } else { 1.0 / inverse };
    let reaches: Vec<f32> = points.iter().map(|(_, inverse)| reach(*inverse)).collect();
    let mut sorted = reaches.clone();
    sorted.sort_unstable_by(f32::total_cmp);
    let (&middle, &last) = (sorted.get(sorted.len() / 2)?, sorted.last()?);
    let is_uneven = last.is_finite() && (!is_sph || last >= UNEVEN_LENGTHS * middle);
    is_uneven.then_some(reaches)
}

/// How far beyond the greatest and least of some values rounding may take what is made of them.
fn rounding(low: f32, high: f32) -> f32 {
    1e-5 * low.abs().max(high.abs())
}
