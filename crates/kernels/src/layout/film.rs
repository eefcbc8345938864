//! What pixels saw.

use super::stage;

stage! {
    #![doc = "What pixels saw."]
    "film" needs []
    constants {
    }
    bindings after [volume] {
        /// By pixel of the tile.
        FILM: FilmPixel;
        /// Of all samples so far.
        FILM_SUMS: FilmSum;
    }
    structs {
        /// What one pixel saw.
        FilmPixel {
            /// Radiance, and coverage.
            color: [f32; 4],
            /// First surface, centred scene space; distance along the viewing axis, or +inf.
            position_depth: [f32; 4],
            /// Unit normal facing the viewer; index of the object, or −1.
            normal_object: [f32; 4],
            /// Points tested, cells crossed, slot of the hit or `NONE`, iterations of its refinement.
            counts: [u32; 4],
            /// 1 less what each channel lets through of the background, by nothing but glass and volumes.
            alpha: [f32; 3],
            /// Of volumes on the camera ray's way, as in [`March`].
            along: f32,
        }
        /// A pixel's samples so far.
        FilmSum {
            /// Sums of colours, alphas and of the first two counts; all else is the first sample's.
            pixel: FilmPixel,
            /// What rounding added to the colours' sums.
            lost: [f32; 4],
            /// What it added to the alphas'.
            lost_alpha: [f32; 3],
            /// Unused.
            pad: u32,
        }
        /// Push constants of `accumulate`.
        AccumulateParams {
            /// Columns and rows of the tile.
            tile_size: [u32; 2],
            /// Which sample the film holds.
            sample_index: u32,
            /// In all.
            samples: u32,
        }
    }
}
