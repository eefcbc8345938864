//! The tree of boxes that rays go through.

use super::rays::TraceParams;
use super::search::SearchNode;
use super::stage;

stage! {
    #![doc = "The tree of boxes that rays go through."]
    "tree" needs ["search", "rays"]
    constants {
    }
    bindings after [grid] {
        /// The boxes around the nodes.
        TREE_BOXES: SearchNode;
        /// The nodes, four times four words each (tree.glsl).
        TREE_NODES: [u32; 4] as node_part;
    }
    structs {
        /// Where the leaves of the tree are.
        TreeInfo {
            /// Their first node, a power of eight.
            first_leaf: u32,
            /// So many nodes before it are not there, nor in memory.
            gap: u32,
        }
        /// Push constants of `tree_nodes`: some nodes of one level of the tree.
        TreeLevelParams {
            /// The first of these nodes.
            first: u32,
            /// How many they are.
            count: u32,
            /// The first node of the whole level.
            first_of_level: u32,
            /// The first node of the level below.
            first_child: u32,
            /// Nodes of the level below; of leaves, points.
            children: u32,
            /// The node that what is bound of all begins with.
            first_bound: u32,
        }
        /// Push constants of `tree_trace`.
        TreeTraceParams {
            /// Of any structure.
            wave: TraceParams,
            /// The tree's.
            tree: TreeInfo,
        }
    }
}
