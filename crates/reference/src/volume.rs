//! Twin of `march` and `glsl/shared/volume.glsl`: a ray through volumes (\[T\] §6).

use crate::camera_rays::Ray;
use crate::grid::{Ball, Grid, within_box};
use crate::light::sample_light;
use crate::media::{Media, transmittance};
use crate::real::{NO_HIT, Real, V3};
use kernels::layout::{
    CELL_NOTHING, Light, ObjectInfo, VOLUME_AVERAGE, VOLUME_EMITS, VOLUME_GRADIENT,
    VOLUME_ISOSURFACE, VOLUME_LIGHTS, VOLUME_MAXIMUM, VOLUME_SHEPARD, VOLUME_SPH, VolumeInfo,
};
use plan::Volumes;
use std::f64::consts::FRAC_1_PI;

/// Transmittance that still counts.
const FEWEST: f64 = 1e-30;
pub(crate) const MOST_SAMPLES: f64 = 16_777_216.0;
/// A gradient over a point's reach, by the scalar: less is rounding.
const FLATTEST: f32 = 1e-5;

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

/// What the gradient of the cubic spline is along y = p − x, by 1/h.
fn spline_pull<R: Real>(q: R, inverse_length: R) -> R {
    let far = (R::of(2.0) - q).max(R::of(0.0));
    let slope =
        if q < R::of(1.0) { R::of(3.0) - R::of(2.25) * q } else { R::of(0.75) * (far * far) / q };
    slope * (inverse_length * inverse_length)
}

/// Light in the volumes of a scene.
#[derive(Debug, Clone, Copy)]
pub struct Lighting<'a, R> {
    /// By point of all volumes: how much of each light's reaches it.
    pub visible: &'a [[R; VOLUME_LIGHTS as usize]],
    /// Of the scene.
    pub lights: &'a [Light],
}

/// What the points in reach of a place add up to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sums<R> {
    numerator: R,
    denominator: R,
    pull: V3<R>,
    weights_pull: V3<R>,
    visible: [R; VOLUME_LIGHTS as usize],
}

impl<R: Real> Sums<R> {
    /// Over all points in reach of x; visibility too where there is lighting.
    pub fn at(
        volume: &VolumeInfo,
        volumes: &Volumes,
        x: V3<R>,
        lighting: Option<Lighting<'_, R>>,
    ) -> Self {
        let zero = R::of(0.0);
        let none = V3::splat(zero);
        let mut sums = Self {
            numerator: zero,
            denominator: zero,
            pull: none,
            weights_pull: none,
            visible: [zero; VOLUME_LIGHTS as usize],
        };
        for_each_near(volume, volumes, x, |i, weight, pull, y| {
            let scalar = R::of_f32(volumes.points[i].scalar);
            sums.numerator = sums.numerator + weight * scalar;
            sums.denominator = sums.denominator + weight;
            sums.pull = sums.pull + y.times(pull * scalar);
            if volume.kernel != VOLUME_SPH {
                sums.weights_pull = sums.weights_pull + y.times(pull);
            }
            if let Some(lighting) = lighting {
                for (sum, visible) in sums.visible.iter_mut().zip(lighting.visible[i]) {
                    *sum = *sum + weight * visible;
                }
            }
        });
        sums
    }

    /// Whether any point is in reach.
    pub fn reached(&self) -> bool {
        self.denominator > R::of(0.0)
    }

    /// Eq. 3, or the sum of its kernel.
    pub fn scalar(&self, volume: &VolumeInfo) -> R {
        if volume.kernel == VOLUME_SHEPARD && self.reached() {
            self.numerator / self.denominator
        } else {
            self.numerator
        }
    }

    /// The direction of the scalar's gradient.
    pub fn gradient(&self, volume: &VolumeInfo) -> V3<R> {
        if volume.kernel == VOLUME_SHEPARD {
            self.pull - self.weights_pull.times(self.scalar(volume))
        } else {
            self.pull
        }
    }

    /// What of the light at x goes towards the viewer, by the colour there.
    fn scattered(&self, volume: &VolumeInfo, x: V3<R>, d: V3<R>, lights: &[Light]) -> V3<R> {
        let zero = R::of(0.0);
        let gradient = self.gradient(volume);
        let square = gradient.dot(gradient);
        let reach = R::of_f32(volume.square_radius);
        let scale = if volume.kernel == VOLUME_SPH { R::of(1.0) / reach } else { reach };
        let most = (self.numerator * self.numerator) * scale;
        let flattest = R::of_f32(FLATTEST);
        let steep = volume.shading == VOLUME_GRADIENT && square > (flattest * flattest) * most;
        let normal = if steep { gradient.over(square.sqrt()) } else { V3::splat(zero) };
        let normal = if normal.dot(d) > zero { -normal } else { normal };
        let mut sum = V3::splat(zero);
        for (light, visible) in lights.iter().zip(self.visible) {
            let light = sample_light(light, x, [R::of(0.5); 2]);
            let share = if steep {
                normal.dot(light.towards).max(zero) * R::of(FRAC_1_PI)
            } else {
                R::of(0.25 * FRAC_1_PI)
            };
            sum = sum + light.arriving.times((visible / self.denominator) * share);
        }
        sum
    }
}

