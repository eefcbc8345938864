//! What `albedo.glsl` and `environment.glsl` read, for every pass whose kernel includes them.

use super::surface_lists;
use crate::state::RayLoop;
use gpu::{Binding, Buffer, PassBuilder, Texel};
use kernels::layout::{
    SHADE_COLORS, SHADE_IMAGES, SHADE_OBJECTS, SHADE_TEXELS, TRACE_CELLS, TRACE_INFO,
    TRACE_POLYNOMIALS, TRACE_SLOTS,
};
use points::device::Surfaces;

/// The surfaces with their colours, and the images.
#[derive(Clone, Copy)]
pub(crate) struct AlbedoIo<'a> {
    pub surfaces: &'a Surfaces,
    pub objects: &'a Buffer,
    pub colors: &'a Buffer,
    pub images: &'a Buffer,
    pub texels: &'a Buffer,
}

impl AlbedoIo<'_> {
    /// Of the kernel.
    pub fn bindings(form: RayLoop) -> impl Iterator<Item = (u32, Binding)> {
        let buffers = [TRACE_INFO, SHADE_COLORS, SHADE_IMAGES, SHADE_TEXELS];
        let buffers = buffers.map(|binding| (binding, Binding::StorageBuffer));
        let objects = (SHADE_OBJECTS, form.read(Texel::Four));
        buffers.into_iter().chain([objects]).chain(surface_lists(form))
    }

    /// Binds all of it.
    pub fn bind<'p>(self, pass: PassBuilder<'p>) -> PassBuilder<'p> {
        pass.buffer(TRACE_INFO, &self.surfaces.grid_levels)
            .buffer(TRACE_CELLS, &self.surfaces.cells)
            .buffer(TRACE_SLOTS, &self.surfaces.slots)
            .buffer(TRACE_POLYNOMIALS, &self.surfaces.polynomials)
            .buffer(SHADE_OBJECTS, self.objects)
            .buffer(SHADE_COLORS, self.colors)
            .buffer(SHADE_IMAGES, self.images)
            .buffer(SHADE_TEXELS, self.texels)
    }
}
