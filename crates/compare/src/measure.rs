//! Numbers for how far values are apart.
//!
//! A [`Tally`] is what one look at all pairs of a channel finds, block by block on all cores. Sums of blocks are added
//! in the order of the picture, so that no result depends on the number of threads; and a histogram of the differences'
//! leading bits says which of them a second look has to sort for percentiles.

use crate::lanes::wide;
use crate::picture::{Plane, Rect};
use rayon::prelude::*;

/// The percentages for which [`Measures::percentiles`] has a value.
pub const PERCENTILES: [u32; 3] = [50, 95, 99];

/// Values of a block: its sums are added in order.
const BLOCK: usize = 1 << 16;
/// Bits of a difference, as f64, below those that choose its bin: the sign, the exponent and four more are left.
const BELOW_BINS: u32 = 48;
/// Bins of differences: none is negative.
const BINS: usize = 1 << (63 - BELOW_BINS);

/// How far two planes, or several pairs of planes together, are apart.
///
/// The difference of two values is |a − b|: 0 for equal infinities and for NaN on both sides, infinite
/// for NaN against a number and for anything finite against an infinity.
#[derive(Debug, Clone, PartialEq)]
pub struct Measures {
    /// How many pairs of values were compared.
    pub values: usize,
    /// How many of them differ.
    pub differing: usize,
    /// In how many of them one is NaN and the other is not.
    pub nan: usize,
    /// The largest difference.
    pub max_abs: f64,
    /// The mean of the differences.
    pub mean: f64,
    /// The root of the mean of their squares.
    pub rmse: f64,
    /// 20 log₁₀ (peak / rmse) in decibels: infinite for equal planes, minus infinity for an infinite
    /// difference.
    pub psnr: f64,
    /// 1, or the largest finite |value| of either plane if that is larger.
    pub peak: f64,
    /// For each of [`PERCENTILES`] the smallest difference that at least so many per cent do not
    /// exceed.
    pub percentiles: [f64; PERCENTILES.len()],
    /// Where the difference is largest: the first such place, row by row.
    pub worst: Worst,
}

/// A place with its two values.
#[derive(Debug, Clone, PartialEq)]
pub struct Worst {
    /// The channel.
    pub channel: String,
    /// Column, from the left edge of the display window.
    pub x: i64,
    /// Row, from its upper edge, downwards.
    pub y: i64,
    /// Value of the first picture.
    pub a: f64,
    /// Value of the second picture.
    pub b: f64,
}

/// What one look at two planes finds.
#[derive(Debug)]
pub struct Tally<'a> {
    channel: &'a str,
    planes: [&'a Plane; 2],
    region: Rect,
    sums: Sums,
    /// How many differences over 0 have these leading bits.
    bins: Vec<u64>,
}

/// What is counted and added up of a block, or of all.
#[derive(Debug, Clone, Copy)]
struct Sums {
    values: usize,
    differing: usize,
    nan: usize,
    sum: f64,
    squares: f64,
    peak: f64,
    /// The largest difference, and the place of the first that is so large.
    most: f64,
    at: usize,
}

/// The difference of two values, as [`Measures`] defines it.
#[must_use]
#[inline(always)]
pub fn difference(a: f64, b: f64) -> f64 {
    let both = a.is_nan() && b.is_nan();
    let one = a.is_nan() != b.is_nan();
    let apart = if a == b || both { 0.0 } else { (a - b).abs() };
    if one { f64::INFINITY } else { apart }
}

/// Rows of two planes, as f64.
#[derive(Default)]
struct Rows {
    a: Vec<f64>,
    b: Vec<f64>,
}

