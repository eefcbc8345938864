//! Twin of `march` and `glsl/shared/volume.glsl`: a ray through volumes (\[T\] §6).

use crate::camera_rays::Ray;
use crate::grid::{Ball, Grid, within_box};
use crate::media::Media;
use crate::real::{NO_HIT, Real, V3};
use kernels::layout::{
    VOLUME_AVERAGE, VOLUME_EMISSION, VOLUME_MAXIMUM, VOLUME_SHEPARD, VOLUME_SPH, VolumeInfo,
};
use plan::Volumes;

/// Transmittance that still counts.
const FEWEST: f64 = 1e-30;
const MOST_SAMPLES: f64 = 16_777_216.0;

/// What volumes do to a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct March<R> {
    /// Emitted towards its start.
    pub color: V3<R>,
    /// What comes through from behind.
    pub transmittance: R,
}

/// Colour and extinction of a scalar: linear between stops, constant beyond the outer ones.
pub fn transfer<R: Real>(volume: &VolumeInfo, volumes: &Volumes, scalar: R) -> (V3<R>, R) {
    let first = volume.first_stop as usize;
    let stops = &volumes.stops[first..first + volume.stop_count as usize];
    let above = stops[1..].partition_point(|stop| R::of_f32(stop.value) <= scalar);
    let (from, to) = (&stops[above], &stops[(above + 1).min(stops.len() - 1)]);
    let span = R::of_f32(to.value) - R::of_f32(from.value);
    let (zero, one) = (R::of(0.0), R::of(1.0));
    let part = if span > zero {
        ((scalar - R::of_f32(from.value)) / span).max(zero).min(one)
    } else {
        zero
    };
    let colors = [V3::of_f32(from.color), V3::of_f32(to.color)];
    let extinctions = [R::of_f32(from.extinction), R::of_f32(to.extinction)];
    (
        colors[0] + (colors[1] - colors[0]).times(part),
        extinctions[0] + part * (extinctions[1] - extinctions[0]),
    )
}

/// Monaghan's cubic spline times π h³, at q = d/h: 1 − 3/2 q² + 3/4 q³ below 1, (2 − q)³/4 below 2.
fn spline<R: Real>(q: R) -> R {
    let far = (R::of(2.0) - q).max(R::of(0.0));
    let near = (R::of(1.0) - q).max(R::of(0.0));
    R::of(0.25) * (far * far * far) - near * near * near
}

/// The scalar at x by Eq. 3, or the sum of its kernel; `None` out of every point's reach.
pub fn scalar_at<R: Real>(volume: &VolumeInfo, volumes: &Volumes, x: V3<R>) -> Option<R> {
    let grid = Grid::<R>::from(&volume.grid);
    let off = (x - grid.origin).times(grid.inverse_edge);
    let inside = (0..3)
        .all(|axis| off.0[axis] >= R::of(0.0) && off.0[axis] < R::of_u32(grid.resolution[axis]));
    let cell =
        |at: [u32; 3]| &volumes.cells[volume.first_cell as usize + grid.cell_id(at) as usize..];
    if !inside || cell(grid.cell_of(x))[0].counts == 0 {
        return None;
    }
    let square_radius = R::of_f32(volume.square_radius);
    let [low, high] = grid.cells_around(&Ball::exact(x, square_radius.sqrt()));
    let (mut numerator, mut denominator) = (R::of(0.0), R::of(0.0));
    for z in low[2]..=high[2] {
        for y in low[1]..=high[1] {
            let row = cell([low[0], y, z]);
            let end = row[(high[0] - low[0]) as usize + 1].first;
            for i in row[0].first as usize..end as usize {
                let point = &volumes.points[i];
                let to = V3::of_f32(point.position) - x;
                let square = to.dot(to);
                if volume.kernel == VOLUME_SPH {
                    let weight = spline(square.sqrt() * R::of_f32(volumes.inverse_lengths[i]));
                    numerator = numerator + weight * R::of_f32(point.scalar);
                    denominator = denominator + weight;
                } else if square <= square_radius {
                    let weight = (-square * R::of_f32(volume.inverse_width)).exp_negative();
                    numerator = numerator + weight * R::of_f32(point.scalar);
                    denominator = denominator + weight;
                }
            }
        }
    }
    let divisor = if volume.kernel == VOLUME_SHEPARD { denominator } else { R::of(1.0) };
    (denominator > R::of(0.0)).then(|| numerator / divisor)
}

