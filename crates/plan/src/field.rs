//! The scalar field of a volume in f64, where a plan has to know it: its gradient, and how large it becomes.

use crate::Volumes;
use kernels::layout::{VOLUME_ISOSURFACE, VOLUME_SHEPARD, VOLUME_SPH, VolumeInfo};
use rayon::prelude::*;
use scene::Object;

/// Points at which the gradient is asked for.
const ASKED: usize = 20_000;
/// Part of them, and how many where they are few, that are steeper than what counts as steep: a stray value is a slope
/// around one point, of all sizes of features no other is as small.
const STEEPER: f64 = 0.003;
const STEEPER_OF_FEW: usize = 60;
/// How far the scalar may be from a straight line within a step, of its range.
const STRAIGHT: f64 = 0.02;

/// Hands out each point of a volume that reaches a place: its index, its weight, what the gradient of that is along the way
/// to it, and this way.
pub(crate) fn for_each_near(
    volumes: &Volumes,
    info: &VolumeInfo,
    x: [f64; 3],
    mut visit: impl FnMut(usize, f64, f64, [f64; 3]),
) {
    for of in volumes.grids_of(info) {
        let grid = &of.grid;
        let reach = f64::from(of.square_radius).sqrt();
        let cell = |axis: usize, at: f64| {
            let cell = (at - f64::from(grid.origin[axis])) * f64::from(grid.inverse_edge);
            (cell.max(0.0) as u32).min(grid.resolution[axis] - 1)
        };
        let [low, high] =
            [-reach, reach].map(|off| [0, 1, 2].map(|axis| cell(axis, x[axis] + off)));
        let [nx, ny, _] = grid.resolution;
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                let row = of.first_cell + nx * (y + ny * z);
                let first = |x: u32| volumes.cells[(row + x) as usize].first as usize;
                for i in first(low[0])..first(high[0] + 1) {
                    let position = volumes.points[i].position;
                    let to = [0, 1, 2].map(|axis| f64::from(position[axis]) - x[axis]);
                    let square = to.iter().map(|along| along * along).sum::<f64>();
                    if let Some([weight, slope]) = weight(volumes, info, i, square) {
                        visit(i, weight, slope, to);
                    }
                }
            }
        }
    }
}

/// The weight of a point at a place, and its slope towards it, by the square of how far away that is; `None` out of its
/// reach.
pub(crate) fn weight(
    volumes: &Volumes,
    info: &VolumeInfo,
    point: usize,
    square: f64,
) -> Option<[f64; 2]> {
    if info.kernel == VOLUME_SPH {
        let (weight, slope) = spline(square.sqrt(), f64::from(volumes.inverse_lengths[point]));
        return Some([weight, slope]);
    }
    let [width, square_radius] = volumes.width_of(info, point);
    let weight = (-square * width).exp();
    (square <= square_radius).then_some([weight, 2.0 * width * weight])
}

/// The scalar at a place, and its gradient; `None` where no point is in reach (Eq. 14 of docs/method.md, or the sum of
/// the kernel).
pub(crate) fn at(volumes: &Volumes, info: &VolumeInfo, x: [f64; 3]) -> Option<(f64, [f64; 3])> {
    let (mut sum, mut weights, mut pull, mut weights_pull) = (0.0, 0.0, [0.0; 3], [0.0; 3]);
    for_each_near(volumes, info, x, |i, weight, slope, to| {
        let scalar = f64::from(volumes.points[i].scalar);
        sum += weight * scalar;
        weights += weight;
        for axis in 0..3 {
            pull[axis] += slope * scalar * to[axis];
            weights_pull[axis] += slope * to[axis];
        }
    });
    let mean = sum / weights;
    let of_mean = [0, 1, 2].map(|axis| (pull[axis] - mean * weights_pull[axis]) / weights);
    let found = if info.kernel == VOLUME_SHEPARD { (mean, of_mean) } else { (sum, pull) };
    (weights > 0.0).then_some(found)
}

/// Monaghan's cubic spline times π h³ at a distance, and its slope towards the particle.
fn spline(distance: f64, inverse_length: f64) -> (f64, f64) {
    let q = distance * inverse_length;
    let (near, far) = ((1.0 - q).max(0.0), (2.0 - q).max(0.0));
    let slope = if q < 1.0 { 3.0 - 2.25 * q } else { 0.75 * far * far / q };
    (0.25 * far.powi(3) - near.powi(3), slope * inverse_length * inverse_length)
}

fn f64s(of: [f32; 3]) -> [f64; 3] {
    of.map(f64::from)
}