impl<'a> Tally<'a> {
    /// Looks at all pixels of a region that both planes have.
    pub(crate) fn of(channel: &'a str, planes: [&'a Plane; 2], region: Rect) -> Self {
        let blocks = blocks(region);
        let empty = || (vec![0u64; BINS], Vec::new(), Rows::default());
        let looked = blocks.into_par_iter().fold(empty, |(mut bins, mut all, mut rows), block| {
            let mut sums = Sums::EMPTY;
            for y in block.clone() {
                let first = (y - region.y) as usize * region.width as usize;
                match Plane::row(planes, region, y, &mut rows.a, &mut rows.b) {
                    true => sums.add_equal(&rows.a, first),
                    false => sums.add(&rows.a, &rows.b, first, &mut bins),
                }
            }
            all.push((block.start, sums));
            (bins, all, rows)
        });
        let (bins, mut all, _) =
            looked.reduce(empty, |(mut bins, mut all, rows), (more, others, _)| {
                for (count, more) in bins.iter_mut().zip(more) {
                    *count += more;
                }
                all.extend(others);
                (bins, all, rows)
            });
        all.sort_unstable_by_key(|(start, _)| *start);
        let sums = all.into_iter().fold(Sums::EMPTY, |sums, (_, block)| sums.and(block));
        Self { channel, planes, region, sums, bins }
    }

    /// Whether no pixel differs.
    #[must_use]
    pub fn is_equal(&self) -> bool {
        self.sums.differing == 0
    }

    /// The pixels that were looked at.
    #[must_use]
    pub fn region(&self) -> Rect {
        self.region
    }

    fn worst(&self) -> Worst {
        let Rect { x, y, width, .. } = self.region;
        let place = self.sums.at as i64;
        let [x, y] = [x + place % width, y + place / width];
        let [a, b] = self.planes.map(|plane| plane.at(x, y));
        Worst { channel: self.channel.to_owned(), x, y, a, b }
    }

    /// The differences of these bins.
    fn of_bins(&self, wanted: &[usize]) -> Vec<f64> {
        if wanted.iter().all(|&bin| self.bins[bin] == 0) {
            return Vec::new();
        }
        let found = blocks(self.region).into_par_iter().map_init(Rows::default, |rows, block| {
            let mut found = Vec::new();
            for y in block {
                if Plane::row(self.planes, self.region, y, &mut rows.a, &mut rows.b) {
                    continue;
                }
                let differences = rows.a.iter().zip(&rows.b).map(|(&a, &b)| difference(a, b));
                found.extend(differences.filter(|d| *d > 0.0 && wanted.contains(&bin_of(*d))));
            }
            found
        });
        found.collect::<Vec<_>>().concat()
    }
}

/// Rows of a region in groups of about [`BLOCK`] values.
fn blocks(region: Rect) -> Vec<std::ops::Range<i64>> {
    let rows = (BLOCK as i64 / region.width.max(1)).max(1);
    let end = region.y + region.height;
    let starts = (0..).map(|block| region.y + block * rows).take_while(|start| *start < end);
    starts.map(|start| start..(start + rows).min(end)).collect()
}

fn bin_of(difference: f64) -> usize {
    (difference.to_bits() >> BELOW_BINS) as usize
}

impl Sums {
    const EMPTY: Self = Self {
        values: 0,
        differing: 0,
        nan: 0,
        sum: 0.0,
        squares: 0.0,
        peak: 1.0,
        most: -1.0,
        at: 0,
    };

    /// A row of values that are the same on both sides, the first of them at this place.
    fn add_equal(&mut self, values: &[f64], first: usize) {
        if self.most < 0.0 {
            (self.most, self.at) = (0.0, first);
        }
        self.values += values.len();
        self.peak = wide(
            #[inline(always)]
            || peak(values, self.peak),
        );
    }

    fn add(&mut self, a: &[f64], b: &[f64], first: usize, bins: &mut [u64]) {
        self.values += a.len();
        self.peak = wide(
            #[inline(always)]
            || peak(b, peak(a, self.peak)),
        );
        for (place, (&a, &b)) in (first..).zip(a.iter().zip(b)) {
            let d = difference(a, b);
            if d > self.most {
                (self.most, self.at) = (d, place);
            }
            if d > 0.0 {
                self.sum += d;
                self.squares += d * d;
                self.differing += 1;
                self.nan += usize::from(a.is_nan() != b.is_nan());
                bins[bin_of(d)] += 1;
            }
        }
    }

    /// With those of what comes after.
    fn and(self, after: Self) -> Self {
        let (most, at) = match after.most > self.most {
            true => (after.most, after.at),
            false => (self.most, self.at),
        };
        Self {
            values: self.values + after.values,
            differing: self.differing + after.differing,
            nan: self.nan + after.nan,
            sum: self.sum + after.sum,
            squares: self.squares + after.squares,
            peak: self.peak.max(after.peak),
            most,
            at,
        }
    }
}

