//! The points, cells and transfer functions of a volume, as kernels read them.

use super::{Lengths, MOST_CELLS, Volumes, has_emission};
use crate::field;
use crate::transfer::{scaled, stops_of};
use kernels::layout::{
    CELL_ABOVE, CELL_BELOW, CELL_LOOK, CELL_NOTHING, GridInfo, VOLUME_AVERAGE, VOLUME_EMISSION,
    VOLUME_EMITS, VOLUME_GRADIENT, VOLUME_INTEGRAL, VOLUME_ISOSURFACE, VOLUME_MAXIMUM,
    VOLUME_SCATTERS, VOLUME_SHEPARD, VOLUME_SPH, VOLUME_SUM, VolumeCell, VolumeInfo, VolumePoint,
    VolumeStop,
};
use scene::{Boundary, ExtinctionFactor, Object, Volume, VolumeKernel, VolumeMode, VolumeShading};

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
        let smoothing = volume.smoothing.map_or(0.25 * radius * radius, |rho| rho as f32);
        let lengths = points.iter().filter(|(_, inverse)| *inverse > 0.0);
        let (sum, count) = lengths.fold((0.0, 0u32), |(sum, count), (_, inverse)| {
            (sum + 1.0 / f64::from(*inverse), count + 1)
        });
        let step = match (volume.step, count) {
            (Some(step), _) => step as f32,
            (None, 0) => 0.25 * radius,
            (None, _) => (0.5 * sum / f64::from(count)) as f32,
        };
        self.step = self.step.min(step);
        let (grid, high) = grid_over(&points, radius);
        let (first_cell, first_stop) = (self.cells.len() as u32, self.stops.len() as u32);
        self.stops.extend(stops);
        let kernel = match volume.kernel {
            VolumeKernel::Shepard => VOLUME_SHEPARD,
            VolumeKernel::Sum => VOLUME_SUM,
            VolumeKernel::Sph { .. } => VOLUME_SPH,
        };
        let info = VolumeInfo {
            grid,
            first_cell,
            first_stop,
            stop_count: self.stops.len() as u32 - first_stop,
            kernel,
            square_radius: radius * radius,
            inverse_width: 1.0 / (2.0 * smoothing),
            object: index,
            bounded: u32::from(volume.boundary != Boundary::None),
            high,
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
            block: 0,
            pad: [0; 3],
        };
        self.list(&info, &points, step);
        self.infos.push(info);
        Lengths { smoothing: smoothing.into(), step: step.into() }
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

    /// Counts, adds up and scatters the points, in their order, and says which cells may show anything.
    fn list(&mut self, info: &VolumeInfo, points: &[(VolumePoint, f32)], step: f32) {
        let grid = &info.grid;
        let base = self.points.len();
        let cell_of: Vec<usize> = points.iter().map(|(p, _)| cell_of(grid, p.position)).collect();
        let cells = grid.cell_count() as usize;
        let mut first = vec![0u32; cells + 1];
        for &cell in &cell_of {
            first[cell + 1] += 1;
        }
        for cell in 0..cells {
            first[cell + 1] += first[cell];
        }
        let mut next = first.clone();
        self.points.resize(base + points.len(), VolumePoint { position: [0.0; 3], scalar: 0.0 });
        self.inverse_lengths.resize(base + points.len(), 0.0);
        for ((point, inverse_length), &cell) in points.iter().zip(&cell_of) {
            self.points[base + next[cell] as usize] = *point;
            self.inverse_lengths[base + next[cell] as usize] = *inverse_length;
            next[cell] += 1;
        }
        let seen = self.cells_seen(info, points, &cell_of, step);
        self.cells.extend(
            first
                .iter()
                .enumerate()
                .map(|(cell, &at)| VolumeCell { first: base as u32 + at, counts: seen[cell] }),
        );
    }

    /// What may be seen from each cell: something, where there are points in the cells around, and some
    /// value that they can have together has an extinction or an emission; or on which side of an isosurface all of it
    /// is. What counts for a place counts for the steps that end there, too: of a step with an end in a cell from which
    /// nothing is seen, nothing is seen.
    fn cells_seen(
        &self,
        info: &VolumeInfo,
        points: &[(VolumePoint, f32)],
        cell_of: &[usize],
        step: f32,
    ) -> Vec<u32> {
        let [nx, ny, nz] = info.grid.resolution.map(|n| n as usize);
        let none = (f32::INFINITY, f32::NEG_INFINITY, 0u32);
        let mut ranges = vec![none; nx * ny * nz];
        let merge =
            |a: (f32, f32, u32), b: (f32, f32, u32)| (a.0.min(b.0), a.1.max(b.1), a.2 + b.2);
        for ((point, _), &cell) in points.iter().zip(cell_of) {
            ranges[cell] = merge(ranges[cell], (point.scalar, point.scalar, 1));
        }
        // Of a place in the cell, and of the ends of the steps that end there.
        let cells = (info.square_radius.sqrt() + step) * info.grid.inverse_edge;
        let reach = ((cells + 1e-3).min(MOST_CELLS as f32)) as usize + 1;
        // The box around a cell, one axis after the other.
        for (stride, count) in [(1, nx), (nx, ny), (nx * ny, nz)] {
            let before = ranges.clone();
            for (at, range) in ranges.iter_mut().enumerate() {
                let place = at / stride % count;
                let (low, high) = (place.saturating_sub(reach), (place + reach).min(count - 1));
                *range = (low..=high)
                    .map(|other| before[at + other * stride - place * stride])
                    .fold(none, merge);
            }
        }
        let seen = |(low, high, count): (f32, f32, u32)| {
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
        };
        ranges.into_iter().map(seen).chain([CELL_NOTHING]).collect()
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

/// How far beyond the greatest and least of some values rounding may take what is made of them.
fn rounding(low: f32, high: f32) -> f32 {
    1e-5 * low.abs().max(high.abs())
}

/// Cells of an edge of the radius, over the points' bounding box grown by it, and the highest corner of that.
fn grid_over(points: &[(VolumePoint, f32)], radius: f32) -> (GridInfo, [f32; 3]) {
    let along = |axis: usize| points.iter().map(move |(p, _)| p.position[axis]);
    let (mut low, mut high, mut extent) = ([0.0; 3], [0.0; 3], [0.0f64; 3]);
    for axis in 0..3 {
        let least = along(axis).fold(f32::INFINITY, f32::min);
        let most = along(axis).fold(f32::NEG_INFINITY, f32::max);
        if least <= most {
            low[axis] = least - radius;
            high[axis] = most + radius;
            extent[axis] = f64::from(most) - f64::from(least) + 2.0 * f64::from(radius);
        }
    }
    let longest = extent.iter().copied().fold(0.0, f64::max);
    let edge = f64::from(radius).max(longest / MOST_CELLS);
    let grid = GridInfo {
        origin: low,
        edge: edge as f32,
        resolution: extent.map(|length| (length * 1.000_01 / edge).ceil().max(1.0) as u32),
        inverse_edge: 1.0 / edge as f32,
    };
    (grid, high)
}

pub(crate) fn cell_of(grid: &GridInfo, position: [f32; 3]) -> usize {
    let at = [0, 1, 2].map(|axis| {
        let cell = ((position[axis] - grid.origin[axis]) * grid.inverse_edge).floor();
        (cell.max(0.0) as usize).min(grid.resolution[axis] as usize - 1)
    });
    at[0] + grid.resolution[0] as usize * (at[1] + grid.resolution[1] as usize * at[2])
}
