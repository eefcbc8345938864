//! The pass `camera_trace`.

use super::{disc_lists, over_pixels, surface_lists};
use crate::discs::DiscLists;
use crate::state::{RayLoop, StoredRays, Touch};
use crate::wave::WaveBuffers;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder, Texel};
use kernels::layout::{
    CameraTraceParams, DISC_KEYS_IN, DISC_RANGES_IN, DISC_SLOTS_IN, SHADE_FILM, SHADE_IMAGES,
    SHADE_OBJECTS, SHADE_TEXELS, TRACE_CELLS, TRACE_HITS, TRACE_INFO, TRACE_LIVE,
    TRACE_POLYNOMIALS, TRACE_SLOTS, WAVE_LIT, WAVE_LIT_HITS, WAVE_NEXT_MARKS, WAVE_SCATTERING,
};
use kernels::spirv;
use points::device::Surfaces;
use std::sync::Arc;

/// What the pass works on.
#[derive(Clone, Copy)]
pub(crate) struct CameraTraceIo<'a> {
    pub lists: &'a DiscLists,
    pub surfaces: &'a Surfaces,
    pub objects: &'a Buffer,
    pub images: &'a Buffer,
    pub texels: &'a Buffer,
    pub film: &'a Buffer,
    /// Of rays that scatter.
    pub state: &'a StoredRays,
    pub hits: &'a Buffer,
    /// Marks are none before.
    pub wave: &'a WaveBuffers,
    /// One u32, zero before: how many rays have not ended.
    pub live: &'a Buffer,
}

/// The first wave from the eye to the film, where nothing but surfaces meets it (\[T\] §4).
pub(crate) struct CameraTrace {
    kernel: Kernel,
}

impl CameraTrace {
    pub const NAME: &'static str = "camera_trace";

    pub fn new(device: &Arc<Device>, scene: u32) -> Result<Self, GpuError> {
        let form = RayLoop::Queue;
        let buffers = [
            TRACE_INFO,
            TRACE_LIVE,
            TRACE_HITS,
            SHADE_IMAGES,
            SHADE_TEXELS,
            SHADE_FILM,
            WAVE_LIT,
            WAVE_LIT_HITS,
            WAVE_SCATTERING,
            WAVE_NEXT_MARKS,
        ];
        let mut bindings = form.bindings(Touch::Writes);
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        bindings.push((SHADE_OBJECTS, form.read(Texel::Four)));
        bindings.extend(surface_lists(form));
        bindings.extend(disc_lists(form));
        let params = size_of::<CameraTraceParams>();
        let module = spirv::camera_trace();
        let scene = Some(scene);
        let kernel = Kernel::specialized(device, Self::NAME, &module, &bindings, params, scene)?;
        Ok(Self { kernel })
    }

    /// Records the first wave of a tile.
    pub fn record(&self, rec: &mut Recorder, io: CameraTraceIo<'_>, params: &CameraTraceParams) {
        io.state
            .bind_written(rec.pass(Self::NAME, &self.kernel))
            .buffer(DISC_RANGES_IN, &io.lists.tiles)
            .buffer(DISC_KEYS_IN, &io.lists.pairs.keys)
            .buffer(DISC_SLOTS_IN, &io.lists.pairs.slots)
            .buffer(TRACE_INFO, &io.surfaces.grid_levels)
            .buffer(TRACE_CELLS, &io.surfaces.cells)
            .buffer(TRACE_SLOTS, &io.surfaces.slots)
            .buffer(TRACE_POLYNOMIALS, &io.surfaces.polynomials)
            .buffer(TRACE_LIVE, io.live)
            .buffer(SHADE_OBJECTS, io.objects)
            .buffer(SHADE_IMAGES, io.images)
            .buffer(SHADE_TEXELS, io.texels)
            .buffer(SHADE_FILM, io.film)
            .buffer(TRACE_HITS, io.hits)
            .buffer(WAVE_LIT, &io.wave.lit.bits)
            .buffer(WAVE_LIT_HITS, io.wave.lit_hits())
            .buffer(WAVE_SCATTERING, &io.wave.scattering.bits)
            .buffer(WAVE_NEXT_MARKS, &io.wave.next.bits)
            .push(params)
            .dispatch(over_pixels(params.tile_size));
    }
}
