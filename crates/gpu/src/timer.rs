//! GPU time of each pass, by two timestamps around it.
//!
//! Both are written when everything before them is done, so a pass is not charged for the one
//! before it. Query pools of a fixed size are added as a recording grows and kept for the next;
//! there is no limit on the number of passes.

use crate::device::Device;
use crate::error::GpuError;
use ash::vk;
use std::sync::Arc;

/// Passes that share a query pool.
const POOL_PASSES: usize = 128;
const POOL_QUERIES: u32 = 2 * POOL_PASSES as u32;

/// The timestamps of one recording.
pub(crate) struct Timer {
    pools: Vec<vk::QueryPool>,
    /// Passes begun in this recording.
    count: usize,
    device: Arc<Device>,
}

impl Timer {
    pub(crate) fn new(device: &Arc<Device>) -> Self {
        Self { pools: Vec::new(), count: 0, device: Arc::clone(device) }
    }

    /// Whether the queue has timestamps; if not, nothing is recorded.
    pub(crate) fn is_available(&self) -> bool {
        self.device.timestamp_mask != 0
    }

    /// Records the timestamp before the next pass.
    ///
    /// # Safety
    /// `commands` is of this timer's device, in the recording state, in the recording since
    /// [`clear`](Self::clear), and no pass is between `begin` and `end`.
    pub(crate) unsafe fn begin(&mut self, commands: vk::CommandBuffer) -> Result<(), GpuError> {
        if !self.is_available() {
            return Ok(());
        }
        let raw = &self.device.raw;
        let (pool, query) = (self.count / POOL_PASSES, (2 * (self.count % POOL_PASSES)) as u32);
        if pool == self.pools.len() {
            let info = vk::QueryPoolCreateInfo::default()
                .query_type(vk::QueryType::TIMESTAMP)
                .query_count(POOL_QUERIES);
            // SAFETY: the queue family has timestamps.
            let pool = unsafe { raw.create_query_pool(&info, None) }
                .map_err(GpuError::call("vkCreateQueryPool", "timer"))?;
            self.device.set_name(pool, "timer");
            self.pools.push(pool);
        }
        let pool = self.pools[pool];
        // SAFETY: as the caller promises; a pool is reset before the first of its queries, and
        // each query is written once in a recording.
        unsafe {
            if query == 0 {
                raw.cmd_reset_query_pool(commands, pool, 0, POOL_QUERIES);
            }
            let stage = vk::PipelineStageFlags::BOTTOM_OF_PIPE;
            raw.cmd_write_timestamp(commands, stage, pool, query);
        }
        Ok(())
    }

    /// Records the timestamp after the pass.
    ///
    /// # Safety
    /// As for [`begin`](Self::begin), which was called before.
    pub(crate) unsafe fn end(&mut self, commands: vk::CommandBuffer) {
        if !self.is_available() {
            return;
        }
        let pool = self.pools[self.count / POOL_PASSES];
        let query = (2 * (self.count % POOL_PASSES) + 1) as u32;
        let stage = vk::PipelineStageFlags::BOTTOM_OF_PIPE;
        // SAFETY: as the caller promises; the query after the one `begin` wrote.
        unsafe { self.device.raw.cmd_write_timestamp(commands, stage, pool, query) };
        self.count += 1;
    }

    /// Milliseconds of each pass, in the order of their beginnings. Call it when the recording
    /// has been executed and waited for.
    pub(crate) fn read(&self) -> Result<Vec<f64>, GpuError> {
        let mask = self.device.timestamp_mask;
        let milliseconds = f64::from(self.device.limits().timestamp_period) / 1e6;
        let mut times = Vec::with_capacity(self.count);
        let mut stamps = [[0_u64; 2]; POOL_PASSES];
        for &pool in &self.pools {
            let passes = (self.count - times.len()).min(POOL_PASSES);
            if passes == 0 {
                break;
            }
            let stamps = &mut stamps[..passes];
            let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
            // SAFETY: the first `2 * passes` queries of the pool were written by the recording,
            // and there is room for 64 bits of each.
            unsafe {
                let stamps = stamps.as_flattened_mut();
                self.device.raw.get_query_pool_results(pool, 0, stamps, flags)
            }
            .map_err(GpuError::call("vkGetQueryPoolResults", "timer"))?;
            // Timestamps wrap around where they have fewer than 64 bits.
            let elapsed = |&[begin, end]: &[u64; 2]| end.wrapping_sub(begin) & mask;
            times.extend(stamps.iter().map(|stamp| elapsed(stamp) as f64 * milliseconds));
        }
        Ok(times)
    }

    /// Forgets the recording.
    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }
}

impl Drop for Timer {
    fn drop(&mut self) {
        for &pool in &self.pools {
            // SAFETY: created by this device; the recorder that owns the timer waited for every
            // submission, so no pending work refers to it.
            unsafe { self.device.raw.destroy_query_pool(pool, None) };
        }
    }
}
