//! Volumes of points, and rays on their way through them.

use super::grid::GridInfo;
use super::stage;

stage! {
    #![doc = "Volumes of points, and rays on their way through them."]
    "volume" needs ["grid"]
    constants {
        /// [`VolumeInfo::kernel`] of the weighted mean, Eq. 3 of the paper.
        VOLUME_SHEPARD = 0;
        /// [`VolumeInfo::kernel`] of the weighted sum.
        VOLUME_SUM = 1;
        /// [`VolumeInfo::kernel`] of particles with smoothing lengths of their own.
        VOLUME_SPH = 2;
        /// [`VolumeInfo::mode`]: emission and extinction along the way.
        VOLUME_EMISSION = 0;
        /// [`VolumeInfo::mode`]: the greatest scalar.
        VOLUME_MAXIMUM = 1;
        /// [`VolumeInfo::mode`]: the mean scalar.
        VOLUME_AVERAGE = 2;
        /// [`VolumeInfo::mode`]: the surface where the scalar is one number.
        VOLUME_ISOSURFACE = 3;
        /// What a ray shows: the integral of the scalar.
        VOLUME_INTEGRAL = 4;
        /// [`VolumeInfo::shading`]: colours are emitted.
        VOLUME_EMITS = 0;
        /// [`VolumeInfo::shading`]: Lambert's law, with the scalar's gradient for a normal.
        VOLUME_GRADIENT = 1;
        /// [`VolumeInfo::shading`]: light is scattered evenly to all sides.
        VOLUME_SCATTERS = 2;
        /// Lights that a scene with lit volumes may have.
        VOLUME_LIGHTS = 4;
        /// [`VolumeCell::counts`]: nothing can be seen from here.
        CELL_NOTHING = 0;
        /// [`VolumeCell::counts`]: something may be seen.
        CELL_LOOK = 1;
        /// [`VolumeCell::counts`]: where there is a scalar, it is above the isosurface.
        CELL_ABOVE = 2;
        /// [`VolumeCell::counts`]: where there is one, it is below.
        CELL_BELOW = 3;
        /// [`VolumeCell::counts`]: the bits of these.
        CELL_KINDS = 3;
        /// [`VolumeCell::counts`], of a grid by size: finer points may be near.
        CELL_FINER = 4;
        /// [`VolumeCell::counts`]: all bits that are none of a float's.
        CELL_MARKS = 7;
        /// Steps of one length that a ray takes at a time, a power of two.
        STRIDE_STEPS = 8;
        /// Parts of a step that is divided.
        MARCH_PARTS = 64;
        /// Places along a ray for which points are measured together, at most.
        BLOCK_PLACES = 8;
    }
    bindings after [wave] {
        /// The volumes of the scene.
        VOLUMES: VolumeInfo;
        /// Of all volumes.
        VOLUME_CELLS: VolumeCell as volume_cell;
        /// Of all volumes.
        VOLUME_POINTS: VolumePoint as volume_point;
        /// 1/h by point, or one by its reach, if any volume has particles or points with a reach of their own.
        VOLUME_LENGTHS: f32 as inverse_length;
        /// Of all transfer functions.
        VOLUME_STOPS: VolumeStop as stop;
        /// By ray.
        MARCHES: March;
        /// The ends of steps by ray and volume, two each where steps may be divided; of lit ones four floats. With grids by size,
        /// after them whether the volume is seen from the stretch of steps.
        MARCH_ENDS: f32;
        /// By ray, where volumes are lit.
        MARCH_LIGHTS: MarchLight;
        /// By ray, where volumes scatter rays.
        MARCH_SCATTERS: MarchScatter;
        /// What of each light's reaches each point of a volume.
        VISIBLE: [f32; 4] as visible;
        /// By ray.
        ISO_SEARCHES: IsoSearch;
        /// By ray and volume.
        VOLUME_BLOCKS: VolumeBlock;
    }
    structs {
        /// A field between points (\[T\] §6).
        VolumeInfo {
            /// Over the points' bounding box grown by the radius, and up to a cell more; that of the largest points where it
            /// has grids by size.
            grid: GridInfo,
            /// In the cells of all volumes.
            first_cell: u32,
            /// In the stops of all volumes.
            first_stop: u32,
            /// Stops of its transfer function.
            stop_count: u32,
            /// One of `VOLUME_*`.
            kernel: u32,
            /// Of a point's reach; where each has its own, of a mean one, and in a grid by size of the greatest there.
            square_radius: f32,
            /// 1 / 2ρ; 0: each point has its own reach r, and ρ = (r/2)². Then 1/r is its inverse length.
            inverse_width: f32,
            /// Index of the object in the scene.
            object: u32,
            /// 1: it counts only inside the object's surface.
            bounded: u32,
            /// Highest corner of the box, whose lowest is the grid's.
            high: [f32; 3],
            /// What a ray shows: one of `VOLUME_EMISSION` and so on.
            mode: u32,
            /// Scalar on an isosurface; of other modes, the mean cosine of the angle that light is scattered by.
            iso: f32,
            /// Of the polynomial that stands for an isosurface, behind those of all points; of other modes, 1 where anything has an
            /// emission.
            slot: u32,
            /// 1: an isosurface of glass, which rays are inside or outside; of a volume that scatters rays, the slot of the
            /// polynomial that stands for it.
            refracts: u32,
            /// What light does in it: one of `VOLUME_EMITS` and so on.
            shading: u32,
            /// Places of a block, a power of two: so many that no weight is out of the range of floats.
            block: u32,
            /// The first of its grids by size, coarsest first, in the list of volumes.
            first_size: u32,
            /// How many of these there are; 0: it has one grid.
            size_count: u32,
            /// log₂ of the length of steps, in shortest steps, where the points of this grid are the smallest around.
            level: u32,
        }
        /// A cell of a volume's grid.
        VolumeCell {
            /// Point in the points of all volumes; the next cell's is the end.
            first: u32,
            /// One of `CELL_*`; in the other bits, beside a steep transfer function, those of the float by which the scalar
            /// within a step may be off a straight line.
            counts: u32,
        }
        /// A point of a volume.
        VolumePoint {
            /// Centred scene space.
            position: [f32; 3],
            /// What it carries; a particle, A (m/ρ) / (π h³).
            scalar: f32,
        }
        /// A stop of a transfer function, ascending in value. Integrals are those from the first stop to this one, each of them
        /// the sum of two numbers.
        VolumeStop {
            /// Linear RGB.
            color: [f32; 3],
            /// σ, per unit of length.
            extinction: f32,
            /// The scalar at this stop.
            value: f32,
            /// Radiance per unit of length.
            emission: [f32; 3],
            /// Of the colour times the extinction, and of the extinction.
            scattering_integral: [f32; 4],
            /// The second numbers of these.
            scattering_rest: [f32; 4],
            /// Of the emission; the fourth is how many stops up to this one bound a steep piece.
            emission_integral: [f32; 4],
            /// The second numbers of these.
            emission_rest: [f32; 4],
        }
        /// How far a ray has marched through volumes. Sums over its way are of two numbers: what rounding added is taken from
        /// the next term.
        March {
            /// Emitted towards its start so far; of other modes than emission, the greatest scalar or the integral
            /// of all, and the length in reach.
            color: [f32; 3],
            /// Optical depth.
            depth: f32,
            /// What rounding added to the colour.
            color_lost: [f32; 3],
            /// What rounding added to the depth.
            depth_lost: f32,
            /// What this step sends per length, of the volumes so far.
            step_color: [f32; 3],
            /// Of this step.
            step_extinction: f32,
            /// Where volumes are lit, numerator of this volume's scalar at this place, so far.
            numerator: f32,
            /// Its denominator.
            denominator: f32,
            /// 0: not begun, 1: on its way, 2: done, 3: once more, for `along`. From bit 2 on, in five bits each: log₂ of the
            /// length of steps from the place on, and of the step before it, in shortest steps.
            state: u32,
            /// End of a step; from bit 24 on, its part, where 0 is the whole step; in bit 31, whether a volume so far
            /// divides it.
            place: u32,
            /// Volume.
            volume: u32,
            /// Of cells around the places that are asked for; from bit 24 on, which grid by size they are of.
            row: u32,
            /// Points of the row that are done.
            cursor: u32,
            /// For the channels of volumes: the depth along the viewing axis where half of what is lost is lost, or below 0;
            /// of other modes than emission, the scalar that is shown.
            along: f32,
        }
        /// Scalars of a volume at even places along a ray.
        VolumeBlock {
            /// Numerators so far; once all points are weighed, the scalars.
            scalars: [f32; 8],
            /// Denominators so far.
            weights: [f32; 8],
            /// The place after the last whose scalar is known.
            known: u32,
            /// 0: places are ends of steps; else they are ends of parts of the step before this place.
            of: u32,
            /// Unused.
            pad: [u32; 2],
        }
        /// What a ray needs beside its march where volumes scatter it.
        MarchScatter {
            /// Colour by extinction, of the scattering volumes of this step so far.
            step_color: [f32; 3],
            /// Their extinction.
            step_extinction: f32,
            /// Most of one of them.
            most: f32,
            /// The slot that stands for that one.
            slot: u32,
            /// Their optical depth so far.
            depth: f32,
            /// What rounding added to it.
            lost: f32,
        }
        /// What a sample of a lit volume needs beside its scalar.
        MarchLight {
            /// Sum of the weights' gradients, by the scalars.
            pull: [f32; 3],
            /// Unused.
            pad: u32,
            /// Sum of the weights' gradients.
            weights_pull: [f32; 3],
            /// Unused.
            pad_end: u32,
            /// Of each light, by the weights.
            visible: [f32; 4],
        }
        /// How far a ray has looked for isosurfaces.
        IsoSearch {
            /// As in [`MarchLight`], at this place.
            pull: [f32; 3],
            /// Numerator of the scalar at this place, so far.
            numerator: f32,
            /// As in [`MarchLight`], at this place.
            weights_pull: [f32; 3],
            /// Its denominator.
            denominator: f32,
            /// Along the ray: the last place on the side that it comes from.
            low: f32,
            /// The first known beyond the surface.
            high: f32,
            /// Scalar less iso there; 0: not known.
            value_low: f32,
            /// The same at the other end.
            value_high: f32,
            /// The next place between them.
            here: f32,
            /// New, stepping, closing in, turning to the viewer, done.
            state: u32,
            /// Sample, or turn.
            place: u32,
            /// Volume.
            volume: u32,
            /// Of cells around the place.
            row: u32,
            /// Points of the row that are done.
            cursor: u32,
            /// Of `low`: 0 not known, 1 below, 2 above.
            side: u32,
            /// Whether it was looked at, or is known from its cell; then which end moved.
            looked: u32,
        }
        /// Push constants of `march`.
        MarchParams {
            /// Viewing axis.
            forward: [f32; 3],
            /// Rays.
            ray_count: u32,
            /// Volumes of the scene.
            volume_count: u32,
            /// Distance of the samples.
            step: f32,
            /// Loop iterations a ray may spend in this pass.
            work: u32,
            /// Lights, where volumes are lit.
            light_count: u32,
            /// 1: `along` is asked for.
            wants_depth: u32,
            /// Where volumes scatter rays: which sample of each pixel, or `NONE`.
            sample_index: u32,
            /// Of all that is random.
            seed: u32,
            /// Columns of the tile.
            tile_width: u32,
            /// The tile's first pixel in the full image.
            tile_origin: [u32; 2],
            /// Unused.
            pad: [u32; 2],
        }
        /// Push constants of `point_rays` and `point_lights`.
        PointLightParams {
            /// Point in the points of all volumes.
            first: u32,
            /// Points of this batch.
            count: u32,
            /// Which light the rays go to.
            light: u32,
            /// Whose points they are.
            volume: u32,
        }
    }
}
