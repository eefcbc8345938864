//! The pass `smooth_sizes`.

use super::line;
use super::search::SearchSpace;
use gpu::{Buffer, Device, GpuError, Recorder};
use kernels::layout::{NEIGHBORS, POINTS, REACHES, SIZES, SmoothParams};
use kernels::spirv::{self, Lists};
use std::sync::Arc;

/// Feature sizes as means over neighbours: a round over all points of an object, then another.
pub(crate) struct SmoothSizes {
    lists: Lists,
    reaches: Buffer,
}

impl SmoothSizes {
    /// For scenes of so many points; `lists`: how they are read.
    pub fn new(device: &Arc<Device>, points: u64, lists: Lists) -> Result<Self, GpuError> {
        Ok(Self { lists, reaches: Buffer::new(device, "reaches", 4 * points)? })
    }

    /// Records one round of `count` points from `first_slot` on, whose neighbours `space` holds. `sizes` is
    /// written in round 1.
    pub fn record(
        &self,
        rec: &mut Recorder,
        points: &Buffer,
        space: &SearchSpace,
        sizes: &Buffer,
        [first_slot, point_count, round]: [u32; 3],
    ) {
        rec.pass(spirv::smooth_sizes(self.lists))
            .buffer(POINTS, points)
            .buffer(NEIGHBORS, &space.lists)
            .buffer(REACHES, &self.reaches)
            .buffer(SIZES, sizes)
            .push(&SmoothParams { first_slot, point_count, stride: space.stride(), round })
            .dispatch(line(point_count));
    }
}
