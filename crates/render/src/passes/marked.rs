//! The passes `count_marked` and `list_marked`.

use super::line;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{LIST_IN, LIVE_OFFSETS, LIVE_RAYS, MarkParams, WAVE_MARKS};
use kernels::spirv;
use points::device::Scan;
use std::sync::Arc;

/// Marks a word.
const MARKS: u32 = 32;

/// What becomes of each ray of a wave: a bit each, or two.
pub(crate) struct Marks {
    pub bits: Buffer,
    /// How many rays those of each word stand for; then where theirs begin, and behind the last the total.
    pub offsets: Buffer,
    levels: Vec<Buffer>,
    /// 1: words go by two, and marks of the second count twice.
    pairs: u32,
}

impl Marks {
    /// For waves of so many rays.
    pub fn new(device: &Arc<Device>, rays: u32, in_pairs: bool) -> Result<Self, GpuError> {
        let words = rays.div_ceil(MARKS);
        let of = |name, words: u32| Buffer::new(device, name, u64::from(words) * 4);
        let pairs = u32::from(in_pairs);
        Ok(Self {
            bits: of("marks", words * (pairs + 1))?,
            offsets: of("offsets of marks", words + 1)?,
            levels: Scan::levels(device, words + 1)?,
            pairs,
        })
    }

    /// Records that no ray of so many has one.
    pub fn record_none(&self, rec: &mut Recorder, rays: u32) {
        rec.fill(&self.bits, 0, u64::from(rays.div_ceil(MARKS) * (self.pairs + 1)) * 4, 0);
    }

    /// How many rays those of so many stand for, as [`ListMarked::record_offsets`] counted them.
    pub fn read_total(&self, rays: u32) -> Result<u32, GpuError> {
        let mut total = [0];
        self.offsets.read(u64::from(rays.div_ceil(MARKS)) * 4, &mut total)?;
        Ok(total[0])
    }
}

/// Counts and lists the rays of a wave that have a mark, in order.
pub(crate) struct ListMarked {
    pub count: Kernel,
    pub list: Kernel,
    pub scan: Scan,
}

impl ListMarked {
    pub const COUNT: &'static str = "count_marked";
    pub const NAME: &'static str = "list_marked";

    pub fn new(device: &Arc<Device>) -> Result<Self, GpuError> {
        let params = size_of::<MarkParams>();
        let kernel = |name, module: &[u32], bindings: &[u32]| {
            let bindings: Vec<(u32, Binding)> =
                bindings.iter().map(|&at| (at, Binding::StorageBuffer)).collect();
            Kernel::new(device, name, module, &bindings, params)
        };
        let counted = [WAVE_MARKS, LIVE_OFFSETS];
        let listed = [WAVE_MARKS, LIVE_OFFSETS, LIST_IN, LIVE_RAYS];
        Ok(Self {
            count: kernel(Self::COUNT, &spirv::count_marked(), &counted)?,
            list: kernel(Self::NAME, &spirv::list_marked(), &listed)?,
            scan: Scan::new(device)?,
        })
    }

    /// Records how many of so many rays have a mark, and where those of each word begin.
    pub fn record_offsets(&self, rec: &mut Recorder, marks: &Marks, rays: u32) {
        let params = MarkParams { words: rays.div_ceil(MARKS), pairs: marks.pairs, listed: 0 };
        rec.fill(&marks.offsets, u64::from(params.words) * 4, 4, 0);
        rec.pass(Self::COUNT, &self.count)
            .buffer(WAVE_MARKS, &marks.bits)
            .buffer(LIVE_OFFSETS, &marks.offsets)
            .push(&params)
            .dispatch(line(params.words));
        self.scan.record(rec, &marks.offsets, params.words + 1, &marks.levels);
    }

    /// Records the same, and the list of those that do: of the rays of a wave, or of those of the list `from`.
    pub fn record(
        &self,
        rec: &mut Recorder,
        marks: &Marks,
        rays: u32,
        from: Option<&Buffer>,
        list: &Buffer,
    ) {
        self.record_offsets(rec, marks, rays);
        let params =
            MarkParams { words: rays.div_ceil(MARKS), pairs: 0, listed: u32::from(from.is_some()) };
        rec.pass(Self::NAME, &self.list)
            .buffer(WAVE_MARKS, &marks.bits)
            .buffer(LIVE_OFFSETS, &marks.offsets)
            .buffer(LIST_IN, from.unwrap_or(&marks.bits))
            .buffer(LIVE_RAYS, list)
            .push(&params)
            .dispatch(line(params.words));
    }
}
