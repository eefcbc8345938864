//! Memory order: points along a Hilbert curve.
//!
//! Neighbours in space are neighbours in memory, and places that follow each other lie close together, which the
//! neighbour search of a device lives by. Points that share a place of the curve are sorted along a finer one
//! through their own box, so that a far outlier spoils nothing.

use kernels::layout::Point;
use rayon::prelude::*;

/// Bits an axis of a place on the curve.
const CURVE_BITS: u32 = 21;
/// So few points that share a place on a curve are sorted by their coordinates.
const UNSORTED: usize = 8;
/// Points that one thread takes at once.
const PART: usize = 1 << 14;

/// Sorts places in `points` (the second number of each) along a Hilbert curve through the cube around them, and those that it does not
/// tell apart along another through theirs. Points that coincide come one after another, in the order of the file.
pub(crate) fn sort_along_curve(points: &[Point], places: &mut [(u64, u32)]) {
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
    if extent <= f32::MIN_POSITIVE {
        places.par_sort_unstable_by_key(|place| (key_of(position(place)), place.1));
        return;
    }
    let scale = f64::from((1u32 << CURVE_BITS) - 1) / f64::from(extent);
    places.par_chunks_mut(PART).flat_map_iter(|part| part.chunks_mut(AT_ONCE)).for_each(|few| {
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
    });
    places.par_sort_unstable();
    let runs = places.chunk_by_mut(|a, b| a.0 == b.0).filter(|run| run.len() > 1);
    runs.for_each(|run| match run.len() <= UNSORTED {
        true => run.sort_unstable_by_key(|place| (key_of(position(place)), place.1)),
        false => sort_along_curve(points, run),
    });
}

/// Whether two positions are one. (A negative zero is a zero.)
pub(crate) fn is_copy(a: [f32; 3], b: [f32; 3]) -> bool {
    a == b
}

/// Equal where positions are.
pub(crate) fn key_of(position: [f32; 3]) -> [u32; 3] {
    position.map(|x| (x + 0.0).to_bits())
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
}
