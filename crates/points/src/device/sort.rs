//! Stable sort of (key, slot) pairs by key, least digit first: the passes `sort_count` and
//! `sort_scatter` with a scan between them.

use super::{line, scan::Scan};
use gpu::{Buffer, Device, GpuError, Recorder};
use kernels::layout::{
    DIGIT_BITS, RUN_LENGTH, SORT_HISTOGRAM, SORT_KEYS_IN, SORT_KEYS_OUT, SORT_SLOTS_IN,
    SORT_SLOTS_OUT, SortParams,
};
use kernels::spirv::{self, Module};
use std::sync::Arc;

/// Keys and what travels with them.
#[derive(Debug)]
pub struct Pairs {
    /// What is sorted by.
    pub keys: Buffer,
    /// A point's slot for each key.
    pub slots: Buffer,
}

impl Pairs {
    /// Space for `count` pairs.
    ///
    /// # Errors
    /// A device without the memory, or too many for one binding.
    pub fn new(device: &Arc<Device>, count: u32) -> Result<Self, GpuError> {
        Ok(Self {
            keys: Buffer::new(device, "pair keys", u64::from(count) * 4)?,
            slots: Buffer::new(device, "pair slots", u64::from(count).next_multiple_of(4) * 4)?,
        })
    }
}

/// Space to sort pairs in, kept from one sort to the next.
#[derive(Debug)]
pub struct SortSpace {
    spare: Pairs,
    histogram: Buffer,
    levels: Vec<Buffer>,
}

impl SortSpace {
    /// Space to sort at most `count` pairs.
    ///
    /// # Errors
    /// A device without the memory, or too many for one binding.
    pub fn new(device: &Arc<Device>, count: u32) -> Result<Self, GpuError> {
        let entries = count.div_ceil(RUN_LENGTH) << DIGIT_BITS;
        Ok(Self {
            spare: Pairs::new(device, count)?,
            histogram: Buffer::new(device, "sort histogram", u64::from(entries) * 4)?,
            levels: Scan::levels(device, entries)?,
        })
    }
}

/// Sorts pairs by key.
#[derive(Debug)]
pub struct Sort;

impl Sort {
    /// What it takes.
    #[must_use]
    pub fn modules() -> [&'static Module; 2] {
        [spirv::sort_count(), spirv::sort_scatter()]
    }

    /// Records the sort of the first `count` of `pairs`, whose keys are at most `largest`. The
    /// buffers of `pairs` and the space change places.
    pub fn record(
        rec: &mut Recorder,
        pairs: &mut Pairs,
        space: &mut SortSpace,
        count: u32,
        largest: u32,
    ) {
        let runs = count.div_ceil(RUN_LENGTH);
        // As few rounds as digits of DIGIT_BITS need, and digits no wider than these rounds do.
        let key_bits = (u32::BITS - largest.leading_zeros()).max(1);
        let bits = key_bits.div_ceil(key_bits.div_ceil(DIGIT_BITS));
        let entries = runs << bits;
        let SortSpace { spare, histogram, levels } = space;
        // Slots are read four at a time, also behind the last.
        let end = u64::from(count) * 4;
        for slots in [&pairs.slots, &spare.slots] {
            let rest = end.next_multiple_of(16).min(slots.bytes()) - end;
            if rest > 0 {
                rec.fill(slots, end, rest, 0);
            }
        }
        for shift in (0..key_bits).step_by(bits as usize) {
            let params = SortParams { count, shift, runs, bits };
            rec.fill(histogram, 0, u64::from(entries) * 4, 0);
            rec.pass(spirv::sort_count())
                .buffer(SORT_KEYS_IN, &pairs.keys)
                .buffer(SORT_HISTOGRAM, histogram)
                .push(&params)
                .dispatch(line(runs));
            Scan::record(rec, histogram, entries, levels);
            rec.pass(spirv::sort_scatter())
                .buffer(SORT_KEYS_IN, &pairs.keys)
                .buffer(SORT_SLOTS_IN, &pairs.slots)
                .buffer(SORT_HISTOGRAM, histogram)
                .buffer(SORT_KEYS_OUT, &spare.keys)
                .buffer(SORT_SLOTS_OUT, &spare.slots)
                .push(&params)
                .dispatch(line(runs));
            std::mem::swap(pairs, spare);
        }
    }
}
