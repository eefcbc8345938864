//! What the rays of a wave have beside their state: paths, classes, light.

use crate::passes::Marks;
use gpu::{Buffer, Device, GpuError};
use kernels::layout::{LightSum, LitHit, Path};
use std::sync::Arc;

/// What is counted on the device.
const TALLIED: usize = 2;

/// One entry a ray, unless said otherwise.
pub(crate) struct WaveBuffers {
    /// This wave's, and the next one's.
    paths: [Buffer; 2],
    /// Of rays that hit a diffuse surface.
    pub lit: Marks,
    lit_rays: Buffer,
    lit_hits: Buffer,
    /// Of rays that hit another.
    pub scattering: Marks,
    scattering_rays: Buffer,
    /// Of the rays of the next wave.
    pub next: Marks,
    light_sums: Buffer,
    tally: Buffer,
}

impl WaveBuffers {
    /// For so many rays. Where no surface `scatters` there is no next wave.
    pub fn new(device: &Arc<Device>, rays: u32, scatters: bool) -> Result<Self, GpuError> {
        let of = |name, count: u32, size: usize| {
            Buffer::new(device, name, u64::from(count) * size as u64)
        };
        let next = if scatters { rays } else { 1 };
        Ok(Self {
            paths: [
                of("paths", rays, size_of::<Path>())?,
                of("next paths", next, size_of::<Path>())?,
            ],
            lit: Marks::new(device, rays, false)?,
            lit_rays: of("list of lit rays", rays, 4)?,
            lit_hits: of("lit hits", rays, size_of::<LitHit>())?,
            scattering: Marks::new(device, next, false)?,
            scattering_rays: of("list of scattering rays", next, 4)?,
            next: Marks::new(device, next, true)?,
            light_sums: of("light sums", rays, size_of::<LightSum>())?,
            tally: of("tally of rays", TALLIED as u32, 4)?,
        })
    }

    /// This wave's paths.
    pub fn paths(&self) -> &Buffer {
        &self.paths[0]
    }

    /// The next wave's paths.
    pub fn next_paths(&self) -> &Buffer {
        &self.paths[1]
    }

    /// The rays that hit a diffuse surface.
    pub fn lit_rays(&self) -> &Buffer {
        &self.lit_rays
    }

    /// Where each did, by ray.
    pub fn lit_hits(&self) -> &Buffer {
        &self.lit_hits
    }

    /// The rays that hit another.
    pub fn scattering_rays(&self) -> &Buffer {
        &self.scattering_rays
    }

    /// One a diffuse hit.
    pub fn light_sums(&self) -> &Buffer {
        &self.light_sums
    }

    /// Hits that sent no ray to a light, and reflected rays.
    pub fn tally(&self) -> &Buffer {
        &self.tally
    }

    /// The next wave is this one.
    pub fn swap(&mut self) {
        self.paths.swap(0, 1);
    }

    /// Hits that sent no ray to a light, and reflected rays, since the tally was zero.
    pub fn read_tally(&self) -> Result<[u64; TALLIED], GpuError> {
        let mut counts = [0u32; TALLIED];
        self.tally.read(0, &mut counts)?;
        Ok(counts.map(u64::from))
    }
}
