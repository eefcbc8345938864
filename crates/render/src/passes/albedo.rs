//! What `albedo.glsl` and `environment.glsl` read, for every pass whose kernel includes them.

use gpu::{Binding, Buffer, PassBuilder};
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
    pub const BINDINGS: [(u32, Binding); 8] = [
        (TRACE_INFO, Binding::StorageBuffer),
        (TRACE_CELLS, Binding::StorageBuffer),
        (TRACE_SLOTS, Binding::StorageBuffer),
        (TRACE_POLYNOMIALS, Binding::StorageBuffer),
        (SHADE_OBJECTS, Binding::StorageBuffer),
        (SHADE_COLORS, Binding::StorageBuffer),
        (SHADE_IMAGES, Binding::StorageBuffer),
        (SHADE_TEXELS, Binding::StorageBuffer),
    ];

    /// Binds all of it.
    pub fn bind<'p>(self, pass: PassBuilder<'p>) -> PassBuilder<'p> {
        pass.buffer(TRACE_INFO, &self.surfaces.grid_info)
            .buffer(TRACE_CELLS, &self.surfaces.cells)
            .buffer(TRACE_SLOTS, &self.surfaces.slots)
            .buffer(TRACE_POLYNOMIALS, &self.surfaces.polynomials)
            .buffer(SHADE_OBJECTS, self.objects)
            .buffer(SHADE_COLORS, self.colors)
            .buffer(SHADE_IMAGES, self.images)
            .buffer(SHADE_TEXELS, self.texels)
    }
}