/// What a ray shows of the scalar that stands for its whole way: a layer of one radius, or all of it.
fn shown<R: Real>(volume: &VolumeInfo, volumes: &Volumes, [scalar, way]: [R; 2]) -> March<R> {
    let mean = volume.mode == VOLUME_AVERAGE;
    let (color, extinction) = transfer(volume, volumes, if mean { scalar / way } else { scalar });
    let thickness = if mean { way } else { R::of_f32(volume.square_radius).sqrt() };
    let through = (-(extinction * thickness)).exp_negative();
    let transmittance = if through < R::of(FEWEST) { R::of(0.0) } else { through };
    March { color: color.times(R::of(1.0) - transmittance), transmittance }
}

/// Follows a ray that ends at `end` through all volumes. `media` are those it is inside of.
pub fn march<R: Real>(ray: &Ray<R>, end: R, media: &Media, volumes: &Volumes) -> March<R> {
    let (zero, one) = (R::of(0.0), R::of(1.0));
    let (mut from, mut to) = (R::of(NO_HIT), zero);
    let taking_part: Vec<&VolumeInfo> = volumes
        .infos
        .iter()
        .filter(|volume| volume.bounded == 0 || media.contains(volume.object))
        .collect();
    for volume in &taking_part {
        let [low, high] = [volume.grid.origin, volume.high].map(V3::of_f32);
        let [enter, leave] = within_box(low, high, ray.origin, ray.direction);
        if enter <= leave {
            from = from.min(if volume.bounded != 0 { zero } else { enter });
            to = to.max(leave);
        }
    }
    let step = R::of_f32(volumes.step);
    let span = to.min(end) - from;
    let samples = (-(-(span / step)).floor()).max(zero).min(R::of(MOST_SAMPLES)).to_u32();
    let mut march = March { color: V3::splat(zero), transmittance: one };
    let mut whole = [zero; 2]; // the greatest scalar or the integral of all, and the length in reach
    for place in 0..samples {
        let begin = R::of_u32(place) * step;
        let length = step.min(span - begin);
        let x = ray.origin + ray.direction.times(from + (begin + R::of(0.5) * length));
        let (mut color, mut extinction) = (V3::splat(zero), zero);
        for volume in &taking_part {
            let Some(scalar) = scalar_at(volume, volumes, x) else { continue };
            if volume.mode == VOLUME_MAXIMUM {
                let greater = whole[1] <= zero || scalar > whole[0];
                whole = [if greater { scalar } else { whole[0] }, whole[1] + length];
            } else if volume.mode == VOLUME_AVERAGE {
                whole = [whole[0] + length * scalar, whole[1] + length];
            } else {
                let (c, sigma) = transfer(volume, volumes, scalar);
                color = color + c.times(sigma);
                extinction = extinction + sigma;
            }
        }
        if extinction > zero {
            let through = (-(extinction * length)).exp_negative();
            let emitted = color.over(extinction).times(march.transmittance * (one - through));
            march.color = march.color + emitted;
            march.transmittance = march.transmittance * through;
        }
        if march.transmittance < R::of(FEWEST) {
            march.transmittance = zero;
            break;
        }
    }
    match volumes.infos.first() {
        Some(only) if only.mode != VOLUME_EMISSION && whole[1] > zero => {
            shown(only, volumes, whole)
        }
        _ => march,
    }
}
