//! The ray state: four storage images, twice, in place of the paper's render targets; or a queue in a buffer.

use gpu::{Binding, Buffer, Device, GpuError, Image, ImageFormat, PassBuilder, Texel};
use kernels::layout::{STATE_IN, STATE_OUT, STATE_ROW, StateRay};
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

/// What a kernel does with the ray state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Touch {
    Reads,
    Writes,
    /// Reads rays, and writes the same ones, or those of the next wave.
    Updates,
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

    /// The bindings of a kernel that touches the state.
    pub(crate) fn bindings(self, touch: Touch) -> Vec<(u32, Binding)> {
        let at = |first: u32, queue| match self {
            Self::Images => (0..4).map(|i| (first + i, Binding::StorageImage)).collect(),
            Self::Queue => vec![(first, queue)],
        };
        let read = || at(STATE_IN, Binding::UniformTexelBuffer(Texel::Four));
        let written = || at(STATE_OUT, Binding::StorageBuffer);
        match touch {
            Touch::Reads => read(),
            Touch::Writes => written(),
            Touch::Updates => [read(), written()].concat(),
        }
    }

    /// How kernels read a list that no dispatch writes while they do.
    pub(crate) fn read(self, texel: Texel) -> Binding {
        match self {
            Self::Images => Binding::StorageBuffer,
            Self::Queue => Binding::UniformTexelBuffer(texel),
        }
    }

    /// The module of a kernel for it.
    pub(crate) fn module(self, images: fn() -> Vec<u32>, queue: fn() -> Vec<u32>) -> Vec<u32> {
        match self {
            Self::Images => images(),
            Self::Queue => queue(),
        }
    }
}

/// The rays of a wave, one after another (`glsl/shared/state.glsl`).
pub(crate) enum StoredRays {
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

    /// Binds them for a kernel that reads them.
    pub fn bind_read<'a>(&self, pass: PassBuilder<'a>) -> PassBuilder<'a> {
        self.bind(pass, STATE_IN)
    }

    /// Binds them for a kernel that writes all of them.
    pub fn bind_written<'a>(&self, pass: PassBuilder<'a>) -> PassBuilder<'a> {
        self.bind(pass, STATE_OUT)
    }

    /// Binds them for a kernel that updates some of them in place.
    pub fn bind_in_place<'a>(&self, pass: PassBuilder<'a>) -> PassBuilder<'a> {
        self.bind(self.bind(pass, STATE_IN), STATE_OUT)
    }

    fn bind<'a>(&self, pass: PassBuilder<'a>, first: u32) -> PassBuilder<'a> {
        match self {
            Self::Images(images) => (first..)
                .zip(images)
                .fold(pass, |pass, (binding, image)| pass.image(binding, image)),
            Self::Queue(buffer) => pass.buffer(first, buffer),
        }
    }
}

/// What a pass reads, and what it writes.
pub(crate) struct RayState {
    pub current: StoredRays,
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

    /// Binds it for a pass over all rays, which [`RayState::passed`] follows.
    pub fn bind_update<'a>(&self, pass: PassBuilder<'a>) -> PassBuilder<'a> {
        match &self.current {
            StoredRays::Images(_) => self.bind_move(pass),
            StoredRays::Queue(_) => self.current.bind_in_place(pass),
        }
    }

    /// Binds it for the pass that makes the next wave, which [`RayState::swap`] follows.
    pub fn bind_move<'a>(&self, pass: PassBuilder<'a>) -> PassBuilder<'a> {
        self.next().bind_written(self.current.bind_read(pass))
    }

    /// What a pass that starts rays writes, which [`RayState::passed`] follows.
    pub fn started(&self) -> &StoredRays {
        match &self.current {
            StoredRays::Images(_) => self.next(),
            StoredRays::Queue(_) => &self.current,
        }
    }

    fn next(&self) -> &StoredRays {
        self.next.as_ref().unwrap_or(&self.current)
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
