//! The search for neighbours.

use super::stage;

stage! {
    #![doc = "The search for neighbours."]
    "search" needs []
    constants {
        /// Consecutive slots that share a box, and so a list of leaves; children of a node.
        LEAF_POINTS = 8;
        /// Levels of boxes, at most.
        LEAF_LEVELS = 10;
        /// Bits of an entry of a list of leaves that say which; the others say for which points.
        LEAF_BITS = 24;
        /// Boxes that the search for one list of leaves may look at.
        LEAF_STEPS = 32_768;
    }
    bindings after [points] {
        /// Boxes of an object, level over level.
        SEARCH_NODES: SearchNode as search_node;
        /// Of each point of the batch, d² that holds k others.
        SEARCH_BOUNDS: f32;
        /// Leaves that the balls of each leaf of the batch touch.
        SEARCH_LEAVES: u32 by 4 as search_leaf;
        /// How many those are, or `NONE`: more than there is room for.
        SEARCH_COUNTS: u32;
        /// Leaves of the batch that are looked at again.
        SEARCH_GROUPS: u32;
        /// Of a search without ties: which leaves of the batch have some all the same.
        SEARCH_TIES: u32;
    }
    structs {
        /// The box around [`LEAF_POINTS`] points, or around as many boxes. Empty where `low` is above `high`.
        SearchNode {
            /// Lowest corner.
            low: [f32; 3],
            /// The first of the boxes inside, or [`NONE`]: points are.
            child: u32,
            /// Highest corner.
            high: [f32; 3],
            /// The box to look at once this one and all inside are done, or [`NONE`].
            next: u32,
        }
        /// Parameters of `leaf_boxes` and `node_boxes`: one level of the boxes of an object.
        LevelParams {
            /// The first slot of the object.
            first_slot: u32,
            /// How many points the object has.
            point_count: u32,
            /// k, how many neighbours are asked for.
            neighbors: u32,
            /// 0: the boxes of points.
            level: u32,
            /// The highest level: it has [`LEAF_POINTS`] boxes.
            top: u32,
            /// Boxes of this level, a multiple of [`LEAF_POINTS`].
            count: u32,
            /// First box of each level.
            offsets: [u32; LEAF_LEVELS as usize],
        }
        /// Parameters of the neighbour search for one batch of points.
        SearchParams {
            /// The first slot of the object.
            first_slot: u32,
            /// How many points the object has.
            point_count: u32,
            /// Place in the object of the batch's first point, a multiple of [`LEAF_POINTS`].
            batch_first: u32,
            /// Points of the batch.
            batch_count: u32,
            /// k: less than `point_count`, or 1.
            neighbors: u32,
            /// Entries of a point in the list of neighbours, a multiple of four.
            stride: u32,
            /// Entries of a list of leaves, a multiple of four.
            capacity: u32,
            /// The first box of the highest level.
            root: u32,
            /// Boxes of points, which come first.
            leaf_count: u32,
            /// How many leaves of the batch are looked at again, with a larger capacity; 0: all are looked at.
            listed: u32,
        }
    }
}
