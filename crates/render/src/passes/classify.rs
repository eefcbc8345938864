//! The passes `classify` and `list_lit`.

use super::line;
use crate::state::{RayLoop, StoredRays, Touch};
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder, Texel};
use kernels::layout::{
    SHADE_FILM, SHADE_IMAGES, SHADE_OBJECTS, SHADE_TEXELS, TRACE_HITS, TRACE_POLYNOMIALS, WAVE_LIT,
    WAVE_LIT_HITS, WAVE_LIT_RAYS, WAVE_NEXT, WAVE_PATHS, WaveParams,
};
use kernels::spirv;
use std::sync::Arc;

/// What the passes work on.
#[derive(Clone, Copy)]
pub(crate) struct ClassifyIo<'a> {
    pub state: &'a StoredRays,
    pub polynomials: &'a Buffer,
    pub hits: &'a Buffer,
    pub objects: &'a Buffer,
    pub film: &'a Buffer,
    pub images: &'a Buffer,
    pub texels: &'a Buffer,
    pub paths: &'a Buffer,
    /// One u32 a ray: whether it hit a diffuse surface; then the offset of such rays in a list.
    pub lit: &'a Buffer,
    /// One u32 a ray: rays of the next wave that it makes.
    pub next: &'a Buffer,
    /// One `LitHit` a ray.
    pub lit_hits: &'a Buffer,
    /// One u32 a ray: the rays that hit a diffuse surface.
    pub lit_rays: &'a Buffer,
}

/// What becomes of each ray of a wave that has met a surface, or nothing (\[T\] §5).
pub(crate) struct Classify {
    classify: Kernel,
    list_lit: Kernel,
}

impl Classify {
    pub const NAME: &'static str = "classify";
    pub const LIST_LIT: &'static str = "list_lit";

    pub fn new(device: &Arc<Device>, form: RayLoop, scene: u32) -> Result<Self, GpuError> {
        let params = size_of::<WaveParams>();
        let buffers = [
            TRACE_HITS,
            SHADE_OBJECTS,
            SHADE_FILM,
            SHADE_IMAGES,
            SHADE_TEXELS,
            WAVE_PATHS,
            WAVE_LIT,
            WAVE_LIT_HITS,
            WAVE_NEXT,
        ];
        let mut bindings = form.bindings(Touch::Reads);
        bindings.push((TRACE_POLYNOMIALS, form.read(Texel::Four)));
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        let listed = [WAVE_LIT, WAVE_LIT_RAYS].map(|binding| (binding, Binding::StorageBuffer));
        let module = form.module(spirv::classify, spirv::classify_queue);
        Ok(Self {
            classify: Kernel::specialized(
                device,
                Self::NAME,
                &module,
                &bindings,
                params,
                Some(scene),
            )?,
            list_lit: Kernel::new(device, Self::LIST_LIT, &spirv::list_lit(), &listed, params)?,
        })
    }

    /// Records the classes of a wave whose rays have all ended.
    pub fn record(&self, rec: &mut Recorder, io: ClassifyIo<'_>, params: &WaveParams) {
        io.state
            .bind_read(rec.pass(Self::NAME, &self.classify))
            .buffer(TRACE_POLYNOMIALS, io.polynomials)
            .buffer(TRACE_HITS, io.hits)
            .buffer(SHADE_OBJECTS, io.objects)
            .buffer(SHADE_FILM, io.film)
            .buffer(SHADE_IMAGES, io.images)
            .buffer(SHADE_TEXELS, io.texels)
            .buffer(WAVE_PATHS, io.paths)
            .buffer(WAVE_LIT, io.lit)
            .buffer(WAVE_LIT_HITS, io.lit_hits)
            .buffer(WAVE_NEXT, io.next)
            .push(params)
            .dispatch(line(params.ray_count));
    }

    /// Records the list of rays that hit a diffuse surface; `lit` holds offsets by now.
    pub fn record_list(&self, rec: &mut Recorder, io: ClassifyIo<'_>, params: &WaveParams) {
        rec.pass(Self::LIST_LIT, &self.list_lit)
            .buffer(WAVE_LIT, io.lit)
            .buffer(WAVE_LIT_RAYS, io.lit_rays)
            .push(params)
            .dispatch(line(params.ray_count));
    }
}
