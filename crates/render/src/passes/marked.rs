//! The passes `count_marked` and `list_marked`.

use super::line;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{LIVE_OFFSETS, LIVE_RAYS, MarkParams, WAVE_MARKS};
use kernels::spirv;
use points::device::Scan;
use std::sync::Arc;

/// Marks a word.
const MARKS: u32 = 32;

/// Lists the rays of a wave that have a mark, in order.
pub(crate) struct ListMarked {
    count: Kernel,
    list: Kernel,
    scan: Scan,
    offsets: Buffer,
    levels: Vec<Buffer>,
    /// One bit a ray.
    pub marks: Buffer,
}

impl ListMarked {
    pub const COUNT: &'static str = "count_marked";
    pub const NAME: &'static str = "list_marked";

    /// For waves of so many rays.
    pub fn new(device: &Arc<Device>, rays: u32) -> Result<Self, GpuError> {
        let params = size_of::<MarkParams>();
        let kernel = |name, module: &[u32], bindings: &[u32]| {
            let bindings: Vec<(u32, Binding)> =
                bindings.iter().map(|&at| (at, Binding::StorageBuffer)).collect();
            Kernel::new(device, name, module, &bindings, params)
        };
        let words = rays.div_ceil(MARKS);
        let of = |name, words: u32| Buffer::new(device, name, u64::from(words) * 4);
        let counted = [WAVE_MARKS, LIVE_OFFSETS];
        let listed = [WAVE_MARKS, LIVE_OFFSETS, LIVE_RAYS];
        Ok(Self {
            count: kernel(Self::COUNT, &spirv::count_marked(), &counted)?,
            list: kernel(Self::NAME, &spirv::list_marked(), &listed)?,
            scan: Scan::new(device)?,
            offsets: of("offsets of marked rays", words + 1)?,
            levels: Scan::levels(device, words + 1)?,
            marks: of("marks", words)?,
        })
    }

    /// Records that no ray of so many has a mark.
    pub fn record_none(&self, rec: &mut Recorder, rays: u32) {
        rec.fill(&self.marks, 0, u64::from(rays.div_ceil(MARKS)) * 4, 0);
    }

    /// Records the list of those of so many rays that have one.
    pub fn record(&self, rec: &mut Recorder, rays: u32, list: &Buffer) {
        let params = MarkParams { words: rays.div_ceil(MARKS) };
        rec.fill(&self.offsets, u64::from(params.words) * 4, 4, 0);
        rec.pass(Self::COUNT, &self.count)
            .buffer(WAVE_MARKS, &self.marks)
            .buffer(LIVE_OFFSETS, &self.offsets)
            .push(&params)
            .dispatch(line(params.words));
        self.scan.record(rec, &self.offsets, params.words + 1, &self.levels);
        rec.pass(Self::NAME, &self.list)
            .buffer(WAVE_MARKS, &self.marks)
            .buffer(LIVE_OFFSETS, &self.offsets)
            .buffer(LIVE_RAYS, list)
            .push(&params)
            .dispatch(line(params.words));
    }

    /// How many of so many rays [`ListMarked::record`] listed.
    pub fn read_count(&self, rays: u32) -> Result<u32, GpuError> {
        let mut total = [0];
        self.offsets.read(u64::from(rays.div_ceil(MARKS)) * 4, &mut total)?;
        Ok(total[0])
    }
}
