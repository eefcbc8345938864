//! What rays go through to their nearest hits: the host's part of `glsl/shared/structure.glsl`. Each structure has a file
//! here, which says what it is made of, what it binds and how it traces; stages know [`Structure`] only.

mod discs;
mod grid;
mod tree;

pub use discs::DiscLists;

use crate::RenderError;
use crate::state::{RayLoop, RayState};
use discs::Discs;
use gpu::{Bindings, Constants, Device, PassBuilder, Recorder, Timings};
use grid::Grid;
use kernels::layout::{CameraTraceParams, TraceParams};
use kernels::spirv::{Module, Rays, Start};
use plan::{Plan, RaysFrom, StructureKind, Window};
use points::device::{Surfaces, line};
use std::sync::Arc;
use tree::Tree;

/// What rays go through. Each finds the hits of any other, to the bit.
pub(crate) trait Structure {
    /// Makes it ready for the camera rays of a tile of the picture; whether it can be. `timed` is told what each
    /// submission cost; the last is the caller's.
    fn take_tile(
        &mut self,
        _recorder: &mut Recorder,
        _of: (&Plan, &Window, &Surfaces),
        _timed: &mut dyn FnMut(&Timings),
    ) -> Result<bool, RenderError> {
        Ok(true)
    }

    /// Records a pass over the rays of a wave, or over listed ones.
    fn trace(&self, recorder: &mut Recorder, pass: &TracePass<'_>);

    /// What traces the first wave of a tile in one pass, and what it reads, where there is such a kernel.
    fn at_once(
        &self,
        _device: &Device,
        _params: &mut CameraTraceParams,
    ) -> Option<(&'static Module, Bindings)> {
        None
    }
}

/// What a pass over rays works on.
pub(crate) struct TracePass<'a> {
    pub params: &'a TraceParams,
    pub state: &'a RayState,
    /// The marks of rays that have not ended, and the list of those that live.
    pub listed: Bindings,
    /// What is bound for all passes.
    pub bound: &'a Bindings,
    pub start: Start,
    pub rays: Rays,
}

impl TracePass<'_> {
    /// Records it. Listed rays stay where they are, and the others with them; of all, the caller then swaps the state.
    fn record<P: bytemuck::NoUninit>(&self, pass: PassBuilder<'_>, own: &Bindings, params: &P) {
        let is_listed = self.params.listed != 0;
        let state = if is_listed { self.state.in_place() } else { self.state.updated() };
        let pass = pass.bind(&state).bind(&self.listed).bind(own).bind(self.bound);
        pass.push(params).dispatch(line(self.params.ray_count));
    }
}

/// Those that a renderer has.
pub(crate) struct Structures {
    grid: Grid,
    tree: Option<Tree>,
    discs: Discs,
}

impl Structures {
    /// Over surfaces that were built, for kernels that are specialized by `constants`.
    pub fn new(
        device: &Arc<Device>,
        surfaces: &Surfaces,
        (form, constants): (RayLoop, Constants),
    ) -> Result<Self, RenderError> {
        Ok(Self {
            grid: Grid::new(surfaces, constants),
            tree: surfaces.tree.as_ref().map(Tree::new),
            discs: Discs::new(device, surfaces.outcomes.len() as u32, form.rays())?,
        })
    }

    /// One of them, if there is one.
    pub fn get(&self, kind: StructureKind) -> Option<&dyn Structure> {
        match kind {
            StructureKind::Grid => Some(&self.grid),
            StructureKind::Tree => self.tree.as_ref().map(|tree| tree as &dyn Structure),
            StructureKind::Discs => Some(&self.discs),
        }
    }

    fn get_mut(&mut self, kind: StructureKind) -> Option<&mut dyn Structure> {
        match kind {
            StructureKind::Grid => Some(&mut self.grid),
            StructureKind::Tree => self.tree.as_mut().map(|tree| tree as &mut dyn Structure),
            StructureKind::Discs => Some(&mut self.discs),
        }
    }

    /// What rays that are not a tile's from the camera go through.
    pub fn of(&self, plan: &Plan, from: RaysFrom<'_>) -> StructureKind {
        let mut wanted = plan.structures(from).into_iter();
        wanted.find(|&kind| self.get(kind).is_some()).unwrap_or(StructureKind::Grid)
    }

    /// What the camera's rays of a tile go through, made ready for it.
    pub fn for_tile(
        &mut self,
        recorder: &mut Recorder,
        of: (&Plan, &Window, &Surfaces),
        timed: &mut dyn FnMut(&Timings),
    ) -> Result<StructureKind, RenderError> {
        for kind in of.0.structures(RaysFrom::Tile(of.1)) {
            if let Some(structure) = self.get_mut(kind)
                && structure.take_tile(recorder, of, timed)?
            {
                return Ok(kind);
            }
        }
        Ok(StructureKind::Grid)
    }

    /// The points of the last tile's screen tiles, where a tile was traced by discs.
    pub fn disc_lists(&self) -> Option<&DiscLists> {
        self.discs.lists()
    }
}

/// The kernels that trace through one.
pub(crate) struct Modules {
    /// Rays from the camera, or others; none where their form is not known before it is built.
    pub trace: Option<&'static Module>,
    /// The first wave of a tile at once.
    pub at_once: Option<&'static Module>,
    /// What it makes of each tile before.
    pub tile: Vec<&'static Module>,
}

/// Those of a structure, as far as they are known ahead.
pub(crate) fn modules(
    kind: StructureKind,
    device: &Device,
    (start, rays): (Start, Rays),
) -> Modules {
    match kind {
        StructureKind::Grid => Grid::modules(),
        StructureKind::Tree => Tree::modules(start),
        StructureKind::Discs => Discs::modules(device, rays),
    }
}
