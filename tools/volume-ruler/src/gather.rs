//! The scalars at eight even places along a ray, of one volume: the points near the way are sought eight at a time, kept side
//! by side, and then weighed at all places by recurrences (docs/method.md, Eq. 14a), again eight at a time.

use crate::cells::Cells;
use kernels::layout::VolumeInfo;

pub const PLACES: usize = 8;
/// A weight of a power of two below this does not matter.
const LEAST_WEIGHT: f32 = -115.415_6;
const LEAST_POWER: f32 = -126.0;
/// What rounding may move a point by, in cells.
const MARGIN: f32 = 2e-3;
/// What recurrences may move a square by, in squares of all that a point may be away.
const WIDER: f32 = 4e-6;

/// Places along a ray, from the first of a block, and which of them are asked for.
#[derive(Clone, Copy)]
pub struct Block {
    pub first: [f32; 3],
    pub direction: [f32; 3],
    pub step: f32,
    /// How far along from the first place those begin that are asked for.
    pub from: f32,
    /// And end.
    pub to: f32,
    /// How much farther than a point's reach the blocks of other rays are away, for which points are sought as well.
    pub wider: f32,
}

/// Points side by side: three coordinates, and the scalars.
#[derive(Default)]
pub struct Points {
    lists: [Vec<f32>; 4],
    count: usize,
}

/// Points near a way: their distances along it and their squares of distance from the first place, and the scalars.
#[derive(Default)]
pub struct Near {
    lists: [Vec<f32>; 3],
    count: usize,
}

/// Room for more, and for eight that are written at once.
fn reserve<const N: usize>(lists: &mut [Vec<f32>; N], needed: usize) {
    if lists[0].len() < needed + 2 * PLACES {
        lists.iter_mut().for_each(|list| list.resize(2 * (needed + PLACES), 0.0));
    }
}

/// What was done.
#[derive(Debug, Clone, Copy, Default)]
pub struct Counts {
    /// Places whose scalar was asked for.
    pub samples: u64,
    /// Points measured against the ways of a packet of rays.
    pub sought: u64,
    /// Points measured against the way of a ray's block.
    pub read: u64,
    /// Of these, those near it.
    pub near: u64,
    /// Pairs of a point and a place in its reach.
    pub weighed: u64,
}

impl Counts {
    pub fn add(&mut self, other: Self) {
        self.samples += other.samples;
        self.sought += other.sought;
        self.read += other.read;
        self.near += other.near;
        self.weighed += other.weighed;
    }
}

/// Calls `visit` with each run of points that the way's reach may meet.
#[inline(always)]
fn for_each_run(
    info: &VolumeInfo,
    cells: &Cells,
    block: &Block,
    mut visit: impl FnMut(usize, usize),
) {
    let inverse = cells.inverse_edge;
    let reach = (info.square_radius.sqrt() + block.wider) * inverse + MARGIN;
    let begin = [0, 1, 2].map(|i| (block.first[i] - cells.origin[i]) * inverse);
    let along = block.direction.map(|d| d * inverse);
    let divisor = along.map(|d| 1.0 / if d.abs() < 1e-20 { 1e-20 } else { d });
    let ends = [block.from, block.to].map(|t| [0, 1, 2].map(|i| begin[i] + t * along[i]));
    let last = cells.resolution.map(|n| n as f32 - 1.0);
    let cell = |at: f32, i: usize| at.max(0.0).min(last[i]) as usize;
    // Where the way is in reach of a row's cells, along one axis.
    let within = |i: usize, at: usize| {
        let a = (at as f32 - reach - begin[i]) * divisor[i];
        let b = (at as f32 + 1.0 + reach - begin[i]) * divisor[i];
        [a.min(b), a.max(b)]
    };
    let low = |i: usize| cell(ends[0][i].min(ends[1][i]) - reach, i);
    let high = |i: usize| cell(ends[0][i].max(ends[1][i]) + reach, i);
    for z in low(2)..=high(2) {
        let [z_enters, z_leaves] = within(2, z);
        let (z_enters, z_leaves) = (z_enters.max(block.from), z_leaves.min(block.to));
        for y in low(1)..=high(1) {
            let [enters, leaves] = within(1, y);
            let (enters, leaves) = (enters.max(z_enters), leaves.min(z_leaves));
            if enters > leaves {
                continue;
            }
            let (a, b) = (begin[0] + enters * along[0], begin[0] + leaves * along[0]);
            let row = cells.resolution[0] * (y + cells.resolution[1] * z);
            let start = cells.first[row + cell(a.min(b) - reach, 0)];
            let end = cells.first[row + cell(a.max(b) + reach, 0) + 1];
            if start < end {
                visit(start as usize, end as usize);
            }
        }
    }
}

