//! The grid: scan, sort, cells, and the lists that rays and hits read.

use super::stage;

stage! {
    #![doc = "The grid: scan, sort, cells, and the lists that rays and hits read."]
    "grid" needs []
    constants {
        /// Entries that one invocation of the scan and sort kernels walks.
        RUN_LENGTH = 256;
        /// Bits of a key sorted in one round.
        DIGIT_BITS = 8;
        /// The greatest distance, in cells, from an empty cell to the next occupied one that is recorded; greater ones count as this.
        MOST_SKIPPED = 4;
        /// Where sums stop instead of wrapping.
        SCAN_LIMIT = 0x7fff_ffff;
        /// Grids of a scene, at most.
        MOST_LEVELS = 16;
    }
    bindings after [search] {
        /// The grid that is built.
        GRID_INFO: GridInfo;
        /// Slots by ordinal.
        GRID_ORDER: u32;
        /// Counts, then offsets, by ordinal.
        GRID_OFFSETS: u32;
        /// The cell of each pair, ascending once they are sorted.
        GRID_KEYS: u32;
        /// The slot of each pair.
        GRID_SLOTS: u32;
        /// Counts, then offsets, of large balls only, by ordinal.
        GRID_LARGE: u32;
        /// Trust balls in the order of (object, index): centre and radius.
        GRID_BALLS: [f32; 4] as ball;
        /// Cells that are marked, 32 of a row a word.
        SKIP_MARKS_IN: u32;
        /// Those that are marked next.
        SKIP_MARKS_OUT: u32;
        /// Cells with points.
        SKIP_OCCUPIED: u32;
        /// Those at most one cell from these.
        SKIP_BESIDE: u32;
        /// At most two.
        SKIP_NEAR: u32;
        /// At most three.
        SKIP_FAR: u32;
        /// Turned into prefix sums in place.
        SCAN_VALUES: u32;
        /// Sums of runs, or what comes before each.
        SCAN_SUMS: u32;
        /// Keys to sort.
        SORT_KEYS_IN: u32;
        /// What travels with them.
        SORT_SLOTS_IN: u32;
        /// `[digit][run]`.
        SORT_HISTOGRAM: u32;
        /// Sorted keys.
        SORT_KEYS_OUT: u32;
        /// What travelled with them.
        SORT_SLOTS_OUT: u32;
        /// First entry of each cell among the listed points.
        CELL_OFFSETS: u32;
        /// Points, cell after cell.
        LISTED_POINTS: ListedPoint as listed_point;
        /// The grids of the scene.
        LEVELS: GridLevel;
        /// First and past-the-last entry of each cell in `SLOTS`.
        CELLS: [u32; 2] as range;
        /// The points of each cell, with room for four after the last.
        SLOTS: u32 by 4 as slot;
    }
    structs {
        /// The uniform grid's place and size.
        GridInfo {
            /// Lowest corner, centred scene space.
            origin: [f32; 3],
            /// Of a cell.
            edge: f32,
            /// Cells along x, y, z.
            resolution: [u32; 3],
            /// 1 / edge.
            inverse_edge: f32,
        }
        /// One of the grids of a scene, which share buffers.
        GridLevel {
            /// Where it lies.
            grid: GridInfo,
            /// In the cells of all grids.
            first_cell: u32,
            /// In the offsets of the points of all grids' cells.
            first_offset: u32,
            /// The lowest slot that it lists.
            first_slot: u32,
            /// Past the highest.
            end_slot: u32,
        }
        /// A point in the list of its cell.
        ListedPoint {
            /// Centred scene space.
            position: [f32; 3],
            /// Its slot.
            slot: u32,
        }
        /// Push constants of the grid build.
        GridParams {
            /// Points of the scene.
            point_count: u32,
            /// Pairs of a cell of the slab and a point near it.
            pair_count: u32,
            /// Radius listed over trust radius; 0: each point only in its own cell.
            ball_scale: f32,
            /// First layer of cells along z of the slab.
            first_layer: u32,
            /// Past the last.
            end_layer: u32,
            /// Pairs of the slabs before; of `order_balls`, points of the parts before.
            first_pair: u32,
            /// 1 where balls may be large.
            any_large: u32,
        }
        /// Push constants of the scan.
        ScanParams {
            /// Values.
            count: u32,
            /// 1 where the sums hold what comes before each run.
            has_base: u32,
        }
        /// Push constants of the sort.
        SortParams {
            /// Keys.
            count: u32,
            /// Lowest bit of the digit.
            shift: u32,
            /// Runs of `RUN_LENGTH` keys.
            runs: u32,
            /// Bits of the digit, `DIGIT_BITS` at most.
            bits: u32,
        }
    }
}

impl GridInfo {
    /// Cells in all.
    #[must_use]
    pub fn cell_count(&self) -> u32 {
        self.resolution.iter().product()
    }
}
