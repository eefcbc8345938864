//! The tree: boxes in boxes around the surfaces of points (`glsl/shared/tree.glsl`).
//!
//! Points lie along a Hilbert curve, so eight consecutive ones are a leaf, eight leaves a node above: level by level
//! from the points up, without a search and without a sort. What is traced through it hits what it would through
//! the grid, to the bit.

use super::line;
use super::work::Work;
use gpu::{Buffer, Device, GpuError, PART_ALIGNMENT};
use kernels::layout::{
    LEAF_POINTS, POLYNOMIALS, Polynomial, SearchNode, TREE_BOXES, TREE_NODES, TreeInfo,
    TreeLevelParams,
};
use kernels::spirv::{self, Children, Module};
use std::sync::Arc;

/// Bytes of a node.
const NODE_BYTES: u64 = 64;
/// Nodes of one dispatch: what it writes of them fits into any binding.
const NODES_AT_ONCE: u32 = 1 << 20;
/// Leaves at most: a ray has bits for the children of eight nodes above each other, and sets leaves aside by 24.
const MOST_LEAVES: u32 = 7 << 21;
/// A binding may begin at multiples of so many.
const NODES_ALIGNED: u32 = (PART_ALIGNMENT / NODE_BYTES) as u32;

/// A tree over all points that carry a surface.
#[derive(Debug)]
pub struct Tree {
    /// 64 bytes each; node 0 is the root.
    pub nodes: Buffer,
    /// Where its leaves are.
    pub info: TreeInfo,
}

/// The nodes of one level: the first, and how many.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Level {
    first: u32,
    count: u32,
}

impl Level {
    fn end(self) -> u32 {
        self.first + self.count
    }
}

/// The levels over so many points, leaves first, the root last. The children of node i are 8 i … 8 i + 7, so that no
/// level needs to be told from another: the root is node 0, and up to seven nodes below it begin at 1.
fn levels_over(points: u32) -> Vec<Level> {
    let mut counts = vec![points.div_ceil(LEAF_POINTS).max(1)];
    while counts[counts.len() - 1] >= LEAF_POINTS {
        counts.push(counts[counts.len() - 1].div_ceil(LEAF_POINTS));
    }
    let top = counts.len() as u32 - 1;
    let first = |level: u32| LEAF_POINTS.pow(top - level);
    let mut levels: Vec<_> =
        (0..).zip(counts).map(|(level, count)| Level { first: first(level), count }).collect();
    levels.push(Level { first: 0, count: 1 });
    levels
}

/// Where the leaves are: in memory they follow right behind the level above.
fn info_of(levels: &[Level]) -> TreeInfo {
    let first_leaf = levels[0].first;
    TreeInfo { first_leaf, gap: first_leaf - levels[1].end() }
}

/// Nodes in memory.
fn node_count(levels: &[Level]) -> u64 {
    u64::from(levels[0].end() - info_of(levels).gap)
}

impl Tree {
    /// Whether a device has room for the tree over so many points and for their polynomials, each of its buffers in
    /// one binding or texel buffer.
    pub(crate) fn fits(device: &Device, points: u32) -> bool {
        if points.div_ceil(LEAF_POINTS) > MOST_LEAVES {
            return false;
        }
        let (nodes, limits) = (node_count(&levels_over(points)), device.limits());
        let polynomials = (u64::from(points) * size_of::<Polynomial>() as u64) / 16;
        let longest = polynomials.max(nodes * NODE_BYTES / 16);
        nodes * size_of::<SearchNode>() as u64 <= limits.max_storage_buffer_range
            && longest <= u64::from(limits.max_texel_buffer_elements)
    }

    /// How many.
    #[must_use]
    pub fn node_count(&self) -> u64 {
        self.nodes.bytes() / NODE_BYTES
    }

    /// What a build takes.
    pub(crate) fn modules() -> [&'static Module; 2] {
        [spirv::tree_nodes(Children::Surfaces), spirv::tree_nodes(Children::Boxes)]
    }

    /// Over the first `points` polynomials, which are read through a texel buffer.
    pub(crate) fn build(
        device: &Arc<Device>,
        rec: &mut Work,
        polynomials: &Buffer,
        points: u32,
    ) -> Result<Self, GpuError> {
        let mut levels = levels_over(points);
        let (info, count) = (info_of(&levels), node_count(&levels));
        levels[0].first -= info.gap;
        let nodes = Buffer::paged(device, "tree", count * NODE_BYTES)?;
        let boxes = Buffer::new(device, "tree boxes", count * size_of::<SearchNode>() as u64)?;
        let mut below = Level { first: 0, count: points };
        for (height, level) in levels.iter().enumerate() {
            let end = level.end();
            for first in (level.first..end).step_by(NODES_AT_ONCE as usize) {
                let count = NODES_AT_ONCE.min(end - first);
                let first_bound = first - first % NODES_ALIGNED;
                let params = TreeLevelParams {
                    first,
                    count,
                    first_of_level: level.first,
                    first_child: below.first,
                    children: below.count,
                    first_bound,
                };
                let pass = match height {
                    0 => rec
                        .pass(spirv::tree_nodes(Children::Surfaces))
                        .buffer(POLYNOMIALS, polynomials),
                    _ => rec.pass(spirv::tree_nodes(Children::Boxes)),
                };
                let bound = [first_bound, first + count - first_bound];
                let [from, bytes] = bound.map(|nodes| u64::from(nodes) * NODE_BYTES);
                pass.buffer(TREE_BOXES, &boxes)
                    .buffer_part(TREE_NODES, &nodes, from, bytes)
                    .push(&params)
                    .dispatch(line(params.count));
            }
            below = *level;
        }
        rec.submit()?;
        Ok(Self { nodes, info })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_leaves_lie_under_eight_nodes() {
        // Nodes with children to visit: all levels but the leaves.
        assert_eq!(levels_over(MOST_LEAVES * LEAF_POINTS).len() - 1, 8);
        assert_eq!(levels_over(MOST_LEAVES * LEAF_POINTS + 1).len() - 1, 9);
        const { assert!(MOST_LEAVES <= 1 << 24) };
    }

    #[test]
    fn levels_never_overlap_and_children_are_where_eight_times_their_parent_says() {
        for points in
            [1, 8, 9, 56, 57, 64, 65, 448, 449, 512, 35_947, 172_974, 1_000_000, 10_000_000]
        {
            let levels = levels_over(points);
            assert_eq!(levels[0].count, points.div_ceil(LEAF_POINTS));
            assert_eq!(levels[levels.len() - 1], Level { first: 0, count: 1 });
            let bytes = node_count(&levels) * NODE_BYTES;
            assert!(bytes <= 11 * u64::from(points) + 4 * NODE_BYTES, "{points}: {bytes} bytes");
            for pair in levels.windows(2) {
                let [below, above] = [pair[0], pair[1]];
                assert!(above.end() <= below.first, "{points}: {levels:?}");
                let last = (below.end() - 1) / LEAF_POINTS;
                assert!(below.first / LEAF_POINTS >= above.first, "{points}: {levels:?}");
                assert!(last < above.end(), "{points}: {levels:?}");
            }
        }
    }
}
