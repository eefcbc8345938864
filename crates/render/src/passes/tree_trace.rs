//! The pass `tree_trace`.

use super::{Start, TraceIo};
use crate::state::{RayLoop, Touch};
use gpu::{Binding, Device, GpuError, Kernel, Recorder, Texel};
use kernels::layout::{
    LIVE_RAYS, TRACE_LIVE, TRACE_NODES, TRACE_POLYNOMIALS, TraceParams, TreeTraceParams, WAVE_MARKS,
};
use kernels::spirv;
use points::device::{Tree, line};
use std::sync::Arc;

/// Lets each live ray visit nodes of the tree.
pub(crate) struct TreeTrace {
    pub from_camera: Kernel,
    /// For rays from surfaces.
    pub leaving: Kernel,
}

impl TreeTrace {
    pub const NAME: &'static str = "tree_trace";

    pub fn new(device: &Arc<Device>, scene: u32) -> Result<Self, GpuError> {
        let form = RayLoop::Queue;
        let mut bindings = form.bindings(Touch::Updates);
        let buffers = [TRACE_LIVE, LIVE_RAYS, WAVE_MARKS];
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        bindings.extend([TRACE_POLYNOMIALS, TRACE_NODES].map(|at| (at, form.read(Texel::Four))));
        let params = size_of::<TreeTraceParams>();
        let kernel = |module: &[u32]| {
            Kernel::specialized(device, Self::NAME, module, &bindings, params, Some(scene))
        };
        Ok(Self {
            from_camera: kernel(&spirv::tree_trace())?,
            leaving: kernel(&spirv::tree_trace_leaving())?,
        })
    }

    /// Records one pass, the first of a wave if `starts`.
    pub fn record(
        &self,
        rec: &mut Recorder,
        io: TraceIo<'_>,
        tree: &Tree,
        start: Start,
        params: &TraceParams,
        starts: bool,
    ) {
        let kernel = match start {
            Start::Camera => &self.from_camera,
            Start::Surface => &self.leaving,
        };
        let TraceParams { ray_count, work, any_hit, listed, passed, .. } = *params;
        let (starts, tree_info) = (u32::from(starts), tree.info);
        io.state
            .current
            .bind_in_place(rec.pass(Self::NAME, kernel))
            .buffer(TRACE_NODES, &tree.nodes)
            .buffer(TRACE_POLYNOMIALS, &io.surfaces.polynomials)
            .buffer(TRACE_LIVE, io.live)
            .buffer(LIVE_RAYS, io.live_rays)
            .buffer(WAVE_MARKS, io.marks)
            .push(&TreeTraceParams {
                ray_count,
                work,
                any_hit,
                listed,
                passed,
                starts,
                tree: tree_info,
            })
            .dispatch(line(ray_count));
    }
}
