//! Positions, each with a ball around it as far as its nearest neighbour known so far. Points that
//! come by make the balls smaller.
//!
//! A ball is entered in the cells of a grid that it touches. Grids have edges of powers of two, one
//! for each size of balls, so that a ball touches eight cells or so, however far others reach. The
//! cells share a table of fixed size: what is found there in vain costs time only.

use super::distance;
use std::collections::BTreeSet;

/// Bits of the number of a bucket.
const BUCKET_BITS: u32 = 16;
/// Words of the map of cells in use; it has eight bits a bucket.
const MAP_WORDS: usize = 1 << (BUCKET_BITS + 3 - 6);
/// Points after which the cells are made anew for the first time; after twice as many again, and so on.
const FIRST_RENEWAL: u64 = 1 << 14;
/// Exponents of edges: beyond, one over the edge, or what is multiplied by it, is no number.
const EXPONENTS: std::ops::RangeInclusive<i32> = -1000..=1000;

pub(super) struct Balls {
    centres: Vec<[f64; 3]>,
    /// Distance of each to the nearest point seen so far that lies elsewhere.
    distances: Vec<f64>,
    /// One over the edge of each grid, and what tells its cells from those of others.
    grids: Vec<(f64, u64)>,
    map: Vec<u64>,
    /// Where the balls of each bucket begin in `entries`, and the end of the last.
    starts: Vec<u32>,
    entries: Vec<u32>,
    seen: u64,
    renewal: u64,
}

impl Balls {
    /// No two centres are equal. `distances` are at least those to the nearest other.
    pub(super) fn new(centres: Vec<[f64; 3]>, distances: Vec<f64>) -> Self {
        Self {
            centres,
            distances,
            grids: Vec::new(),
            map: Vec::new(),
            starts: Vec::new(),
            entries: Vec::new(),
            seen: 0,
            renewal: 0,
        }
    }

    pub(super) fn see(&mut self, position: &[f64; 3]) {
        if self.seen == self.renewal {
            self.enter_cells();
            self.renewal = (2 * self.seen).max(FIRST_RENEWAL);
        }
        self.seen += 1;
        for &(scale, salt) in &self.grids {
            let cell = hash_of(position.map(|x| floor(x * scale)), salt);
            let bit = cell >> (64 - BUCKET_BITS - 3);
            if self.map[(bit >> 6) as usize] >> (bit & 63) & 1 == 0 {
                continue;
            }
            let bucket = (bit >> 3) as usize;
            let [start, end] = [bucket, bucket + 1].map(|place| self.starts[place] as usize);
            for &ball in &self.entries[start..end] {
                let (centre, nearest) =
                    (&self.centres[ball as usize], &mut self.distances[ball as usize]);
                let found = distance(centre, position);
                if found < *nearest && centre != position {
                    *nearest = found;
                }
            }
        }
    }

    #[cfg(test)]
    pub(super) fn centres(&self) -> &[[f64; 3]] {
        &self.centres
    }

    pub(super) fn into_distances(self) -> Vec<f64> {
        self.distances
    }

    /// Enters all balls, as large as they are now, in the cells that they touch.
    fn enter_cells(&mut self) {
        // The edge is at least the diameter.
        let exponent = |distance: f64| {
            let exponent = (2.0 * distance).log2().ceil() as i32;
            exponent.clamp(*EXPONENTS.start(), *EXPONENTS.end())
        };
        let exponents: BTreeSet<i32> = self.distances.iter().map(|&d| exponent(d)).collect();
        let grid_of = |exponent: i32| (2f64.powi(-exponent), exponent as u64);
        self.grids = exponents.into_iter().map(grid_of).collect();
        let mut touched: Vec<(u64, u32)> = Vec::new();
        for (ball, (centre, &distance)) in (0..).zip(self.centres.iter().zip(&self.distances)) {
            let (scale, salt) = grid_of(exponent(distance));
            let [low, high] =
                [-distance, distance].map(|reach| centre.map(|x| floor((x + reach) * scale)));
            // Two cells an axis at most, or three where the ends are rounded.
            let cells = |axis: usize| low[axis]..=high[axis].min(low[axis].saturating_add(2));
            for x in cells(0) {
                for y in cells(1) {
                    for z in cells(2) {
                        let bit = hash_of([x, y, z], salt) >> (64 - BUCKET_BITS - 3);
                        touched.push((bit, ball));
                    }
                }
            }
        }
        touched.sort_unstable();
        touched.dedup();
        self.map = vec![0; MAP_WORDS];
        self.starts = vec![0; (1 << BUCKET_BITS) + 1];
        for &(bit, _) in &touched {
            self.map[(bit >> 6) as usize] |= 1 << (bit & 63);
            self.starts[(bit >> 3) as usize + 1] += 1;
        }
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        self.entries = touched.into_iter().map(|(_, ball)| ball).collect();
    }
}

/// The largest whole number that is not greater, or the nearest that the type has: in either case one
/// that does not descend where `x` ascends.
fn floor(x: f64) -> i64 {
    let towards_zero = x as i64;
    towards_zero.saturating_sub(i64::from(towards_zero as f64 > x))
}

fn hash_of(cell: [i64; 3], salt: u64) -> u64 {
    let [x, y, z] = cell.map(|coordinate| coordinate as u64);
    let mixed = (x.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ y).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    let mixed = (mixed ^ mixed >> 32 ^ z).wrapping_mul(0x1656_67b1_9e37_79f9);
    (mixed ^ mixed >> 29 ^ salt).wrapping_mul(0xd6e8_feb8_6659_fd93)
}
