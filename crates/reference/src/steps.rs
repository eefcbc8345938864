//! Twin of `glsl/shared/steps.glsl`: the steps of a ray through volumes, and what each volume has at their ends.

use crate::block::{Block, scalars};
use crate::camera_rays::Ray;
use crate::grid::within_box;
use crate::media::Media;
use crate::real::{NO_HIT, Real, V3};
use crate::volume::{Lighting, MOST_SAMPLES, Sums, cell_at, is_divided, look_by_size, mean_of};
use kernels::layout::{
    BLOCK_PLACES, CELL_NOTHING, MARCH_PARTS, STRIDE_STEPS, VOLUME_EMISSION, VOLUME_EMITS,
    VOLUME_ISOSURFACE, VOLUME_SPH, VolumeInfo,
};
use plan::Volumes;
use std::ops::ControlFlow;

/// Scalar.
const LARGEST: f64 = 1e38;

/// What a step ends with in a volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum End<R> {
    /// Nothing is seen from the cell, whatever the scalar.
    Unseen,
    /// No point is in reach.
    Unreached,
    /// The scalar, and the light.
    At(R, V3<R>),
}

/// A step with one end in reach is so for half of its way. At the border of particles a sum is 0.
pub(crate) struct Between<R> {
    pub(crate) share: R,
    pub(crate) from: R,
    pub(crate) to: R,
    pub(crate) light: V3<R>,
}

