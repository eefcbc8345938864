//! Strays of a file: by all its positions where these are held, else by a sample of them and what lies far from it.
//!
//! A position that lies near the sample is none. The others are few, and are kept as they go past in the second pass;
//! the rule of [`Strays`] is applied to the sample together with them. A sample is thinner than the set, so a stray has
//! to lie farther off to be one: by the root of how much thinner, on a surface.

use crate::distinct::Distinct;
use crate::set::PointSet;
use crate::strays::{Apart, Strays, filter, rough_origin, size_of};

/// Cells along each axis of the box around the sample.
const CELLS: usize = 254;
/// Positions far from the sample that are kept. Where there are more, they are sparse surroundings.
const MOST_FAR: usize = 1 << 17;

/// What the summary says of strays.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Found {
    /// The box around all others.
    pub bulk: [[f64; 3]; 2],
    pub apart: Option<Apart>,
}

/// Finds the strays of a file.
pub(super) enum Bulk {
    Found(Option<Found>),
    /// Once all points went past.
    Passing(Box<Passing>),
}

impl Bulk {
    /// Of positions that are held; nothing of none.
    pub(super) fn of(positions: &[[f64; 3]]) -> Self {
        let found = rough_origin(&[positions]).map(|origin| {
            let strays = Strays::find(positions, origin);
            let any = !strays.places.is_empty();
            Found { bulk: strays.bulk, apart: any.then(|| strays.apart(0, positions)) }
        });
        Self::Found(found)
    }

    pub(super) fn of_blocks(blocks: &[PointSet]) -> Self {
        Self::of(&blocks.iter().flat_map(|block| &block.positions).copied().collect::<Vec<_>>())
    }

    /// Of what was seen in the first pass: of all positions where there are few.
    pub(super) fn of_distinct(distinct: &Distinct) -> Self {
        let sample = distinct.positions();
        match distinct.sample_is_whole() {
            true => Self::of(&sample),
            false => Self::Passing(Box::new(Passing::new(sample))),
        }
    }

    pub(super) fn see(&mut self, positions: &[[f64; 3]]) {
        if let Self::Passing(passing) = self {
            positions.iter().for_each(|position| passing.see(position));
        }
    }

    pub(super) fn begin_again(&mut self) {
        if let Self::Passing(passing) = self {
            passing.far.clear();
            passing.far_count = 0;
        }
    }

    /// `points` is how many there are, `bounds` their box.
    pub(super) fn finish(self, points: u64, bounds: [[f64; 3]; 2]) -> Found {
        let found = match self {
            Self::Found(found) => found,
            Self::Passing(passing) => passing.finish(points),
        };
        found.unwrap_or(Found { bulk: bounds, apart: None })
    }
}

/// The sample, and what lies far from it.
pub(super) struct Passing {
    /// Without its strays, which go past again.
    sample: Vec<[f64; 3]>,
    origin: [f64; 3],
    low: [f64; 3],
    inverse_edge: f64,
    /// Cells of a cube, one bit each: whether it, or one beside it, has a position of the sample.
    near: Vec<u64>,
    /// The box around what went past near the sample.
    bulk: [[f64; 3]; 2],
    far: Vec<[f64; 3]>,
    far_count: u64,
}

