//! The pass `shade`.

use super::{AlbedoIo, line, lit_rays};
use crate::state::{RayLoop, StoredRays, Touch};
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{
    SHADE_FILM, WAVE_LIGHT_SUMS, WAVE_LIT_HITS, WAVE_LIT_RAYS, WAVE_PATHS, WaveParams,
};
use kernels::spirv;
use std::sync::Arc;

/// What the pass works on.
#[derive(Clone, Copy)]
pub(crate) struct ShadeIo<'a> {
    /// The shadow rays, as those towards the last light left them.
    pub shadows: &'a StoredRays,
    pub albedos: AlbedoIo<'a>,
    /// One `LitHit` a ray.
    pub lit_hits: &'a Buffer,
    pub film: &'a Buffer,
    pub paths: &'a Buffer,
    pub lit_rays: &'a Buffer,
    pub light_sums: &'a Buffer,
}

/// Lambert's law at the diffuse hits of a wave (method, section 4).
pub(crate) struct Shade {
    pub kernel: Kernel,
}

impl Shade {
    pub const NAME: &'static str = "shade";

    pub fn new(device: &Arc<Device>, form: RayLoop, scene: u32) -> Result<Self, GpuError> {
        let mut bindings = form.bindings(Touch::Reads);
        bindings.extend(AlbedoIo::bindings(form));
        let buffers = [SHADE_FILM, WAVE_LIGHT_SUMS];
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        bindings.extend(lit_rays(form));
        let params = size_of::<WaveParams>();
        let kernel = Kernel::specialized(
            device,
            Self::NAME,
            &form.module(spirv::shade, spirv::shade_queue),
            &bindings,
            params,
            Some(scene),
        )?;
        Ok(Self { kernel })
    }

    /// Records the shading of a wave's diffuse hits, once every light has been asked.
    pub fn record(&self, rec: &mut Recorder, io: ShadeIo<'_>, params: &WaveParams) {
        let pass = io.shadows.bind_read(rec.pass(Self::NAME, &self.kernel));
        io.albedos
            .bind(pass)
            .buffer(WAVE_LIT_HITS, io.lit_hits)
            .buffer(SHADE_FILM, io.film)
            .buffer(WAVE_PATHS, io.paths)
            .buffer(WAVE_LIT_RAYS, io.lit_rays)
            .buffer(WAVE_LIGHT_SUMS, io.light_sums)
            .push(params)
            .dispatch(line(params.ray_count));
    }
}