/// Numbers that both ways of weighing begin with.
struct Width {
    /// Of weights as powers of two.
    power: f32,
    /// Of the factor from place to place.
    twice: f32,
    /// Squares of distances that the search takes in.
    wide: f32,
}

impl Width {
    fn of(info: &VolumeInfo, block: &Block) -> Self {
        let power = -info.inverse_width * std::f32::consts::LOG2_E;
        let reach = info.square_radius.sqrt() + block.wider;
        let farthest = reach + block.to;
        Self {
            power,
            twice: -2.0 * power * block.step,
            wide: reach * reach + WIDER * (farthest * farthest),
        }
    }
}

/// Numerators and denominators at the places, in plain Rust.
pub fn plain(
    info: &VolumeInfo,
    cells: &Cells,
    block: &Block,
    counts: &mut Counts,
) -> [[f32; PLACES]; 2] {
    let width = Width::of(info, block);
    let mut sums = [[0.0; PLACES]; 2];
    for_each_run(info, cells, block, |start, end| {
        counts.read += (end - start) as u64;
        for i in start..end {
            let off = [cells.x[i], cells.y[i], cells.z[i]];
            let off = [0, 1, 2].map(|k| off[k] - block.first[k]);
            let along: f32 = (0..3).map(|k| off[k] * block.direction[k]).sum();
            let mut square: f32 = off.iter().map(|x| x * x).sum();
            let t = along.max(block.from).min(block.to);
            if square + t * (t - 2.0 * along) > width.wide {
                continue;
            }
            counts.near += 1;
            let power = width.power * square;
            let mut weight = if power < LEAST_WEIGHT { 0.0 } else { power.max(LEAST_POWER).exp2() };
            let ratio = (width.twice * along).clamp(LEAST_POWER, -LEAST_POWER).exp2();
            let mut more = block.step * block.step - 2.0 * block.step * along;
            for k in 0..PLACES {
                if square <= info.square_radius {
                    counts.weighed += 1;
                    sums[0][k] += weight * cells.scalar[i];
                    sums[1][k] += weight;
                }
                weight *= ratio;
                square += more;
                more += 2.0 * block.step * block.step;
            }
        }
    });
    sums
}

#[cfg(target_arch = "x86_64")]
pub mod avx2 {
    use super::{
        Block, Counts, LEAST_POWER, LEAST_WEIGHT, Near, PLACES, Points, Width, for_each_run,
        reserve,
    };
    use crate::cells::Cells;
    use kernels::layout::VolumeInfo;
    use std::arch::x86_64::*;

    /// For each mask, the lanes that it has, first to last.
    static LANES: [[i32; 8]; 256] = lanes();

    const fn lanes() -> [[i32; 8]; 256] {
        let mut table = [[0; 8]; 256];
        let mut mask = 0;
        while mask < 256 {
            let (mut lane, mut count) = (0, 0);
            while lane < 8 {
                if mask >> lane & 1 == 1 {
                    table[mask][count] = lane;
                    count += 1;
                }
                lane += 1;
            }
            mask += 1;
        }
        table
    }

