//! Twin of `glsl/shared/volume.glsl`: a scalar between points, and what a transfer function makes of it (\[T\] §6).

use crate::grid::{Ball, Grid};
use crate::light::sample_light;
use crate::material::cloud::phase;
use crate::real::{Real, V3};
use kernels::layout::{
    CELL_FINER, CELL_KINDS, CELL_LOOK, CELL_MARKS, CELL_NOTHING, Light, STRIDE_STEPS,
    VOLUME_GRADIENT, VOLUME_LIGHTS, VOLUME_SHEPARD, VOLUME_SPH, VolumeInfo, VolumeStop,
};
use plan::Volumes;
use std::f64::consts::FRAC_1_PI;

pub(crate) const MOST_SAMPLES: f64 = 16_777_215.0;
/// A gradient over a point's reach, by the scalar: less is rounding.
const FLATTEST: f32 = 1e-5;

/// Means of a transfer function: what is sent along the ray per length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown<R> {
    /// Colour by extinction.
    pub scattering: V3<R>,
    /// σ
    pub extinction: R,
    /// Radiance per length.
    pub emission: V3<R>,
}

impl<R: Real> Shown<R> {
    /// Two of them, each number by number.
    fn zip(self, other: Self, f: impl Fn(R, R) -> R) -> Self {
        Self {
            scattering: self.scattering.zip(other.scattering, &f),
            extinction: f(self.extinction, other.extinction),
            emission: self.emission.zip(other.emission, &f),
        }
    }

    fn times(self, s: R) -> Self {
        self.zip(self, |x, _| s * x)
    }

    /// Whether it is more than nothing.
    pub(crate) fn is_seen(&self) -> bool {
        self.extinction > R::of(0.0) || self.emission.0.iter().any(|&of| of > R::of(0.0))
    }

    /// One of the integrals from the first stop on.
    fn integral(of: [f32; 4], emission: [f32; 4]) -> Self {
        let [x, y, z, extinction] = of.map(R::of_f32);
        let [r, g, b, _] = emission.map(R::of_f32);
        Self { scattering: V3([x, y, z]), extinction, emission: V3([r, g, b]) }
    }
}

/// The mean from one scalar to another, neither of them beyond the stops of a piece. Colour, extinction and emission
/// are linear there; constant beyond the outer stops.
fn mean_within<R: Real>(stops: &[VolumeStop], piece: usize, a: R, b: R) -> Shown<R> {
    let (low, high) = (&stops[piece.max(1) - 1], &stops[piece.min(stops.len() - 1)]);
    let (zero, one) = (R::of(0.0), R::of(1.0));
    let span = R::of_f32(high.value) - R::of_f32(low.value);
    let part = |at: R| {
        if span > zero { ((at - R::of_f32(low.value)) / span).max(zero).min(one) } else { zero }
    };
    let (from, to) = (part(a), part(b));
    let (middle, width) = (R::of(0.5) * (from + to), to - from);
    let color_low = V3::of_f32(low.color);
    let color_change = V3::of_f32(high.color) - color_low;
    let extinction_low = R::of_f32(low.extinction);
    let extinction_change = R::of_f32(high.extinction) - extinction_low;
    let color = color_low + color_change.times(middle);
    let extinction = extinction_low + middle * extinction_change;
    let bend = (width * width) * R::of(1.0 / 12.0);
    let emission_low = V3::of_f32(low.emission);
    Shown {
        scattering: color.times(extinction) + color_change.times(bend * extinction_change),
        extinction,
        emission: emission_low + (V3::of_f32(high.emission) - emission_low).times(middle),
    }
}

/// How many stops at or below a scalar bound a steep piece.
fn steep_stops<R: Real>(stops: &[VolumeStop], scalar: R) -> f32 {
    let piece = stops.partition_point(|stop| R::of_f32(stop.value) <= scalar);
    if piece > 0 { stops[piece - 1].emission_integral[3] } else { 0.0 }
}