impl<R: Real> Between<R> {
    /// `None` where nothing counts.
    pub(crate) fn of(volume: &VolumeInfo, there: End<R>, here: End<R>) -> Option<Self> {
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

/// The scalars of a volume in a block of places, and which block that is.
#[derive(Debug, Clone, Copy)]
struct Known<R> {
    of: Option<[u32; 2]>,
    scalars: [Option<R>; BLOCK_PLACES as usize],
    /// Whether the volume is seen from the stretch of steps.
    is_seen: bool,
}

/// How long steps are, as powers of two of the shortest: those from a place on, and the one before it.
#[derive(Debug, Clone, Copy, Default)]
struct Stride {
    level: u32,
    before: u32,
}

/// Which end of a step.
#[derive(Debug, Clone, Copy)]
struct At {
    place: u32,
    /// Of the step before the place; 0 is the whole step.
    part: u32,
    stride: Stride,
}

/// Where a ray passes volumes, in steps. Places count the shortest of these.
pub(crate) struct Way<'a, R> {
    ray: &'a Ray<R>,
    pub(crate) taking_part: Vec<&'a VolumeInfo>,
    volumes: &'a Volumes,
    from: R,
    span: R,
    step: R,
    steps: u32,
    /// Whether it ends at the border of the volumes' boxes, where no point is in reach.
    leaves: bool,
}

/// An end of a step, and the step before it.
pub(crate) struct Place<R> {
    x: V3<R>,
    pub(crate) length: R,
    pub(crate) begin: R,
    /// Where the whole step begins.
    whole: R,
    outside: bool,
}

/// The longest step of which a stretch may begin at a place.
pub(crate) fn longest_at(place: u32) -> u32 {
    if place > 0 { place.trailing_zeros() - STRIDE_STEPS.ilog2() } else { 31 }
}

/// Whether a stretch of steps of a level may begin at a place.
pub(crate) fn begins_stretch(level: u32, place: u32) -> bool {
    place & ((STRIDE_STEPS << level) - 1) == 0
}

impl<'a, R: Real> Way<'a, R> {
    pub(crate) fn of(ray: &'a Ray<R>, end: R, media: &Media, volumes: &'a Volumes) -> Self {
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

    /// The end of a step, or of a part of it.
    fn place(&self, At { place, part, stride }: At) -> Place<R> {
        let from = ((place.max(1) - 1) >> stride.before) << stride.before;
        let whole = R::of_u32(from) * self.step;
        let begin = whole;
        let longest = self.step * R::of_u32(1 << stride.before);
        let length = if place > 0 { longest.min(self.span - begin) } else { R::of(0.0) };
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

    /// Where a stretch of steps begins: their length, the longest that all volumes allow and of which a stretch may begin at
    /// that place, and which volumes are seen from them.
    fn settled(&self, stride: Stride, at: u32, x: V3<R>, known: &mut [Known<R>]) -> Stride {
        if self.volumes.sizes.is_empty() || !begins_stretch(stride.level, at) {
            return stride;
        }
        let mut longest = longest_at(at);
        for (volume, known) in self.taking_part.iter().zip(known) {
            let look = look_by_size(volume, self.volumes, x, stride.before);
            known.is_seen = look.kind != CELL_NOTHING;
            longest = longest.min(look.level);
        }
        Stride { level: longest, ..stride }
    }

    /// The place after one; after the last, one more.
    fn after(&self, at: u32, stride: Stride) -> u32 {
        if at >= self.steps { self.steps + 1 } else { (at + (1 << stride.level)).min(self.steps) }
    }

    /// What all volumes show at a place, the end of a step or of a part of it.
    fn look_all(
        &self,
        at: At,
        known: &mut [Known<R>],
        lighting: Option<Lighting<'_, R>>,
    ) -> Vec<End<R>> {
        let place = self.place(at);
        let each = self.taking_part.iter().zip(known);
        each.map(|(volume, known)| self.look(volume, (at, &place), known, lighting)).collect()
    }

    /// The block of places that a place is in, and its number in it. The last step is of a length of its own, and a block
    /// by itself.
    fn block(&self, volume: &VolumeInfo, at: At) -> (u32, usize, Block<R>) {
        let of = self.place(at);
        let At { place, part, stride } = at;
        let (number, level) = if part > 0 { (part - 1, 0) } else { (place, stride.level) };
        let is_single = part == 0 && place == self.steps;
        let first =
            if is_single { number } else { (number >> level & !(volume.block - 1)) << level };
        let until = if part > 0 { MARCH_PARTS - 1 } else { self.steps };
        let last = (first + (volume.block << level)).min(until) - 1;
        let count = if is_single { 1 } else { ((last - first) >> level) + 1 };
        let count_by = if part > 0 { of.length } else { self.step };
        let step = count_by * R::of_u32(1 << level);
        let begin = if is_single {
            of.begin + of.length
        } else if part > 0 {
            of.whole + R::of_u32(first + 1) * step
        } else {
            self.from + R::of_u32(first) * count_by
        };
        let direction = self.ray.direction;
        let first_place = self.ray.origin + direction.times(begin);
        let level_of_step = if part > 0 { stride.before } else { stride.level };
        let block = Block { first: first_place, direction, step, count, level: level_of_step };
        (first, ((number - first) >> level) as usize, block)
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
    pub(crate) fn walk(
        &self,
        lighting: Option<Lighting<'_, R>>,
        mut visit: impl FnMut(&Place<R>, &[End<R>], &[End<R>]) -> ControlFlow<()>,
    ) {
        let mut there = vec![End::Unseen; self.taking_part.len()];
        let mut known =
            vec![
                Known { of: None, scalars: [None; BLOCK_PLACES as usize], is_seen: false };
                there.len()
            ];
        let (mut stride, mut next) = (Stride::default(), 0);
        while self.steps > 0 && next <= self.steps {
            let at = At { place: next, part: 0, stride };
            let place = self.place(at);
            stride = self.settled(stride, next, place.x, &mut known);
            let at = At { stride, ..at };
            let here = self.look_all(at, &mut known, lighting);
            let mut done = ControlFlow::Continue(());
            if self.is_divided(&there, &here, place.x) {
                for part in 1..=MARCH_PARTS {
                    let at = At { part, ..at };
                    let place = self.place(at);
                    let next = match part == MARCH_PARTS {
                        true => here.clone(),
                        false => self.look_all(at, &mut known, lighting),
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
            stride.before = stride.level;
            next = self.after(next, stride);
        }
    }

    fn look(
        &self,
        volume: &VolumeInfo,
        (at, place): (At, &Place<R>),
        known: &mut Known<R>,
        lighting: Option<Lighting<'_, R>>,
    ) -> End<R> {
        let x = place.x;
        let (is_inside, is_seen) = if self.volumes.sizes.is_empty() {
            let cell = cell_at(volume, self.volumes, x);
            (cell.is_some(), cell.is_some_and(|cell| cell != CELL_NOTHING))
        } else {
            (true, known.is_seen)
        };
        if !is_inside || place.outside {
            return End::Unreached;
        }
        if !is_seen {
            return End::Unseen;
        }
        if let Some(lighting) = lighting {
            let level = if at.part > 0 { at.stride.before } else { at.stride.level };
            return self.look_at_light(volume, (x, level), lighting);
        }
        let (first, k, block) = self.block(volume, at);
        let of = Some([first, at.part.min(1) * (at.place + 1)]);
        if known.of != of {
            (known.of, known.scalars) = (of, scalars(volume, self.volumes, &block));
        }
        known.scalars[k].map_or(End::Unreached, |scalar| End::At(scalar, V3::splat(R::of(1.0))))
    }

    /// The scalar and the light at a place, where steps are of a level, of its own points.
    fn look_at_light(
        &self,
        volume: &VolumeInfo,
        at: (V3<R>, u32),
        lighting: Lighting<'_, R>,
    ) -> End<R> {
        let sums = Sums::at(volume, self.volumes, at, Some(lighting));
        if !sums.reached() {
            return End::Unreached;
        }
        let scalar = sums.scalar(volume).max(R::of(-LARGEST)).min(R::of(LARGEST));
        if volume.shading == VOLUME_EMITS {
            return End::At(scalar, V3::splat(R::of(1.0)));
        }
        End::At(scalar, sums.scattered(volume, at.0, self.ray.direction, lighting.lights))
    }
}
