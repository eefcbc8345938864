//! Twin of `isosurface`: where a ray first meets a surface on which the scalar of a volume is one number.
//!
//! The kernel passes over samples whose side their cell tells, unless that is where the side changes. The
//! twin looks at all of them.

use crate::block::{Block, scalars};
use crate::camera_rays::Ray;
use crate::grid::within_box;
use crate::media::Media;
use crate::real::{Real, V3};
use crate::steps::{begins_stretch, longest_at};
use crate::surface_hit::Hit;
use crate::volume::{MOST_SAMPLES, Sums, look_by_size};
use kernels::layout::{BLOCK_PLACES, VOLUME_ISOSURFACE, VOLUME_SHEPARD, VolumeInfo};
use plan::Volumes;

/// Turns that close in, at most.
const TURNS: u32 = 4;
/// The same where a block has fewer than `BLOCK_PLACES`.
const TURNS_OF_FEW: u32 = 8;
/// Of the way between the ends, from one place of a narrow turn to the next.
const NARROWER: f64 = 1.0 / 64.0;
/// The value of a place on the surface: 0 is not known.
const ON_IT: f32 = -1e-20;

/// On which side of an isosurface a place is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Below,
    Above,
}

/// The scalar at a place less that of the isosurface, and the side; a mean of no points has none.
#[derive(Debug, Clone, Copy)]
struct Sample<R> {
    t: R,
    value: R,
    side: Option<Side>,
}

/// A ray and a volume that it may meet.
struct Search<'a, R> {
    ray: &'a Ray<R>,
    volume: &'a VolumeInfo,
    volumes: &'a Volumes,
}

impl<R: Real> Search<'_, R> {
    fn place(&self, t: R) -> V3<R> {
        self.ray.origin + self.ray.direction.times(t)
    }

    /// The samples at places of a block from `begin` along the ray on, each `apart` from the next, where steps are of a level.
    fn block(
        &self,
        begin: R,
        apart: R,
        (count, level): (u32, u32),
    ) -> [Sample<R>; BLOCK_PLACES as usize] {
        let (first, direction) = (self.place(begin), self.ray.direction);
        let block = Block { first, direction, step: apart, count, level };
        let scalars = scalars(self.volume, self.volumes, &block);
        std::array::from_fn(|k| {
            let t = begin + R::of_u32(k as u32) * apart;
            let known = self.volume.kernel != VOLUME_SHEPARD || scalars[k].is_some();
            let exact = scalars[k].unwrap_or(R::of(0.0)) - R::of_f32(self.volume.iso);
            let value = if exact == R::of(0.0) { R::of_f32(ON_IT) } else { exact };
            let side = if value > R::of(0.0) { Side::Above } else { Side::Below };
            Sample { t, value: if known { value } else { R::of(0.0) }, side: known.then_some(side) }
        })
    }

    /// The first two samples on different sides, of those between the ray's start and `end`. The ray is on
    /// the side `start` at first, if that is known.
    fn bracket(&self, end: R, start: Option<Side>) -> Option<[Sample<R>; 2]> {
        let zero = R::of(0.0);
        let [low, high] = [self.volume.grid.origin, self.volume.high].map(V3::of_f32);
        let [enter, leave] = within_box(low, high, self.ray.origin, self.ray.direction);
        let leave = leave.min(end);
        if enter >= leave {
            return None;
        }
        let step = R::of_f32(self.volumes.step);
        let steps = (-(R::of(0.5) - (leave - enter) / step).floor()).max(zero);
        let samples = steps.min(R::of(MOST_SAMPLES)).to_u32() + 1;
        let by_size = !self.volumes.sizes.is_empty();
        let at = |place: u32, level: u32| {
            let half = R::of(0.5) * R::of_u32(1 << level);
            (enter + (R::of_u32(place) + half) * step).min(leave)
        };
        let is_last = |place: u32, level: u32| match by_size {
            true => at(place, level) >= leave,
            false => place + 1 >= samples,
        };
        let mut before = Sample { t: enter, value: zero, side: start };
        let (mut first, mut level) = (0, 0);
        while first < samples {
            if by_size && begins_stretch(level, first) {
                let x = self.place(enter + R::of_u32(first) * step);
                level = look_by_size(self.volume, self.volumes, x, 0).level.min(longest_at(first));
            }
            // The end of the way is a block by itself.
            let is_end = is_last(first, level);
            let place = |k: u32| first + (k << level);
            let within = (0..self.volume.block).take_while(|&k| !is_last(place(k), level)).count();
            let count = within.max(1) as u32;
            let apart = step * R::of_u32(1 << level);
            let block = self.block(at(first, level), apart, (count, level));
            for (k, here) in (0..count).zip(block) {
                let here = Sample { t: at(place(k), level), ..here };
                match (before.side, here.side) {
                    (Some(a), Some(b)) if a != b => return Some([before, here]),
                    _ => before = here,
                }
            }
            first = if is_end { samples } else { place(count) };
        }
        None
    }

    /// Closes in on the surface between two samples, with a block of places a turn: evenly between them, then close about
    /// where the straight line between their values is 0.
    fn close_in(&self, [mut low, mut high]: [Sample<R>; 2]) -> R {
        let count = self.volume.block;
        let turns = if count < BLOCK_PLACES { TURNS_OF_FEW } else { TURNS };
        let mut narrow = false;
        for _ in 0..turns {
            let way = high.t - low.t;
            let apart = if narrow { way * R::of(NARROWER) } else { way / R::of_u32(count + 1) };
            let span = R::of_u32(count - 1) * apart;
            let about = between(&low, &high) - R::of(0.5) * span;
            let begin = if narrow { low.t.max(about.min(high.t - span)) } else { low.t + apart };
            let places = &self.block(begin, apart, (count, 0))[..count as usize];
            let is_beyond = |here: &Sample<R>| here.side.is_some() && here.side != low.side;
            let beyond = places.iter().position(is_beyond);
            if let Some(last) = beyond.unwrap_or(places.len()).checked_sub(1) {
                low = Sample { side: low.side, ..places[last] };
            }
            if let Some(beyond) = beyond {
                high = places[beyond];
            }
            if narrow && beyond.is_some_and(|beyond| beyond > 0) {
                break;
            }
            narrow = !narrow && low.value * high.value < R::of(0.0);
        }
        between(&low, &high)
    }

    fn hit(&self, t: R) -> Hit<R> {
        let (x, d) = (self.place(t), self.ray.direction);
        let gradient = Sums::at(self.volume, self.volumes, (x, 0), None).gradient(self.volume);
        let square = gradient.dot(gradient);
        let normal = if square > R::of(0.0) { gradient.over(square.sqrt()) } else { d };
        let normal = if normal.dot(d) > R::of(0.0) { -normal } else { normal };
        Hit { position: x, t, normal }
    }
}