/// Whether a step between two scalars that ends at x is divided.
pub(crate) fn is_divided<R: Real>(
    volume: &VolumeInfo,
    volumes: &Volumes,
    [a, b]: [R; 2],
    x: V3<R>,
) -> bool {
    let grid = Grid::<R>::from(&volume.grid);
    let cell = volumes.cells[(volume.first_cell + grid.cell_id(grid.cell_of(x))) as usize];
    let margin = R::of_f32(f32::from_bits(cell.counts & !CELL_MARKS));
    let stops = stops_of(volume, volumes);
    steep_stops(stops, a.min(b) - margin) < steep_stops(stops, a.max(b) + margin)
}

/// The stops of a volume's transfer function.
fn stops_of<'a>(volume: &VolumeInfo, volumes: &'a Volumes) -> &'a [VolumeStop] {
    let first = volume.first_stop as usize;
    &volumes.stops[first..first + volume.stop_count as usize]
}

/// The mean of the transfer function over all scalars from one to another: pre-integration (Engel et al. 2001), exact
/// between stops.
pub fn mean_of<R: Real>(volume: &VolumeInfo, volumes: &Volumes, a: R, b: R) -> Shown<R> {
    let stops = stops_of(volume, volumes);
    let (low, high) = (a.min(b), a.max(b));
    let piece = |scalar: R| stops.partition_point(|stop| R::of_f32(stop.value) <= scalar);
    let (lower, upper) = (piece(low), piece(high));
    if lower == upper {
        return mean_within(stops, lower, low, high);
    }
    let (first, last) = (&stops[lower], &stops[upper - 1]);
    let (end, begin) = (R::of_f32(first.value), R::of_f32(last.value));
    let inverse = R::of(1.0) / (high - low);
    let parts = (mean_within(stops, lower, low, end).times(end - low))
        .zip(mean_within(stops, upper, begin, high).times(high - begin), |x, y| x + y);
    let between = |of: fn(&VolumeStop) -> Shown<R>| of(last).zip(of(first), |x, y| x - y);
    let integral = between(|s| Shown::integral(s.scattering_integral, s.emission_integral))
        .zip(between(|s| Shown::integral(s.scattering_rest, s.emission_rest)), |x, y| x + y);
    parts.zip(integral, |x, y| x + y).times(inverse)
}

/// Monaghan's cubic spline times π h³, at q = d/h: 1 − 3/2 q² + 3/4 q³ below 1, (2 − q)³/4 below 2.
pub(crate) fn spline<R: Real>(q: R) -> R {
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
    /// Over all points in reach of a place, where steps are of a level; visibility too where there is lighting.
    pub fn at(
        volume: &VolumeInfo,
        volumes: &Volumes,
        at: (V3<R>, u32),
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
        for_each_near(volume, volumes, at, |i, weight, pull, y| {
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
    pub(crate) fn scattered(
        &self,
        volume: &VolumeInfo,
        x: V3<R>,
        d: V3<R>,
        lights: &[Light],
    ) -> V3<R> {
        let zero = R::of(0.0);
        let gradient = self.gradient(volume);
        let square = gradient.dot(gradient);
        let reach = R::of_f32(volume.square_radius);
        let per_length = volume.kernel == VOLUME_SPH || has_own_reaches(volume);
        let scale = if per_length { R::of(1.0) / reach } else { reach };
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
            } else if volume.iso != 0.0 {
                phase(R::of_f32(volume.iso), d.dot(light.towards))
            } else {
                R::of(0.25 * FRAC_1_PI)
            };
            sum = sum + light.arriving.times((visible / self.denominator) * share);
        }
        sum
    }
}

/// Whether each point has a reach of its own.
pub(crate) fn has_own_reaches(volume: &VolumeInfo) -> bool {
    volume.inverse_width == 0.0
}

/// The grids with points that may be in reach where steps are of a level: all but those of shorter steps.
pub(crate) fn grids_at<'a>(
    volume: &'a VolumeInfo,
    volumes: &'a Volumes,
    level: u32,
) -> &'a [VolumeInfo] {
    let all = volumes.grids_of(volume);
    &all[..all.partition_point(|of| of.level >= level).max(1)]
}

/// What a volume's grids say of a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Look {
    /// One of `CELL_*`, of all places of a stretch of steps from there.
    pub(crate) kind: u32,
    /// Of steps among the smallest points around.
    pub(crate) level: u32,
}

