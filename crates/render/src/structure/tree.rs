//! Rays through the tree of boxes around points.

use super::{Modules, Structure, TracePass};
use gpu::{Bindings, Device, Recorder};
use kernels::layout::{CameraTraceParams, TREE_NODES, TreeInfo, TreeTraceParams};
use kernels::spirv::{self, Camera, Module, Start};
use points::device;

/// The tree of a scene, for rays of a queue.
pub(crate) struct Tree {
    nodes: Bindings,
    info: TreeInfo,
}

impl Tree {
    pub fn new(built: &device::Tree) -> Self {
        Self { nodes: Bindings::new().buffer(TREE_NODES, &built.nodes), info: built.info }
    }

    pub fn modules(start: Start) -> Modules {
        let at_once = Some(spirv::camera_trace(Camera::Tree));
        Modules { trace: Some(spirv::tree_trace(start)), at_once, tile: Vec::new() }
    }
}

impl Structure for Tree {
    fn trace(&self, recorder: &mut Recorder, pass: &TracePass<'_>) {
        let params = TreeTraceParams { wave: *pass.params, tree: self.info };
        pass.record(recorder.pass(spirv::tree_trace(pass.start)), &self.nodes, &params);
    }

    fn at_once(
        &self,
        _device: &Device,
        params: &mut CameraTraceParams,
    ) -> Option<(&'static Module, Bindings)> {
        params.tree = self.info;
        Some((spirv::camera_trace(Camera::Tree), self.nodes.clone()))
    }
}
