//! Twin of `march`: rays through volumes, sample after sample (\[T\] §6).

use crate::block::{Block, scalars};
use crate::camera_rays::Ray;
use crate::grid::within_box;
use crate::media::{Media, transmittance};
use crate::real::{NO_HIT, Real, V3};
use crate::volume::{Lighting, MOST_SAMPLES, Shown, Sums, cell_at, is_divided, mean_of, scalar_at};
use kernels::layout::{
    BLOCK_PLACES, CELL_NOTHING, MARCH_PARTS, ObjectInfo, VOLUME_AVERAGE, VOLUME_EMISSION,
    VOLUME_EMITS, VOLUME_INTEGRAL, VOLUME_ISOSURFACE, VOLUME_MAXIMUM, VOLUME_SPH, VolumeInfo,
};
use plan::Volumes;
use std::ops::ControlFlow;

/// Optical depth through which nothing is seen, a transmittance of 1e-30.
const DEEPEST: f64 = 69.077_552_8;
/// The optical depth from there on.
const OPAQUE: f64 = NO_HIT;
/// Scalar.
const LARGEST: f64 = 1e38;

/// What volumes do to a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct March<R> {
    /// Where one scatters it, if one does.
    pub scattered: Option<Scattered<R>>,
    /// Emitted towards its start.
    pub color: V3<R>,
    /// Optical depth.
    pub depth: R,
    /// What channels of volumes show (`March::along` in `glsl/stages/volume.glsl`).
    pub along: R,
}

/// A place where a volume scatters a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scattered<R> {
    /// Along the ray.
    pub t: R,
    /// The share of light that goes on.
    pub color: V3<R>,
    /// The slot that stands for the volume.
    pub slot: u32,
}

/// What of light counts along a ray.
#[derive(Debug, Clone, Copy)]
pub enum Along<'a, R> {
    /// What volumes emit.
    Emitted,
    /// That, and what reaches the points of volumes that are lit.
    OfLamps(Lighting<'a, R>),
    /// That, and where the optical depth of volumes that are lit is this, they scatter the ray.
    Scattered(R),
}

impl<'a, R: Real> Along<'a, R> {
    pub(crate) fn lamps(self) -> Option<Lighting<'a, R>> {
        match self {
            Self::OfLamps(lighting) => Some(lighting),
            _ => None,
        }
    }
}

/// Scattering volumes of a step.
struct Scatter<R> {
    color: V3<R>,
    extinction: R,
    /// The most of one of them, and the slot that stands for it.
    most: R,
    slot: u32,
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
        return March { scattered: None, color: V3::splat(zero), depth: zero, along: zero };
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
    March { scattered: None, color, depth, along: scalar }
}

impl<R: Real> Scatter<R> {
    fn add(&mut self, volume: &VolumeInfo, of: &Between<R>, seen: &Shown<R>) {
        let own = of.share * seen.extinction;
        if own > self.most {
            (self.most, self.slot) = (own, volume.refracts);
        }
        self.color = self.color + seen.scattering.times(of.share);
        self.extinction = self.extinction + own;
    }
}

