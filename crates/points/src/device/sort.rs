//! Stable sort of (key, slot) pairs by key, least digit first: the passes `sort_count` and
//! `sort_scatter` with a scan between them.

use super::{line, scan::Scan};
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{
    DIGIT_BITS, RUN_LENGTH, SORT_HISTOGRAM, SORT_KEYS_IN, SORT_KEYS_OUT, SORT_SLOTS_IN,
    SORT_SLOTS_OUT, SortParams,
};
use kernels::spirv;
use std::sync::Arc;

/// Keys and what travels with them.
pub(crate) struct Pairs {
    pub keys: Buffer,
    pub slots: Buffer,
}

impl Pairs {
    pub fn new(device: &Arc<Device>, count: u32) -> Result<Self, GpuError> {
        Ok(Self {
            keys: Buffer::new(device, "pair keys", u64::from(count) * 4)?,
            slots: Buffer::new(device, "pair slots", u64::from(count) * 4)?,
        })
    }
}

pub(crate) struct Sort {
    count: Kernel,
    scatter: Kernel,
}

impl Sort {
    pub fn new(device: &Arc<Device>) -> Result<Self, GpuError> {
        let all = [SORT_KEYS_IN, SORT_SLOTS_IN, SORT_HISTOGRAM, SORT_KEYS_OUT, SORT_SLOTS_OUT]
            .map(|binding| (binding, Binding::StorageBuffer));
        let counted = [all[0], all[2]];
        let params = size_of::<SortParams>();
        Ok(Self {
            count: Kernel::new(device, "sort_count", &spirv::sort_count(), &counted, params)?,
            scatter: Kernel::new(device, "sort_scatter", &spirv::sort_scatter(), &all, params)?,
        })
    }

    /// Sorts `pairs`, whose keys are at most `largest`; returns them, as another object.
    pub fn run(
        &self,
        device: &Arc<Device>,
        rec: &mut Recorder,
        scan: &Scan,
        pairs: Pairs,
        count: u32,
        largest: u32,
    ) -> Result<Pairs, GpuError> {
        let runs = count.div_ceil(RUN_LENGTH);
        let entries = runs << DIGIT_BITS;
        let histogram = Buffer::new(device, "sort histogram", u64::from(entries) * 4)?;
        let levels = Scan::levels(device, entries)?;
        let (mut from, mut to) = (pairs, Pairs::new(device, count)?);
        for shift in (0..u32::BITS - largest.leading_zeros()).step_by(DIGIT_BITS as usize) {
            let params = SortParams { count, shift, runs };
            rec.fill(&histogram, 0, u64::from(entries) * 4, 0);
            rec.pass("sort_count", &self.count)
                .buffer(SORT_KEYS_IN, &from.keys)
                .buffer(SORT_HISTOGRAM, &histogram)
                .push(&params)
                .dispatch(line(runs));
            scan.record(rec, &histogram, entries, &levels);
            rec.pass("sort_scatter", &self.scatter)
                .buffer(SORT_KEYS_IN, &from.keys)
                .buffer(SORT_SLOTS_IN, &from.slots)
                .buffer(SORT_HISTOGRAM, &histogram)
                .buffer(SORT_KEYS_OUT, &to.keys)
                .buffer(SORT_SLOTS_OUT, &to.slots)
                .push(&params)
                .dispatch(line(runs));
            std::mem::swap(&mut from, &mut to);
        }
        Ok(from)
    }
}