/// From 0 to what the integral along no ray exceeds: the greatest scalar times the diagonal of the box. A mean is
/// nowhere greater than the greatest of its points; a sum is taken to be greatest at one of them.
pub(crate) fn bound_of_integrals(volumes: &Volumes, info: &VolumeInfo) -> [f64; 2] {
    let range = volumes.range_of(info);
    let points = volumes.points[range].iter();
    let value = |point: &kernels::layout::VolumePoint| match info.kernel {
        VOLUME_SHEPARD => f64::from(point.scalar),
        _ => at(volumes, info, f64s(point.position)).map_or(0.0, |(value, _)| value),
    };
    let (least, most) = points
        .map(value)
        .fold((0.0f64, 0.0f64), |(least, most), value| (least.min(value), most.max(value)));
    let (low, high) = (f64s(info.grid.origin), f64s(info.high));
    let diagonal = (0..3).map(|axis| (high[axis] - low[axis]).powi(2)).sum::<f64>().sqrt();
    [least * diagonal, most * diagonal]
}

/// A warning where a step that a scene gives is too long for how fast the scalar changes. Within a step the scalar is
/// taken to go straight from one end to the other. Its gradient g changes on the scale L of the kernel, so it departs
/// from that by about g ℓ²/8L. A step longer than L passes by points, whatever their scalars.
pub(crate) fn long_step(volumes: &Volumes, info: &VolumeInfo, object: &Object) -> Option<String> {
    let volume = object.volume.as_ref().filter(|_| info.mode != VOLUME_ISOSURFACE)?;
    volume.step?;
    let range = volumes.range_of(info);
    let asked = range.len().min(ASKED);
    let places = (0..asked).map(|i| range.start + i * range.len() / asked);
    let places: Vec<usize> = places.collect();
    let found: Vec<(f64, [f64; 3])> = (places.into_par_iter())
        .filter_map(|i| at(volumes, info, f64s(volumes.points[i].position)))
        .collect();
    let mut steepness: Vec<f64> = found
        .iter()
        .map(|(_, gradient)| gradient.iter().map(|along| along * along).sum::<f64>().sqrt())
        .collect();
    steepness.sort_by(f64::total_cmp);
    let few = STEEPER_OF_FEW.min(steepness.len() / 10);
    let steeper = few.max((STEEPER * steepness.len() as f64) as usize);
    let steep = *steepness.get(steepness.len().checked_sub(steeper + 1)?)?;
    let border = (info.kernel != VOLUME_SHEPARD).then_some(0.0);
    let values = || found.iter().map(|(value, _)| *value).chain(border);
    let span = values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min);
    let scale = match info.kernel {
        VOLUME_SPH => mean_length(volumes, info),
        _ => f64::from(info.square_radius).sqrt(),
    };
    let step = f64::from(volumes.step);
    if scale.is_nan() || scale <= 0.0 {
        return None;
    }
    let good = match span > 0.0 && steep > 0.0 {
        true => (8.0 * STRAIGHT * scale * span / steep).sqrt().max(0.25 * scale),
        false => f64::INFINITY,
    };
    let why = if step > 1.01 * good {
        let off = steep * step * step / (8.0 * scale) / span;
        format!(
            "too long for how fast '{}' changes: within one it is off a straight line by {:.0} % of its range",
            volume.scalar,
            (100.0 * off).clamp(1.0, 100.0),
        )
    } else if step > 1.01 * scale {
        format!(
            "longer than a point reaches, {}: rays pass by points between two samples",
            short(scale)
        )
    } else {
        return None;
    };
    Some(format!(
        "object '{}': a step of {} is {why}, and features are missed; set step = {} or leave it out",
        object.name,
        short(step),
        short(good.min(scale)),
    ))
}

/// Twice the mean smoothing length: what the step of particles is a quarter of.
fn mean_length(volumes: &Volumes, info: &VolumeInfo) -> f64 {
    let lengths = volumes.inverse_lengths[volumes.range_of(info)].iter();
    let there = lengths.filter(|inverse| **inverse > 0.0).map(|inverse| 1.0 / f64::from(*inverse));
    let (sum, count) = there.fold((0.0, 0u32), |(sum, count), h| (sum + h, count + 1));
    2.0 * sum / f64::from(count.max(1))
}

/// Two digits, rounded down.
fn short(length: f64) -> String {
    let unit = 10f64.powf(length.log10().floor() - 1.0);
    let digits = (length / unit * (1.0 + 1e-9)).floor();
    format!(
        "{}",
        format!("{digits}e{}", (length.log10().floor() - 1.0) as i32)
            .parse::<f64>()
            .unwrap_or(length)
    )
}
