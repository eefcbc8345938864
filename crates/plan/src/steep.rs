//! Transfer functions that are steeper than the scalar along a step is straight (docs/method.md, section 7).
//!
//! Rays integrate a transfer function over a straight line between the scalars at the two ends of a step. Within the
//! step the scalar departs from that line, most of all where points come into reach. Where the transfer function has
//! pieces so steep and narrow that this shows, a ray divides the steps that may pass one of them. How far the scalar
//! departs is measured on the data, by how much the scalars of the points around vary.

use crate::Volumes;
use crate::field;
use crate::volumes::cell_of;
use kernels::layout::{
    CELL_MARKS, CELL_NOTHING, VOLUME_EMISSION, VOLUME_SHEPARD, VOLUME_SPH, VolumeInfo, VolumeStop,
};
use rayon::prelude::*;

/// Steps at which the field is looked at, and into how many parts.
const STEPS: usize = 2_000;
const PARTS: usize = 8;
/// What a step may miss of its optical depth, or of what it emits.
const VISIBLE: f64 = 0.01;
/// Width of a steep piece, by how far the scalar is off a straight line: over a wider one, an integral along the line
/// misses little.
const NARROW: f64 = 4.0;
/// Part of the steps that count for how far that is.
const MOST: f64 = 0.99;

/// How the scalar goes along steps.
struct Along {
    /// Off a straight line.
    off: f64,
    /// Off it, by the spread of the points around.
    share: f64,
}

/// Marks the stops beside steep pieces, and writes into the cells how far the scalar may be off a straight line there.
pub(crate) fn mark(volumes: &mut Volumes) {
    for at in 0..volumes.infos.len() {
        let info = volumes.infos[at];
        let stops = info.first_stop as usize..(info.first_stop + info.stop_count) as usize;
        let step = step_of_most(volumes, &info);
        let missed = |pair: &[VolumeStop]| step * change(&pair[0], &pair[1]);
        let pieces = volumes.stops[stops.clone()].windows(2);
        if info.mode != VOLUME_EMISSION || !pieces.clone().any(|pair| missed(pair) > VISIBLE) {
            continue;
        }
        let spreads = spreads(volumes, &info);
        let Some(along) = measure(volumes, &info, &spreads) else { continue };
        let is_steep = |pair: &[VolumeStop]| {
            let gap = f64::from(pair[1].value) - f64::from(pair[0].value);
            let share = if along.off < gap { along.off / gap } else { 1.0 };
            gap < NARROW * along.off && missed(pair) * share > VISIBLE
        };
        let steep: Vec<bool> = pieces.map(is_steep).collect();
        let mut count = 0.0;
        for (i, stop) in volumes.stops[stops].iter_mut().enumerate() {
            let before = i > 0 && steep[i - 1];
            let bounds = before || steep.get(i).is_some_and(|steep| *steep);
            count += if bounds { 1.0 } else { 0.0 };
            stop.emission_integral[3] = count;
        }
        if count > 0.0 {
            let cells = volumes.cells[info.first_cell as usize..].iter_mut();
            for (cell, spread) in cells.zip(spreads).filter(|(cell, _)| cell.counts != CELL_NOTHING)
            {
                let margin = (along.share * spread).min(f64::from(f32::MAX)) as f32;
                cell.counts |= margin.to_bits() & !CELL_MARKS;
            }
        }
    }
}

/// Whether a volume has stops beside steep pieces.
pub(crate) fn is_steep(volumes: &Volumes, info: &VolumeInfo) -> bool {
    let last = info.first_stop + info.stop_count;
    volumes.stops[..last as usize].last().is_some_and(|stop| stop.emission_integral[3] > 0.0)
}

/// How much extinction, what it scatters or emission change from one stop to another.
fn change(from: &VolumeStop, to: &VolumeStop) -> f64 {
    let scattering = |stop: &VolumeStop, i: usize| {
        f64::from(stop.color[i]) * f64::from(stop.extinction) + f64::from(stop.emission[i])
    };
    (0..3)
        .map(|i| (scattering(from, i) - scattering(to, i)).abs())
        .fold((f64::from(from.extinction) - f64::from(to.extinction)).abs(), f64::max)
}

/// The length of steps among most points of a volume.
fn step_of_most(volumes: &Volumes, info: &VolumeInfo) -> f64 {
    let own = |grid: &&VolumeInfo| volumes.range_of(&VolumeInfo { size_count: 0, ..**grid }).len();
    let most = volumes.grids_of(info).iter().max_by_key(own).unwrap_or(info);
    step_in(volumes, most)
}

/// The length of steps where the points of a grid are the smallest around.
fn step_in(volumes: &Volumes, grid: &VolumeInfo) -> f64 {
    f64::from(volumes.step) * f64::from(grid.level).exp2()
}