/// Between two places on either side: on the line between their values, or in the middle.
fn between<R: Real>(low: &Sample<R>, high: &Sample<R>) -> R {
    let part = if low.value * high.value < R::of(0.0) {
        low.value / (low.value - high.value)
    } else {
        R::of(0.5)
    };
    low.t + part * (high.t - low.t)
}

fn isosurfaces<'a, R>(
    ray: &'a Ray<R>,
    volumes: &'a Volumes,
) -> impl Iterator<Item = Search<'a, R>> {
    let infos = volumes.infos.iter().filter(|volume| volume.mode == VOLUME_ISOSURFACE);
    infos.map(move |volume| Search { ray, volume, volumes })
}

/// The nearest isosurface on a ray that ends at `end`: the hit, and the slot that stands for it. `media` are
/// those it is inside.
pub fn isosurface<R: Real>(
    ray: &Ray<R>,
    mut end: R,
    media: &Media,
    volumes: &Volumes,
) -> Option<(Hit<R>, u32)> {
    let mut nearest = None;
    for search in isosurfaces(ray, volumes) {
        let inside = media.contains(search.volume.object);
        let side = if inside { Side::Above } else { Side::Below };
        let start = (search.volume.refracts != 0).then_some(side);
        if let Some(bracket) = search.bracket(end, start) {
            let hit = search.hit(search.close_in(bracket));
            end = hit.t;
            nearest = Some((hit, search.volume.slot));
        }
    }
    nearest
}

/// Whether an isosurface blocks a ray towards a light at `end`.
pub fn blocks<R: Real>(ray: &Ray<R>, end: R, volumes: &Volumes) -> bool {
    isosurfaces(ray, volumes).any(|search| search.bracket(end, None).is_some())
}
