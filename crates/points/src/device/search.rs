//! Exact nearest neighbours on the device: the passes `leaf_boxes`, `node_boxes`, `bound_reach`,
//! `gather_leaves` and `find_neighbors`.
//!
//! Points lie along a Hilbert curve, so eight consecutive ones are a leaf, eight leaves a node, and so on: a
//! tree without a build, of any density. A first bound comes from the points around one in memory; then each
//! leaf's points look together for the leaves that their balls touch; then each point goes through its own.
//! What is pruned is pruned by a distance computed with the operations of d², and rounding is monotone, so
//! the lists are those of [`NeighborSearch`], ties included.
//!
//! Work is bounded. A leaf whose points touch too many others, since little of what is near them is near them
//! in memory, is searched again with more room; one that touches thousands (with a point far from all, whose
//! ball holds the whole set) is left to the host, and counted. So are all points where each has more than 64
//! neighbours, for which the kernels have no registers.

use super::line;
use super::work::Work;
use crate::neighbors::nearest_of_few;
use crate::{NeighborSearch, SlotRange};
use gpu::{Buffer, Device, GpuError};
use kernels::layout::{
    LEAF_LEVELS, LEAF_POINTS, LevelParams, NEIGHBORS, NONE, POINTS, Point, SEARCH_BOUNDS,
    SEARCH_COUNTS, SEARCH_GROUPS, SEARCH_LEAVES, SEARCH_NODES, SEARCH_TIES, SearchNode,
    SearchParams,
};
use kernels::spirv::{self, Finding, Lists, Module, Neighbors};
use std::sync::Arc;

/// Of so many leaves with ties one, and all are taken to have some: lattices and terrains.
const TIED_SHARE: usize = 16;
/// Neighbours that the smaller kernels find, at most.
const FEW: u32 = 16;
/// Neighbours that the kernels find, at most.
const MANY: u32 = 64;
/// Points whose neighbours are listed and fitted in one go: 8 MiB of lists at k = 16, 32 at 64 and above.
pub(crate) const BATCH: u32 = 1 << 17;
/// Leaves that a leaf's points may touch, for every 16 neighbours.
const CAPACITY: u32 = 96;
/// The same for the few leaves whose points touched more, and how many of those are searched in one go. Work
/// stays below the 65 535 loop iterations after which lavapipe stops: a window of 32 leaves takes at most 280.
const LARGE_CAPACITY: u32 = 4096;
const LARGE_GROUPS: u32 = 256;
/// Leaves of a batch that the host searches without a tree.
const WITHOUT_TREE: usize = 64;

/// How the kernels read points.
pub(crate) struct Search {
    device: Arc<Device>,
    lists: Lists,
}

/// The boxes around one object's points.
pub(crate) struct Boxes {
    object: SlotRange,
    nodes: Buffer,
    root: u32,
    leaf_count: u32,
}

/// Space for one batch of points of an object.
pub(crate) struct SearchSpace {
    neighbors: u32,
    stride: u32,
    capacity: u32,
    bounds: Buffer,
    leaves: Buffer,
    counts: Buffer,
    large_leaves: Buffer,
    large_counts: Buffer,
    groups: Buffer,
    /// A word a leaf.
    ties: Buffer,
    /// Whether ties were found to be the rule.
    tied: bool,
    /// Slots, `stride` a point, nearest first, `NONE` behind the last.
    pub lists: Buffer,
}

impl Search {
    /// `lists`: how points and boxes are read.
    pub fn new(device: &Arc<Device>, lists: Lists) -> Self {
        Self { device: Arc::clone(device), lists }
    }

    /// How many points are searched for in one go, at most, where each has so many neighbours: whole leaves.
    pub fn batch(neighbors: u32) -> u32 {
        BATCH * MANY / neighbors.max(MANY) / LEAF_POINTS * LEAF_POINTS
    }

