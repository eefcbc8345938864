//! The pass `scatter`.

use super::line;
use crate::state::{RayLoop, RayState, Touch};
use crate::wave::WaveBuffers;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder, Texel};
use kernels::layout::{
    SHADE_FILM, SHADE_IMAGES, SHADE_OBJECTS, SHADE_TEXELS, TRACE_HITS, TRACE_INFO,
    TRACE_POLYNOMIALS, WAVE_NEXT, WAVE_NEXT_MARKS, WAVE_NEXT_PATHS, WAVE_PATHS, WAVE_SCATTERING,
    WAVE_TALLY, WaveParams,
};
use kernels::spirv;
use points::device::Surfaces;
use std::sync::Arc;

/// What the pass works on.
#[derive(Clone, Copy)]
pub(crate) struct ScatterIo<'a> {
    /// This wave, and the next.
    pub state: &'a RayState,
    pub surfaces: &'a Surfaces,
    pub hits: &'a Buffer,
    pub objects: &'a Buffer,
    pub film: &'a Buffer,
    pub images: &'a Buffer,
    pub texels: &'a Buffer,
    /// This wave's paths, or the one that its rays share.
    pub paths: &'a Buffer,
    /// Offsets of marks are known.
    pub wave: &'a WaveBuffers,
}

/// The reflected and refracted rays that a wave makes (\[T\] §5).
pub(crate) struct Scatter {
    pub kernel: Kernel,
}

impl Scatter {
    pub const NAME: &'static str = "scatter";

    pub fn new(device: &Arc<Device>, form: RayLoop, scene: u32) -> Result<Self, GpuError> {
        let mut bindings = form.bindings(Touch::Updates);
        let buffers =
            [TRACE_INFO, SHADE_FILM, SHADE_IMAGES, SHADE_TEXELS, WAVE_NEXT_PATHS, WAVE_TALLY];
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        let read = [TRACE_POLYNOMIALS, TRACE_HITS, SHADE_OBJECTS, WAVE_PATHS];
        bindings.extend(read.map(|binding| (binding, form.read(Texel::Four))));
        bindings.push((WAVE_SCATTERING, form.read(Texel::One)));
        bindings.push((WAVE_NEXT_MARKS, form.read(Texel::Two)));
        bindings.push((WAVE_NEXT, form.read(Texel::One)));
        let params = size_of::<WaveParams>();
        let kernel = Kernel::specialized(
            device,
            Self::NAME,
            &form.module(spirv::scatter, spirv::scatter_queue),
            &bindings,
            params,
            Some(scene),
        )?;
        Ok(Self { kernel })
    }

    /// Records the next wave, made by so many rays; the caller then swaps ray state and paths.
    pub fn record(&self, rec: &mut Recorder, io: ScatterIo<'_>, params: &WaveParams) {
        io.state
            .bind_move(rec.pass(Self::NAME, &self.kernel))
            .buffer(TRACE_INFO, &io.surfaces.grid_levels)
            .buffer(TRACE_POLYNOMIALS, &io.surfaces.polynomials)
            .buffer(TRACE_HITS, io.hits)
            .buffer(SHADE_OBJECTS, io.objects)
            .buffer(SHADE_FILM, io.film)
            .buffer(SHADE_IMAGES, io.images)
            .buffer(SHADE_TEXELS, io.texels)
            .buffer(WAVE_PATHS, io.paths)
            .buffer(WAVE_NEXT_PATHS, io.wave.next_paths())
            .buffer(WAVE_SCATTERING, io.wave.scattering_rays())
            .buffer(WAVE_NEXT_MARKS, &io.wave.next.bits)
            .buffer(WAVE_NEXT, &io.wave.next.offsets)
            .buffer(WAVE_TALLY, io.wave.tally())
            .push(params)
            .dispatch(line(params.ray_count));
    }
}
