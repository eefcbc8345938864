//! The pass `classify`.

use super::line;
use crate::state::{RayLoop, StoredRays, Touch};
use crate::wave::WaveBuffers;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder, Texel};
use kernels::layout::{
    MARCH_STATE, SHADE_FILM, SHADE_IMAGES, SHADE_OBJECTS, SHADE_TEXELS, TRACE_HITS,
    TRACE_POLYNOMIALS, WAVE_LIT, WAVE_LIT_HITS, WAVE_NEXT_MARKS, WAVE_NEXT_PATHS, WAVE_PATHS,
    WAVE_SCATTERING, WaveParams,
};
use kernels::spirv;
use std::sync::Arc;

/// What the pass works on.
#[derive(Clone, Copy)]
pub(crate) struct ClassifyIo<'a> {
    pub state: &'a StoredRays,
    pub polynomials: &'a Buffer,
    pub hits: &'a Buffer,
    pub objects: &'a Buffer,
    pub film: &'a Buffer,
    pub images: &'a Buffer,
    pub texels: &'a Buffer,
    /// Where there are volumes.
    pub marches: Option<&'a Buffer>,
    /// Marks are none before.
    pub wave: &'a WaveBuffers,
}

/// What becomes of each ray of a wave that has met a surface, or nothing (\[T\] §5).
pub(crate) struct Classify {
    pub kernel: Kernel,
}

impl Classify {
    pub const NAME: &'static str = "classify";

    pub fn new(device: &Arc<Device>, form: RayLoop, scene: u32) -> Result<Self, GpuError> {
        let buffers = [
            MARCH_STATE,
            SHADE_FILM,
            SHADE_IMAGES,
            SHADE_TEXELS,
            WAVE_NEXT_PATHS,
            WAVE_LIT,
            WAVE_LIT_HITS,
            WAVE_SCATTERING,
            WAVE_NEXT_MARKS,
        ];
        let read = [TRACE_POLYNOMIALS, TRACE_HITS, SHADE_OBJECTS, WAVE_PATHS];
        let mut bindings = form.bindings(Touch::Reads);
        bindings.extend(read.map(|binding| (binding, form.read(Texel::Four))));
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        let module = form.module(spirv::classify, spirv::classify_queue);
        let (params, scene) = (size_of::<WaveParams>(), Some(scene));
        let kernel = Kernel::specialized(device, Self::NAME, &module, &bindings, params, scene)?;
        Ok(Self { kernel })
    }

    /// Records the classes of a wave whose rays have all ended.
    pub fn record(&self, rec: &mut Recorder, io: ClassifyIo<'_>, params: &WaveParams) {
        io.state
            .bind_read(rec.pass(Self::NAME, &self.kernel))
            .buffer(TRACE_POLYNOMIALS, io.polynomials)
            .buffer(TRACE_HITS, io.hits)
            .buffer(SHADE_OBJECTS, io.objects)
            .buffer(SHADE_FILM, io.film)
            .buffer(SHADE_IMAGES, io.images)
            .buffer(SHADE_TEXELS, io.texels)
            .buffer(MARCH_STATE, io.marches.unwrap_or(io.hits))
            .buffer(WAVE_PATHS, io.wave.paths())
            .buffer(WAVE_NEXT_PATHS, io.wave.paths())
            .buffer(WAVE_LIT, &io.wave.lit.bits)
            .buffer(WAVE_LIT_HITS, io.wave.lit_hits())
            .buffer(WAVE_SCATTERING, &io.wave.scattering.bits)
            .buffer(WAVE_NEXT_MARKS, &io.wave.next.bits)
            .push(params)
            .dispatch(line(params.ray_count));
    }
}