/// Whether anything may be seen from x.
pub(crate) fn may_be_seen<R: Real>(volume: &VolumeInfo, volumes: &Volumes, x: V3<R>) -> bool {
    let grid = Grid::<R>::from(&volume.grid);
    let off = (x - grid.origin).times(grid.inverse_edge);
    let inside = (0..3)
        .all(|axis| off.0[axis] >= R::of(0.0) && off.0[axis] < R::of_u32(grid.resolution[axis]));
    let cell = |at: [u32; 3]| &volumes.cells[(volume.first_cell + grid.cell_id(at)) as usize];
    inside && cell(grid.cell_of(x)).counts != CELL_NOTHING
}

/// Hands out each point near x: its place, its weight, its weight's gradient along y = p − x, and y.
fn for_each_near<R: Real>(
    volume: &VolumeInfo,
    volumes: &Volumes,
    x: V3<R>,
    mut visit: impl FnMut(usize, R, R, V3<R>),
) {
    let grid = Grid::<R>::from(&volume.grid);
    let cell =
        |at: [u32; 3]| &volumes.cells[volume.first_cell as usize + grid.cell_id(at) as usize..];
    let square_radius = R::of_f32(volume.square_radius);
    let inverse_width = R::of_f32(volume.inverse_width);
    let [low, high] = grid.cells_around(&Ball::exact(x, square_radius.sqrt()));
    for z in low[2]..=high[2] {
        for y in low[1]..=high[1] {
            let row = cell([low[0], y, z]);
            let end = row[(high[0] - low[0]) as usize + 1].first;
            for i in row[0].first as usize..end as usize {
                let to = V3::of_f32(volumes.points[i].position) - x;
                let square = to.dot(to);
                if volume.kernel == VOLUME_SPH {
                    let inverse_length = R::of_f32(volumes.inverse_lengths[i]);
                    let q = square.sqrt() * inverse_length;
                    visit(i, spline(q), spline_pull(q, inverse_length), to);
                } else if square <= square_radius {
                    let weight = (-square * inverse_width).exp_negative();
                    visit(i, weight, weight, to);
                }
            }
        }
    }
}

/// The scalar at x by Eq. 3, or the sum of its kernel; `None` out of every point's reach.
pub fn scalar_at<R: Real>(volume: &VolumeInfo, volumes: &Volumes, x: V3<R>) -> Option<R> {
    if !may_be_seen(volume, volumes, x) {
        return None;
    }
    let (mut numerator, mut denominator) = (R::of(0.0), R::of(0.0));
    for_each_near(volume, volumes, x, |i, weight, _, _| {
        numerator = numerator + weight * R::of_f32(volumes.points[i].scalar);
        denominator = denominator + weight;
    });
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
pub fn march<R: Real>(
    ray: &Ray<R>,
    end: R,
    media: &Media,
    volumes: &Volumes,
    objects: &[ObjectInfo],
    lighting: Option<Lighting<'_, R>>,
) -> March<R> {
    let (zero, one) = (R::of(0.0), R::of(1.0));
    let (mut from, mut to) = (R::of(NO_HIT), zero);
    let taking_part: Vec<&VolumeInfo> = volumes
        .infos
        .iter()
        .filter(|volume| volume.mode != VOLUME_ISOSURFACE)
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
    let medium = media.medium(objects);
    let step = R::of_f32(volumes.step);
    let span = to.min(end) - from;
    let samples = (-(-(span / step)).floor()).max(zero).min(R::of(MOST_SAMPLES)).to_u32();
    let mut march = March { color: V3::splat(zero), transmittance: one };
    let mut whole = [zero; 2]; // the greatest scalar or the integral of all, and the length in reach
    for place in 0..samples {
        let begin = R::of_u32(place) * step;
        let length = step.min(span - begin);
        let t = from + (begin + R::of(0.5) * length);
        let x = ray.origin + ray.direction.times(t);
        let (mut color, mut extinction) = (V3::splat(zero), zero);
        for volume in &taking_part {
            let Some(scalar) = scalar_at(volume, volumes, x) else { continue };
            if volume.mode == VOLUME_MAXIMUM {
                let greater = whole[1] <= zero || scalar > whole[0];
                whole = [if greater { scalar } else { whole[0] }, whole[1] + length];
            } else if volume.mode == VOLUME_AVERAGE {
                whole = [whole[0] + length * scalar, whole[1] + length];
            } else {
                let (mut c, sigma) = transfer(volume, volumes, scalar);
                if let Some(lighting) = lighting
                    && volume.shading != VOLUME_EMITS
                    && sigma > zero
                {
                    let sums = Sums::at(volume, volumes, x, Some(lighting));
                    c = c * sums.scattered(volume, x, ray.direction, lighting.lights);
                }
                color = color + c.times(sigma);
                extinction = extinction + sigma;
            }
        }
        if extinction > zero {
            let through = (-(extinction * length)).exp_negative();
            let color = color.over(extinction);
            let color =
                if medium.is_some() { color * transmittance(medium, t, objects) } else { color };
            let emitted = color.times(march.transmittance * (one - through));
            march.color = march.color + emitted;
            march.transmittance = march.transmittance * through;
        }
        if march.transmittance < R::of(FEWEST) {
            march.transmittance = zero;
            break;
        }
    }
    match volumes.infos.first() {
        Some(only) if [VOLUME_MAXIMUM, VOLUME_AVERAGE].contains(&only.mode) && whole[1] > zero => {
            shown(only, volumes, whole)
        }
        _ => march,
    }
}