/// The largest finite |value|, if it is over `peak`.
#[inline(always)]
fn peak(values: &[f64], peak: f64) -> f64 {
    // Eight apart, so that they fit into registers side by side; a maximum is the same in any order.
    let mut lanes = [peak; 8];
    let (eights, rest) = values.as_chunks::<8>();
    let larger = |most: &mut f64, value: f64| {
        // What is infinite or no number does not become 0.
        let size = if value * 0.0 == 0.0 { value.abs() } else { 0.0 };
        *most = if size > *most { size } else { *most };
    };
    for eight in eights {
        for (most, &value) in lanes.iter_mut().zip(eight) {
            larger(most, value);
        }
    }
    for &value in rest {
        larger(&mut lanes[0], value);
    }
    lanes.into_iter().fold(peak, f64::max)
}

impl Measures {
    /// Of one channel, or of several together.
    ///
    /// # Panics
    /// Where there is no channel, or none has a pixel.
    #[must_use]
    pub fn of(tallies: &[&Tally<'_>]) -> Self {
        let mut worst: Option<&Tally<'_>> = None;
        let mut sums = Sums::EMPTY;
        for tally in tallies {
            if worst.is_none_or(|worst| tally.sums.most > worst.sums.most) {
                worst = Some(tally);
            }
            sums = sums.and(tally.sums);
        }
        let Some(worst) = worst.filter(|_| sums.values > 0) else {
            unreachable!("compare: no value to measure")
        };
        let count = sums.values as f64;
        let rmse = (sums.squares / count).sqrt();
        Self {
            values: sums.values,
            differing: sums.differing,
            nan: sums.nan,
            max_abs: sums.most,
            mean: sums.sum / count,
            rmse,
            psnr: if rmse > 0.0 { 20.0 * (sums.peak / rmse).log10() } else { f64::INFINITY },
            peak: sums.peak,
            percentiles: percentiles_of(tallies, &sums),
            worst: worst.worst(),
        }
    }
}

/// For each of [`PERCENTILES`] the smallest difference that at least so many per cent do not exceed: the nearest rank.
fn percentiles_of(tallies: &[&Tally<'_>], sums: &Sums) -> [f64; PERCENTILES.len()] {
    let equal = sums.values - sums.differing;
    // Of each rank that is no zero, its bin, and how many differences are before that bin's.
    let places = PERCENTILES.map(|percent| {
        let rank = (sums.values * percent as usize).div_ceil(100).max(1) - 1;
        let rank = rank.checked_sub(equal)?;
        let mut before = 0;
        for bin in 0..BINS {
            let here = tallies.iter().map(|tally| tally.bins[bin]).sum::<u64>() as usize;
            if rank < before + here {
                return Some((bin, rank - before));
            }
            before += here;
        }
        None
    });
    let wanted: Vec<usize> = places.iter().flatten().map(|(bin, _)| *bin).collect();
    let mut found: Vec<f64> = tallies.iter().flat_map(|tally| tally.of_bins(&wanted)).collect();
    found.par_sort_unstable_by(f64::total_cmp);
    places.map(|place| {
        let Some((bin, rank)) = place else { return 0.0 };
        let first = found.partition_point(|difference| bin_of(*difference) < bin);
        found[first + rank]
    })
}

/// For each of [`PERCENTILES`] the smallest of `values` that at least so many per cent do not exceed:
/// the nearest rank. There is at least one value, and none is NaN.
pub(crate) fn percentiles(values: &mut [f32]) -> [f32; PERCENTILES.len()] {
    let count = values.len();
    let (mut rest, mut before) = (values, 0);
    PERCENTILES.map(|percent| {
        // Each is at or after the one before, so only what lies there is looked at again.
        let rank = (count * percent as usize).div_ceil(100).max(1) - 1;
        let value = *rest.select_nth_unstable_by(rank - before, f32::total_cmp).1;
        rest = &mut std::mem::take(&mut rest)[rank - before..];
        before = rank;
        value
    })
}