/// How long steps are around a point, and how far it reaches.
fn lengths_at(volumes: &Volumes, info: &VolumeInfo, point: usize) -> [f64; 2] {
    let holds = |grid: &&VolumeInfo| {
        volumes.range_of(&VolumeInfo { size_count: 0, ..**grid }).contains(&point)
    };
    let own = volumes.grids_of(info).iter().find(holds).unwrap_or(info);
    let reach = match info.size_count {
        0 => f64::from(info.square_radius).sqrt(),
        _ if info.kernel == VOLUME_SPH => 2.0 / f64::from(volumes.inverse_lengths[point]),
        _ => 1.0 / f64::from(volumes.inverse_lengths[point]),
    };
    [step_in(volumes, own), reach]
}

/// How much the scalars vary that points have in and around each cell: their standard deviation where a scalar is a
/// mean, the root of the sum of their squares where it is a sum. With grids by size, 1 in all cells: how far scalars are
/// off a straight line is one number for all of them.
fn spreads(volumes: &Volumes, info: &VolumeInfo) -> Vec<f64> {
    if info.size_count > 0 {
        return vec![1.0; info.grid.cell_count() as usize];
    }
    let [nx, ny, nz] = info.grid.resolution.map(|n| n as usize);
    let first = |cell: usize| volumes.cells[info.first_cell as usize + cell].first as usize;
    let is_mean = info.kernel == VOLUME_SHEPARD;
    let all = &volumes.points[first(0)..first(nx * ny * nz)];
    let sum: f64 = all.iter().map(|point| f64::from(point.scalar)).sum();
    let middle = if is_mean { sum / all.len().max(1) as f64 } else { 0.0 };
    // Count, sum, and sum of squares.
    let mut sums: Vec<[f64; 3]> = (0..nx * ny * nz)
        .map(|cell| {
            let points = volumes.points[first(cell)..first(cell + 1)].iter();
            points.map(|point| f64::from(point.scalar) - middle).fold([0.0; 3], |sums, scalar| {
                [sums[0] + 1.0, sums[1] + scalar, sums[2] + scalar * scalar]
            })
        })
        .collect();
    // A point reaches no farther than a cell's edge.
    for (stride, count) in [(1, nx), (nx, ny), (nx * ny, nz)] {
        let lines = (0..sums.len()).filter(|at| at / stride % count == 0);
        let mut line = vec![[0.0; 3]; count];
        for start in lines {
            for (i, value) in line.iter_mut().enumerate() {
                *value = sums[start + i * stride];
            }
            for i in 0..count {
                let around = &line[i.saturating_sub(1)..(i + 2).min(count)];
                sums[start + i * stride] =
                    around.iter().fold([0.0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
            }
        }
    }
    let spread = |[count, sum, squares]: [f64; 3]| match is_mean {
        true => (squares / count.max(1.0) - (sum / count.max(1.0)).powi(2)).max(0.0).sqrt(),
        false => squares.sqrt(),
    };
    sums.into_iter().map(spread).collect()
}

/// Follows the scalar along steps in all directions around points in all parts of the volume; `None` where there are no
/// such steps with points in reach all along.
fn measure(volumes: &Volumes, info: &VolumeInfo, spreads: &[f64]) -> Option<Along> {
    let points = volumes.range_of(info);
    let found: Vec<[f64; 2]> = (0..STEPS.min(points.len()))
        .into_par_iter()
        .filter_map(|i| {
            let at = points.start + i * points.len() / STEPS.min(points.len());
            let (point, [step, reach]) = (&volumes.points[at], lengths_at(volumes, info, at));
            let off = direction(i * 1_237 % STEPS);
            let part = 0.5 * reach * (i as f64 * 0.754_877_666).fract();
            let start = [0, 1, 2].map(|axis| f64::from(point.position[axis]) + part * off[axis]);
            let d = direction(i);
            let mut scalars = [0.0; PARTS + 1];
            let mut end = start;
            for (k, scalar) in scalars.iter_mut().enumerate() {
                let t = step * k as f64 / PARTS as f64;
                end = [0, 1, 2].map(|axis| start[axis] + t * d[axis]);
                *scalar = field::at(volumes, info, end)?.0;
            }
            let change = scalars[PARTS] - scalars[0];
            let line = |k: usize| scalars[0] + change * k as f64 / PARTS as f64;
            let off = (1..PARTS).map(|k| (scalars[k] - line(k)).abs()).fold(0.0, f64::max);
            let spread = spreads[cell_of(&info.grid, end.map(|x| x as f32))];
            Some([off, off / spread])
        })
        .collect();
    let part = |which: usize, part: f64| {
        let mut values: Vec<f64> =
            found.iter().map(|of| of[which]).filter(|value| value.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        values.get((part * values.len() as f64) as usize).copied()
    };
    Some(Along { off: part(0, MOST)?, share: part(1, MOST)? })
}

/// Directions spread evenly: a spiral from pole to pole.
fn direction(i: usize) -> [f64; 3] {
    let z = 1.0 - (2 * i + 1) as f64 / STEPS as f64;
    let (sin, cos) = (i as f64 * 2.399_963_229_728_653).sin_cos();
    let across = (1.0 - z * z).max(0.0).sqrt();
    [across * cos, across * sin, z]
}
