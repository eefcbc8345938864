//! Discs of leaves, eight points each, binned into screen tiles: count, scan, emit, sort, ranges (\[T\] §4).
//!
//! Depends on the camera, so it runs for every tile of every picture. Buffers stay from one to the
//! next and grow where they must.

use super::{Modules, Structure, TracePass};
use crate::RenderError;
use gpu::{Bindings, Buffer, Device, GpuError, Recorder, Timings};
use kernels::layout::{
    CameraTraceParams, DISC_KEYS, DISC_LEAVES, DISC_OFFSETS, DISC_TILES, DepthRanks, DiscParams,
    DiscTraceParams, LEAF_POINTS, POLYNOMIALS,
};
use kernels::spirv::{self, Camera, Module, Rays};
use plan::{MAX_DISC_PAIRS, Plan, Window, screen_tiles};
use points::device::{Pairs, Scan, Sort, SortSpace, Surfaces, line};
use std::sync::Arc;

/// Lanes that ask together (`glsl/shared/packet.glsl`).
const PACKET: u32 = 8;

/// The leaves of each screen tile, front to back.
#[derive(Debug)]
pub struct DiscLists {
    /// First and past-the-last pair of each screen tile; empty ones have zeros.
    pub tiles: Buffer,
    /// Screen tile and rank of each pair, ascending, and its leaf with those of its points that cover the tile.
    pub pairs: Pairs,
    /// How many pairs there are.
    pub pair_count: u32,
    /// How the pairs of a screen tile are ordered.
    pub ranks: DepthRanks,
    space: SortSpace,
    capacity: u32,
}

impl DiscLists {
    fn new(device: &Arc<Device>, tiles: u32, capacity: u32) -> Result<Self, GpuError> {
        Ok(Self {
            tiles: Buffer::new(device, "screen tiles", u64::from(tiles) * 8)?,
            pairs: Pairs::new(device, capacity)?,
            pair_count: 0,
            ranks: DepthRanks { nearest: 1.0, farthest: 1.0, shift: 0, bits: 0 },
            space: SortSpace::new(device, capacity)?,
            capacity,
        })
    }
}

impl DiscLists {
    /// For the kernels that read them.
    pub(crate) fn bindings(&self) -> Bindings {
        Bindings::new()
            .buffer(DISC_TILES, &self.tiles)
            .buffer(DISC_KEYS, &self.pairs.keys)
            .buffer(DISC_LEAVES, &self.pairs.slots)
    }
}

/// Bins the discs of a scene.
pub(crate) struct Discs {
    device: Arc<Device>,
    rays: Rays,
    offsets: Buffer,
    levels: Vec<Buffer>,
    lists: Option<DiscLists>,
}

impl Discs {
    /// For a scene of `point_count` points.
    pub fn new(device: &Arc<Device>, point_count: u32, rays: Rays) -> Result<Self, GpuError> {
        let leaves = point_count.div_ceil(LEAF_POINTS);
        Ok(Self {
            device: Arc::clone(device),
            rays,
            offsets: Buffer::new(device, "disc offsets", (u64::from(leaves) + 1) * 4)?,
            levels: Scan::levels(device, leaves + 1)?,
            lists: None,
        })
    }

    pub fn modules(device: &Device, rays: Rays) -> Modules {
        let own = [spirv::disc_count(rays), spirv::disc_emit(rays), spirv::disc_ranges()];
        Modules {
            trace: Some(spirv::disc_trace(rays)),
            at_once: module_at_once(device),
            tile: [&own[..], &Scan::modules(), &Sort::modules()].concat(),
        }
    }

    /// What was made of the last tile that was binned.
    pub fn lists(&self) -> Option<&DiscLists> {
        self.lists.as_ref()
    }

    /// Lists the points of each screen tile of a tile of the picture; `None` where the pairs are
    /// too many. `timed` is told what each submission cost; the last is the caller's.
    fn bin(
        &mut self,
        rec: &mut Recorder,
        (plan, tile, surfaces): (&Plan, &Window, &Surfaces),
        timed: &mut dyn FnMut(&Timings),
    ) -> Result<Option<&DiscLists>, GpuError> {
        let counted = plan.discs_of(tile, &surfaces.grids);
        let pair_count = self.count_pairs(rec, &surfaces.polynomials, &counted, timed)?;
        if pair_count > MAX_DISC_PAIRS {
            return Ok(None);
        }
        let params = DiscParams { pair_count, ..counted };
        self.list_pairs(rec, &surfaces.polynomials, &params, screen_tiles(tile))?;
        Ok(self.lists.as_ref())
    }