    /// What searches of so many neighbours take, those first that take longest to compile.
    pub fn modules(&self, neighbors: u32) -> Vec<&'static Module> {
        if neighbors > MANY {
            return Vec::new();
        }
        let others = [
            self.find_module(neighbors),
            spirv::gather_leaves(self.lists),
            self.bound_module(neighbors),
            spirv::leaf_boxes(self.lists),
            spirv::node_boxes(),
        ];
        self.untied_module(neighbors).into_iter().chain(others).collect()
    }

    fn bound_module(&self, neighbors: u32) -> &'static Module {
        spirv::bound_reach(match self.lists {
            Lists::Storage => Neighbors::Storage,
            Lists::Texels if neighbors > FEW => Neighbors::Texels,
            Lists::Texels => Neighbors::Few,
        })
    }

    fn find_module(&self, neighbors: u32) -> &'static Module {
        spirv::find_neighbors(match self.lists {
            Lists::Storage => Finding::Storage,
            Lists::Texels if neighbors > FEW => Finding::Texels,
            Lists::Texels => Finding::Few,
        })
    }

    /// The same where no two others are equally far; with texels only, and few neighbours.
    fn untied_module(&self, neighbors: u32) -> Option<&'static Module> {
        let has_one = self.lists == Lists::Texels && neighbors <= FEW;
        has_one.then(|| spirv::find_neighbors(Finding::Untied))
    }

    /// Records the boxes around the points of one object, whose lists will have at most `neighbors` entries.
    pub fn record_boxes(
        &self,
        rec: &mut Work,
        points: &Buffer,
        object: SlotRange,
        neighbors: u32,
    ) -> Result<Boxes, GpuError> {
        let mut offsets = [0; LEAF_LEVELS as usize];
        let mut counts = vec![];
        let mut boxes = object.count;
        let mut total = 0;
        while counts.is_empty() || boxes > LEAF_POINTS {
            boxes = boxes.div_ceil(LEAF_POINTS).next_multiple_of(LEAF_POINTS);
            offsets[counts.len()] = total;
            total += boxes;
            counts.push(boxes);
        }
        let is_searched = neighbors <= MANY;
        let bytes = if is_searched { u64::from(total) * size_of::<SearchNode>() as u64 } else { 4 };
        let nodes = Buffer::new(&self.device, "search boxes", bytes)?;
        let top = counts.len() - 1;
        for (level, &count) in counts.iter().enumerate().filter(|_| is_searched) {
            let params = LevelParams {
                first_slot: object.first_slot,
                point_count: object.count,
                neighbors,
                level: level as u32,
                top: top as u32,
                count,
                offsets,
            };
            if level == 0 {
                rec.pass(spirv::leaf_boxes(self.lists))
                    .buffer(POINTS, points)
                    .buffer(SEARCH_NODES, &nodes)
                    .push(&params)
                    .dispatch(line(count));
            } else {
                rec.pass(spirv::node_boxes())
                    .buffer(SEARCH_NODES, &nodes)
                    .push(&params)
                    .dispatch(line(count));
            }
        }
        Ok(Boxes { object, nodes, root: offsets[top], leaf_count: counts[0] })
    }

    /// Space for lists of so many entries of at most so many points.
    pub fn space(&self, points: u32, neighbors: u32) -> Result<SearchSpace, GpuError> {
        let device = &self.device;
        let stride = neighbors.next_multiple_of(4);
        let searched = if neighbors <= MANY { points } else { 1 };
        let groups = searched.div_ceil(LEAF_POINTS);
        let capacity = CAPACITY * neighbors.div_ceil(FEW);
        let words = |name, count: u64| Buffer::new(device, name, 4 * count);
        Ok(SearchSpace {
            neighbors,
            stride,
            capacity,
            bounds: words("neighbor bounds", u64::from(searched))?,
            leaves: words("leaf lists", u64::from(groups) * u64::from(capacity))?,
            counts: words("leaf counts", u64::from(groups))?,
            large_leaves: words(
                "large leaf lists",
                u64::from(groups.min(LARGE_GROUPS)) * u64::from(LARGE_CAPACITY),
            )?,
            large_counts: words("large leaf counts", u64::from(LARGE_GROUPS))?,
            ties: words("leaves with ties", u64::from(groups))?,
            tied: false,
            groups: words("large leaves", u64::from(LARGE_GROUPS))?,
            lists: words("neighbors", u64::from(points) * u64::from(stride))?,
        })
    }

    /// Finds the neighbours of `count` points from place `first` of the object on; returns how many of them
    /// were left to the host. `own` has the object's points.
    pub fn find<'a>(
        &self,
        rec: &mut Work,
        points: &Buffer,
        boxes: &Boxes,
        space: &mut SearchSpace,
        [first, count]: [u32; 2],
        (own, on_host): (&'a [Point], &mut Option<NeighborSearch<'a>>),
    ) -> Result<u64, GpuError> {
        let params = SearchParams {
            first_slot: boxes.object.first_slot,
            point_count: boxes.object.count,
            batch_first: first,
            batch_count: count,
            neighbors: space.neighbors,
            stride: space.stride,
            capacity: space.capacity,
            root: boxes.root,
            leaf_count: boxes.leaf_count,
            listed: 0,
        };
        if space.neighbors > MANY {
            let all: Vec<u32> = (0..count.div_ceil(LEAF_POINTS)).collect();
            return space.find_on_host(&all, own, &params, on_host);
        }
        if !space.neighbors.is_multiple_of(4) {
            let bytes = u64::from(count) * u64::from(space.stride) * 4;
            rec.fill(&space.lists, 0, bytes, NONE);
        }
        rec.pass(self.bound_module(space.neighbors))
            .buffer(POINTS, points)
            .buffer(SEARCH_BOUNDS, &space.bounds)
            .push(&params)
            .dispatch(line(count));
        let groups = count.div_ceil(LEAF_POINTS);
        let all = [&space.leaves, &space.counts];
        self.record_gather(rec, points, boxes, space, all, &params);
        let untied = self.untied_module(space.neighbors).filter(|_| !space.tied);
        if let Some(untied) = untied {
            rec.fill(&space.ties, 0, u64::from(groups) * 4, 0);
            rec.pass(untied)
                .buffer(POINTS, points)
                .buffer(SEARCH_BOUNDS, &space.bounds)
                .buffer(SEARCH_LEAVES, &space.leaves)
                .buffer(SEARCH_COUNTS, &space.counts)
                .buffer(NEIGHBORS, &space.lists)
                .buffer(SEARCH_GROUPS, &space.groups)
                .buffer(SEARCH_TIES, &space.ties)
                .push(&params)
                .dispatch(line(count));
        } else {
            self.record_find(rec, points, space, all, &params);
        }
        rec.submit()?;
        let mut left = unfinished(&space.counts, groups, NONE)?;
        if untied.is_some() {
            let tied = unfinished(&space.ties, groups, 1)?;
            if tied.len() * TIED_SHARE > groups as usize {
                space.tied = true;
                self.record_find(rec, points, space, all, &params);
                rec.submit()?;
            } else {
                left.extend(tied);
                left.sort_unstable();
                left.dedup();
            }
        }
        if left.is_empty() {
            return Ok(0);
        }
        let mut too_large = Vec::new();
        for groups in left.chunks_mut(LARGE_GROUPS as usize) {
            space.groups.write(0, groups)?;
            let listed = groups.len() as u32;
            let params = SearchParams { listed, capacity: LARGE_CAPACITY, ..params };
            let large = [&space.large_leaves, &space.large_counts];
            self.record_gather(rec, points, boxes, space, large, &params);
            self.record_find(rec, points, space, large, &params);
            rec.submit()?;
            let unfinished = unfinished(&space.large_counts, listed, NONE)?;
            too_large.extend(unfinished.into_iter().map(|nth| groups[nth as usize]));
        }
        space.find_on_host(&too_large, own, &params, on_host)
    }

    fn record_gather(
        &self,
        rec: &mut Work,
        points: &Buffer,
        boxes: &Boxes,
        space: &SearchSpace,
        [leaves, counts]: [&Buffer; 2],
        params: &SearchParams,
    ) {
        rec.pass(spirv::gather_leaves(self.lists))
            .buffer(POINTS, points)
            .buffer(SEARCH_NODES, &boxes.nodes)
            .buffer(SEARCH_BOUNDS, &space.bounds)
            .buffer(SEARCH_LEAVES, leaves)
            .buffer(SEARCH_COUNTS, counts)
            .buffer(SEARCH_GROUPS, &space.groups)
            .push(params)
            .dispatch(line(groups_of(params)));
    }

    fn record_find(
        &self,
        rec: &mut Work,
        points: &Buffer,
        space: &SearchSpace,
        [leaves, counts]: [&Buffer; 2],
        params: &SearchParams,
    ) {
        rec.pass(self.find_module(space.neighbors))
            .buffer(POINTS, points)
            .buffer(SEARCH_BOUNDS, &space.bounds)
            .buffer(SEARCH_LEAVES, leaves)
            .buffer(SEARCH_COUNTS, counts)
            .buffer(NEIGHBORS, &space.lists)
            .buffer(SEARCH_GROUPS, &space.groups)
            .push(params)
            .dispatch(line(groups_of(params) * LEAF_POINTS));
    }
}

