//! The passes `mark_live` and `list_live`.

use super::line;
use crate::state::{RayLoop, StoredRays, Touch};
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{LIVE_OFFSETS, LIVE_RAYS, TraceParams};
use kernels::spirv;
use points::device::Scan;
use std::sync::Arc;

/// Lists the rays of a wave that have not ended, so that a pass over few of them costs little.
pub(crate) struct ListLive {
    mark: Kernel,
    list: Kernel,
    scan: Scan,
    offsets: Buffer,
    levels: Vec<Buffer>,
    /// The rays, as [`ListLive::record`] listed them last.
    pub rays: Buffer,
}

impl ListLive {
    pub const NAME: &'static str = "list_live";
    pub const MARK: &'static str = "mark_live";

    /// For waves of so many rays.
    pub fn new(device: &Arc<Device>, rays: u32, form: RayLoop) -> Result<Self, GpuError> {
        let params = size_of::<TraceParams>();
        let mut bindings = form.bindings(Touch::Reads);
        bindings.push((LIVE_OFFSETS, Binding::StorageBuffer));
        let mark = Kernel::new(
            device,
            Self::MARK,
            &form.module(spirv::mark_live, spirv::mark_live_queue),
            &bindings,
            params,
        )?;
        let bindings = [LIVE_OFFSETS, LIVE_RAYS].map(|at| (at, Binding::StorageBuffer));
        Ok(Self {
            mark,
            list: Kernel::new(device, Self::NAME, &spirv::list_live(), &bindings, params)?,
            scan: Scan::new(device)?,
            offsets: Buffer::new(device, "live offsets", (u64::from(rays) + 1) * 4)?,
            levels: Scan::levels(device, rays + 1)?,
            rays: Buffer::new(device, "list of live rays", u64::from(rays) * 4)?,
        })
    }

    /// Records the list of a wave's live rays; `params` has all of the wave's.
    pub fn record(&self, rec: &mut Recorder, state: &StoredRays, params: &TraceParams) {
        state
            .bind_read(rec.pass(Self::MARK, &self.mark))
            .buffer(LIVE_OFFSETS, &self.offsets)
            .push(params)
            .dispatch(line(params.ray_count));
        rec.fill(&self.offsets, u64::from(params.ray_count) * 4, 4, 0);
        self.scan.record(rec, &self.offsets, params.ray_count + 1, &self.levels);
        rec.pass(Self::NAME, &self.list)
            .buffer(LIVE_OFFSETS, &self.offsets)
            .buffer(LIVE_RAYS, &self.rays)
            .push(params)
            .dispatch(line(params.ray_count));
    }
}
