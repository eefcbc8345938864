//! The pass `shade`.

use super::{AlbedoIo, line};
use crate::state::{RayLoop, StoredRays, Touch};
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{
    SHADE_FILM, TRACE_HITS, WAVE_LIGHT_SUMS, WAVE_LIT_RAYS, WAVE_PATHS, WaveParams,
};
use kernels::spirv;
use std::sync::Arc;

/// What the pass works on.
#[derive(Clone, Copy)]
pub(crate) struct ShadeIo<'a> {
    /// The shadow rays, as those towards the last light left them.
    pub shadows: &'a StoredRays,
    pub albedos: AlbedoIo<'a>,
    pub hits: &'a Buffer,
    pub film: &'a Buffer,
    pub paths: &'a Buffer,
    pub lit_rays: &'a Buffer,
    pub light_sums: &'a Buffer,
}

/// Lambert's law at the diffuse hits of a wave (method, section 4).
pub(crate) struct Shade {
    kernel: Kernel,
}

impl Shade {
    pub const NAME: &'static str = "shade";

    pub fn new(device: &Arc<Device>, form: RayLoop) -> Result<Self, GpuError> {
        let mut bindings = form.bindings(Touch::Reads);
        bindings.extend(AlbedoIo::bindings(form));
        let buffers = [TRACE_HITS, SHADE_FILM, WAVE_PATHS, WAVE_LIT_RAYS, WAVE_LIGHT_SUMS];
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        let params = size_of::<WaveParams>();
        let kernel = Kernel::new(
            device,
            Self::NAME,
            &form.module(spirv::shade, spirv::shade_queue),
            &bindings,
            params,
        )?;
        Ok(Self { kernel })
    }

    /// Records the shading of a wave's diffuse hits, once every light has been asked.
    pub fn record(&self, rec: &mut Recorder, io: ShadeIo<'_>, params: &WaveParams) {
        let pass = io.shadows.bind_read(rec.pass(Self::NAME, &self.kernel));
        io.albedos
            .bind(pass)
            .buffer(TRACE_HITS, io.hits)
            .buffer(SHADE_FILM, io.film)
            .buffer(WAVE_PATHS, io.paths)
            .buffer(WAVE_LIT_RAYS, io.lit_rays)
            .buffer(WAVE_LIGHT_SUMS, io.light_sums)
            .push(params)
            .dispatch(line(params.ray_count));
    }
}
