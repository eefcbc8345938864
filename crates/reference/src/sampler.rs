//! Twin of `glsl/shared/sampler.glsl`: the low-discrepancy numbers of a pixel's samples, from (pixel,
//! sample, seed) alone.
//!
//! The first two dimensions of Sobol's sequence, padded: each pair of numbers is its own copy of them,
//! shuffled and Owen-scrambled by hashes (Burley, Practical Hash-based Owen Scrambling, JCGT 2020).

use crate::real::Real;

/// Every bit depends on every bit.
fn mix_bits(x: u32) -> u32 {
    let x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    let x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

fn sample_key([column, row]: [u32; 2], seed: u32, dimension: u32) -> u32 {
    [dimension, row, column]
        .into_iter()
        .fold(mix_bits(seed.wrapping_add(0x9e37_79b9)), |key, next| {
            mix_bits(next.wrapping_add(key))
        })
}

/// Owen's scrambling of the binary digits: whether a digit flips depends on those before it.
fn owen_scramble(x: u32, key: u32) -> u32 {
    let mut x = x.reverse_bits().wrapping_add(key);
    for factor in [0x6c50_b47c, 0xb82f_1e52, 0xc7af_e638, 0x8d22_f6e6] {
        x ^= x.wrapping_mul(factor);
    }
    x.reverse_bits()
}

/// The second dimension of Sobol's sequence; the first is the index with its bits reversed.
fn sobol_second(index: u32) -> u32 {
    let mut x = index.reverse_bits();
    x ^= x << 16;
    x ^= (x & 0x00ff_00ff) << 8;
    x ^= (x & 0x0f0f_0f0f) << 4;
    x ^= (x & 0x3333_3333) << 2;
    x ^ ((x & 0x5555_5555) << 1)
}

/// In [0, 1): a float holds 24 bits.
fn unit_float<R: Real>(x: u32) -> R {
    R::of_u32(x >> 8) * R::of(1.0 / 16_777_216.0)
}

/// One number in [0, 1).
#[must_use]
pub fn sample_1d<R: Real>(pixel: [u32; 2], sample_index: u32, seed: u32, dimension: u32) -> R {
    let key = sample_key(pixel, seed, dimension);
    let index = owen_scramble(sample_index, key);
    unit_float(owen_scramble(index.reverse_bits(), mix_bits(key.wrapping_add(1))))
}

/// A place in the unit square.
#[must_use]
pub fn sample_2d<R: Real>(pixel: [u32; 2], sample_index: u32, seed: u32, dimension: u32) -> [R; 2] {
    let key = sample_key(pixel, seed, dimension);
    let index = owen_scramble(sample_index, key);
    [
        unit_float(owen_scramble(index.reverse_bits(), mix_bits(key.wrapping_add(1)))),
        unit_float(owen_scramble(sobol_second(index), mix_bits(key.wrapping_add(2)))),
    ]
}

/// Of a pixel's place in a block that shares a sequence.
const BLOCK_BITS: u32 = 7;

/// The bits of a number below 2¹⁶, with a 0 above each.
fn spread_bits(x: u32) -> u32 {
    let x = (x | (x << 8)) & 0x00ff_00ff;
    let x = (x | (x << 4)) & 0x0f0f_0f0f;
    let x = (x | (x << 2)) & 0x3333_3333;
    (x | (x << 1)) & 0x5555_5555
}

/// Which sequence, in place of a pixel, and which of its samples the sample of a pixel is, of at most 2^`bits`, where the
/// pixels of a block share one: along a curve of quadrants within quadrants, so that what one pixel lacks its
/// neighbours have (Ahmed and Wonka 2020).
#[must_use]
pub fn shared_sample(pixel: [u32; 2], index: u32, bits: u32) -> ([u32; 2], u32) {
    let [x, y] = pixel.map(|at| spread_bits(at & ((1 << BLOCK_BITS) - 1)));
    (pixel.map(|at| at >> BLOCK_BITS), ((x | (y << 1)) << bits) | index)
}

/// The unit disc from the unit square, areas kept, (½, ½) to the very centre (Shirley and Chiu 1997).
#[must_use]
pub fn concentric_disc<R: Real>(u: [R; 2]) -> [R; 2] {
    let a = u.map(|u| R::of(2.0) * u - R::of(1.0));
    let wide = a[0].abs() > a[1].abs();
    let (radius, other) = if wide { (a[0], a[1]) } else { (a[1], a[0]) };
    let divisor = if radius != R::of(0.0) { radius } else { R::of(1.0) };
    let angle = R::of(std::f64::consts::FRAC_PI_4) * (other / divisor);
    let (along, across) = (radius * angle.cos_octant(), radius * angle.sin_octant());
    if wide { [along, across] } else { [across, along] }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PIXELS: [[u32; 2]; 4] = [[0, 0], [1, 0], [319, 207], [16_383, 16_383]];
    const DIMENSIONS: [u32; 4] = [0, 1, 2, 4097];

    /// Sobol's second dimension by its direction numbers: v₀ = ½, v = v ⊕ v/2.
    #[test]
    fn the_second_dimension_is_sobols() {
        for index in (0..4096).chain([0x8000_0000, 0xdead_beef, u32::MAX]) {
            let (mut sum, mut direction) = (0, 1u32 << 31);
            for bit in 0..32 {
                sum ^= if index >> bit & 1 == 1 { direction } else { 0 };
                direction ^= direction >> 1;
            }
            assert_eq!(sobol_second(index), sum, "{index}");
        }
    }

    /// The samples of each quadrant of a block, of 2, 4, … pixels a side, are a (0, 2)-net: one in each of the intervals.
    #[test]
    fn neighbours_share_a_net() {
        for side in [1, 2, 4] {
            let (k, bits) = (2 * u32::ilog2(side) + 2, 2);
            let mut samples: Vec<[f64; 2]> = Vec::new();
            for at in 0..side * side {
                let pixel = [384 + 4 * side + at % side, 128 + 8 * side + at / side];
                samples.extend((0..4).map(|i| {
                    let (block, index) = shared_sample(pixel, i, bits);
                    sample_2d::<f64>(block, index, 7, 4097)
                }));
            }
            for columns in (0..=k).map(|a| 1u32 << a) {
                let rows = (1u32 << k) / columns;
                let mut seen = vec![false; 1 << k];
                for [x, y] in &samples {
                    let cell =
                        (x * f64::from(columns)) as u32 * rows + (y * f64::from(rows)) as u32;
                    assert!(!std::mem::replace(&mut seen[cell as usize], true), "{side}");
                }
            }
        }
    }

    /// A (0, 2)-sequence: of the first 2^k samples, one lies in each of the 2^k intervals of 2^-a by
    /// 2^-(k - a), for every a.
    #[test]
    fn every_elementary_interval_has_one_sample() {
        for (pixel, dimension) in PIXELS.into_iter().zip(DIMENSIONS) {
            for k in 0..=10 {
                let samples: Vec<[f64; 2]> =
                    (0..1 << k).map(|i| sample_2d(pixel, i, 7, dimension)).collect();
                for columns in (0..=k).map(|a| 1u32 << a) {
                    let rows = (1u32 << k) / columns;
                    let mut seen = vec![false; 1 << k];
                    for [x, y] in &samples {
                        let at = |u: f64, parts: u32| (u * f64::from(parts)) as usize;
                        let cell = at(*y, rows) * columns as usize + at(*x, columns);
                        assert!(!seen[cell], "{pixel:?}, {dimension}: 2^{k}, {columns} columns");
                        seen[cell] = true;
                    }
                }
                let mut places: Vec<u32> = (0..1 << k)
                    .map(|i| (sample_1d::<f64>(pixel, i, 7, dimension) * f64::from(1 << k)) as u32)
                    .collect();
                places.sort_unstable();
                assert!(places.into_iter().eq(0..1 << k), "one number: {pixel:?}, 2^{k}");
            }
        }
    }

    /// Numbers of one sample over many pixels, or of many seeds, are as even and as unrelated as random
    /// ones: mean ½ and correlation 0, both within 5 standard deviations.
    #[test]
    fn pixels_seeds_and_dimensions_are_unrelated() {
        type Numbers = fn(u32) -> [f64; 2];
        let neighbors: [(&str, Numbers, Numbers); 4] = [
            ("columns", |i| sample_2d([i, 3], 0, 0, 0), |i| sample_2d([i + 1, 3], 0, 0, 0)),
            ("rows", |i| sample_2d([5, i], 3, 1, 0), |i| sample_2d([5, i + 1], 3, 1, 0)),
            ("seeds", |i| sample_2d([9, 9], 1, i, 0), |i| sample_2d([9, 9], 1, i + 1, 0)),
            ("dimensions", |i| sample_2d([i, 0], 2, 0, 0), |i| sample_2d([i, 0], 2, 0, 1)),
        ];
        let count = 20_000;
        for (name, here, there) in neighbors {
            for (axis, other) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let pairs = (0..count).map(|i| (here(i)[axis] - 0.5, there(i)[other] - 0.5));
                let (mut sum, mut product) = (0.0, 0.0);
                for (a, b) in pairs {
                    sum += a;
                    product += a * b;
                }
                let mean = sum / f64::from(count);
                // A uniform number has variance 1/12.
                let correlation = 12.0 * product / f64::from(count);
                let deviation = 1.0 / f64::from(count).sqrt();
                assert!(mean.abs() < 5.0 * deviation / 12f64.sqrt(), "{name}: mean {mean}");
                assert!(correlation.abs() < 5.0 * deviation, "{name}: correlation {correlation}");
            }
        }
    }

    #[test]
    fn numbers_are_below_one_and_the_same_in_both_precisions() {
        assert_eq!(unit_float::<f32>(u32::MAX), 1.0 - 2f32.powi(-24));
        for i in 0..1000 {
            let single = sample_2d::<f32>([i, 2 * i], i, 3, 1);
            assert_eq!(single.map(f64::from), sample_2d::<f64>([i, 2 * i], i, 3, 1));
        }
    }

    /// The centre goes to the centre, edges to the rim, and areas are kept: of an even grid, the share
    /// r² lies within radius r, and the angles are even.
    #[test]
    fn the_disc_is_covered_evenly() {
        assert_eq!(concentric_disc([0.5f32, 0.5]), [0.0, 0.0]);
        let n = 400;
        let (mut inside, mut quadrants) = ([0u32; 4], [0u32; 4]);
        for i in 0..n * n {
            let u = [i % n, i / n].map(|k| (f64::from(k) + 0.5) / f64::from(n));
            let [x, y] = concentric_disc(u);
            let square = x * x + y * y;
            assert!(square <= 1.0 + 1e-12);
            for (ring, r) in [0.25, 0.5, 0.75, 0.9].into_iter().enumerate() {
                inside[ring] += u32::from(square < r * r);
            }
            // Eighths of the circle, two by two.
            let eighth = (y.atan2(x) / std::f64::consts::FRAC_PI_4).floor() as i32;
            quadrants[eighth.rem_euclid(4) as usize] += 1;
            let [edge, _] = concentric_disc([1.0, u[1]]);
            assert!(edge >= 0.5f64.sqrt() - 1e-12);
        }
        // A square of side r n has its border within a cell: 4 r n of n² cells at most.
        for (count, r) in inside.into_iter().zip([0.25, 0.5, 0.75, 0.9]) {
            let share = f64::from(count) / f64::from(n * n);
            assert!((share - r * r).abs() < 4.0 * r / f64::from(n), "{share} within {r}");
        }
        for count in quadrants {
            assert!((f64::from(count) / f64::from(n * n) - 0.25).abs() < 2.0 / f64::from(n));
        }
    }
}