    /// 2^x for −126 ≤ x ≤ 126, within three units in the last place.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    #[allow(clippy::approx_constant, reason = "a fitted polynomial's")]
    fn power_of_two(x: __m256) -> __m256 {
        let n = _mm256_round_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(x);
        let r = _mm256_sub_ps(x, n);
        let square = _mm256_mul_ps(r, r);
        let s = |x: f32| _mm256_set1_ps(x);
        let low = _mm256_fmadd_ps(r, s(6.931_47e-1), s(1.0));
        let middle = _mm256_fmadd_ps(r, s(5.550_733_6e-2), s(2.402_224_2e-1));
        let high = _mm256_fmadd_ps(r, s(1.326_472_5e-3), s(9.671_513e-3));
        let p = _mm256_fmadd_ps(square, _mm256_fmadd_ps(square, high, middle), low);
        let bits = _mm256_slli_epi32::<23>(_mm256_cvtps_epi32(n));
        _mm256_castsi256_ps(_mm256_add_epi32(_mm256_castps_si256(p), bits))
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn sum_of(x: __m256) -> f32 {
        let four = _mm_add_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps::<1>(x));
        let two = _mm_add_ps(four, _mm_movehl_ps(four, four));
        _mm_cvtss_f32(_mm_add_ss(two, _mm_movehdup_ps(two)))
    }

    /// Eight numbers of a list in each lane.
    type Eight = __m256;

    /// Eight points about the first place of a block.
    struct About {
        x: [Eight; 3],
        along: Eight,
        square: Eight,
        /// Those that are near the way.
        mask: usize,
    }

    /// Numbers of a block in all lanes.
    struct Lanes {
        first: [Eight; 3],
        direction: [Eight; 3],
        from: Eight,
        to: Eight,
        wide: Eight,
    }

    impl Lanes {
        #[inline]
        #[target_feature(enable = "avx2,fma")]
        fn of(block: &Block, wide: f32) -> Self {
            Self {
                first: block.first.map(|x| _mm256_set1_ps(x)),
                direction: block.direction.map(|x| _mm256_set1_ps(x)),
                from: _mm256_set1_ps(block.from),
                to: _mm256_set1_ps(block.to),
                wide: _mm256_set1_ps(wide),
            }
        }

