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
    /// Of shadow rays, where light passes surfaces.
    shadow_paths: Buffer,
    /// The number of each of them.
    every_ray: Buffer,
    tally: Buffer,
}

impl WaveBuffers {
    /// For so many rays. Where no surface `scatters` there is no next wave.
    pub fn new(
        device: &Arc<Device>,
        rays: u32,
        scatters: bool,
        light_passes: bool,
    ) -> Result<Self, GpuError> {
        let of = |name, count: u32, size: usize| {
            Buffer::new(device, name, u64::from(count) * size as u64)
        };
        let next = if scatters { rays } else { 1 };
        let passing = if light_passes { rays } else { 1 };
        let every_ray: Vec<u32> = (0..passing).collect();
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
            shadow_paths: of("shadow paths", passing, size_of::<Path>())?,
            every_ray: Buffer::from_slice(device, "list of shadow rays", &every_ray)?,
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

    /// Where the media of shadow rays are, and the list of their places among them: the paths of the wave, or, where light
    /// passes surfaces, which changes them, their own.
    pub fn shadow_media(&self, light_passes: bool) -> [&Buffer; 2] {
        match light_passes {
            false => [self.paths(), &self.lit_rays],
            true => [&self.shadow_paths, &self.every_ray],
        }
    }

    /// What shadow rays are inside, where light passes surfaces.
    pub fn shadow_paths(&self) -> &Buffer {
        &self.shadow_paths
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
