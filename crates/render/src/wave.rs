//! What the rays of a wave have beside their state: paths, classes, light.

use gpu::{Buffer, Device, GpuError, Recorder};
use kernels::layout::{LightSum, LitHit, Path};
use points::device::Scan;
use std::sync::Arc;

/// Kinds of rays that are counted on the device.
const TALLIED: usize = 3;

/// One entry a ray, unless said otherwise.
pub(crate) struct WaveBuffers {
    /// This wave's, and the next one's.
    paths: [Buffer; 2],
    lit: Buffer,
    next: Buffer,
    lit_rays: Buffer,
    lit_hits: Buffer,
    light_sums: Buffer,
    tally: Buffer,
    levels: Vec<Buffer>,
}

impl WaveBuffers {
    /// For so many rays. Where no surface `scatters` there is no next wave.
    pub fn new(device: &Arc<Device>, rays: u32, scatters: bool) -> Result<Self, GpuError> {
        let of = |name, count: u64, size: usize| Buffer::new(device, name, count * size as u64);
        let all = u64::from(rays);
        let next = if scatters { all } else { 1 };
        Ok(Self {
            paths: [
                of("paths", all, size_of::<Path>())?,
                of("next paths", next, size_of::<Path>())?,
            ],
            lit: of("lit rays", all + 1, 4)?,
            next: of("next rays", all + 1, 4)?,
            lit_rays: of("list of lit rays", all, 4)?,
            lit_hits: of("lit hits", all, size_of::<LitHit>())?,
            light_sums: of("light sums", all, size_of::<LightSum>())?,
            tally: of("tally of rays", TALLIED as u64, 4)?,
            levels: Scan::levels(device, rays + 1)?,
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

    /// Whether each ray hit a diffuse surface; then offsets of those that did.
    pub fn lit(&self) -> &Buffer {
        &self.lit
    }

    /// Rays of the next wave that each ray makes; then their offsets.
    pub fn next(&self) -> &Buffer {
        &self.next
    }

    /// The rays that hit a diffuse surface.
    pub fn lit_rays(&self) -> &Buffer {
        &self.lit_rays
    }

    /// Where each did, by ray.
    pub fn lit_hits(&self) -> &Buffer {
        &self.lit_hits
    }

    /// One a diffuse hit.
    pub fn light_sums(&self) -> &Buffer {
        &self.light_sums
    }

    /// Shadow, reflected and refracted rays.
    pub fn tally(&self) -> &Buffer {
        &self.tally
    }

    /// The next wave is this one.
    pub fn swap(&mut self) {
        self.paths.swap(0, 1);
    }

    /// Records the way from counts to offsets, with the total behind the last.
    pub fn record_offsets(&self, rec: &mut Recorder, scan: &Scan, counts: &Buffer, rays: u32) {
        rec.fill(counts, u64::from(rays) * 4, 4, 0);
        scan.record(rec, counts, rays + 1, &self.levels);
    }

    /// The total that [`WaveBuffers::record_offsets`] left.
    pub fn read_total(offsets: &Buffer, rays: u32) -> Result<u32, GpuError> {
        let mut total = [0];
        offsets.read(u64::from(rays) * 4, &mut total)?;
        Ok(total[0])
    }

    /// Shadow, reflected and refracted rays since the tally was zero.
    pub fn read_tally(&self) -> Result<[u64; TALLIED], GpuError> {
        let mut counts = [0u32; TALLIED];
        self.tally.read(0, &mut counts)?;
        Ok(counts.map(u64::from))
    }
}
