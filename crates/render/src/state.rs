//! The ray state: four storage images, twice, in place of the paper's render targets.

use gpu::{Device, GpuError, Image, ImageFormat};
use std::sync::Arc;

/// Position, direction, cell, accumulated colour, with the nearest hit so far packed among them
/// (`glsl/shared/state.glsl`).
pub(crate) type StateImages = [Image; 4];

/// What a pass reads, and what it writes.
pub(crate) struct RayState {
    pub current: StateImages,
    pub next: StateImages,
}

impl RayState {
    pub fn new(device: &Arc<Device>, size: [u32; 2]) -> Result<Self, GpuError> {
        let image = |name| Image::new(device, name, size, ImageFormat::Rgba32Uint);
        let set = || -> Result<StateImages, GpuError> {
            Ok([
                image("ray position")?,
                image("ray direction")?,
                image("ray cell")?,
                image("ray color")?,
            ])
        };
        Ok(Self { current: set()?, next: set()? })
    }

    /// What was written is read next.
    pub fn swap(&mut self) {
        std::mem::swap(&mut self.current, &mut self.next);
    }
}
