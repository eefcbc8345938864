//! The points of a whole scene, centred and in memory order.
//!
//! Coordinates are moved to the centre of the scene's bounding box in f64 before anything is f32,
//! so survey data with offsets of 10⁶ keeps its digits. The points of an object are then sorted
//! along a Morton curve: neighbours in space are neighbours in memory. A point's place there is its
//! slot; results never depend on it, since ties go by [`Cloud::order`].

use kernels::layout::Point;
use rayon::prelude::*;

/// Farther than this from the centre, squares of squares of f32 coordinates would overflow.
pub const FARTHEST: f64 = 1e12;

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
        let all = objects.iter().flat_map(|object| object.positions);
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
            .iter()
            .flat_map(|p| [0, 1, 2].map(|axis| (p[axis] - self.origin[axis]).abs()))
            .fold(0.0, f64::max);
        if farthest > FARTHEST {
            return Err(CloudError::TooFar { object: index, farthest });
        }
        let local: Vec<Point> = object
            .positions
            .iter()
            .zip(object.file_index)
            .map(|(p, &index)| Point {
                position: [0, 1, 2].map(|axis| (p[axis] - self.origin[axis]) as f32),
                index,
            })
            .collect();
        let keys = morton_keys(&local);
        let mut slots: Vec<u32> = (0..local.len() as u32).collect();
        slots.par_sort_unstable_by_key(|&i| (keys[i as usize], i));
        for (slot, &i) in slots.iter().enumerate() {
            self.points.push(local[i as usize]);
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

/// Lowest and highest coordinate along each axis; `None` without points.
#[must_use]
pub fn bounds_of<'a>(points: impl IntoIterator<Item = &'a [f64; 3]>) -> Option<[[f64; 3]; 2]> {
    let mut all = points.into_iter();
    let &first = all.next()?;
    Some(all.fold([first, first], |[low, high], p| {
        [
            [0, 1, 2].map(|axis| low[axis].min(p[axis])),
            [0, 1, 2].map(|axis| high[axis].max(p[axis])),
        ]
    }))
}

/// 21 bits an axis, interleaved, over the cube around the points.
fn morton_keys(points: &[Point]) -> Vec<u64> {
    let along = |axis: usize| points.iter().map(move |p| p.position[axis]);
    let low = [0, 1, 2].map(|axis| along(axis).fold(f32::INFINITY, f32::min));
    let high = [0, 1, 2].map(|axis| along(axis).fold(f32::NEG_INFINITY, f32::max));
    let extent = (0..3).map(|axis| high[axis] - low[axis]).fold(f32::MIN_POSITIVE, f32::max);
    let steps = f64::from((1u32 << 21) - 1);
    points
        .par_iter()
        .map(|p| {
            [0, 1, 2]
                .map(|axis| {
                    let at = f64::from(p.position[axis] - low[axis]) / f64::from(extent);
                    spread_bits((at * steps) as u64) << axis
                })
                .iter()
                .sum()
        })
        .collect()
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
    fn what_f32_cannot_bear_is_an_error() {
        let error = cloud(&[[0.0; 3], [1e300, 0.0, 0.0]]).expect_err("too far");
        assert_eq!(error, CloudError::TooFar { object: 0, farthest: 5e299 });
        assert_eq!(cloud(&[]).expect_err("empty"), CloudError::Empty);
    }
}
