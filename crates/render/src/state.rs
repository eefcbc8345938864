//! The ray state: four storage images, twice, in place of the paper's render targets; or a queue in a buffer.

use gpu::{Bindings, Buffer, Device, GpuError, Image, ImageFormat};
use kernels::layout::{STATE_IN, STATE_OUT, STATE_ROW, StateRay};
use kernels::spirv::Rays;
use std::sync::Arc;

/// Where the ray state lives. Both give the same bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RayLoop {
    /// In four images that are read and four that are written: every pass carries every ray on (\[T\] §5).
    Images,
    /// In a buffer, in place: a pass writes of a ray what it changes, and a ray that is done costs nothing.
    /// Kernels read rays, polynomials, the grid's lists and volumes through uniform texel buffers then.
    Queue,
}

impl RayLoop {
    /// What a scene asks for, or the better of both; images where the device's texel buffers are too short for
    /// one of a list's `longest` texels.
    pub(crate) fn of(wanted: plan::RayLoop, device: &Device, longest: u64) -> Self {
        let fits = longest <= u64::from(device.limits().max_texel_buffer_elements);
        match wanted {
            plan::RayLoop::Queue | plan::RayLoop::Auto if fits => Self::Queue,
            _ => Self::Images,
        }
    }

    /// The variant of kernels for it.
    pub(crate) fn rays(self) -> Rays {
        match self {
            Self::Images => Rays::Images,
            Self::Queue => Rays::Queue,
        }
    }
}

/// The rays of a wave, one after another (`glsl/shared/state.glsl`).
enum StoredRays {
    /// Position, direction, cell and where the ray started, with the nearest hit so far packed among them;
    /// `STATE_ROW` rays a row.
    Images([Image; 4]),
    /// One [`StateRay`] each.
    Queue(Buffer),
}

impl StoredRays {
    fn new(device: &Arc<Device>, rays: u32, form: RayLoop) -> Result<Self, GpuError> {
        let size = [STATE_ROW, rays.div_ceil(STATE_ROW).max(1)];
        let image = |name| Image::new(device, name, size, ImageFormat::Rgba32Uint);
        let bytes = u64::from(rays.max(1)) * size_of::<StateRay>() as u64;
        Ok(match form {
            RayLoop::Images => Self::Images([
                image("ray position")?,
                image("ray direction")?,
                image("ray cell")?,
                image("ray start")?,
            ]),
            RayLoop::Queue => Self::Queue(Buffer::new(device, "ray queue", bytes)?),
        })
    }

    fn bind(&self, bindings: Bindings, first: u32) -> Bindings {
        match self {
            Self::Images(images) => (first..)
                .zip(images)
                .fold(bindings, |bindings, (binding, image)| bindings.image(binding, image)),
            Self::Queue(buffer) => bindings.buffer(first, buffer),
        }
    }
}

/// What a pass reads, and what it writes.
pub(crate) struct RayState {
    current: StoredRays,
    /// Of a queue there is another only where waves follow.
    next: Option<StoredRays>,
}

impl RayState {
    /// For so many rays. Where none `moves` on, there is no next wave.
    pub fn new(
        device: &Arc<Device>,
        rays: u32,
        form: RayLoop,
        moves: bool,
    ) -> Result<Self, GpuError> {
        let set = || StoredRays::new(device, rays, form);
        let next = if form == RayLoop::Images || moves { Some(set()?) } else { None };
        Ok(Self { current: set()?, next })
    }

    /// For a pass that reads rays, or updates some of them where they are.
    pub fn in_place(&self) -> Bindings {
        self.table(&self.current)
    }

    /// For a pass over all rays, or one that starts them, which [`RayState::passed`] follows.
    pub fn updated(&self) -> Bindings {
        match &self.current {
            StoredRays::Images(_) => self.moved(),
            StoredRays::Queue(_) => self.in_place(),
        }
    }

    /// For the pass that makes the next wave, which [`RayState::swap`] follows.
    pub fn moved(&self) -> Bindings {
        self.table(self.next.as_ref().unwrap_or(&self.current))
    }

    fn table(&self, written: &StoredRays) -> Bindings {
        written.bind(self.current.bind(Bindings::new(), STATE_IN), STATE_OUT)
    }

    /// After a pass over all rays: of images, what was written is read next.
    pub fn passed(&mut self) {
        if matches!(self.current, StoredRays::Images(_)) {
            self.swap();
        }
    }

    /// What was written is read next.
    pub fn swap(&mut self) {
        if let Some(next) = &mut self.next {
            std::mem::swap(&mut self.current, next);
        }
    }
}
