//! The pass `shadow_rays`.

use super::{line, lit_rays};
use crate::state::{RayLoop, RayState, Touch};
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{
    SHADE_FILM, SHADE_LIGHTS, TRACE_INFO, WAVE_LIGHT_SUMS, WAVE_LIT_HITS, WAVE_LIT_RAYS,
    WAVE_PATHS, WAVE_TALLY, WaveParams,
};
use kernels::spirv;
use std::sync::Arc;

/// What the pass works on.
#[derive(Clone, Copy)]
pub(crate) struct ShadowRaysIo<'a> {
    /// The shadow rays: as those towards the light before left it, and for those towards this one.
    pub shadows: &'a RayState,
    pub grid_levels: &'a Buffer,
    /// One `LitHit` a ray.
    pub lit_hits: &'a Buffer,
    pub lights: &'a Buffer,
    pub film: &'a Buffer,
    pub paths: &'a Buffer,
    pub lit_rays: &'a Buffer,
    /// One `LightSum` a diffuse hit.
    pub light_sums: &'a Buffer,
    pub tally: &'a Buffer,
}

/// The rays from the diffuse hits of a wave towards one light (\[T\] §5).
pub(crate) struct ShadowRays {
    pub kernel: Kernel,
}

impl ShadowRays {
    pub const NAME: &'static str = "shadow_rays";

    pub fn new(device: &Arc<Device>, form: RayLoop, scene: u32) -> Result<Self, GpuError> {
        let mut bindings = form.bindings(Touch::Updates);
        let buffers = [TRACE_INFO, SHADE_LIGHTS, SHADE_FILM, WAVE_LIGHT_SUMS, WAVE_TALLY];
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        bindings.extend(lit_rays(form));
        let params = size_of::<WaveParams>();
        let kernel = Kernel::specialized(
            device,
            Self::NAME,
            &form.module(spirv::shadow_rays, spirv::shadow_rays_queue),
            &bindings,
            params,
            Some(scene),
        )?;
        Ok(Self { kernel })
    }

    /// Records the rays towards one light; the caller then swaps their state.
    pub fn record(&self, rec: &mut Recorder, io: ShadowRaysIo<'_>, params: &WaveParams) {
        io.shadows
            .bind_update(rec.pass(Self::NAME, &self.kernel))
            .buffer(TRACE_INFO, io.grid_levels)
            .buffer(WAVE_LIT_HITS, io.lit_hits)
            .buffer(SHADE_LIGHTS, io.lights)
            .buffer(SHADE_FILM, io.film)
            .buffer(WAVE_PATHS, io.paths)
            .buffer(WAVE_LIT_RAYS, io.lit_rays)
            .buffer(WAVE_LIGHT_SUMS, io.light_sums)
            .buffer(WAVE_TALLY, io.tally)
            .push(params)
            .dispatch(line(params.ray_count));
    }
}
