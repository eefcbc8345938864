//! The pass `camera_trace`.

use super::{disc_lists, over_pixels, surface_lists};
use crate::discs::DiscLists;
use crate::state::{RayLoop, StoredRays, Touch};
use crate::wave::WaveBuffers;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder, Texel};
use kernels::layout::{
    CameraTraceParams, DISC_KEYS_IN, DISC_LEAVES_IN, DISC_RANGES_IN, SHADE_FILM, SHADE_IMAGES,
    SHADE_OBJECTS, SHADE_TEXELS, TRACE_CELLS, TRACE_HITS, TRACE_INFO, TRACE_LIVE, TRACE_NODES,
    TRACE_POLYNOMIALS, TRACE_SLOTS, WAVE_LIT, WAVE_LIT_HITS, WAVE_NEXT_MARKS, WAVE_SCATTERING,
};
use kernels::spirv;
use points::device::{Surfaces, Tree};
use std::sync::Arc;

/// Lanes that ask together (`glsl/shared/packet.glsl`).
const PACKET: u32 = 8;

/// How its rays find their hits.
#[derive(Clone, Copy)]
pub(crate) enum CameraWay<'a> {
    Discs(&'a Kernel, &'a DiscLists),
    Tree(&'a Kernel, &'a Tree),
}

/// What the pass works on.
#[derive(Clone, Copy)]
pub(crate) struct CameraTraceIo<'a> {
    pub way: CameraWay<'a>,
    pub surfaces: &'a Surfaces,
    pub objects: &'a Buffer,
    pub images: &'a Buffer,
    pub texels: &'a Buffer,
    pub film: &'a Buffer,
    /// Of rays that scatter.
    pub state: &'a StoredRays,
    pub hits: &'a Buffer,
    /// Marks are none before.
    pub wave: &'a WaveBuffers,
    /// One u32, zero before: how many rays have not ended.
    pub live: &'a Buffer,
}

/// The first wave from the eye to the film, where nothing but surfaces meets it (\[T\] §4).
pub(crate) struct CameraTrace {
    /// Where the device's subgroups are made of packets of eight that can vote.
    pub by_discs: Option<Kernel>,
    pub by_tree: Kernel,
}

impl CameraTrace {
    pub const NAME: &'static str = "camera_trace";

    pub fn new(device: &Arc<Device>, scene: u32) -> Result<Self, GpuError> {
        let form = RayLoop::Queue;
        let buffers = [
            TRACE_INFO,
            TRACE_LIVE,
            TRACE_HITS,
            SHADE_IMAGES,
            SHADE_TEXELS,
            SHADE_FILM,
            WAVE_LIT,
            WAVE_LIT_HITS,
            WAVE_SCATTERING,
            WAVE_NEXT_MARKS,
        ];
        let mut bindings = form.bindings(Touch::Writes);
        bindings.extend(buffers.map(|binding| (binding, Binding::StorageBuffer)));
        bindings.push((SHADE_OBJECTS, form.read(Texel::Four)));
        bindings.extend(surface_lists(form));
        let kernel = |module: &[u32], lists: &[(u32, Binding)]| {
            let bindings = [&bindings[..], lists].concat();
            let params = size_of::<CameraTraceParams>();
            Kernel::specialized(device, Self::NAME, module, &bindings, params, Some(scene))
        };
        let subgroup = device.limits().subgroup_size;
        let has_packets = subgroup != 0 && subgroup.is_multiple_of(PACKET);
        let by_discs = || kernel(&spirv::camera_trace(), &disc_lists(form));
        Ok(Self {
            by_discs: has_packets.then(by_discs).transpose()?,
            by_tree: kernel(&spirv::camera_trace_tree(), &[(TRACE_NODES, form.read(Texel::Four))])?,
        })
    }

    /// By discs, where the device can.
    pub fn discs<'a>(&'a self, lists: &'a DiscLists) -> Option<CameraWay<'a>> {
        self.by_discs.as_ref().map(|kernel| CameraWay::Discs(kernel, lists))
    }

    /// Through the tree.
    pub fn tree<'a>(&'a self, tree: &'a Tree) -> CameraWay<'a> {
        CameraWay::Tree(&self.by_tree, tree)
    }

    /// Records the first wave of a tile.
    pub fn record(rec: &mut Recorder, io: CameraTraceIo<'_>, params: &CameraTraceParams) {
        let mut params = *params;
        let pass = match io.way {
            CameraWay::Discs(kernel, lists) => rec
                .pass(Self::NAME, kernel)
                .buffer(DISC_RANGES_IN, &lists.tiles)
                .buffer(DISC_KEYS_IN, &lists.pairs.keys)
                .buffer(DISC_LEAVES_IN, &lists.pairs.slots),
            CameraWay::Tree(kernel, tree) => {
                params.tree = tree.info;
                rec.pass(Self::NAME, kernel).buffer(TRACE_NODES, &tree.nodes)
            }
        };
        io.state
            .bind_written(pass)
            .buffer(TRACE_INFO, &io.surfaces.grid_levels)
            .buffer(TRACE_CELLS, &io.surfaces.cells)
            .buffer(TRACE_SLOTS, &io.surfaces.slots)
            .buffer(TRACE_POLYNOMIALS, &io.surfaces.polynomials)
            .buffer(TRACE_LIVE, io.live)
            .buffer(SHADE_OBJECTS, io.objects)
            .buffer(SHADE_IMAGES, io.images)
            .buffer(SHADE_TEXELS, io.texels)
            .buffer(SHADE_FILM, io.film)
            .buffer(TRACE_HITS, io.hits)
            .buffer(WAVE_LIT, &io.wave.lit.bits)
            .buffer(WAVE_LIT_HITS, io.wave.lit_hits())
            .buffer(WAVE_SCATTERING, &io.wave.scattering.bits)
            .buffer(WAVE_NEXT_MARKS, &io.wave.next.bits)
            .push(&params)
            .dispatch(over_pixels(params.tile_size));
    }
}