    fn count_pairs(
        &self,
        rec: &mut Recorder,
        polynomials: &Buffer,
        params: &DiscParams,
        timed: &mut dyn FnMut(&Timings),
    ) -> Result<u32, GpuError> {
        let leaves = params.point_count.div_ceil(LEAF_POINTS);
        let end = u64::from(leaves) * 4;
        rec.fill(&self.offsets, end, 4, 0);
        rec.pass(spirv::disc_count(self.rays))
            .buffer(POLYNOMIALS, polynomials)
            .buffer(DISC_OFFSETS, &self.offsets)
            .push(params)
            .dispatch(line(leaves));
        Scan::record(rec, &self.offsets, leaves + 1, &self.levels);
        timed(&rec.submit()?);
        let mut total = [0];
        self.offsets.read(end, &mut total)?;
        Ok(total[0])
    }

    fn list_pairs(
        &mut self,
        rec: &mut Recorder,
        polynomials: &Buffer,
        params: &DiscParams,
        tiles: u32,
    ) -> Result<(), GpuError> {
        let fits = |lists: &DiscLists| {
            lists.capacity >= params.pair_count && lists.tiles.bytes() >= u64::from(tiles) * 8
        };
        let kept = self.lists.take().filter(fits);
        let mut lists = match kept {
            Some(lists) => lists,
            // A quarter more: the next picture's camera is often a little nearer.
            None => {
                let capacity = (params.pair_count + params.pair_count / 4).min(MAX_DISC_PAIRS);
                DiscLists::new(&self.device, tiles, capacity)?
            }
        };
        (lists.pair_count, lists.ranks) = (params.pair_count, params.ranks);
        rec.fill(&lists.tiles, 0, u64::from(tiles) * 8, 0);
        if params.pair_count > 0 {
            rec.pass(spirv::disc_emit(self.rays))
                .buffer(POLYNOMIALS, polynomials)
                .buffer(DISC_OFFSETS, &self.offsets)
                .buffer(DISC_KEYS, &lists.pairs.keys)
                .buffer(DISC_LEAVES, &lists.pairs.slots)
                .push(params)
                .dispatch(line(params.point_count.div_ceil(LEAF_POINTS)));
            let largest = (tiles << params.ranks.bits) - 1;
            let DiscLists { pairs, space, pair_count, .. } = &mut lists;
            Sort::record(rec, pairs, space, *pair_count, largest);
            rec.pass(spirv::disc_ranges())
                .buffer(DISC_KEYS, &lists.pairs.keys)
                .buffer(DISC_TILES, &lists.tiles)
                .push(params)
                .dispatch(line(params.pair_count));
        }
        self.lists = Some(lists);
        Ok(())
    }
}

/// What traces the first wave in one pass by the lists of screen tiles, where the device's subgroups are made of packets
/// of eight that can vote.
fn module_at_once(device: &Device) -> Option<&'static Module> {
    let subgroup = device.limits().subgroup_size;
    let has_packets = subgroup != 0 && subgroup.is_multiple_of(PACKET);
    has_packets.then(|| spirv::camera_trace(Camera::Discs))
}

impl Structure for Discs {
    fn take_tile(
        &mut self,
        recorder: &mut Recorder,
        of: (&Plan, &Window, &Surfaces),
        timed: &mut dyn FnMut(&Timings),
    ) -> Result<bool, RenderError> {
        Ok(self.bin(recorder, of, timed)?.is_some())
    }

    /// They cross no cells, so that K does not count.
    fn trace(&self, recorder: &mut Recorder, pass: &TracePass<'_>) {
        let lists = self.lists.as_ref().unwrap_or_else(|| unreachable!("a tile was taken"));
        let params = DiscTraceParams { wave: *pass.params, ranks: lists.ranks };
        let recorded = recorder.pass(spirv::disc_trace(self.rays));
        pass.record(recorded, &lists.bindings(), &params);
    }

    fn at_once(
        &self,
        device: &Device,
        _params: &mut CameraTraceParams,
    ) -> Option<(&'static Module, Bindings)> {
        Some((module_at_once(device)?, self.lists.as_ref()?.bindings()))
    }
}
