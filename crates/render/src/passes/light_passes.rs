//! The passes `shadow_media`, `shadow_meet` and `shadow_go_on`.

use super::{line, lit_rays};
use crate::state::{RayLoop, RayState, StoredRays, Touch};
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder, Texel};
use kernels::layout::{
    SHADE_FILM, SHADE_OBJECTS, SHADOW_PATHS, ShadowParams, TRACE_INFO, TRACE_LIVE,
    TRACE_POLYNOMIALS, WAVE_LIGHT_SUMS, WAVE_LIT_HITS, WAVE_LIT_RAYS, WAVE_MARKS, WAVE_PATHS,
    WaveParams,
};
use kernels::spirv;
use points::device::Surfaces;
use std::sync::Arc;

/// What the passes work on.
#[derive(Clone, Copy)]
pub(crate) struct LightPassesIo<'a> {
    pub state: &'a StoredRays,
    pub surfaces: &'a Surfaces,
    pub objects: &'a Buffer,
    pub film: &'a Buffer,
    pub light_sums: &'a Buffer,
    /// One `Path` a shadow ray.
    pub shadow_paths: &'a Buffer,
    /// Two u32, zero before `shadow_go_on`.
    pub live: &'a Buffer,
    /// Zero before `shadow_go_on`.
    pub marks: &'a Buffer,
}

/// Light past surfaces between media of one index.
pub(crate) struct LightPasses {
    pub media: Kernel,
    pub meet: Kernel,
    pub go_on: Kernel,
}

impl LightPasses {
    pub const MEDIA: &'static str = "shadow_media";
    pub const MEET: &'static str = "shadow_meet";
    pub const GO_ON: &'static str = "shadow_go_on";

    pub fn new(device: &Arc<Device>, form: RayLoop, scene: u32) -> Result<Self, GpuError> {
        let with = |touch: Touch, buffers: &[u32]| {
            let mut bindings = form.bindings(touch);
            bindings.extend(buffers.iter().map(|&binding| (binding, Binding::StorageBuffer)));
            bindings
        };
        let of_surfaces = [TRACE_POLYNOMIALS, SHADE_OBJECTS].map(|at| (at, form.read(Texel::Four)));
        let mut media = with(Touch::Reads, &[SHADOW_PATHS]);
        media.extend(lit_rays(form));
        let mut meet = with(Touch::Updates, &[WAVE_LIGHT_SUMS, SHADOW_PATHS]);
        meet.extend(of_surfaces);
        let mut go_on = with(
            Touch::Updates,
            &[WAVE_LIGHT_SUMS, SHADOW_PATHS, TRACE_INFO, TRACE_LIVE, WAVE_MARKS, SHADE_FILM],
        );
        go_on.extend(of_surfaces);
        let kernel = |name, module: Vec<u32>, bindings: &[(u32, Binding)], params| {
            Kernel::specialized(device, name, &module, bindings, params, Some(scene))
        };
        Ok(Self {
            media: kernel(
                Self::MEDIA,
                form.module(spirv::shadow_media, spirv::shadow_media_queue),
                &media,
                size_of::<WaveParams>(),
            )?,
            meet: kernel(
                Self::MEET,
                form.module(spirv::shadow_meet, spirv::shadow_meet_queue),
                &meet,
                size_of::<ShadowParams>(),
            )?,
            go_on: kernel(
                Self::GO_ON,
                form.module(spirv::shadow_go_on, spirv::shadow_go_on_queue),
                &go_on,
                size_of::<ShadowParams>(),
            )?,
        })
    }

    /// Records what the rays towards a light start inside, by the paths of the wave.
    pub fn record_media(
        &self,
        rec: &mut Recorder,
        shadows: &RayState,
        [paths, lit_rays, lit_hits, shadow_paths]: [&Buffer; 4],
        params: &WaveParams,
    ) {
        shadows
            .current
            .bind_read(rec.pass(Self::MEDIA, &self.media))
            .buffer(WAVE_PATHS, paths)
            .buffer(WAVE_LIT_RAYS, lit_rays)
            .buffer(WAVE_LIT_HITS, lit_hits)
            .buffer(SHADOW_PATHS, shadow_paths)
            .push(params)
            .dispatch(line(params.ray_count));
    }

    /// Records what rays that have ended have met.
    pub fn record_meet(&self, rec: &mut Recorder, io: LightPassesIo<'_>, params: &ShadowParams) {
        io.state
            .bind_in_place(rec.pass(Self::MEET, &self.meet))
            .buffer(TRACE_POLYNOMIALS, &io.surfaces.polynomials)
            .buffer(SHADE_OBJECTS, io.objects)
            .buffer(WAVE_LIGHT_SUMS, io.light_sums)
            .buffer(SHADOW_PATHS, io.shadow_paths)
            .push(params)
            .dispatch(line(params.ray_count));
    }

    /// Records the way on of those that a surface lets through, in place.
    pub fn record_go_on(&self, rec: &mut Recorder, io: LightPassesIo<'_>, params: &ShadowParams) {
        io.state
            .bind_in_place(rec.pass(Self::GO_ON, &self.go_on))
            .buffer(TRACE_INFO, &io.surfaces.grid_levels)
            .buffer(TRACE_POLYNOMIALS, &io.surfaces.polynomials)
            .buffer(SHADE_OBJECTS, io.objects)
            .buffer(SHADE_FILM, io.film)
            .buffer(WAVE_LIGHT_SUMS, io.light_sums)
            .buffer(SHADOW_PATHS, io.shadow_paths)
            .buffer(TRACE_LIVE, io.live)
            .buffer(WAVE_MARKS, io.marks)
            .push(params)
            .dispatch(line(params.ray_count));
    }
}
