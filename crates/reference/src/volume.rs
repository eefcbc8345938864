//! Twin of `march` and `glsl/shared/volume.glsl`: a ray through volumes (\[T\] §6).

use crate::camera_rays::Ray;
use crate::grid::{Ball, Grid, within_box};
use crate::light::sample_light;
use crate::media::{Media, transmittance};
use crate::real::{NO_HIT, Real, V3};
use kernels::layout::{
    CELL_KINDS, CELL_NOTHING, Light, MARCH_PARTS, ObjectInfo, VOLUME_AVERAGE, VOLUME_EMISSION,
    VOLUME_EMITS, VOLUME_GRADIENT, VOLUME_INTEGRAL, VOLUME_ISOSURFACE, VOLUME_LIGHTS,
    VOLUME_MAXIMUM, VOLUME_SHEPARD, VOLUME_SPH, VolumeInfo, VolumeStop,
};
use plan::Volumes;
use std::f64::consts::FRAC_1_PI;
use std::ops::ControlFlow;

/// Optical depth through which nothing is seen, a transmittance of 1e-30.
const DEEPEST: f64 = 69.077_552_8;
/// The optical depth from there on.
const OPAQUE: f64 = NO_HIT;
/// Scalar.
const LARGEST: f64 = 1e38;
pub(crate) const MOST_SAMPLES: f64 = 16_777_215.0;
/// A gradient over a point's reach, by the scalar: less is rounding.
const FLATTEST: f32 = 1e-5;