/// Where smaller points may be near, the finer grid knows more. The marks of a grid hold for a stretch of its steps; where the
/// step before the place is longer than that, it knows only of levels.
pub(crate) fn look_by_size<R: Real>(
    volume: &VolumeInfo,
    volumes: &Volumes,
    x: V3<R>,
    before: u32,
) -> Look {
    // Out of one grid, what is seen is not known.
    let nothing = if volume.size_count > 0 { CELL_NOTHING } else { CELL_LOOK };
    let mut look = Look { kind: nothing, level: volume.level };
    let mut holds = true;
    for (size, of) in volumes.grids_of(volume).iter().enumerate() {
        let Some(cell) = cell_at(of, volumes, x) else { break };
        holds &= size == 0 || of.level + STRIDE_STEPS.ilog2() >= before;
        if holds {
            look.kind = cell & CELL_KINDS;
        }
        look.level = of.level;
        if cell & CELL_FINER == 0 {
            break;
        }
    }
    look
}

/// The marks of x's cell; `None` out of the grid.
pub(crate) fn cell_at<R: Real>(volume: &VolumeInfo, volumes: &Volumes, x: V3<R>) -> Option<u32> {
    let grid = Grid::<R>::from(&volume.grid);
    let off = (x - grid.origin).times(grid.inverse_edge);
    let inside = (0..3)
        .all(|axis| off.0[axis] >= R::of(0.0) && off.0[axis] < R::of_u32(grid.resolution[axis]));
    let cell = |at: [u32; 3]| volumes.cells[(volume.first_cell + grid.cell_id(at)) as usize].counts;
    inside.then(|| cell(grid.cell_of(x)))
}

/// Whether anything may be seen from x.
pub(crate) fn may_be_seen<R: Real>(volume: &VolumeInfo, volumes: &Volumes, x: V3<R>) -> bool {
    cell_at(volume, volumes, x).is_some_and(|counts| counts & CELL_KINDS != CELL_NOTHING)
}

/// Hands out each point near x, where steps are of a level: its place, its weight, its weight's gradient along y = p − x, and y.
fn for_each_near<R: Real>(
    volume: &VolumeInfo,
    volumes: &Volumes,
    (x, level): (V3<R>, u32),
    mut visit: impl FnMut(usize, R, R, V3<R>),
) {
    let own = has_own_reaches(volume);
    for of in grids_at(volume, volumes, level) {
        let grid = Grid::<R>::from(&of.grid);
        let cell =
            |at: [u32; 3]| &volumes.cells[of.first_cell as usize + grid.cell_id(at) as usize..];
        let [low, high] = grid.cells_around(&Ball::exact(x, R::of_f32(of.square_radius).sqrt()));
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                let row = cell([low[0], y, z]);
                let end = row[(high[0] - low[0]) as usize + 1].first;
                for i in row[0].first as usize..end as usize {
                    let to = V3::of_f32(volumes.points[i].position) - x;
                    let square = to.dot(to);
                    let inverse_length =
                        R::of_f32(volumes.inverse_lengths.get(i).copied().unwrap_or(0.0));
                    if volume.kernel == VOLUME_SPH {
                        let q = square.sqrt() * inverse_length;
                        visit(i, spline(q), spline_pull(q, inverse_length), to);
                    } else if own {
                        let inverse_square = inverse_length * inverse_length;
                        if square <= R::of(1.0) / inverse_square {
                            let weight = (-square * (R::of(2.0) * inverse_square)).exp_negative();
                            visit(i, weight, weight * inverse_square, to);
                        }
                    } else if square <= R::of_f32(volume.square_radius) {
                        let weight = (-square * R::of_f32(volume.inverse_width)).exp_negative();
                        visit(i, weight, weight, to);
                    }
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
    for_each_near(volume, volumes, (x, 0), |i, weight, _, _| {
        numerator = numerator + weight * R::of_f32(volumes.points[i].scalar);
        denominator = denominator + weight;
    });
    let divisor = if volume.kernel == VOLUME_SHEPARD { denominator } else { R::of(1.0) };
    (denominator > R::of(0.0)).then(|| numerator / divisor)
}
