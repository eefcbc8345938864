//! The pass `smooth_sizes`.

use super::line;
use super::search::SearchSpace;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder, Texel};
use kernels::layout::{SMOOTH_LISTS, SMOOTH_POINTS, SMOOTH_REACHES, SMOOTH_SIZES, SmoothParams};
use kernels::spirv;
use std::sync::Arc;

/// Feature sizes as means over neighbours: a round over all points of an object, then another.
pub(crate) struct SmoothSizes {
    kernel: Kernel,
    reaches: Buffer,
}

impl SmoothSizes {
    pub const NAME: &'static str = "smooth_sizes";

    /// For scenes of so many points; `texels`: they are read through a texel buffer.
    pub fn new(device: &Arc<Device>, points: u64, texels: bool) -> Result<Self, GpuError> {
        let read =
            if texels { Binding::UniformTexelBuffer(Texel::Four) } else { Binding::StorageBuffer };
        let bindings = [
            (SMOOTH_POINTS, read),
            (SMOOTH_LISTS, Binding::StorageBuffer),
            (SMOOTH_REACHES, Binding::StorageBuffer),
            (SMOOTH_SIZES, Binding::StorageBuffer),
        ];
        let module = if texels { spirv::smooth_sizes_texels() } else { spirv::smooth_sizes() };
        let params = size_of::<SmoothParams>();
        Ok(Self {
            kernel: Kernel::new(device, Self::NAME, &module, &bindings, params)?,
            reaches: Buffer::new(device, "reaches", 4 * points)?,
        })
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
        rec.pass(Self::NAME, &self.kernel)
            .buffer(SMOOTH_POINTS, points)
            .buffer(SMOOTH_LISTS, &space.lists)
            .buffer(SMOOTH_REACHES, &self.reaches)
            .buffer(SMOOTH_SIZES, sizes)
            .push(&SmoothParams { first_slot, point_count, stride: space.stride(), round })
            .dispatch(line(point_count));
    }
}
