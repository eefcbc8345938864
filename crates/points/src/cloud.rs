//! The points of a whole scene, centred and in memory order.
//!
//! Coordinates are moved to the centre of the scene's bounding box in f64 before anything is f32,
//! so survey data with offsets of 10⁶ keeps its digits. The points of an object are then sorted
//! along a Hilbert curve: neighbours in space are neighbours in memory, and places that follow each other
//! lie close together, which the neighbour search of a device lives by. Points that share a place of the curve
//! are sorted along a finer one through their own box, so that a far outlier spoils nothing. A point's place there is its
//! slot; results never depend on it, since ties go by [`Cloud::order`].

use kernels::layout::Point;
use rayon::prelude::*;

/// Farther than this from the centre, squares of squares of f32 coordinates would overflow.
pub const FARTHEST: f64 = 1e12;

/// Bits an axis of a place on the curve.
const CURVE_BITS: u32 = 21;
/// So many points that share a place on a curve may lie in any order.
const UNSORTED: usize = 8;

/// The points of one object, in world coordinates.
#[derive(Debug, Clone, Copy)]
pub struct ObjectPoints<'a> {
    /// World positions, finite.
    pub positions: &'a [[f64; 3]],
    /// Place in the file of each.
    pub file_index: &'a [u32],
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
    /// The world position that was subtracted.
    pub origin: [f64; 3],
    /// World bounding box: lowest and highest corner.
    pub bounds: [[f64; 3]; 2],
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
    /// Centres, sorts and numbers the points of all objects.
    ///
    /// # Errors
    /// Too many points, none, or points farther apart than f32 bears.
    pub fn new(objects: &[ObjectPoints<'_>]) -> Result<Self, CloudError> {
        let all = objects.iter().map(|object| object.positions);
        let bounds = bounds_of(all).ok_or(CloudError::Empty)?;
        Self::within(bounds, objects)
    }

    /// The same in a scene that reaches farther than these points: its box is given.
    ///
    /// # Errors
    /// As [`Cloud::new`], but for a scene without points here.
    pub fn within(bounds: [[f64; 3]; 2], objects: &[ObjectPoints<'_>]) -> Result<Self, CloudError> {
        let count: usize = objects.iter().map(|object| object.positions.len()).sum();
        let limit = u32::MAX / 4;
        if count > limit as usize {
            return Err(CloudError::TooMany { count, limit });
        }
        let origin = [0, 1, 2].map(|axis| middle(bounds[0][axis], bounds[1][axis]));
        let mut cloud = Self {
            points: Vec::with_capacity(count),
            objects: Vec::new(),
            order: vec![0; count],
            origin,
            bounds,
        };
        for (index, object) in objects.iter().enumerate() {
            cloud.add_object(index, object)?;
        }
        Ok(cloud)
    }

    fn add_object(&mut self, index: usize, object: &ObjectPoints<'_>) -> Result<(), CloudError> {
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
        let mut places: Vec<(u64, u32)> = (0..local.len() as u32).map(|i| (0, i)).collect();
        sort_along_curve(&local, &mut places);
        let in_order = places.par_iter().with_min_len(PART);
        self.points.par_extend(in_order.map(|&(_, i)| local[i as usize]));
        for (slot, &(_, i)) in places.iter().enumerate() {
            self.order[first + i as usize] = (first + slot) as u32;
        }
        self.objects.push(SlotRange { first_slot: first as u32, count: local.len() as u32 });
        Ok(())
    }

    /// The values of one object, given in file order, in the order of its slots.
    #[must_use]
    pub fn by_slot<T: Copy + Default>(&self, object: usize, values: &[T]) -> Vec<T> {
        let range = self.objects[object].range();
        let mut sorted = vec![T::default(); range.len()];
        for (&slot, &value) in self.order[range.clone()].iter().zip(values) {
            sorted[slot as usize - range.start] = value;
        }
        sorted
    }
}

/// Halfway without overflow.
fn middle(low: f64, high: f64) -> f64 {
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

/// Sorts places in `points` along a Hilbert curve through the cube around them, and those that it does not
/// tell apart along another through theirs. Points that coincide come in the order of the file, one after
/// another wherever there are more than [`UNSORTED`].
fn sort_along_curve(points: &[Point], places: &mut [(u64, u32)]) {
    let position = |place: &(u64, u32)| points[place.1 as usize].position;
    let empty = || ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    let join = |a: ([f32; 3], [f32; 3]), b: ([f32; 3], [f32; 3])| {
        ([0, 1, 2].map(|i| a.0[i].min(b.0[i])), [0, 1, 2].map(|i| a.1[i].max(b.1[i])))
    };
    let (low, high) = places
        .par_iter()
        .with_min_len(1 << 12)
        .fold(empty, |bounds, place| join(bounds, (position(place), position(place))))
        .reduce(empty, join);
    let extent = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f32::max);
    // What is left of coordinates this small is no order, and need not be one.
    let is_spread = extent > f32::MIN_POSITIVE;
    let scale =
        f64::from((1u32 << CURVE_BITS) - 1) / f64::from(if is_spread { extent } else { 1.0 });
    if is_spread {
        places.par_chunks_mut(PART).flat_map_iter(|part| part.chunks_mut(AT_ONCE)).for_each(
            |few| {
                let mut cells = [[0; AT_ONCE]; 3];
                for (i, place) in few.iter().enumerate() {
                    let p = position(place);
                    for axis in 0..3 {
                        cells[axis][i] = (f64::from(p[axis] - low[axis]) * scale) as u32;
                    }
                }
                for (place, on_curve) in few.iter_mut().zip(places_on_curve(cells)) {
                    place.0 = on_curve;
                }
            },
        );
    } else {
        places.par_iter_mut().for_each(|place| place.0 = 0);
    }
    places.par_sort_unstable();
    if is_spread {
        let runs = places.chunk_by_mut(|a, b| a.0 == b.0).filter(|run| run.len() > UNSORTED);
        runs.for_each(|run| sort_along_curve(points, run));
    }
}

/// Cells whose places are computed together, so that each step is one of a vector: six times as fast as one by one.
const AT_ONCE: usize = 8;

/// Where cells of a cube with 2^[`CURVE_BITS`] cells a side lie on the Hilbert curve through it, by the coordinates of
/// all along each axis. After Skilling, Programming the Hilbert curve, 2004.
#[expect(clippy::needless_range_loop, reason = "one lane of two axes, which may be the same")]
fn places_on_curve(cells: [[u32; AT_ONCE]; 3]) -> [u64; AT_ONCE] {
    let mut x = cells;
    for bit in (1..CURVE_BITS).rev() {
        let below = (1 << bit) - 1;
        for axis in 0..3 {
            for i in 0..AT_ONCE {
                // All ones where the bit is set: then the first axis turns, else both change places.
                let set = 0u32.wrapping_sub((x[axis][i] >> bit) & 1);
                let exchanged = (x[0][i] ^ x[axis][i]) & below & !set;
                x[0][i] ^= exchanged ^ (below & set);
                x[axis][i] ^= exchanged;
            }
        }
    }
    std::array::from_fn(|i| {
        let mut cell = [x[0][i], x[1][i], x[2][i]];
        cell[1] ^= cell[0];
        cell[2] ^= cell[1];
        // Each bit turns those below it: what is left is the parity of the bits from each on.
        let mut turns = cell[2] >> 1;
        for shift in [1, 2, 4, 8, 16] {
            turns ^= turns >> shift;
        }
        let [x, y, z] = cell.map(|bits| spread_bits(u64::from(bits ^ turns)));
        x << 2 | y << 1 | z
    })
}

/// Puts two zero bits between each of the low 21 bits.
fn spread_bits(value: u64) -> u64 {
    let mut x = value & 0x1f_ffff;
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud(positions: &[[f64; 3]]) -> Result<Cloud, CloudError> {
        let file_index: Vec<u32> = (0..positions.len() as u32).collect();
        Cloud::new(&[ObjectPoints { positions, file_index: &file_index }])
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

    #[test]
    fn the_curve_goes_through_every_cell_by_steps_of_one() {
        // Of the lowest three bits, in the corner where the curve begins.
        let rows = (0..64).map(|i| [i % 8, i / 8]);
        let mut cells: Vec<(u64, [u32; 3])> = rows
            .flat_map(|[y, z]| {
                let row: [u32; AT_ONCE] = std::array::from_fn(|x| x as u32);
                let places = places_on_curve([row, [y; AT_ONCE], [z; AT_ONCE]]);
                places.into_iter().zip(row.map(|x| [x, y, z]))
            })
            .collect();
        cells.sort_unstable();
        assert!(cells.iter().zip(0..).all(|(cell, place)| cell.0 == place));
        let step = |a: [u32; 3], b: [u32; 3]| -> u32 { (0..3).map(|i| a[i].abs_diff(b[i])).sum() };
        assert!(cells.windows(2).all(|pair| step(pair[0].1, pair[1].1) == 1));
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
