//! The pass `shade`.

use super::{AlbedoIo, bind_state, over_pixels, state_bindings};
use crate::state::StateImages;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{SHADE_FILM, SHADE_LIGHTS, STATE_IN, ShadeParams, TRACE_HITS};
use kernels::spirv;
use std::sync::Arc;

/// What the pass works on.
pub(crate) struct ShadeIo<'a> {
    pub state: &'a StateImages,
    pub albedos: AlbedoIo<'a>,
    pub hits: &'a Buffer,
    pub lights: &'a Buffer,
    pub film: &'a Buffer,
}

/// Lambert's law at the hit of each ray, the background where there is none (method, section 4).
pub(crate) struct Shade {
    kernel: Kernel,
}

impl Shade {
    pub const NAME: &'static str = "shade";

    pub fn new(device: &Arc<Device>) -> Result<Self, GpuError> {
        let mut bindings = state_bindings(STATE_IN).to_vec();
        bindings.extend(AlbedoIo::BINDINGS);
        let buffers = [TRACE_HITS, SHADE_LIGHTS, SHADE_FILM];
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        let params = size_of::<ShadeParams>();
        let kernel = Kernel::new(device, Self::NAME, &spirv::shade(), &bindings, params)?;
        Ok(Self { kernel })
    }

    /// Records the shading of a tile whose rays have all ended.
    pub fn record(&self, rec: &mut Recorder, io: ShadeIo<'_>, params: &ShadeParams) {
        let pass = bind_state(rec.pass(Self::NAME, &self.kernel), STATE_IN, io.state);
        io.albedos
            .bind(pass)
            .buffer(TRACE_HITS, io.hits)
            .buffer(SHADE_LIGHTS, io.lights)
            .buffer(SHADE_FILM, io.film)
            .push(params)
            .dispatch(over_pixels(params.tile_size));
    }
}
