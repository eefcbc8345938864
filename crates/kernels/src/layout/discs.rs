//! The leaves that cover each screen tile.

use super::rays::{CameraParams, TraceParams};
use super::stage;

stage! {
    #![doc = "The leaves that cover each screen tile."]
    "discs" needs ["rays"]
    constants {
        /// Pixels that a screen tile has along each side.
        DISC_TILE = 8;
    }
    bindings after [tree] {
        /// Counts, then offsets, by leaf.
        DISC_OFFSETS: u32 as disc_offset;
        /// Screen tile and rank of each pair, front to back within a tile once they are sorted.
        DISC_KEYS: u32 as disc_key;
        /// The leaf of each pair, and which of its points cover the tile; with room for four after the last.
        DISC_LEAVES: u32 by 4 as disc_leaf;
        /// First and past-the-last pair of each screen tile.
        DISC_TILES: [u32; 2] as disc_range;
    }
    structs {
        /// Distances between nearest and farthest, ranked by their bits.
        DepthRanks {
            /// Greater than zero; what is nearer has the same rank.
            nearest: f32,
            /// What is farther has the same rank.
            farthest: f32,
            /// Of a float's bits, so that the rank has few.
            shift: u32,
            /// Bits of a rank.
            bits: u32,
        }
        /// Push constants of `disc_count`, `disc_emit` and `disc_ranges`.
        DiscParams {
            /// The camera, and the tile of the picture.
            camera: CameraParams,
            /// How pairs of a screen tile are ordered.
            ranks: DepthRanks,
            /// Points of the scene.
            point_count: u32,
            /// Pairs of a screen tile and a leaf with points whose discs cover it.
            pair_count: u32,
        }
        /// Push constants of `disc_trace`.
        DiscTraceParams {
            /// Of any structure.
            wave: TraceParams,
            /// How pairs of a screen tile are ordered.
            ranks: DepthRanks,
        }
    }
}
