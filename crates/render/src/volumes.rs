//! The volumes of a scene on a device.

use gpu::{Buffer, Device, GpuError};
use kernels::layout::March;
use plan::Volumes;
use std::sync::Arc;

/// One buffer each, and how far the rays of a wave have marched.
pub(crate) struct VolumeBuffers {
    pub infos: Buffer,
    pub cells: Buffer,
    pub points: Buffer,
    pub inverse_lengths: Buffer,
    pub stops: Buffer,
    pub marches: Buffer,
}

impl VolumeBuffers {
    /// For waves of so many rays; `None` where a scene has no volume.
    pub fn new(
        device: &Arc<Device>,
        volumes: &Volumes,
        rays: u32,
    ) -> Result<Option<Self>, GpuError> {
        if volumes.infos.is_empty() {
            return Ok(None);
        }
        let bytes = u64::from(rays) * size_of::<March>() as u64;
        Ok(Some(Self {
            infos: Buffer::from_slice(device, "volumes", &volumes.infos)?,
            cells: Buffer::from_slice(device, "volume cells", &volumes.cells)?,
            points: Buffer::from_slice(device, "volume points", &volumes.points)?,
            inverse_lengths: Buffer::from_slice(
                device,
                "volume lengths",
                &volumes.inverse_lengths,
            )?,
            stops: Buffer::from_slice(device, "transfer functions", &volumes.stops)?,
            marches: Buffer::new(device, "marches", bytes)?,
        }))
    }
}
