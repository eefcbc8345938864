//! The passes `point_rays` and `point_lights`.

use super::{line, volume_lists};
use crate::state::{RayLoop, RayState, Touch};
use crate::volumes::VolumeBuffers;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{
    MARCH_CELLS, MARCH_LENGTHS, MARCH_POINTS, MARCH_STOPS, MARCH_VISIBLE, MARCH_VOLUMES,
    PointLightParams, SHADE_LIGHTS, TRACE_INFO, WAVE_LIGHT_SUMS, WAVE_LIT_RAYS, WAVE_PATHS,
};
use kernels::spirv;
use std::sync::Arc;

/// What the passes work on.
#[derive(Clone, Copy)]
pub(crate) struct PointLightIo<'a> {
    pub shadows: &'a RayState,
    pub volumes: &'a VolumeBuffers,
    pub grid_levels: &'a Buffer,
    pub lights: &'a Buffer,
    pub paths: &'a Buffer,
    pub lit_rays: &'a Buffer,
    pub light_sums: &'a Buffer,
}

/// How much of a light reaches the points of a volume: the rays towards it, and what came of them.
pub(crate) struct PointLight {
    pub rays: Kernel,
    pub lights: Kernel,
}

impl PointLight {
    pub const RAYS: &'static str = "point_rays";
    pub const LIGHTS: &'static str = "point_lights";

    pub fn new(device: &Arc<Device>, form: RayLoop) -> Result<Self, GpuError> {
        let params = size_of::<PointLightParams>();
        let with = |touch: Touch, buffers: &[u32]| {
            let mut bindings = form.bindings(touch);
            bindings.extend(buffers.iter().map(|&binding| (binding, Binding::StorageBuffer)));
            bindings
        };
        let written = [WAVE_PATHS, WAVE_LIT_RAYS, WAVE_LIGHT_SUMS];
        let mut rays = with(
            Touch::Writes,
            &[&[TRACE_INFO, SHADE_LIGHTS, MARCH_VOLUMES], &written[..]].concat(),
        );
        rays.extend(volume_lists(form));
        let lights = with(Touch::Reads, &[WAVE_LIGHT_SUMS, MARCH_VISIBLE]);
        Ok(Self {
            rays: Kernel::new(
                device,
                Self::RAYS,
                &form.module(spirv::point_rays, spirv::point_rays_queue),
                &rays,
                params,
            )?,
            lights: Kernel::new(
                device,
                Self::LIGHTS,
                &form.module(spirv::point_lights, spirv::point_lights_queue),
                &lights,
                params,
            )?,
        })
    }

    /// Records the rays towards one light; the caller then swaps their state.
    pub fn record_rays(&self, rec: &mut Recorder, io: PointLightIo<'_>, params: &PointLightParams) {
        io.shadows
            .started()
            .bind_written(rec.pass(Self::RAYS, &self.rays))
            .buffer(TRACE_INFO, io.grid_levels)
            .buffer(SHADE_LIGHTS, io.lights)
            .buffer(MARCH_VOLUMES, &io.volumes.infos)
            .buffer(MARCH_CELLS, &io.volumes.cells)
            .buffer(MARCH_POINTS, &io.volumes.points)
            .buffer(MARCH_LENGTHS, &io.volumes.inverse_lengths)
            .buffer(MARCH_STOPS, &io.volumes.stops)
            .buffer(WAVE_PATHS, io.paths)
            .buffer(WAVE_LIT_RAYS, io.lit_rays)
            .buffer(WAVE_LIGHT_SUMS, io.light_sums)
            .push(params)
            .dispatch(line(params.count));
    }

    /// Records what came of them.
    pub fn record_lights(
        &self,
        rec: &mut Recorder,
        io: PointLightIo<'_>,
        params: &PointLightParams,
    ) {
        io.shadows
            .current
            .bind_read(rec.pass(Self::LIGHTS, &self.lights))
            .buffer(WAVE_LIGHT_SUMS, io.light_sums)
            .buffer(MARCH_VISIBLE, &io.volumes.visible)
            .push(params)
            .dispatch(line(params.count));
    }
}
