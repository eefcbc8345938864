//! The pass `isosurface`.

use super::{line, volume_lists};
use crate::state::{RayLoop, StoredRays, Touch};
use crate::volumes::VolumeBuffers;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{
    ISO_SEARCHES, MARCH_CELLS, MARCH_LENGTHS, MARCH_POINTS, MARCH_STOPS, MARCH_VOLUMES,
    MarchParams, TRACE_HITS, TRACE_LIVE, WAVE_LIGHT_SUMS, WAVE_PATHS,
};
use kernels::spirv;
use std::sync::Arc;

/// What the pass works on.
#[derive(Clone, Copy)]
pub(crate) struct IsosurfaceIo<'a> {
    /// Read and, for rays that meet an isosurface, written in place.
    pub state: &'a StoredRays,
    pub volumes: &'a VolumeBuffers,
    pub paths: &'a Buffer,
    /// One u32, zero before: how many rays are not done.
    pub live: &'a Buffer,
    pub of: Searching<'a>,
}

/// Whose way is searched.
#[derive(Clone, Copy)]
pub(crate) enum Searching<'a> {
    /// The rays of a wave, as far as their hits, which give way to nearer ones.
    Wave { hits: &'a Buffer },
    /// Shadow rays, as far as their lights.
    Shadows { light_sums: &'a Buffer },
}

/// Where rays first meet a surface on which the scalar of a volume is one number.
pub(crate) struct Isosurface {
    pub wave: Kernel,
    pub shadows: Kernel,
}

impl Isosurface {
    pub const NAME: &'static str = "isosurface";

    pub fn new(device: &Arc<Device>, form: RayLoop) -> Result<Self, GpuError> {
        let params = size_of::<MarchParams>();
        let kernel = |module: &[u32], of: u32| {
            let mut bindings = form.bindings(Touch::Updates);
            bindings.extend(volume_lists(form));
            let buffers = [TRACE_LIVE, WAVE_PATHS, MARCH_VOLUMES, ISO_SEARCHES, of];
            bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
            Kernel::new(device, Self::NAME, module, &bindings, params)
        };
        Ok(Self {
            wave: kernel(&form.module(spirv::isosurface, spirv::isosurface_queue), TRACE_HITS)?,
            shadows: kernel(
                &form.module(spirv::isosurface_shadows, spirv::isosurface_shadows_queue),
                WAVE_LIGHT_SUMS,
            )?,
        })
    }

    /// Records one pass.
    pub fn record(&self, rec: &mut Recorder, io: IsosurfaceIo<'_>, params: &MarchParams) {
        let (kernel, binding, of) = match io.of {
            Searching::Wave { hits } => (&self.wave, TRACE_HITS, hits),
            Searching::Shadows { light_sums } => (&self.shadows, WAVE_LIGHT_SUMS, light_sums),
        };
        io.state
            .bind_in_place(rec.pass(Self::NAME, kernel))
            .buffer(TRACE_LIVE, io.live)
            .buffer(WAVE_PATHS, io.paths)
            .buffer(MARCH_VOLUMES, &io.volumes.infos)
            .buffer(MARCH_CELLS, &io.volumes.cells)
            .buffer(MARCH_POINTS, &io.volumes.points)
            .buffer(MARCH_LENGTHS, &io.volumes.inverse_lengths)
            .buffer(MARCH_STOPS, &io.volumes.stops)
            .buffer(ISO_SEARCHES, &io.volumes.searches)
            .buffer(binding, of)
            .push(params)
            .dispatch(line(params.ray_count));
    }
}