/// What volumes do to a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct March<R> {
    /// Emitted towards its start.
    pub color: V3<R>,
    /// Optical depth.
    pub depth: R,
    /// What channels of volumes show (`March::along` in `glsl/shared/layout.glsl`).
    pub along: R,
}

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
    fn is_seen(&self) -> bool {
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
fn is_divided<R: Real>(volume: &VolumeInfo, volumes: &Volumes, [a, b]: [R; 2], x: V3<R>) -> bool {
    let grid = Grid::<R>::from(&volume.grid);
    let cell = volumes.cells[(volume.first_cell + grid.cell_id(grid.cell_of(x))) as usize];
    let margin = R::of_f32(f32::from_bits(cell.counts & !CELL_KINDS));
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

/// What may be seen from x's cell, one of `CELL_*`; `None` out of the grid.
fn cell_at<R: Real>(volume: &VolumeInfo, volumes: &Volumes, x: V3<R>) -> Option<u32> {
    let grid = Grid::<R>::from(&volume.grid);
    let off = (x - grid.origin).times(grid.inverse_edge);
    let inside = (0..3)
        .all(|axis| off.0[axis] >= R::of(0.0) && off.0[axis] < R::of_u32(grid.resolution[axis]));
    let cell = |at: [u32; 3]| volumes.cells[(volume.first_cell + grid.cell_id(at)) as usize].counts;
    inside.then(|| cell(grid.cell_of(x)))
}

/// Whether anything may be seen from x.
pub(crate) fn may_be_seen<R: Real>(volume: &VolumeInfo, volumes: &Volumes, x: V3<R>) -> bool {
    cell_at(volume, volumes, x).is_some_and(|counts| counts != CELL_NOTHING)
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

/// Kahan's summation.
#[derive(Debug, Clone, Copy)]
struct Sum<R> {
    sum: R,
    /// What rounding added to it.
    lost: R,
}

impl<R: Real> Sum<R> {
    fn zero() -> Self {
        Self { sum: R::of(0.0), lost: R::of(0.0) }
    }

    fn add(&mut self, term: R) {
        let more = term - self.lost;
        let total = self.sum + more;
        let left = (total - self.sum) - more;
        self.lost = if total.abs() < R::of(NO_HIT) { left } else { R::of(0.0) };
        self.sum = total;
    }
}

/// What a step ends with in a volume.
#[derive(Debug, Clone, Copy, PartialEq)]
enum End<R> {
    /// Nothing is seen from the cell, whatever the scalar.
    Unseen,
    /// No point is in reach.
    Unreached,
    /// The scalar, and the light.
    At(R, V3<R>),
}

/// A step with one end in reach is so for half of its way. At the border of particles a sum is 0.
struct Between<R> {
    share: R,
    from: R,
    to: R,
    light: V3<R>,
}

impl<R: Real> Between<R> {
    /// `None` where nothing counts.
    fn of(volume: &VolumeInfo, there: End<R>, here: End<R>) -> Option<Self> {
        let half = R::of(0.5);
        let border = |scalar| if volume.kernel == VOLUME_SPH { R::of(0.0) } else { scalar };
        match (there, here) {
            (End::At(from, light_there), End::At(to, light)) => {
                let light = (light_there + light).times(half);
                Some(Self { share: R::of(1.0), from, to, light })
            }
            (End::At(from, light), End::Unreached) => {
                Some(Self { share: half, from, to: border(from), light })
            }
            (End::Unreached, End::At(to, light)) => {
                Some(Self { share: half, from: border(to), to, light })
            }
            _ => None,
        }
    }
}

/// Whether one scalar stands for the whole way of a ray.
pub(crate) fn is_whole(volume: &VolumeInfo) -> bool {
    [VOLUME_MAXIMUM, VOLUME_AVERAGE, VOLUME_INTEGRAL].contains(&volume.mode)
}

/// What a ray shows of the scalar that stands for its whole way, from that or its integral and the length in reach: a
/// layer of one radius, all of it, or once.
fn shown<R: Real>(volume: &VolumeInfo, volumes: &Volumes, [scalar, way]: [R; 2]) -> March<R> {
    let zero = R::of(0.0);
    if way <= zero {
        return March { color: V3::splat(zero), depth: zero, along: zero };
    }
    let mean = volume.mode == VOLUME_AVERAGE;
    let scalar = if mean { scalar / way } else { scalar };
    let thickness = match volume.mode {
        VOLUME_AVERAGE => way,
        VOLUME_INTEGRAL => R::of(1.0),
        _ => R::of_f32(volume.square_radius).sqrt(),
    };
    let seen = mean_of(volume, volumes, scalar, scalar);
    let depth = seen.extinction * thickness;
    let color = (seen.scattering + seen.emission).times(thickness * depth.mean_transmittance());
    let depth = if depth > R::of(DEEPEST) { R::of(OPAQUE) } else { depth };
    March { color, depth, along: scalar }
}

/// Where a ray passes volumes, in steps.
struct Way<'a, R> {
    ray: &'a Ray<R>,
    taking_part: Vec<&'a VolumeInfo>,
    volumes: &'a Volumes,
    from: R,
    span: R,
    step: R,
    steps: u32,
    /// Whether it ends at the border of the volumes' boxes, where no point is in reach.
    leaves: bool,
}

/// An end of a step, and the step before it.
struct Place<R> {
    x: V3<R>,
    length: R,
    begin: R,
    outside: bool,
}

impl<'a, R: Real> Way<'a, R> {
    fn of(ray: &'a Ray<R>, end: R, media: &Media, volumes: &'a Volumes) -> Self {
        let zero = R::of(0.0);
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
        let step = R::of_f32(volumes.step);
        let to = to.min(end);
        let span = to - from;
        let steps = (-(-(span / step)).floor()).max(zero).min(R::of(MOST_SAMPLES)).to_u32();
        Self { ray, taking_part, volumes, from, span, step, steps, leaves: to < end }
    }

    /// The end of a step, or of a part of it; part 0 is the whole step.
    fn place(&self, place: u32, part: u32) -> Place<R> {
        let begin = R::of_u32(place.max(1) - 1) * self.step;
        let length = if place > 0 { self.step.min(self.span - begin) } else { R::of(0.0) };
        let (begin, length) = if part > 0 {
            let length = length * R::of(1.0 / f64::from(MARCH_PARTS));
            (begin + R::of_u32(part - 1) * length, length)
        } else {
            (begin, length)
        };
        let t = self.from + (begin + length);
        Place {
            x: self.ray.origin + self.ray.direction.times(t),
            length,
            begin: self.from + begin,
            outside: (place == 0 && self.from > R::of(0.0))
                || (place == self.steps && part == 0 && self.leaves),
        }
    }

    /// What all volumes show at a place.
    fn look_all(&self, place: &Place<R>, lighting: Option<Lighting<'_, R>>) -> Vec<End<R>> {
        self.taking_part.iter().map(|volume| self.look(volume, place, lighting)).collect()
    }

    /// Whether a step is divided: a scalar may pass a steep piece of its transfer function within it, or something is
    /// seen up to a border of what points reach.
    fn is_divided(&self, there: &[End<R>], here: &[End<R>], x: V3<R>) -> bool {
        if !self.volumes.any_steep() {
            return false;
        }
        let ends = there.iter().zip(here);
        self.taking_part.iter().zip(ends).any(|(volume, (there, here))| {
            let between = Between::of(volume, *there, *here);
            let Some(of) = between.filter(|_| volume.mode == VOLUME_EMISSION) else { return false };
            let border = of.share < R::of(1.0);
            let seen = || mean_of(volume, self.volumes, of.from, of.to).is_seen();
            border && seen() || is_divided(volume, self.volumes, [of.from, of.to], x)
        })
    }

    /// Hands out each step, or each part of one that is divided, with what each volume shows at both of its ends.
    fn walk(
        &self,
        lighting: Option<Lighting<'_, R>>,
        mut visit: impl FnMut(&Place<R>, &[End<R>], &[End<R>]) -> ControlFlow<()>,
    ) {
        let mut there = vec![End::Unseen; self.taking_part.len()];
        for at in 0..if self.steps > 0 { self.steps + 1 } else { 0 } {
            let place = self.place(at, 0);
            let here = self.look_all(&place, lighting);
            let mut done = ControlFlow::Continue(());
            if self.is_divided(&there, &here, place.x) {
                for part in 1..=MARCH_PARTS {
                    let place = self.place(at, part);
                    let next = match part == MARCH_PARTS {
                        true => here.clone(),
                        false => self.look_all(&place, lighting),
                    };
                    done = visit(&place, &there, &next);
                    if done.is_break() {
                        break;
                    }
                    there = next;
                }
            } else {
                done = visit(&place, &there, &here);
            }
            if done.is_break() {
                return;
            }
            there = here;
        }
    }

    fn look(
        &self,
        volume: &VolumeInfo,
        place: &Place<R>,
        lighting: Option<Lighting<'_, R>>,
    ) -> End<R> {
        let x = place.x;
        let cell = match cell_at(volume, self.volumes, x) {
            Some(cell) if !place.outside => cell,
            _ => return End::Unreached,
        };
        if cell == CELL_NOTHING {
            return End::Unseen;
        }
        let Some(scalar) = scalar_at(volume, self.volumes, x) else { return End::Unreached };
        let scalar = scalar.max(R::of(-LARGEST)).min(R::of(LARGEST));
        let light = match lighting {
            Some(lighting) if volume.shading != VOLUME_EMITS => {
                let sums = Sums::at(volume, self.volumes, x, Some(lighting));
                sums.scattered(volume, x, self.ray.direction, lighting.lights)
            }
            _ => V3::splat(R::of(1.0)),
        };
        End::At(scalar, light)
    }
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
    let zero = R::of(0.0);
    let way = Way::of(ray, end, media, volumes);
    let medium = media.medium(objects);
    let (mut color, mut depth) = ([Sum::zero(); 3], Sum::<R>::zero());
    let mut whole = [Sum::zero(); 2]; // the greatest scalar or the integral of all, and the length in reach
    let mut met = false;
    way.walk(lighting, |place, there, here| {
        let (mut step_color, mut step_extinction) = (V3::splat(zero), zero);
        for (volume, (&there, &here)) in way.taking_part.iter().zip(there.iter().zip(here)) {
            let between = Between::of(volume, there, here);
            if is_whole(volume) {
                let counted = between.as_ref().map_or(zero, |of| of.share * place.length);
                if volume.mode != VOLUME_MAXIMUM {
                    whole[0]
                        .add(between.map_or(zero, |of| counted * (R::of(0.5) * (of.from + of.to))));
                } else if let End::At(scalar, _) = here
                    && (!met || scalar > whole[0].sum)
                {
                    whole[0].sum = scalar;
                }
                met |= matches!(here, End::At(..));
                whole[1].add(counted);
            } else if let Some(of) = between {
                let mut seen = mean_of(volume, volumes, of.from, of.to);
                if lighting.is_some() {
                    seen.scattering = seen.scattering * of.light;
                }
                step_color = step_color + (seen.scattering + seen.emission).times(of.share);
                step_extinction = step_extinction + of.share * seen.extinction;
            }
        }
        let step_depth = step_extinction * place.length;
        if step_depth > zero || step_color.0.iter().any(|&channel| channel > zero) {
            let lengths = if medium.is_some() {
                let absorption =
                    V3::of_f32(objects[medium.unwrap_or_default() as usize].absorption);
                let depths = V3::splat(step_depth) + absorption.times(place.length);
                V3(depths.0.map(|depth| place.length * depth.mean_transmittance()))
                    * transmittance(medium, place.begin, objects)
            } else {
                V3::splat(place.length * step_depth.mean_transmittance())
            };
            let sent = (lengths * step_color).times((-depth.sum).exp_negative());
            for (sum, sent) in color.iter_mut().zip(sent.0) {
                sum.add(sent);
            }
        }
        if step_depth > zero {
            depth.add(step_depth);
        }
        if depth.sum > R::of(DEEPEST) {
            depth.sum = R::of(OPAQUE);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    });
    match volumes.infos.first() {
        Some(only) if is_whole(only) => shown(only, volumes, whole.map(|of| of.sum)),
        _ => March { color: V3(color.map(|of| of.sum)), depth: depth.sum, along: R::of(-1.0) },
    }
}

/// Where along the ray half of the light is lost that the volumes take on its way, which `depth` says: the first place
/// with the transmittance (1 + T)/2. `None` where they take none.
pub fn half_lost<R: Real>(
    ray: &Ray<R>,
    end: R,
    media: &Media,
    volumes: &Volumes,
    depth: R,
) -> Option<R> {
    let wanted = (R::of(0.5) * depth.absorptance()).depth_of_absorptance();
    if wanted <= R::of(0.0) {
        return None;
    }
    let way = Way::of(ray, end, media, volumes);
    let mut depth = Sum::<R>::zero();
    let mut lost = None;
    way.walk(None, |place, there, here| {
        let mut extinction = R::of(0.0);
        for (volume, (&there, &here)) in way.taking_part.iter().zip(there.iter().zip(here)) {
            if let Some(of) = Between::of(volume, there, here) {
                let seen = mean_of(volume, volumes, of.from, of.to);
                extinction = extinction + of.share * seen.extinction;
            }
        }
        let step_depth = extinction * place.length;
        let missing = wanted - depth.sum;
        if step_depth > R::of(0.0) && step_depth >= missing {
            let part = missing.max(R::of(0.0)) / step_depth;
            lost = Some(place.begin + place.length * part);
            return ControlFlow::Break(());
        }
        if step_depth > R::of(0.0) {
            depth.add(step_depth);
        }
        ControlFlow::Continue(())
    });
    lost
}
