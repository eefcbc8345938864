//! Points, and the surfaces near them.

use super::stage;

stage! {
    #![doc = "Points, and the surfaces near them."]
    "points" needs []
    constants {
        /// No slot, no colour, no object; a ray's cell once the ray is done.
        NONE = 0xffff_ffff;
        /// Invocations a workgroup of kernels that run along a list.
        LINE_GROUP = 64;
        /// Invocations a row of such a kernel, where one row is not enough.
        LINE_ROW = 1_048_576;
        /// Invocations a workgroup of kernels that run over 8 × 8 pixels.
        TILE_GROUP = 64;
        /// A fit that found no surface.
        FIT_NO_SURFACE = 0;
        /// A fit that fell back to a plane.
        FIT_PLANE = 1;
        /// The paper's polynomial without linear terms.
        FIT_INCOMPLETE = 2;
        /// The polynomial with linear terms.
        FIT_FULL = 3;
        /// No fit: the point is drawn as a disc.
        FIT_DISC = 4;
        /// No fit: the point is drawn as a sphere.
        FIT_SPHERE = 5;
    }
    bindings after [] {
        /// Every point, by slot.
        POINTS: Point as point;
        /// Neighbours of the batch's points, by slot.
        NEIGHBORS: u32 by 4 as neighbor;
        /// The surfaces of points, by slot.
        POLYNOMIALS: Polynomial as polynomial;
        /// How each fit ended.
        OUTCOMES: FitOutcome;
        /// h by slot, where it is smoothed.
        SIZES: f32;
        /// Of the points of the batch.
        RIMS: Rim;
        /// Distance of each point to its last neighbour, by slot.
        REACHES: f32;
        /// Trust balls that end at a rim.
        CLIPS: BallClip;
        /// Of each sphere or disc of the batch.
        RADII: f32;
        /// Three floats for each disc of the batch, where normals are given.
        NORMALS: f32;
    }
    structs {
        /// One point of the scene.
        Point {
            /// Centred scene space.
            position: [f32; 3],
            /// Place in its file.
            index: u32,
        }
        /// The surface near one point, in world form: with y = x − center,
        /// gradient · y − offset − yᵀ M y = 0 where |y| ≤ trust (\[T\] §4; method, section 1).
        Polynomial {
            /// p, and the trust radius b; b = 0 where the point carries no surface. At a rim, centre and radius
            /// of a ball inside that one.
            center_trust: [f32; 4],
            /// m = n − E u − F v, and D.
            gradient_offset: [f32; 4],
            /// M: xx, yy, zz, xy.
            curvature: [f32; 4],
            /// M: xz, yz.
            cross_terms: [f32; 2],
            /// Index of the object in the scene.
            object: u32,
            /// Place in its file.
            index: u32,
        }
        /// How one fit ended.
        FitOutcome {
            /// The trust radius b, or 0.
            trust: f32,
            /// One of `FIT_*`.
            kind: u32,
            /// h.
            feature_size: f32,
        }
        /// What a point's neighbours say about a rim of the set.
        Rim {
            /// Unit vector in the tangent plane; zero where the cell is not open.
            outward: [f32; 3],
            /// Along it: from the point to where the surface ends.
            reach: f32,
            /// Reach of the Voronoi cell over that of the neighbours.
            openness: f32,
        }
        /// Parameters of `smooth_sizes` for one batch of points.
        SmoothParams {
            /// Of the batch.
            first_slot: u32,
            /// Points of the batch.
            point_count: u32,
            /// Entries of a point in the list of neighbours.
            stride: u32,
            /// 0: reaches are written; 1: sizes.
            round: u32,
        }
        /// A trust ball that ends at a rim.
        BallClip {
            /// Of the point.
            slot: u32,
            /// The ball's radius.
            trust: f32,
            /// From the point to the ball's centre.
            shift: [f32; 3],
        }
        /// Push constants of `clip_balls`.
        ClipParams {
            /// Balls.
            count: u32,
        }
        /// Push constants of `shape_spheres` and `shape_discs`.
        ShapeParams {
            /// First slot of this batch.
            first_slot: u32,
            /// Slots in this batch.
            count: u32,
            /// Index of the object in the scene.
            object: u32,
            /// Slot that the buffers by slot are bound from.
            bound_from: u32,
            /// 1: normals are given; 0: of discs, planes were fitted.
            has_normals: u32,
        }
        /// Push constants of `fit_polynomials`.
        FitParams {
            /// First slot of this batch.
            first_slot: u32,
            /// Points in this batch.
            point_count: u32,
            /// Entries a point in the list of neighbours, a multiple of four; of a plan: k.
            neighbors: u32,
            /// `FIT_FULL`, `FIT_INCOMPLETE` or `FIT_PLANE`: the first kind tried.
            polynomial: u32,
            /// h for all points; 0: the distance to the last neighbour; −1: given for each.
            feature_size: f32,
            /// b / h.
            trust: f32,
            /// Index of the object in the scene.
            object: u32,
            /// Slot whose neighbours come first in the list.
            first_listed: u32,
            /// h over the width of the weights.
            weight_scale: f32,
            /// 1: b grows, at most to h, where neighbours leave a gap.
            close_gaps: u32,
            /// Of the distance to the centroid, over the reach of the neighbours; 0: no rims.
            rim_limit: f32,
            /// Slot that the buffers by slot are bound from; points are bound as a whole.
            bound_from: u32,
        }
    }
}
