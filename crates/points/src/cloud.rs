//! The points of a whole scene, centred and in memory order.
//!
//! Coordinates are moved to the middle of the scene's bounding box in f64 before anything is f32,
//! so survey data with offsets of 10⁶ keeps its digits. The points of an object are then sorted
//! along a Hilbert curve ([`crate::curve`]). A point's place there is its slot; results never depend on it,
//! since ties go by [`Cloud::order`].
//!
//! Where points carry a surface, those of one object at equal f32 positions count once: the first of the file
//! stands for all ([`Cloud::within`]).

use crate::curve::{is_copy, sort_along_curve};
use crate::watch::{Unwatched, Watch};
use kernels::layout::Point;
use rayon::prelude::*;
use std::borrow::Cow;

/// Farther than this from the centre, squares of squares of f32 coordinates would overflow.
pub const FARTHEST: f64 = 1e12;

/// The points of one object, in world coordinates.
#[derive(Debug, Clone, Copy)]
pub struct ObjectPoints<'a> {
    /// World positions, finite.
    pub positions: &'a [[f64; 3]],
    /// Place in the file of each.
    pub file_index: &'a [u32],
    /// Their places along a Hilbert curve, where somebody has sorted them already
    /// ([`Strays::order`](crate::Strays::order)), from the same origin.
    pub order: Option<&'a [u32]>,
}

impl<'a> ObjectPoints<'a> {
    /// Points that are not sorted yet.
    #[must_use]
    pub fn new(positions: &'a [[f64; 3]], file_index: &'a [u32]) -> Self {
        Self { positions, file_index, order: None }
    }
}

/// Slots of one object: `first_slot .. first_slot + count`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SlotRange {
    /// The first.
    pub first_slot: u32,
    /// How many.
    pub count: u32,
}

impl SlotRange {
    /// As a range of `usize`.
    #[must_use]
    pub fn range(&self) -> std::ops::Range<usize> {
        self.first_slot as usize..self.first_slot as usize + self.count as usize
    }
}

/// All points of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Cloud {
    /// By slot, object after object.
    pub points: Vec<Point>,
    /// Slots of each object.
    pub objects: Vec<SlotRange>,
    /// Slots by ordinal, that is in the order of (object, place in the file).
    pub order: Vec<u32>,
    /// The copies among the points given of each object; `None` where there are none.
    copies: Vec<Option<Copies>>,
    /// The world position that was subtracted.
    pub origin: [f64; 3],
    /// World bounding box: lowest and highest corner.
    pub bounds: [[f64; 3]; 2],
}

/// Points of an object that lie where an earlier one lies, and do not count.
#[derive(Debug, Clone, PartialEq)]
struct Copies {
    /// Places of the points that count, ascending.
    counted: Vec<u32>,
    /// Of each point given, the slot of the one that counts for it.
    slots: Vec<u32>,
}

/// What makes points unusable together.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum CloudError {
    /// A span that f32 arithmetic cannot bear.
    #[error(
        "the points of object {object} reach {farthest:e} from the middle of the scene, but at most \
         {FARTHEST:e} is supported; remove outliers or scale the object down"
    )]
    TooFar {
        /// Index in the scene.
        object: usize,
        /// Largest coordinate after centring.
        farthest: f64,
    },
    /// More points than 32 bits of slot can count.
    #[error("the scene has {count} points but at most {limit} are supported; thin the point sets")]
    TooMany {
        /// Points in all.
        count: usize,
        /// Largest count.
        limit: u32,
    },
    /// No point at all.
    #[error("the scene has no points; give an object a file with at least one")]
    Empty,
}

