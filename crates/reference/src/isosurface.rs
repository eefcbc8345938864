//! Twin of `isosurface`: where a ray first meets a surface on which the scalar of a volume is one number.
//!
//! The kernel passes over samples whose side their cell tells, unless that is where the side changes. The
//! twin looks at all of them.

use crate::camera_rays::Ray;
use crate::grid::within_box;
use crate::media::Media;
use crate::real::{Real, V3};
use crate::steps::{begins_stretch, longest_at};
use crate::surface_hit::Hit;
use crate::volume::{MOST_SAMPLES, Sums, look_by_size};
use kernels::layout::{VOLUME_ISOSURFACE, VOLUME_SHEPARD, VolumeInfo};
use plan::Volumes;

/// Turns of regula falsi.
const TURNS: u32 = 8;
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

    /// At a place, where steps are of a level.
    fn sample(&self, t: R, level: u32) -> Sample<R> {
        let sums = Sums::at(self.volume, self.volumes, (self.place(t), level), None);
        let exact = sums.scalar(self.volume) - R::of_f32(self.volume.iso);
        let value = if exact == R::of(0.0) { R::of_f32(ON_IT) } else { exact };
        let known = self.volume.kernel != VOLUME_SHEPARD || sums.reached();
        let side = if value > R::of(0.0) { Side::Above } else { Side::Below };
        Sample { t, value: if known { value } else { R::of(0.0) }, side: known.then_some(side) }
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
        let mut before = Sample { t: enter, value: zero, side: start };
        let (mut place, mut level) = (0, 0);
        while place < samples {
            if !self.volumes.sizes.is_empty() && begins_stretch(level, place) {
                let x = self.place(enter + R::of_u32(place) * step);
                level = look_by_size(self.volume, self.volumes, x, 0).level.min(longest_at(place));
            }
            let half = R::of(0.5) * R::of_u32(1 << level);
            let t = (enter + (R::of_u32(place) + half) * step).min(leave);
            let here = self.sample(t, level);
            match (before.side, here.side) {
                (Some(a), Some(b)) if a != b => return Some([before, here]),
                _ => before = here,
            }
            let is_last = !self.volumes.sizes.is_empty() && t >= leave;
            place = if is_last { samples } else { place + (1 << level) };
        }
        None
    }

    /// Closes in on the surface between two samples.
    fn close_in(&self, [mut low, mut high]: [Sample<R>; 2]) -> R {
        // Of an end that stays where it is for two turns, half the value counts (Illinois).
        let mut moved_low = None;
        for _ in 0..TURNS {
            let here = self.sample(between(&low, &high), 0);
            let before = here.side.is_none() || here.side == low.side;
            let share = R::of(if moved_low == Some(before) { 0.5 } else { 1.0 });
            if before {
                low = Sample { side: low.side, ..here };
                high.value = share * high.value;
            } else {
                high = here;
                low.value = share * low.value;
            }
            moved_low = Some(before);
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