/// The scalars of a volume in a block of places, and which block that is.
#[derive(Debug, Clone, Copy)]
struct Known<R> {
    of: Option<[u32; 2]>,
    scalars: [Option<R>; BLOCK_PLACES as usize],
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
    /// Where the whole step begins.
    whole: R,
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
        let whole = R::of_u32(place.max(1) - 1) * self.step;
        let begin = whole;
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
            whole: self.from + whole,
            outside: (place == 0 && self.from > R::of(0.0))
                || (place == self.steps && part == 0 && self.leaves),
        }
    }

    /// What all volumes show at a place, the end of a step or of a part of it.
    fn look_all(
        &self,
        at: [u32; 2],
        known: &mut [Known<R>],
        lighting: Option<Lighting<'_, R>>,
    ) -> Vec<End<R>> {
        let place = self.place(at[0], at[1]);
        let each = self.taking_part.iter().zip(known);
        each.map(|(volume, known)| self.look(volume, (at, &place), known, lighting)).collect()
    }

    /// The block of places that a place is in, and its number in it. The last step is of a length of its own, and a block
    /// by itself.
    fn block(&self, volume: &VolumeInfo, [place, part]: [u32; 2]) -> (u32, usize, Block<R>) {
        let of = self.place(place, part);
        let number = if part > 0 { part - 1 } else { place };
        let is_single = part == 0 && place == self.steps;
        let first = if is_single { number } else { number & !(volume.block - 1) };
        let end = if part > 0 { MARCH_PARTS - 1 } else { self.steps };
        let count = if is_single { 1 } else { volume.block.min(end - first) };
        let step = if part > 0 { of.length } else { self.step };
        let begin = if is_single {
            of.begin + of.length
        } else if part > 0 {
            of.whole + R::of_u32(first + 1) * step
        } else {
            self.from + R::of_u32(first) * step
        };
        let direction = self.ray.direction;
        let first_place = self.ray.origin + direction.times(begin);
        let block = Block { first: first_place, direction, step, count };
        (first, (number - first) as usize, block)
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
        let mut known =
            vec![Known { of: None, scalars: [None; BLOCK_PLACES as usize] }; there.len()];
        for at in 0..if self.steps > 0 { self.steps + 1 } else { 0 } {
            let place = self.place(at, 0);
            let here = self.look_all([at, 0], &mut known, lighting);
            let mut done = ControlFlow::Continue(());
            if self.is_divided(&there, &here, place.x) {
                for part in 1..=MARCH_PARTS {
                    let place = self.place(at, part);
                    let next = match part == MARCH_PARTS {
                        true => here.clone(),
                        false => self.look_all([at, part], &mut known, lighting),
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
        (at, place): ([u32; 2], &Place<R>),
        known: &mut Known<R>,
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
        if let Some(lighting) = lighting {
            return self.look_at_light(volume, x, lighting);
        }
        let (first, k, block) = self.block(volume, at);
        let of = Some([first, at[1].min(1) * (at[0] + 1)]);
        if known.of != of {
            *known = Known { of, scalars: scalars(volume, self.volumes, &block) };
        }
        known.scalars[k].map_or(End::Unreached, |scalar| End::At(scalar, V3::splat(R::of(1.0))))
    }

    /// The scalar and the light at a place, of its own points.
    fn look_at_light(&self, volume: &VolumeInfo, x: V3<R>, lighting: Lighting<'_, R>) -> End<R> {
        let Some(scalar) = scalar_at(volume, self.volumes, x) else { return End::Unreached };
        let scalar = scalar.max(R::of(-LARGEST)).min(R::of(LARGEST));
        if volume.shading == VOLUME_EMITS {
            return End::At(scalar, V3::splat(R::of(1.0)));
        }
        let sums = Sums::at(volume, self.volumes, x, Some(lighting));
        End::At(scalar, sums.scattered(volume, x, self.ray.direction, lighting.lights))
    }
}

/// Follows a ray that ends at `end` through all volumes. `media` are those it is inside.
pub fn march<R: Real>(
    ray: &Ray<R>,
    end: R,
    media: &Media,
    volumes: &Volumes,
    objects: &[ObjectInfo],
    light: Along<'_, R>,
) -> March<R> {
    let lighting = light.lamps();
    let zero = R::of(0.0);
    let way = Way::of(ray, end, media, volumes);
    let medium = media.medium(objects);
    let (mut color, mut depth) = ([Sum::zero(); 3], Sum::<R>::zero());
    let mut whole = [Sum::zero(); 2]; // the greatest scalar or the integral of all, and the length in reach
    let mut met = false;
    let mut scatter_depth = Sum::<R>::zero();
    let mut scattered = None;
    way.walk(lighting, |place, there, here| {
        let (mut step_color, mut step_extinction) = (V3::splat(zero), zero);
        let mut scatter = Scatter { color: V3::splat(zero), extinction: zero, most: zero, slot: 0 };
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
                if matches!(light, Along::Scattered(_)) && volume.shading != VOLUME_EMITS {
                    scatter.add(volume, &of, &seen);
                    (seen.scattering, seen.extinction) = (V3::splat(zero), zero);
                }
                step_color = step_color + (seen.scattering + seen.emission).times(of.share);
                step_extinction = step_extinction + of.share * seen.extinction;
            }
        }
        let mut length = place.length;
        if let Along::Scattered(chosen) = light {
            let depth = scatter.extinction * length;
            let short_of = chosen - scatter_depth.sum;
            if depth > zero && depth >= short_of {
                length = length * (short_of.max(zero) / depth);
                let color =
                    scatter.color.over(scatter.extinction).zip(V3::splat(R::of(1.0)), R::min);
                scattered = Some(Scattered { t: place.begin + length, color, slot: scatter.slot });
            } else if depth > zero {
                scatter_depth.add(depth);
            }
        }
        let step_depth = step_extinction * length;
        if step_depth > zero || step_color.0.iter().any(|&channel| channel > zero) {
            let lengths = if medium.is_some() {
                let absorption =
                    V3::of_f32(objects[medium.unwrap_or_default() as usize].absorption);
                let depths = V3::splat(step_depth) + absorption.times(length);
                V3(depths.0.map(|depth| length * depth.mean_transmittance()))
                    * transmittance(medium, place.begin, objects)
            } else {
                V3::splat(length * step_depth.mean_transmittance())
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
        if scattered.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    match volumes.infos.first() {
        Some(only) if is_whole(only) => shown(only, volumes, whole.map(|of| of.sum)),
        _ => {
            let color = V3(color.map(|of| of.sum));
            March { scattered, color, depth: depth.sum, along: R::of(-1.0) }
        }
    }
}

/// Where along the ray half of the light is lost that the volumes take on its way, which `depth` says: the first place
/// with the transmittance (1 + T)/2. `None` where they take none.
pub fn half_lost<R: Real>(
    ray: &Ray<R>,
    end: R,
    media: &Media,
    volumes: &Volumes,
    lighting: Option<Lighting<'_, R>>,
    depth: R,
) -> Option<R> {
    let wanted = (R::of(0.5) * depth.absorptance()).depth_of_absorptance();
    if wanted <= R::of(0.0) {
        return None;
    }
    let way = Way::of(ray, end, media, volumes);
    let mut depth = Sum::<R>::zero();
    let mut lost = None;
    way.walk(lighting, |place, there, here| {
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