/// Leaves that a search looks at.
fn groups_of(params: &SearchParams) -> u32 {
    match params.listed {
        0 => params.batch_count.div_ceil(LEAF_POINTS),
        listed => listed,
    }
}

/// Which of the first `count` words are `mark`: of counts, `NONE`, where a list of leaves is not whole.
fn unfinished(counts: &Buffer, count: u32, mark: u32) -> Result<Vec<u32>, GpuError> {
    let mut read = vec![0u32; count as usize];
    counts.read(0, &mut read)?;
    Ok((0..count).filter(|&nth| read[nth as usize] == mark).collect())
}

impl SearchSpace {
    /// Entries of a point in the lists.
    pub fn stride(&self) -> u32 {
        self.stride
    }

    /// Finds the neighbours of some of a batch's leaves on the host; returns of how many points.
    fn find_on_host<'a>(
        &self,
        groups: &[u32],
        own: &'a [Point],
        params: &SearchParams,
        search: &mut Option<NeighborSearch<'a>>,
    ) -> Result<u64, GpuError> {
        let mut left = 0;
        let (k, first_slot) = (self.neighbors as usize, params.first_slot);
        // Leaves that follow each other are searched together, on all threads.
        for run in groups.chunk_by(|a, b| a + 1 == *b) {
            let (Some(first), Some(last)) = (run.first(), run.last()) else { continue };
            let from = first * LEAF_POINTS;
            let to = params.batch_count.min((last + 1) * LEAF_POINTS);
            let range = (params.batch_first + from) as usize..(params.batch_first + to) as usize;
            let found = if groups.len() <= WITHOUT_TREE && search.is_none() {
                nearest_of_few(own, first_slot, range, k)
            } else {
                let tree = search.get_or_insert_with(|| NeighborSearch::new(own, first_slot));
                tree.nearest(range, k)
            };
            let mut lists = vec![NONE; ((to - from) * self.stride) as usize];
            for (list, found) in lists.chunks_mut(self.stride as usize).zip(found.chunks(k)) {
                list[..found.len()].copy_from_slice(found);
            }
            self.lists.write(u64::from(from) * u64::from(self.stride) * 4, &lists)?;
            left += u64::from(to - from);
        }
        Ok(left)
    }
}
