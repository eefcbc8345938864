//! Rays on their way, and where they met surfaces.

use super::stage;

stage! {
    #![doc = "Rays on their way, and where they met surfaces."]
    "rays" needs []
    constants {
        /// A ray's cell before its structure has begun with it (structure.glsl).
        RAY_STARTS = 0xffff_fffe;
        /// Texels a row of the ray state's images.
        STATE_ROW = 1024;
        /// Beside an object in [`TraceParams::passed`]: its surface is left out only near the ray's start.
        PASSED_NEAR = 0x8000_0000;
        /// A pixel that hit nothing.
        HIT_NONE = 0;
        /// A hit that stands.
        HIT_ACCEPTED = 1;
        /// A hit whose refinement is under way.
        HIT_PENDING = 2;
        /// A hit whose refinement left the trust region.
        HIT_REJECTED = 3;
        /// Low bits of `Hit.status` that say what has become of it; the next 8 bits count the iterations
        /// since the stored hit.
        HIT_STATUS_BITS = 8;
        /// The bits of `Hit.status` from here on count all iterations of the ray.
        HIT_TOTAL_SHIFT = 16;
        /// Rays from one place, or through one place of the lens.
        PERSPECTIVE = 0;
        /// Parallel rays.
        ORTHOGRAPHIC = 1;
        /// Intervals of the table that the reconstruction filter is sampled by.
        FILTER_INTERVALS = 1024;
        /// Numbers of the low-discrepancy sequence for the place on the film.
        SAMPLE_FILM = 0;
        /// For the place on the lens.
        SAMPLE_LENS = 1;
        /// For what glass does with a ray: one a bounce from here on.
        SAMPLE_FRESNEL = 2;
        /// For the place on a light: one a light from here on.
        SAMPLE_LIGHT = 4096;
        /// For the direction that light is scattered in: one a bounce from here on.
        SAMPLE_SCATTER = 8192;
        /// For whether a path goes on: one a bounce from here on.
        SAMPLE_SURVIVAL = 12288;
        /// For how far a ray comes in volumes that scatter it: one a bounce from here on, so many for each surface that it has
        /// passed as if there were nothing.
        SAMPLE_DISTANCE = 0x8000_0000;
        /// See [`SAMPLE_DISTANCE`].
        DISTANCES_A_CROSSING = 2048;
        /// Numbers of a bounce, of paths that light takes from surface to surface.
        SAMPLES_A_BOUNCE = 65536;
    }
    bindings after [discs] {
        /// The ray state read: a queue, or the first of four images.
        STATE_IN: StateRay as state;
        /// The second.
        DIRECTION_IN: image;
        /// The third.
        CELL_IN: image;
        /// The fourth.
        START_IN: image;
        /// The ray state written: a queue, or the first of four images.
        STATE_OUT: StateRay;
        /// The second.
        DIRECTION_OUT: image;
        /// The third.
        CELL_OUT: image;
        /// The fourth.
        START_OUT: image;
        /// How many rays are not done, and one more count.
        LIVE: u32;
        /// Where rays met surfaces, by ray.
        HITS: Hit as hit;
        /// A bit a ray.
        MARKS: u32;
        /// How many marks each word has, then how many come before.
        MARK_OFFSETS: u32;
        /// The rays that are marked, in order.
        LIVE_RAYS: u32;
        /// The rays whose marks these are, where they are listed.
        LIST_IN: u32;
        /// Where the reconstruction filter's integral takes equal steps.
        CAMERA_FILTER: f32;
    }
    structs {
        /// Push constants of `camera_rays`.
        CameraParams {
            /// Centred scene space.
            eye: [f32; 3],
            /// Size of a pixel: on the plane at distance 1, or, where rays are parallel, anywhere.
            scale: f32,
            /// Unit vector to the right.
            right: [f32; 3],
            /// Half the full image's columns.
            half_width: f32,
            /// Unit vector upwards.
            up: [f32; 3],
            /// Half the full image's rows.
            half_height: f32,
            /// Unit vector of the viewing axis.
            forward: [f32; 3],
            /// Which sample of its pixel; `NONE` where there is only one, through the pixel's centre and the
            /// lens's.
            sample_index: u32,
            /// The tile's first pixel in the full image.
            tile_origin: [u32; 2],
            /// Columns and rows of the tile.
            tile_size: [u32; 2],
            /// `PERSPECTIVE` or `ORTHOGRAPHIC`.
            projection: u32,
            /// 0: a pinhole.
            lens_radius: f32,
            /// Distance along the viewing axis of the plane in focus, greater than 0.
            focus: f32,
            /// Of all that is random.
            seed: u32,
        }
        /// Push constants of the kernel of any structure that rays go through (structure.glsl).
        TraceParams {
            /// Rays of the wave, or of those that are listed.
            ray_count: u32,
            /// K: cells a ray may cross in this pass.
            cells: u32,
            /// Loop iterations a ray may spend in this pass.
            work: u32,
            /// 1: any hit ends a ray.
            any_hit: u32,
            /// 1: rays are those of a list, and their state stays where it is.
            listed: u32,
            /// Object whose surface is not there, or `NONE`.
            passed: u32,
        }
        /// A ray as it travels in a queue; all bits as unsigned integers.
        StateRay {
            /// Origin in centred scene space, and the nearest hit so far.
            position: [u32; 4],
            /// Unit direction, and how many cells were crossed.
            direction: [u32; 4],
            /// Cell, `RAY_STARTS` or `NONE`, cursor in it, points tested, slot of the hit or `NONE`.
            cell: [u32; 4],
            /// The point whose surface it starts on or `NONE`, up to where hits do not count, the cell where it came
            /// into the grid that it is in, of several; one unused.
            start: [u32; 4],
        }
        /// Where a pixel's ray met a surface.
        Hit {
            /// Centred scene space.
            position: [f32; 3],
            /// Distance along the ray.
            t: f32,
            /// Unit normal facing the ray's origin.
            normal: [f32; 3],
            /// One of `HIT_*`, and counts of iterations.
            status: u32,
        }
        /// Push constants of `count_marked` and `list_marked`.
        MarkParams {
            /// Words of 32 marks each.
            words: u32,
            /// 1: a word is followed by one whose marks count twice.
            pairs: u32,
            /// 1: marks are of the rays of a list.
            listed: u32,
        }
    }
}