impl Passing {
    fn new(mut sample: Vec<[f64; 3]>) -> Self {
        let origin = rough_origin(&[&sample]).unwrap_or_default();
        let strays = Strays::find(&sample, origin);
        let mut stray = strays.places.iter().copied().peekable();
        let mut place = 0..;
        sample.retain(|_| stray.next_if_eq(&place.next().unwrap_or_default()).is_none());
        let [low, _] = strays.bulk;
        let edge = (4.0 * strays.reach).max(size_of(strays.bulk) / CELLS as f64);
        let mut passing = Self {
            sample: Vec::new(),
            origin,
            low,
            inverse_edge: if edge > 0.0 { 1.0 / edge } else { 0.0 },
            near: vec![0; (CELLS + 2).pow(3).div_ceil(64)],
            bulk: [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]],
            far: Vec::new(),
            far_count: 0,
        };
        for position in &sample {
            if let Some(cell) = passing.cell(position) {
                for offset in 0..27 {
                    let beside =
                        [cell[0] + offset % 3, cell[1] + offset / 3 % 3, cell[2] + offset / 9];
                    // The cells of the sample itself are not at the sides of the cube.
                    let bit = Self::bit(beside.map(|at| at.saturating_sub(1)));
                    passing.near[bit / 64] |= 1 << (bit % 64);
                }
            }
        }
        passing.sample = sample;
        passing
    }

    /// The cell of a position, counted from one beside the box of the sample.
    fn cell(&self, position: &[f64; 3]) -> Option<[usize; 3]> {
        let at = [0, 1, 2].map(|axis| (position[axis] - self.low[axis]) * self.inverse_edge + 1.0);
        let is_inside = at.iter().all(|x| (0.0..(CELLS + 2) as f64).contains(x));
        is_inside.then(|| at.map(|x| x as usize))
    }

    fn bit([x, y, z]: [usize; 3]) -> usize {
        let side = CELLS + 2;
        (z.min(side - 1) * side + y.min(side - 1)) * side + x.min(side - 1)
    }

    fn see(&mut self, position: &[f64; 3]) {
        let bit = self.cell(position).map(Self::bit);
        if bit.is_some_and(|bit| self.near[bit / 64] >> (bit % 64) & 1 == 1) {
            let [low, high] = &mut self.bulk;
            for axis in 0..3 {
                low[axis] = low[axis].min(position[axis]);
                high[axis] = high[axis].max(position[axis]);
            }
        } else {
            self.far_count += 1;
            if self.far.len() < MOST_FAR {
                self.far.push(*position);
            }
        }
    }

    /// `None` where what lies far from the sample is too much to be stray.
    fn finish(self, points: u64) -> Option<Found> {
        if self.far_count > self.far.len() as u64 {
            return None;
        }
        let (near, first) = (self.sample.len(), self.sample.len() as u32);
        let all = [self.sample, self.far].concat();
        let strays = Strays::find(&all, self.origin);
        let [mut low, mut high] = self.bulk;
        let mut stray = strays.places.iter().copied().filter(|&at| at >= first).peekable();
        let mut found: Vec<[f64; 3]> = Vec::new();
        for (position, place) in all[near..].iter().zip(first..) {
            if stray.next_if_eq(&place).is_some() {
                found.push(*position);
                continue;
            }
            low = [0, 1, 2].map(|axis| low[axis].min(position[axis]));
            high = [0, 1, 2].map(|axis| high[axis].max(position[axis]));
        }
        let bulk = [low, high];
        let strays = Strays { bulk, ..strays };
        let farthest = found.iter().map(|p| strays.distance(p)).fold(0.0, f64::max);
        let apart = (!found.is_empty()).then(|| Apart {
            count: found.len() as u64,
            is_counted: false,
            of: points,
            farthest,
            size: size_of(bulk),
            is_volume: false,
            is_drawn: false,
            filter: (farthest > 0.0).then(|| filter(0, bulk)),
        });
        Some(Found { bulk, apart })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 300 000 points of a wavy sheet with a few far off, in one place and in several, and a cluster of twenty.
    #[test]
    fn a_sample_finds_the_strays_that_all_positions_have() {
        let mut points: Vec<[f64; 3]> = (0..300_000)
            .map(|i| {
                let (x, y) = (f64::from(i % 600) / 100.0, f64::from(i / 600) / 100.0);
                [4e5 + x, 5e6 + y, (3.0 * x).sin() + y.cos()]
            })
            .collect();
        let sheet = crate::bounds_of([&points[..]]).unwrap();
        points.insert(77, [0.0; 3]);
        points.insert(177_000, [4e5, 5e6, 1e9]);
        points.extend([[4e5 + 20.0, 5e6, 0.0]; 5]);
        points.extend((0..20).map(|i| [4e5 + 60.0 + 0.01 * f64::from(i), 5e6, 0.0]));
        let mut distinct = Distinct::new();
        points.iter().for_each(|p| distinct.see(p));
        assert!(!distinct.sample_is_whole());
        let mut bulk = Bulk::of_distinct(&distinct);
        // A file that is begun again is seen anew.
        bulk.see(&points[..1000]);
        bulk.begin_again();
        bulk.see(&points);
        let found = bulk.finish(points.len() as u64, sheet);
        let expected = Bulk::of(&points).finish(points.len() as u64, sheet);
        assert_eq!(found.bulk, expected.bulk);
        assert_eq!(found.bulk[1][0], 4e5 + 60.0 + 0.01 * 19.0, "the cluster is no stray");
        let apart = found.apart.unwrap();
        assert!(!apart.is_counted);
        assert_eq!(Some(Apart { is_counted: true, ..apart }), expected.apart);
    }
}
