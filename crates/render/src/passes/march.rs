//! The pass `march`.

use super::{line, volume_lists};
use crate::state::{RayLoop, StoredRays, Touch};
use crate::volumes::VolumeBuffers;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder, Texel};
use kernels::layout::{
    MARCH_CELLS, MARCH_ENDS, MARCH_LENGTHS, MARCH_LIGHT, MARCH_POINTS, MARCH_STATE, MARCH_STOPS,
    MARCH_VISIBLE, MARCH_VOLUMES, MarchParams, SHADE_LIGHTS, SHADE_OBJECTS, TRACE_HITS, TRACE_LIVE,
    WAVE_LIGHT_SUMS, WAVE_LIT_RAYS, WAVE_PATHS,
};
use kernels::spirv;
use std::sync::Arc;

/// Whose way is marched.
#[derive(Clone, Copy)]
pub(crate) enum Marched<'a> {
    /// The rays of a wave, as far as their hits; where volumes are lit, by these lights.
    Wave { hits: &'a Buffer, objects: &'a Buffer, lights: Option<&'a Buffer> },
    /// Shadow rays, as far as their lights.
    Shadows { lit_rays: &'a Buffer, light_sums: &'a Buffer },
}

/// What the pass works on.
#[derive(Clone, Copy)]
pub(crate) struct MarchIo<'a> {
    pub state: &'a StoredRays,
    pub volumes: &'a VolumeBuffers,
    pub paths: &'a Buffer,
    /// One u32, zero before: how many rays are not done.
    pub live: &'a Buffer,
    pub marched: Marched<'a>,
}

/// Rays through volumes, sample after sample (\[T\] §6).
pub(crate) struct March {
    pub wave: Kernel,
    pub lit: Kernel,
    pub shadows: Kernel,
}

impl March {
    pub const NAME: &'static str = "march";

    pub fn new(device: &Arc<Device>, form: RayLoop, scene: u32) -> Result<Self, GpuError> {
        let params = size_of::<MarchParams>();
        let kernel = |module: &[u32], more: &[u32]| {
            let mut bindings = form.bindings(Touch::Reads);
            bindings.extend(volume_lists(form));
            let buffers = [TRACE_LIVE, WAVE_PATHS, MARCH_VOLUMES, MARCH_STATE, MARCH_ENDS];
            let all = buffers.iter().chain(more);
            bindings.extend(all.map(|&binding| match binding {
                SHADE_OBJECTS | MARCH_VISIBLE => (binding, form.read(Texel::Four)),
                _ => (binding, Binding::StorageBuffer),
            }));
            Kernel::specialized(device, Self::NAME, module, &bindings, params, Some(scene))
        };
        Ok(Self {
            wave: kernel(
                &form.module(spirv::march, spirv::march_queue),
                &[TRACE_HITS, SHADE_OBJECTS],
            )?,
            lit: kernel(
                &form.module(spirv::march_lit, spirv::march_lit_queue),
                &[TRACE_HITS, SHADE_OBJECTS, SHADE_LIGHTS, MARCH_LIGHT, MARCH_VISIBLE],
            )?,
            shadows: kernel(
                &form.module(spirv::march_shadows, spirv::march_shadows_queue),
                &[WAVE_LIT_RAYS, WAVE_LIGHT_SUMS],
            )?,
        })
    }

    /// Records one pass.
    pub fn record(&self, rec: &mut Recorder, io: MarchIo<'_>, params: &MarchParams) {
        let kernel = match io.marched {
            Marched::Wave { lights: None, .. } => &self.wave,
            Marched::Wave { lights: Some(_), .. } => &self.lit,
            Marched::Shadows { .. } => &self.shadows,
        };
        let pass = io
            .state
            .bind_read(rec.pass(Self::NAME, kernel))
            .buffer(TRACE_LIVE, io.live)
            .buffer(WAVE_PATHS, io.paths)
            .buffer(MARCH_VOLUMES, &io.volumes.infos)
            .buffer(MARCH_CELLS, &io.volumes.cells)
            .buffer(MARCH_POINTS, &io.volumes.points)
            .buffer(MARCH_LENGTHS, &io.volumes.inverse_lengths)
            .buffer(MARCH_STOPS, &io.volumes.stops)
            .buffer(MARCH_STATE, &io.volumes.marches)
            .buffer(MARCH_ENDS, &io.volumes.ends);
        let pass = match io.marched {
            Marched::Wave { hits, objects, lights } => {
                let pass = pass.buffer(TRACE_HITS, hits).buffer(SHADE_OBJECTS, objects);
                match lights {
                    None => pass,
                    Some(lights) => pass
                        .buffer(SHADE_LIGHTS, lights)
                        .buffer(MARCH_LIGHT, &io.volumes.march_lights)
                        .buffer(MARCH_VISIBLE, &io.volumes.visible),
                }
            }
            Marched::Shadows { lit_rays, light_sums } => {
                pass.buffer(WAVE_LIT_RAYS, lit_rays).buffer(WAVE_LIGHT_SUMS, light_sums)
            }
        };
        pass.push(params).dispatch(line(params.ray_count));
    }
}
