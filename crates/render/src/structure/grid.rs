//! Rays through the grid, cell after cell (\[T\] §5). Its lists are bound for all passes, since hits look around in them too.

use super::{Modules, Structure, TracePass};
use gpu::{Bindings, Constants, Recorder};
use kernels::layout::SCENE_SKIPS;
use kernels::spirv;
use points::device::Surfaces;

/// The grids of a scene.
pub(crate) struct Grid {
    /// What its kernel is specialized by.
    constants: Constants,
}

impl Grid {
    pub fn new(surfaces: &Surfaces, [scene, lighting]: Constants) -> Self {
        let skips = surfaces.is_listed && surfaces.grids.skip_cells();
        Self { constants: [scene | if skips { SCENE_SKIPS } else { 0 }, lighting] }
    }

    /// None are known ahead: `grid_trace` is specialized by whether cells are skipped, and that follows from how many there are.
    pub fn modules() -> Modules {
        Modules { trace: None, at_once: None, tile: Vec::new() }
    }
}

impl Structure for Grid {
    fn trace(&self, recorder: &mut Recorder, pass: &TracePass<'_>) {
        let module = spirv::grid_trace(pass.start, pass.rays);
        let recorded = recorder.pass_specialized(module, Some(self.constants));
        pass.record(recorded, &Bindings::new(), pass.params);
    }
}
