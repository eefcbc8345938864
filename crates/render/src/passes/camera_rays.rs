//! The pass `camera_rays`.

use super::over_pixels;
use crate::state::{RayLoop, StoredRays, Touch};
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{CAMERA_FILTER, CAMERA_PATH, CameraParams, TRACE_INFO, WAVE_PATHS};
use kernels::spirv;
use std::sync::Arc;

/// What the pass works on.
#[derive(Clone, Copy)]
pub(crate) struct CameraRaysIo<'a> {
    pub grid_levels: &'a Buffer,
    /// Where the reconstruction filter's integral takes equal steps.
    pub filter: &'a Buffer,
    /// The path of every ray, but for its pixel.
    pub start: &'a Buffer,
    pub state: &'a StoredRays,
    pub paths: &'a Buffer,
}

/// The camera's ray of each pixel, in the first cell that it meets.
pub(crate) struct CameraRays {
    pub kernel: Kernel,
}

impl CameraRays {
    pub const NAME: &'static str = "camera_rays";

    pub fn new(device: &Arc<Device>, form: RayLoop) -> Result<Self, GpuError> {
        let mut bindings = form.bindings(Touch::Writes);
        bindings.extend(
            [TRACE_INFO, CAMERA_FILTER, CAMERA_PATH, WAVE_PATHS]
                .map(|at| (at, Binding::StorageBuffer)),
        );
        let params = size_of::<CameraParams>();
        let kernel = Kernel::new(
            device,
            Self::NAME,
            &form.module(spirv::camera_rays, spirv::camera_rays_queue),
            &bindings,
            params,
        )?;
        Ok(Self { kernel })
    }

    /// Records the start of every ray of a tile.
    pub fn record(&self, rec: &mut Recorder, io: CameraRaysIo<'_>, params: &CameraParams) {
        io.state
            .bind_written(rec.pass(Self::NAME, &self.kernel))
            .buffer(TRACE_INFO, io.grid_levels)
            .buffer(WAVE_PATHS, io.paths)
            .buffer(CAMERA_FILTER, io.filter)
            .buffer(CAMERA_PATH, io.start)
            .push(params)
            .dispatch(over_pixels(params.tile_size));
    }
}