        /// Of `count` points, or more.
        ///
        /// # Safety
        /// Eight numbers can be read from each place.
        #[inline]
        #[target_feature(enable = "avx2,fma")]
        unsafe fn about(&self, lists: [*const f32; 3], count: usize) -> About {
            // SAFETY: as the caller says.
            let x = lists.map(|list| unsafe { _mm256_loadu_ps(list) });
            let off = [0, 1, 2].map(|i| _mm256_sub_ps(x[i], self.first[i]));
            let along = _mm256_mul_ps(off[0], self.direction[0]);
            let along = _mm256_fmadd_ps(off[1], self.direction[1], along);
            let along = _mm256_fmadd_ps(off[2], self.direction[2], along);
            let square = _mm256_fmadd_ps(off[1], off[1], _mm256_mul_ps(off[0], off[0]));
            let square = _mm256_fmadd_ps(off[2], off[2], square);
            let t = _mm256_min_ps(_mm256_max_ps(along, self.from), self.to);
            let way = _mm256_sub_ps(t, _mm256_add_ps(along, along));
            let least = _mm256_fmadd_ps(t, way, square);
            let mask = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(least, self.wide)) as usize;
            let mask = if count < 8 { mask & ((1 << count) - 1) } else { mask };
            About { x, along, square, mask }
        }
    }

    /// Writes the lanes of a mask to the ends of lists.
    ///
    /// # Safety
    /// The lists have eight places from there on.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn pack<const N: usize>(
        mask: usize,
        values: [Eight; N],
        lists: &mut [Vec<f32>; N],
        count: &mut usize,
    ) {
        // SAFETY: the table has a row for each mask; lists, as the caller says.
        unsafe {
            let order = _mm256_loadu_si256(LANES[mask].as_ptr().cast());
            for (list, values) in lists.iter_mut().zip(values) {
                _mm256_storeu_ps(
                    list.as_mut_ptr().add(*count),
                    _mm256_permutevar8x32_ps(values, order),
                );
            }
        }
        *count += mask.count_ones() as usize;
    }

    /// The points near the blocks of some rays; returns how many were measured.
    #[target_feature(enable = "avx2,fma")]
    pub fn points_near(
        info: &VolumeInfo,
        cells: &Cells,
        block: &Block,
        points: &mut Points,
    ) -> u64 {
        let lanes = Lanes::of(block, Width::of(info, block).wide);
        let mut read = 0;
        points.count = 0;
        for_each_run(info, cells, block, |start, end| {
            reserve(&mut points.lists, points.count + end - start);
            read += (end - start) as u64;
            for i in (start..end).step_by(8) {
                let lists = [&cells.x, &cells.y, &cells.z];
                // SAFETY: lists of cells have eight numbers after the last point; those of the points have room.
                unsafe {
                    let about = lanes.about(lists.map(|list| list.as_ptr().add(i)), end - i);
                    if about.mask != 0 {
                        let [x, y, z] = about.x;
                        let scalar = _mm256_loadu_ps(cells.scalar.as_ptr().add(i));
                        pack(about.mask, [x, y, z, scalar], &mut points.lists, &mut points.count);
                    }
                }
            }
        });
        read
    }

    /// Numerators and denominators at the places. With `COUNTS` it says what was done.
    #[target_feature(enable = "avx2,fma")]
    pub fn sums<const COUNTS: bool>(
        info: &VolumeInfo,
        points: &Points,
        block: &Block,
        near: &mut Near,
        counts: &mut Counts,
    ) -> [[f32; PLACES]; 2] {
        let width = Width::of(info, block);
        let lanes = Lanes::of(block, width.wide);
        near.count = 0;
        reserve(&mut near.lists, points.count);
        let [x, y, z, scalars] = &points.lists;
        for i in (0..points.count).step_by(8) {
            // SAFETY: lists of points have eight numbers after the last; those of what is near have room for all.
            unsafe {
                let about =
                    lanes.about([x, y, z].map(|list| list.as_ptr().add(i)), points.count - i);
                if about.mask != 0 {
                    let scalar = _mm256_loadu_ps(scalars.as_ptr().add(i));
                    let values = [about.along, about.square, scalar];
                    pack(about.mask, values, &mut near.lists, &mut near.count);
                }
            }
        }
        if COUNTS {
            counts.read += points.count as u64;
            counts.near += near.count as u64;
        }
        if near.count == 0 {
            return [[0.0; PLACES]; 2];
        }
        // Behind the last, points that are in reach of nothing.
        for lane in near.count..near.count + PLACES {
            [near.lists[0][lane], near.lists[1][lane], near.lists[2][lane]] = [0.0, f32::MAX, 0.0];
        }
        let s = |x: f32| _mm256_set1_ps(x);
        let (step, zero) = (block.step, _mm256_setzero_ps());
        let square_radius = s(info.square_radius);
        let bend = s(2.0 * step * step);
        let (mut numerators, mut denominators) = ([zero; PLACES], [zero; PLACES]);
        let mut i = 0;
        while i < near.count {
            // SAFETY: the lists have at least eight places after the last point that is near.
            let [along, mut square, scalar] = unsafe {
                [0, 1, 2].map(|of: usize| _mm256_loadu_ps(near.lists[of].as_ptr().add(i)))
            };
            let power = _mm256_mul_ps(square, s(width.power));
            let matters = _mm256_cmp_ps::<_CMP_GE_OQ>(power, s(LEAST_WEIGHT));
            let mut weight =
                _mm256_and_ps(matters, power_of_two(_mm256_max_ps(power, s(LEAST_POWER))));
            let ratio = _mm256_mul_ps(along, s(width.twice));
            let ratio = _mm256_min_ps(_mm256_max_ps(ratio, s(LEAST_POWER)), s(-LEAST_POWER));
            let ratio = power_of_two(ratio);
            let mut more = _mm256_fnmadd_ps(along, s(2.0 * step), s(step * step));
            for k in 0..PLACES {
                let within = _mm256_cmp_ps::<_CMP_LE_OQ>(square, square_radius);
                if COUNTS {
                    counts.weighed += u64::from(_mm256_movemask_ps(within).count_ones());
                }
                let here = _mm256_and_ps(within, weight);
                denominators[k] = _mm256_add_ps(denominators[k], here);
                numerators[k] = _mm256_fmadd_ps(here, scalar, numerators[k]);
                weight = _mm256_mul_ps(weight, ratio);
                square = _mm256_add_ps(square, more);
                more = _mm256_add_ps(more, bend);
            }
            i += 8;
        }
        [numerators.map(|x| sum_of(x)), denominators.map(|x| sum_of(x))]
    }
}