impl Cloud {
    /// Centres, sorts and numbers the points of all objects, those that coincide too.
    ///
    /// # Errors
    /// Too many points, none, or points farther apart than f32 bears.
    pub fn new(objects: &[ObjectPoints<'_>]) -> Result<Self, CloudError> {
        let all = objects.iter().map(|object| object.positions);
        let bounds = bounds_of(all).ok_or(CloudError::Empty)?;
        Self::build(bounds, objects, false, &Unwatched)
    }

    /// The same, where points of one object at equal f32 positions count once: the one that comes first in its file.
    ///
    /// # Errors
    /// As [`Cloud::new`].
    pub fn distinct(objects: &[ObjectPoints<'_>]) -> Result<Self, CloudError> {
        let all = objects.iter().map(|object| object.positions);
        Self::within(bounds_of(all).ok_or(CloudError::Empty)?, objects, &Unwatched)
    }

    /// The distinct points of a scene whose box is given, which may reach farther than they. The units of `watch` are
    /// points.
    ///
    /// # Errors
    /// As [`Cloud::new`], but for a scene without points here.
    pub fn within(
        bounds: [[f64; 3]; 2],
        objects: &[ObjectPoints<'_>],
        watch: &dyn Watch,
    ) -> Result<Self, CloudError> {
        Self::build(bounds, objects, true, watch)
    }

    fn build(
        bounds: [[f64; 3]; 2],
        objects: &[ObjectPoints<'_>],
        once: bool,
        watch: &dyn Watch,
    ) -> Result<Self, CloudError> {
        let count: usize = objects.iter().map(|object| object.positions.len()).sum();
        let limit = u32::MAX / 4;
        if count > limit as usize {
            return Err(CloudError::TooMany { count, limit });
        }
        let mut cloud = Self {
            points: Vec::with_capacity(count),
            objects: Vec::new(),
            order: Vec::with_capacity(count),
            copies: Vec::new(),
            origin: origin_of(bounds),
            bounds,
        };
        let mut before = 0;
        for (index, object) in objects.iter().enumerate() {
            let points = object.positions.len() as u64;
            cloud.add_object(index, object, once, &|quarters| {
                watch.done(before + points * quarters / 4);
            })?;
            before += points;
        }
        Ok(cloud)
    }

    fn add_object(
        &mut self,
        index: usize,
        object: &ObjectPoints<'_>,
        once: bool,
        done: &dyn Fn(u64),
    ) -> Result<(), CloudError> {
        let first = self.points.len();
        let farthest = object
            .positions
            .par_chunks(PART)
            .map(|part| {
                let away = |p: &[f64; 3]| [0, 1, 2].map(|axis| (p[axis] - self.origin[axis]).abs());
                part.iter().flat_map(away).fold(0.0, f64::max)
            })
            .reduce(|| 0.0, f64::max);
        if farthest > FARTHEST {
            return Err(CloudError::TooFar { object: index, farthest });
        }
        let local: Vec<Point> = object
            .positions
            .par_iter()
            .zip(object.file_index)
            .with_min_len(PART)
            .map(|(p, &index)| Point {
                position: [0, 1, 2].map(|axis| (p[axis] - self.origin[axis]) as f32),
                index,
            })
            .collect();
        done(1);
        let mut places: Cow<'_, [u32]> = match object.order {
            Some(order) => Cow::Borrowed(order),
            None => {
                let mut places: Vec<(u64, u32)> = (0..local.len() as u32).map(|i| (0, i)).collect();
                sort_along_curve(&local, &mut places);
                Cow::Owned(places.into_iter().map(|(_, place)| place).collect())
            }
        };
        done(2);
        let is_copy_of_last = |pair: &[u32]| {
            let [a, b] = [pair[0], pair[1]].map(|place| local[place as usize].position);
            is_copy(a, b)
        };
        let mut slots = vec![u32::MAX; local.len()];
        let has_copies = once && places.par_windows(2).any(is_copy_of_last);
        if has_copies {
            let mut firsts: Vec<u32> = Vec::new();
            for (at, &place) in places.iter().enumerate() {
                if at == 0 || !is_copy_of_last(&places[at - 1..=at]) {
                    firsts.push(place);
                }
                slots[place as usize] = (first + firsts.len() - 1) as u32;
            }
            places = Cow::Owned(firsts);
            let mut counted = places.to_vec();
            counted.sort_unstable();
            self.order.extend(counted.iter().map(|&place| slots[place as usize]));
            self.copies.push(Some(Copies { counted, slots }));
        } else {
            for (slot, &i) in places.iter().enumerate() {
                slots[i as usize] = (first + slot) as u32;
            }
            self.order.append(&mut slots);
            self.copies.push(None);
        }
        done(3);
        let in_order = places.par_iter().with_min_len(PART);
        self.points.par_extend(in_order.map(|&i| local[i as usize]));
        self.objects.push(SlotRange { first_slot: first as u32, count: places.len() as u32 });
        done(4);
        Ok(())
    }

    /// Puts some slots of an object after all its others: `last` says which, by place among them. Within both parts
    /// the order stays, so that each still lies along the curve. What anybody had by slot is void.
    ///
    /// # Panics
    /// Unless `last` has one entry a slot of the object.
    pub fn put_last(&mut self, object: usize, last: &[bool]) {
        let range = self.objects[object].range();
        assert_eq!(last.len(), range.len(), "one entry a slot of the object");
        let (mut next, mut next_last) = (0, last.iter().filter(|&&last| !last).count());
        let place_of = |&last: &bool| {
            let next = if last { &mut next_last } else { &mut next };
            *next += 1;
            *next - 1
        };
        let places: Vec<usize> = last.iter().map(place_of).collect();
        let before = self.points[range.clone()].to_vec();
        for (point, place) in before.into_iter().zip(&places) {
            self.points[range.start + place] = point;
        }
        let moved = |slot: &mut u32| {
            *slot = (range.start + places[*slot as usize - range.start]) as u32;
        };
        self.order[range.clone()].iter_mut().for_each(moved);
        if let Some(copies) = &mut self.copies[object] {
            copies.slots.iter_mut().for_each(moved);
        }
    }

    /// Whether a point of an object counts, by its place among those given: a copy does not.
    #[must_use]
    pub fn counts(&self, object: usize, place: usize) -> bool {
        let counted = self.copies[object].as_ref().map(|copies| &copies.counted);
        counted.is_none_or(|counted| counted.binary_search(&(place as u32)).is_ok())
    }

    /// The slot of a point of an object, by its place among those given: of a copy, that of the point that counts.
    #[must_use]
    pub fn slot(&self, object: usize, place: usize) -> u32 {
        match &self.copies[object] {
            Some(copies) => copies.slots[place],
            // As many ordinals as slots.
            None => self.order[self.objects[object].first_slot as usize + place],
        }
    }

    /// The values of one object, given in file order, in the order of its slots.
    #[must_use]
    pub fn by_slot<T: Copy + Default>(&self, object: usize, values: &[T]) -> Vec<T> {
        let range = self.objects[object].range();
        let mut sorted = vec![T::default(); range.len()];
        let mut put = |(&slot, value): (&u32, T)| sorted[slot as usize - range.start] = value;
        let slots = self.order[range.clone()].iter();
        match &self.copies[object] {
            Some(Copies { counted, .. }) => {
                slots.zip(counted.iter().map(|&i| values[i as usize])).for_each(&mut put);
            }
            None => slots.zip(values.iter().copied()).for_each(&mut put),
        }
        sorted
    }
}

/// What is subtracted from the positions of a scene with this box: its middle.
#[must_use]
pub fn origin_of([low, high]: [[f64; 3]; 2]) -> [f64; 3] {
    [0, 1, 2].map(|axis| middle(low[axis], high[axis]))
}

/// Halfway without overflow.
pub(crate) fn middle(low: f64, high: f64) -> f64 {
    0.5 * low + 0.5 * high
}

/// Points that one thread takes at once.
const PART: usize = 1 << 14;

/// Lowest and highest coordinate of the points of all sets along each axis; `None` without points.
#[must_use]
pub fn bounds_of<'a>(sets: impl IntoIterator<Item = &'a [[f64; 3]]>) -> Option<[[f64; 3]; 2]> {
    let joined = |[low, high]: [[f64; 3]; 2], [low_too, high_too]: [[f64; 3]; 2]| {
        [
            [0, 1, 2].map(|axis| low[axis].min(low_too[axis])),
            [0, 1, 2].map(|axis| high[axis].max(high_too[axis])),
        ]
    };
    let of_part = |part: &[[f64; 3]]| part.iter().map(|&p| [p, p]).reduce(joined);
    let of_set = |set: &[[f64; 3]]| set.par_chunks(PART).filter_map(of_part).reduce_with(joined);
    sets.into_iter().filter_map(of_set).reduce(joined)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud(positions: &[[f64; 3]]) -> Result<Cloud, CloudError> {
        let file_index: Vec<u32> = (0..positions.len() as u32).collect();
        Cloud::new(&[ObjectPoints::new(positions, &file_index)])
    }

    #[test]
    fn survey_coordinates_keep_their_digits() {
        let far =
            cloud(&[[500_000.001, 4.1e6, 1200.0], [500_000.003, 4.1e6, 1200.0]]).expect("a cloud");
        let mut x: Vec<f32> = far.points.iter().map(|p| p.position[0]).collect();
        x.sort_by(f32::total_cmp);
        // 6e-11 is half an ulp of the f64 coordinate.
        assert!((x[1] - 1e-3).abs() < 1e-9 && (x[0] + 1e-3).abs() < 1e-9, "{x:?}");
    }

    #[test]
    fn order_leads_from_the_file_to_memory_and_back() {
        let positions: Vec<[f64; 3]> =
            (0..1000).map(|i| [f64::from(i * 7919 % 1000), f64::from(i * 31 % 97), 0.0]).collect();
        let cloud = cloud(&positions).expect("a cloud");
        for (ordinal, &slot) in cloud.order.iter().enumerate() {
            assert_eq!(cloud.points[slot as usize].index as usize, ordinal);
        }
        let ids: Vec<u32> = (0..1000).collect();
        for (point, id) in cloud.points.iter().zip(cloud.by_slot(0, &ids)) {
            assert_eq!(point.index, id);
        }
    }

    /// Two objects, the first with copies: every third slot of it goes last, and whatever led to a point still does.
    #[test]
    fn what_is_put_last_keeps_its_order_and_every_way_to_it() {
        let position = |i: u32| [f64::from(i * 7919 % 100), f64::from(i * 31 % 97), 0.0];
        let positions: Vec<[f64; 3]> = (0..300).map(|i| position(i % 200)).collect();
        let file_index: Vec<u32> = (0..300).collect();
        let objects = [ObjectPoints::new(&positions, &file_index); 2];
        let before = Cloud::distinct(&objects).expect("a cloud");
        assert!(before.objects.iter().all(|object| object.count == 200), "copies count once");
        let is_last = |place: usize| place % 3 == 1;
        let last: Vec<bool> = (0..200).map(is_last).collect();
        let mut after = before.clone();
        after.put_last(0, &last);
        let own = &before.points[..200];
        let part = |which| (0..200).filter(move |&at| is_last(at) == which).map(|at| own[at]);
        let expected: Vec<Point> = part(false).chain(part(true)).collect();
        assert_eq!(after.points[..200], expected);
        assert_eq!(after.points[200..], before.points[200..], "the other object");
        for place in 0..300 {
            let at = |cloud: &Cloud| cloud.points[cloud.slot(0, place) as usize];
            assert_eq!(at(&after), at(&before), "the point for place {place}");
            assert_eq!(after.counts(0, place), before.counts(0, place));
        }
        for ordinal in 0..400 {
            let at = |cloud: &Cloud| cloud.points[cloud.order[ordinal] as usize];
            assert_eq!(at(&after), at(&before), "the order by place in the file");
        }
        let ids = after.by_slot(0, &file_index);
        assert!(after.points[..200].iter().zip(ids).all(|(point, id)| point.index == id));
        after.put_last(0, &[false; 200]);
        assert_eq!(after.points[..200], expected, "nothing goes last");
    }

    /// 2^21 cells an axis, and all points but one in the same.
    #[test]
    fn an_outlier_leaves_the_others_in_order() {
        let mut line: Vec<[f64; 3]> =
            (0..1000).map(|i| [f64::from(i * 619 % 1000), 0.0, 0.0]).collect();
        line.push([1e10, 0.0, 0.0]);
        // The spacing of f32 at 5e9 is 512: the line becomes points that coincide, three times.
        let cloud = cloud(&line).expect("a cloud");
        let steps = cloud.points.windows(2);
        let ordered = |pair: &[Point]| {
            let way = pair[1].position[0] - pair[0].position[0];
            way > 0.0 || (way == 0.0 && pair[0].index < pair[1].index)
        };
        assert_eq!(steps.filter(|pair| !ordered(pair)).count(), 0);
    }

    #[test]
    fn what_f32_cannot_bear_is_an_error() {
        let error = cloud(&[[0.0; 3], [1e300, 0.0, 0.0]]).expect_err("too far");
        assert_eq!(error, CloudError::TooFar { object: 0, farthest: 5e299 });
        assert_eq!(cloud(&[]).expect_err("empty"), CloudError::Empty);
    }
}
