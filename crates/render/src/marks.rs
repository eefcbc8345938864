//! Marks of rays, a bit each, and lists of those that have one: `count_marked`, scan, `list_marked`.

use gpu::{Buffer, Device, GpuError, Recorder};
use kernels::layout::{LIST_IN, LIVE_RAYS, MARK_OFFSETS, MARKS, MarkParams};
use kernels::spirv::{self, Module};
use points::device::{Scan, line};
use std::sync::Arc;

/// Marks a word.
const WORD: u32 = u32::BITS;

/// What becomes of each ray of a wave: a bit each, or two.
pub(crate) struct Marks {
    pub bits: Buffer,
    /// How many rays those of each word stand for; then where theirs begin, and after the last the total.
    pub offsets: Buffer,
    levels: Vec<Buffer>,
    /// 1: words go by two, and marks of the second count twice.
    pairs: u32,
}

impl Marks {
    /// For waves of so many rays.
    pub fn new(device: &Arc<Device>, rays: u32, in_pairs: bool) -> Result<Self, GpuError> {
        let words = rays.div_ceil(WORD);
        let of = |name, words: u32| Buffer::new(device, name, u64::from(words) * 4);
        let pairs = u32::from(in_pairs);
        Ok(Self {
            bits: of("marks", words * (pairs + 1))?,
            offsets: of("offsets of marks", words + 1)?,
            levels: Scan::levels(device, words + 1)?,
            pairs,
        })
    }

    /// What counting and listing takes.
    pub fn modules() -> Vec<&'static Module> {
        [&[spirv::count_marked(), spirv::list_marked()][..], &Scan::modules()].concat()
    }

    /// Records that no ray of so many has one.
    pub fn record_none(&self, rec: &mut Recorder, rays: u32) {
        rec.fill(&self.bits, 0, u64::from(rays.div_ceil(WORD) * (self.pairs + 1)) * 4, 0);
    }

    /// How many rays those of so many stand for, as [`Marks::record_offsets`] counted them.
    pub fn read_total(&self, rays: u32) -> Result<u32, GpuError> {
        let mut total = [0];
        self.offsets.read(u64::from(rays.div_ceil(WORD)) * 4, &mut total)?;
        Ok(total[0])
    }

    /// Records how many of so many rays have a mark, and where those of each word begin.
    pub fn record_offsets(&self, rec: &mut Recorder, rays: u32) {
        let params = MarkParams { words: rays.div_ceil(WORD), pairs: self.pairs, listed: 0 };
        rec.fill(&self.offsets, u64::from(params.words) * 4, 4, 0);
        rec.pass(spirv::count_marked())
            .buffer(MARKS, &self.bits)
            .buffer(MARK_OFFSETS, &self.offsets)
            .push(&params)
            .dispatch(line(params.words));
        Scan::record(rec, &self.offsets, params.words + 1, &self.levels);
    }

    /// Records the same, and the list of those that do: of the rays of a wave, or of those of the list `from`.
    pub fn record_list(&self, rec: &mut Recorder, rays: u32, from: Option<&Buffer>, list: &Buffer) {
        self.record_offsets(rec, rays);
        let words = rays.div_ceil(WORD);
        rec.pass(spirv::list_marked())
            .buffer(MARKS, &self.bits)
            .buffer(MARK_OFFSETS, &self.offsets)
            .buffer(LIST_IN, from.unwrap_or(&self.bits))
            .buffer(LIVE_RAYS, list)
            .push(&MarkParams { words, pairs: 0, listed: u32::from(from.is_some()) })
            .dispatch(line(words));
    }
}
