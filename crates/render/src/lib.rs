//! The frontend: drives the passes of a [`Plan`] on a device.
//!
//! [`Renderer::new`] builds the surfaces once; [`Renderer::frame`] traces them, as often as one
//! likes. A tile's rays live in a queue in a buffer, or, as in section 5 of the paper, in four storage
//! images and four more that a pass writes, which swap after each pass. Any number of cells a pass gives
//! the same bytes, which the test `every_k_gives_the_same_bytes` checks.
#![forbid(unsafe_code)]

mod ahead;
mod budget;
mod frame;
mod marks;
mod renderer;
mod stages;
mod state;
mod stats;
mod structure;
mod tables;

pub use points::device::BuildError;
pub use renderer::Renderer;
pub use state::RayLoop;
pub use stats::{FrameStats, Traversal};
pub use structure::DiscLists;

/// Why a frame could not be finished.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The device refused or failed.
    #[error(transparent)]
    Gpu(#[from] gpu::GpuError),
    /// More texels than one buffer of the device may hold.
    #[error(
        "the images ({images}) need {needed} bytes but the device takes {limit}, that is {} pixels of 8 \
         bits or {} of floats in all; make them smaller, or render with --device reference",
        limit / 4, limit / 12
    )]
    Images {
        /// Their files.
        images: String,
        /// Bytes of all.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
    },
    /// More points than the device has memory for, said before any is taken.
    #[error(transparent)]
    Memory(BuildError),
    /// The watcher asked for an end.
    #[error("interrupted")]
    Interrupted,
}

impl From<BuildError> for RenderError {
    fn from(error: BuildError) -> Self {
        match error {
            BuildError::Gpu(error) => Self::Gpu(error),
            error @ BuildError::Memory { .. } => Self::Memory(error),
            BuildError::Interrupted => Self::Interrupted,
        }
    }
}
