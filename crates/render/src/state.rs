//! The ray state: four storage images, twice, in place of the paper's render targets.

use gpu::{Device, GpuError, Image, ImageFormat};
use kernels::layout::STATE_ROW;
use std::sync::Arc;

/// Position, direction, cell and where the ray started, with the nearest hit so far packed among them
/// (`glsl/shared/state.glsl`). The rays of a wave lie one after another, `STATE_ROW` a row.
pub(crate) type StateImages = [Image; 4];

/// What a pass reads, and what it writes.
pub(crate) struct RayState {
    pub current: StateImages,
    pub next: StateImages,
}

impl RayState {
    /// For so many rays.
    pub fn new(device: &Arc<Device>, rays: u32) -> Result<Self, GpuError> {
        let size = [STATE_ROW, rays.div_ceil(STATE_ROW).max(1)];
        let image = |name| Image::new(device, name, size, ImageFormat::Rgba32Uint);
        let set = || -> Result<StateImages, GpuError> {
            Ok([
                image("ray position")?,
                image("ray direction")?,
                image("ray cell")?,
                image("ray start")?,
            ])
        };
        Ok(Self { current: set()?, next: set()? })
    }

    /// What was written is read next.
    pub fn swap(&mut self) {
        std::mem::swap(&mut self.current, &mut self.next);
    }
}
