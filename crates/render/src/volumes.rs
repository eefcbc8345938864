//! The volumes of a scene on a device.

use gpu::{Buffer, Device, GpuError};
use kernels::layout::{IsoSearch, March, MarchLight, VOLUME_LIGHTS};
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
    /// What steps of each ray end with in each volume.
    pub ends: Buffer,
    /// Beside the marches, where volumes are lit.
    pub march_lights: Buffer,
    /// What of each light's reaches each point, where volumes are lit.
    pub visible: Buffer,
    /// How far the rays of a wave have looked for isosurfaces.
    pub searches: Buffer,
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
        let of = |name, needed: bool, count: u64, size: usize| {
            Buffer::new(device, name, if needed { count } else { 1 } * size as u64)
        };
        let rays = u64::from(rays);
        let (lit, points) = (volumes.any_lit(), volumes.points.len() as u64);
        let count = volumes.infos.len() as u64;
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
            marches: of("marches", true, rays, size_of::<March>())?,
            ends: of("ends of steps", true, rays * count, if lit { 16 } else { 4 })?,
            march_lights: of("light of marches", lit, rays, size_of::<MarchLight>())?,
            visible: of("visible lights", lit, points, 4 * VOLUME_LIGHTS as usize)?,
            searches: of("searches", volumes.any_isosurface(), rays, size_of::<IsoSearch>())?,
        }))
    }
}
