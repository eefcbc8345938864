//! GPU time of each pass, by timestamps around it.
//!
//! A timestamp is written when everything before it is done. The one after a pass serves as the
//! one before the next, so times of consecutive passes add up to the whole and the barrier
//! between two is charged to the second; a fill or copy between them is charged to neither.
//! Query pools of a fixed size are added as a recording grows and kept for the next; there is no
//! limit on the number of passes.

use crate::device::Device;
use crate::error::GpuError;
use ash::vk;
use std::sync::Arc;

/// Timestamps of one query pool.
const POOL_STAMPS: usize = 256;

/// The timestamps of one recording.
pub(crate) struct Timer {
    pools: Vec<vk::QueryPool>,
    /// Timestamps recorded.
    stamps: usize,
    /// The two timestamps of each pass.
    passes: Vec<[usize; 2]>,
    /// The last timestamp, if no command came after it.
    latest: Option<usize>,
    is_on: bool,
    device: Arc<Device>,
}

impl Timer {
    /// On, if the queue has timestamps.
    pub(crate) fn new(device: &Arc<Device>) -> Self {
        let mut timer = Self {
            pools: Vec::new(),
            stamps: 0,
            passes: Vec::new(),
            latest: None,
            is_on: false,
            device: Arc::clone(device),
        };
        timer.turn(true);
        timer
    }

    /// Turns timing off, or on where the queue has timestamps. Call it between recordings.
    pub(crate) fn turn(&mut self, on: bool) {
        self.is_on = on && self.device.timestamp_mask != 0;
    }

    /// Records what comes before a pass.
    ///
    /// # Safety
    /// `commands` is of this timer's device, in the recording state, and the same since
    /// [`clear`](Self::clear).
    pub(crate) unsafe fn begin(&mut self, commands: vk::CommandBuffer) -> Result<(), GpuError> {
        if self.is_on && self.latest.is_none() {
            // SAFETY: as the caller promises.
            self.latest = Some(unsafe { self.stamp(commands)? });
        }
        Ok(())
    }

    /// Records what comes after the pass.
    ///
    /// # Safety
    /// As for [`begin`](Self::begin).
    pub(crate) unsafe fn end(&mut self, commands: vk::CommandBuffer) -> Result<(), GpuError> {
        if let Some(begin) = self.latest {
            // SAFETY: as the caller promises.
            let end = unsafe { self.stamp(commands)? };
            self.passes.push([begin, end]);
            self.latest = Some(end);
        }
        Ok(())
    }

    /// Notes that something other than a pass was recorded.
    pub(crate) fn interrupt(&mut self) {
        self.latest = None;
    }

    /// Records one timestamp and returns its number.
    ///
    /// # Safety
    /// As for [`begin`](Self::begin).
    unsafe fn stamp(&mut self, commands: vk::CommandBuffer) -> Result<usize, GpuError> {
        let raw = &self.device.raw;
        let (pool, query) = (self.stamps / POOL_STAMPS, self.stamps % POOL_STAMPS);
        if pool == self.pools.len() {
            let info = vk::QueryPoolCreateInfo::default()
                .query_type(vk::QueryType::TIMESTAMP)
                .query_count(POOL_STAMPS as u32);
            // SAFETY: the queue family has timestamps, or the timer would be off.
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
                raw.cmd_reset_query_pool(commands, pool, 0, POOL_STAMPS as u32);
            }
            let stage = vk::PipelineStageFlags::BOTTOM_OF_PIPE;
            raw.cmd_write_timestamp(commands, stage, pool, query as u32);
        }
        self.stamps += 1;
        Ok(self.stamps - 1)
    }

    /// Milliseconds of each pass, in the order of recording. Call it when the recording has been
    /// executed and waited for.
    pub(crate) fn read(&self) -> Result<Vec<f64>, GpuError> {
        let mut stamps = vec![0_u64; self.stamps];
        for (&pool, stamps) in self.pools.iter().zip(stamps.chunks_mut(POOL_STAMPS)) {
            let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
            // SAFETY: as many queries of the pool, from its first, were written by the recording,
            // and there is room for 64 bits of each.
            unsafe { self.device.raw.get_query_pool_results(pool, 0, stamps, flags) }
                .map_err(GpuError::call("vkGetQueryPoolResults", "timer"))?;
        }
        let mask = self.device.timestamp_mask;
        let step = f64::from(self.device.limits().timestamp_period) / 1e6;
        // Timestamps wrap around where they have fewer than 64 bits.
        let elapsed = |&[begin, end]: &[usize; 2]| stamps[end].wrapping_sub(stamps[begin]) & mask;
        Ok(self.passes.iter().map(|pass| elapsed(pass) as f64 * step).collect())
    }

    /// Forgets the recording.
    pub(crate) fn clear(&mut self) {
        self.stamps = 0;
        self.passes.clear();
        self.latest = None;
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
