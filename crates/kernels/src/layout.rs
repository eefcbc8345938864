//! Host side of `glsl/shared/layout.glsl`: structs, binding numbers, group sizes.
//!
//! A moved Rust field does not compile ([`gpu_layout!`]); a moved GLSL field fails the test
//! `layout_matches_spirv`, a changed constant `constants_match_the_host`.

use bytemuck::{Pod, Zeroable};

/// A struct's GLSL name, its size, and its members with their offsets, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StructLayout {
    /// Name in GLSL and in Rust.
    pub name: &'static str,
    /// Size in bytes, without padding at the end that std430 may add to an array's stride.
    pub size: usize,
    /// Members in order, each with its offset in bytes.
    pub members: &'static [(&'static str, usize)],
}

macro_rules! gpu_layout {
    ($name:ident, $size:literal, { $($field:ident: $offset:literal),* $(,)? }) => {
        const _: () = assert!(size_of::<$name>() == $size, concat!(stringify!($name), ": size"));
        $(const _: () = assert!(
            std::mem::offset_of!($name, $field) == $offset,
            concat!(stringify!($name), ".", stringify!($field), ": offset")
        );)*
        impl $name {
            /// What the host takes this struct's layout to be.
            pub const LAYOUT: StructLayout = StructLayout {
                name: stringify!($name),
                size: $size,
                members: &[$((stringify!($field), $offset)),*],
            };
        }
    };
}

macro_rules! constants {
    ($($(#[$doc:meta])* $name:ident = $value:literal;)*) => {
        $($(#[$doc])* pub const $name: u32 = $value;)*

        /// Every constant that host and kernels share, by its GLSL name.
        pub const CONSTANTS: &[(&str, u32)] = &[$((stringify!($name), $name)),*];
    };
}

constants! {
    /// No slot, no colour, no object; a ray's cell once the ray is done.
    NONE = 0xffff_ffff;
    /// Invocations a workgroup of kernels that run along a list.
    LINE_GROUP = 64;
    /// Invocations a row of such a kernel, where one row is not enough.
    LINE_ROW = 1_048_576;
    /// Invocations a workgroup of kernels that run over 8 × 8 pixels.
    TILE_GROUP = 64;
    /// Entries that one invocation of the scan and sort kernels walks.
    RUN_LENGTH = 256;
    /// Bits of a key sorted in one round.
    DIGIT_BITS = 8;
    /// Pixels that a screen tile has along each side.
    DISC_TILE = 8;
    /// Binding of the discs' build: counts, then offsets, by leaf.
    DISC_OFFSETS = 1;
    /// Binding of the discs' build: screen tile and rank of each pair.
    DISC_KEYS = 2;
    /// Binding of the discs' build: the leaf of each pair, and which of its points.
    DISC_LEAVES = 3;
    /// Binding of the discs' build: first and past-the-last pair of each screen tile.
    DISC_TILES = 4;
    /// Binding of `fit_polynomials`: every point.
    FIT_POINTS = 0;
    /// Binding of `fit_polynomials`: neighbours of the batch's points.
    FIT_NEIGHBORS = 1;
    /// Binding of `fit_polynomials`: the result.
    FIT_POLYNOMIALS = 2;
    /// Binding of `fit_polynomials`: how each fit ended.
    FIT_OUTCOMES = 3;
    /// Binding of `fit_polynomials`: h by slot, where it is smoothed.
    FIT_SIZES = 4;
    /// Binding of `fit_polynomials`: [`Rim`]s of the batch.
    FIT_RIMS = 5;
    /// Binding of the neighbour search: every point.
    SEARCH_POINTS = 0;
    /// Binding of the neighbour search: [`SearchNode`]s of an object, level over level.
    SEARCH_NODES = 1;
    /// Binding of the neighbour search: of each point of the batch, d² that holds k others.
    SEARCH_BOUNDS = 2;
    /// Binding of the neighbour search: leaves that the balls of each leaf of the batch touch.
    SEARCH_LEAVES = 3;
    /// Binding of the neighbour search: how many those are, or [`NONE`]: more than there is room for.
    SEARCH_COUNTS = 4;
    /// Binding of the neighbour search: neighbours of the batch's points.
    SEARCH_LISTS = 5;
    /// Binding of the neighbour search: leaves of the batch that are looked at again.
    SEARCH_GROUPS = 6;
    /// Binding of `find_neighbors` without ties: which leaves of the batch have some all the same.
    SEARCH_TIES = 7;
    /// Consecutive slots that share a box, and so a list of leaves; children of a node.
    LEAF_POINTS = 8;
    /// Levels of boxes, at most.
    LEAF_LEVELS = 10;
    /// Bits of an entry of a list of leaves that say which; the others say for which points.
    LEAF_BITS = 24;
    /// Boxes that the search for one list of leaves may look at.
    LEAF_STEPS = 32_768;
    /// Binding of `smooth_sizes`: every point.
    SMOOTH_POINTS = 0;
    /// Binding of `smooth_sizes`: neighbours of the batch's points.
    SMOOTH_LISTS = 1;
    /// Binding of `smooth_sizes`: distance of each point to its last neighbour, by slot.
    SMOOTH_REACHES = 2;
    /// Binding of `smooth_sizes`: h by slot.
    SMOOTH_SIZES = 3;
    /// Binding of `clip_balls`: [`BallClip`]s.
    CLIP_CLIPS = 0;
    /// Binding of `clip_balls`: polynomials.
    CLIP_POLYNOMIALS = 1;
    /// Binding of `shape_spheres` and `shape_discs`: points.
    SHAPE_POINTS = 0;
    /// Binding of `shape_spheres` and `shape_discs`: the radius of each of the batch.
    SHAPE_RADII = 1;
    /// Binding of `shape_spheres` and `shape_discs`: polynomials.
    SHAPE_POLYNOMIALS = 2;
    /// Binding of `shape_spheres` and `shape_discs`: [`FitOutcome`]s.
    SHAPE_OUTCOMES = 3;
    /// Binding of `shape_discs`: three floats for each of the batch, where normals are given.
    SHAPE_NORMALS = 4;
    /// Binding of the grid build: [`GridInfo`].
    GRID_INFO = 0;
    /// Binding of the grid build: polynomials.
    GRID_POLYNOMIALS = 1;
    /// Binding of the grid build: slots by ordinal.
    GRID_ORDER = 2;
    /// Binding of the grid build: counts, then offsets, by ordinal.
    GRID_OFFSETS = 3;
    /// Binding of the grid build: the cell of each pair.
    GRID_KEYS = 4;
    /// Binding of the grid build: the slot of each pair.
    GRID_SLOTS = 5;
    /// Binding of the grid build: first and past-the-last pair of each cell.
    GRID_CELLS = 6;
    /// Binding of the grid build: counts, then offsets, of large balls alone, by ordinal.
    GRID_LARGE = 7;
    /// Binding of the grid build: trust balls in the order of (object, index).
    GRID_BALLS = 8;
    /// Binding of `grow_marks`: cells that are marked, 32 of a row a word.
    SKIP_MARKS_IN = 8;
    /// Binding of `mark_occupied` and `grow_marks`: the cells that they mark.
    SKIP_MARKS_OUT = 9;
    /// Binding of `skip_cells`: cells with points.
    SKIP_OCCUPIED = 10;
    /// Binding of `skip_cells`: those at most one cell from these.
    SKIP_BESIDE = 11;
    /// Binding of `skip_cells`: at most two.
    SKIP_NEAR = 12;
    /// Binding of `skip_cells`: at most three.
    SKIP_FAR = 13;
    /// Cells from an empty one to the next that may not be: no greater distance is told apart.
    MOST_SKIPPED = 4;
    /// Binding of the scan: values, turned into prefix sums in place.
    SCAN_VALUES = 0;
    /// Binding of the scan: sums of runs, or what comes before each.
    SCAN_SUMS = 1;
    /// Where sums stop instead of wrapping.
    SCAN_LIMIT = 0x7fff_ffff;
    /// Binding of the sort: keys to sort.
    SORT_KEYS_IN = 0;
    /// Binding of the sort: what travels with them.
    SORT_SLOTS_IN = 1;
    /// Binding of the sort: `[digit][run]`.
    SORT_HISTOGRAM = 2;
    /// Binding of the sort: sorted keys.
    SORT_KEYS_OUT = 3;
    /// Binding of the sort: what travelled with them.
    SORT_SLOTS_OUT = 4;
    /// Binding of `cell_offsets`: [`GridInfo`].
    OFFSETS_INFO = 0;
    /// Binding of `cell_offsets`: cells, ascending.
    OFFSETS_KEYS = 1;
    /// Binding of `cell_offsets`: first entry of each cell.
    OFFSETS_OUT = 2;
    /// Binding of `list_points`: slots, cell after cell.
    OFFSETS_SLOTS = 3;
    /// Binding of `list_points`: polynomials.
    OFFSETS_POLYNOMIALS = 4;
    /// Binding of `list_points`: [`ListedPoint`]s, cell after cell.
    OFFSETS_POINTS = 5;
    /// First of the four bindings of the ray state read.
    STATE_IN = 0;
    /// First of the four bindings of the ray state written.
    STATE_OUT = 4;
    /// Binding of the tracing kernels: [`GridInfo`].
    TRACE_INFO = 8;
    /// Binding of `grid_trace`: range of each cell; of `disc_trace`: of each screen tile.
    TRACE_CELLS = 9;
    /// Binding of `grid_trace`: points of the cells; of `disc_trace`: of the screen tiles.
    TRACE_SLOTS = 10;
    /// Binding of the tracing kernels: polynomials.
    TRACE_POLYNOMIALS = 11;
    /// Binding of `grid_trace` and `disc_trace`: count of live rays.
    TRACE_LIVE = 12;
    /// Binding of `shade`: [`ObjectInfo`] by object.
    SHADE_OBJECTS = 13;
    /// Binding of `shade`: three floats a point.
    SHADE_COLORS = 14;
    /// Binding of `shade`: [`Light`]s.
    SHADE_LIGHTS = 15;
    /// Binding of `shade`: [`FilmPixel`]s.
    SHADE_FILM = 16;
    /// Binding of the kernels that deal with hits: [`Hit`]s.
    TRACE_HITS = 17;
    /// Binding of `refine`: first entry of each cell among the points.
    REFINE_OFFSETS = 18;
    /// Binding of `refine`: [`ListedPoint`]s, cell after cell.
    REFINE_POINTS = 19;
    /// Binding of `refine`: [`FitOutcome`]s.
    REFINE_OUTCOMES = 20;
    /// Binding of the kernels of a wave: [`Path`] by ray.
    WAVE_PATHS = 21;
    /// Binding of `scatter`: the [`Path`]s of the next wave.
    WAVE_NEXT_PATHS = 22;
    /// Binding of the kernels of a wave: marks of the rays that hit a diffuse surface.
    WAVE_LIT = 23;
    /// Binding of `scatter`: where the rays that those of each word of marks make begin in the next wave.
    WAVE_NEXT = 24;
    /// Binding of the kernels of a wave: counts of rays, four u32.
    WAVE_TALLY = 25;
    /// Binding of the kernels of a wave: the rays that hit a diffuse surface.
    WAVE_LIT_RAYS = 26;
    /// Binding of the kernels of a wave: what the lights send to those hits, and what the light of now would.
    WAVE_LIGHT_SUMS = 27;
    /// Texels a row of the ray state's images.
    STATE_ROW = 1024;
    /// Words of a path's set of media: two media each.
    MEDIA_WORDS = 8;
    /// [`ObjectInfo::material`] of Lambert's law.
    MATERIAL_DIFFUSE = 0;
    /// [`ObjectInfo::material`] of a perfect mirror.
    MATERIAL_MIRROR = 1;
    /// [`ObjectInfo::material`] of smooth glass.
    MATERIAL_GLASS = 2;
    /// Surfaces that a path may pass through that do not change its medium.
    MOST_CROSSINGS = 1024;
    /// [`Path::channels`] of a ray that carries all three.
    CHANNELS_ALL = 7;
    /// Bit beside them: the path was reflected somewhere.
    PATH_REFLECTED = 8;
    /// Beside an object in [`TraceParams::passed`]: its surface is not there near the ray's start alone.
    PASSED_NEAR = 0x8000_0000;
    /// [`WaveParams::transparent`]: camera rays leave the background out.
    TRANSPARENT_CAMERA = 1;
    /// [`WaveParams::transparent`]: and so does all that was refracted alone.
    TRANSPARENT_GLASS = 2;
    /// Binding of `camera_rays`: where the reconstruction filter's integral takes equal steps.
    CAMERA_FILTER = 28;
    /// Binding of `accumulate`: [`FilmSum`]s.
    FILM_SUMS = 29;
    /// Binding of `camera_rays`: the [`Path`] of every ray, but for its pixel.
    CAMERA_PATH = 32;
    /// Binding of `march`: [`VolumeInfo`]s.
    MARCH_VOLUMES = 33;
    /// Binding of `march`: [`VolumeCell`]s of all volumes.
    MARCH_CELLS = 34;
    /// Binding of `march`: [`VolumePoint`]s of all volumes.
    MARCH_POINTS = 35;
    /// Binding of `march`: [`VolumeStop`]s of all volumes.
    MARCH_STOPS = 36;
    /// Binding of `march`: [`March`] by ray.
    MARCH_STATE = 37;
    /// Binding of `march`: 1/h by point, if any volume has particles.
    MARCH_LENGTHS = 38;
    /// Binding of `count_marked` and `list_marked`: marks of each word, then offsets.
    LIVE_OFFSETS = 39;
    /// Binding of `list_marked` and `grid_trace`: the rays that are marked; those that live.
    LIVE_RAYS = 40;
    /// Binding of `isosurface`: [`IsoSearch`] by ray.
    ISO_SEARCHES = 41;
    /// Binding of `march_lit`: [`MarchLight`] by ray.
    MARCH_LIGHT = 42;
    /// Binding of `point_lights` and `march_lit`: what of each light's reaches each point of a volume.
    MARCH_VISIBLE = 43;
    /// Binding of `camera_trace` and `disc_trace`: first and past-the-last entry of each screen tile.
    DISC_RANGES_IN = 44;
    /// Binding of `camera_trace` and `disc_trace`: front to back within a screen tile.
    DISC_KEYS_IN = 45;
    /// Binding of `camera_trace` and `disc_trace`: leaves of the screen tiles, and which of their points.
    DISC_LEAVES_IN = 46;
    /// Binding of the kernels of a wave: [`LitHit`] by ray.
    WAVE_LIT_HITS = 47;
    /// Binding of `count_marked` and `list_marked`: a bit a ray.
    WAVE_MARKS = 48;
    /// Binding of the kernels of a wave: marks of the rays that hit what is not diffuse; of `scatter`, their list.
    WAVE_SCATTERING = 49;
    /// Binding of the kernels of a wave: two marks a ray, for the rays of the next wave that it makes.
    WAVE_NEXT_MARKS = 50;
    /// Binding of `list_marked`: the rays whose marks these are, where they are listed.
    LIST_IN = 51;
    /// Binding of the kernels that go through the tree: its nodes.
    TRACE_NODES = 52;
    /// Binding of `tree_nodes`: [`SearchNode`]s, the boxes around the nodes.
    TREE_BOXES = 53;
    /// Binding of `tree_nodes`: the nodes.
    TREE_NODES = 54;
    /// Binding of `march`: the ends of steps by ray and volume.
    MARCH_ENDS = 55;
    /// Binding of the kernels that let light pass surfaces: a [`Path`] a shadow ray.
    SHADOW_PATHS = 56;
    /// [`WaveParams::flags`]: rays come from the camera.
    WAVE_FROM_CAMERA = 1;
    /// [`WaveParams::flags`]: all rays have the camera's path, but for the pixel.
    WAVE_SHARES_PATH = 2;
    /// [`WaveParams::flags`]: of paths that have shown no scalar of a volume yet, the next part of the way does.
    WAVE_VALUES = 4;
    /// [`WaveParams::flags`]: of paths that have lost no light to volumes yet, the next part of the way says where it is.
    WAVE_LOSSES = 8;
    /// Of the constant that kernels are specialized by: rays that hit nothing see an image.
    SCENE_ENVIRONMENT = 1;
    /// Normals of an object are blended.
    SCENE_BLENDS = 2;
    /// There is light, and `shade` writes the colours of diffuse hits.
    SCENE_LIGHTS = 4;
    /// What each channel lets through is written.
    SCENE_ALPHA = 8;
    /// Cells crossed, points hit and iterations are written.
    SCENE_DIAGNOSTICS = 16;
    /// Points of an object have colours, or places in a texture.
    SCENE_VALUES = 32;
    /// An object has a texture.
    SCENE_TEXTURES = 64;
    /// A pixel has several samples.
    SCENE_SAMPLES = 128;
    /// Hits of an object are refined.
    SCENE_REFINES = 256;
    /// An object is diffuse.
    SCENE_DIFFUSE = 512;
    /// One is not.
    SCENE_SCATTERS = 1024;
    /// Several objects are of glass, and rays may be inside more than one.
    SCENE_NESTED = 2048;
    /// Glass has indices by channel, and rays become three.
    SCENE_DISPERSES = 4096;
    /// Glass absorbs.
    SCENE_ABSORBS = 8192;
    /// Whether glass reflects or refracts is drawn.
    SCENE_CHANCE = 16384;
    /// Paths carry what volumes emit.
    SCENE_VOLUMES = 32768;
    /// More than one light.
    SCENE_MANY_LIGHTS = 65536;
    /// Rays leave empty cells together.
    SCENE_SKIPS = 131_072;
    /// Bit of the specialization constant `SCENE`: the scene has several grids.
    SCENE_LEVELS = 262_144;
    /// Some points are drawn as spheres or discs.
    SCENE_SHAPES = 524_288;
    /// Some are drawn as spheres.
    SCENE_SPHERES = 1_048_576;
    /// The environment is turned.
    SCENE_TURNED = 2_097_152;
    /// Glass may meet a medium of its own index.
    SCENE_CLEAR = 4_194_304;
    /// Points of a volume have weights, Eq. 3 or their sum.
    SCENE_WEIGHTS = 8_388_608;
    /// Or smoothing lengths.
    SCENE_PARTICLES = 16_777_216;
    /// More than one.
    SCENE_MANY_VOLUMES = 33_554_432;
    /// One scalar stands for the whole way of a ray.
    SCENE_WHOLES = 67_108_864;
    /// A transfer function has an emission.
    SCENE_GLOWS = 134_217_728;
    /// Where half of the light is lost is asked for.
    SCENE_DEPTHS = 268_435_456;
    /// Grids of a scene, at most.
    MOST_LEVELS = 16;
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
    /// Binding of `shade`: [`ImageInfo`]s.
    SHADE_IMAGES = 30;
    /// Binding of `shade`: a table of sRGB, and the texels of all images.
    SHADE_TEXELS = 31;
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
    /// An image of red, green, blue in sRGB, a byte each, from the lowest byte of a word on.
    IMAGE_SRGB8 = 0;
    /// An image of red, green, blue as three floats, linear.
    IMAGE_LINEAR = 1;
    /// A light infinitely far away.
    LIGHT_DIRECTIONAL = 0;
    /// A light at a point.
    LIGHT_POINT = 1;
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
}

/// One point of the scene.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Point {
    /// Centred scene space.
    pub position: [f32; 3],
    /// Place in its file.
    pub index: u32,
}
gpu_layout!(Point, 16, { position: 0, index: 12 });

/// A point in the list of its cell.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ListedPoint {
    /// Centred scene space.
    pub position: [f32; 3],
    /// Its slot.
    pub slot: u32,
}
gpu_layout!(ListedPoint, 16, { position: 0, slot: 12 });

/// The surface near one point, in world form: with y = x − center,
/// gradient · y − offset − yᵀ M y = 0 where |y| ≤ trust (\[T\] §4; method, section 1).
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Polynomial {
    /// p, and the trust radius b; b = 0 where the point carries no surface. At a rim, centre and radius
    /// of a ball inside that one.
    pub center_trust: [f32; 4],
    /// m = n − E u − F v, and D.
    pub gradient_offset: [f32; 4],
    /// M: xx, yy, zz, xy.
    pub curvature: [f32; 4],
    /// M: xz, yz.
    pub cross_terms: [f32; 2],
    /// Index of the object in the scene.
    pub object: u32,
    /// Place in its file.
    pub index: u32,
}
gpu_layout!(Polynomial, 64, {
    center_trust: 0, gradient_offset: 16, curvature: 32, cross_terms: 48, object: 56, index: 60,
});

/// How one fit ended.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FitOutcome {
    /// The trust radius b, or 0.
    pub trust: f32,
    /// One of `FIT_*`.
    pub kind: u32,
    /// h.
    pub feature_size: f32,
}
gpu_layout!(FitOutcome, 12, { trust: 0, kind: 4, feature_size: 8 });

/// What a point's neighbours say about a rim of the set.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Rim {
    /// Unit vector in the tangent plane; zero where the cell is not open.
    pub outward: [f32; 3],
    /// Along it: from the point to where the surface ends.
    pub reach: f32,
    /// Reach of the Voronoi cell over that of the neighbours.
    pub openness: f32,
}
gpu_layout!(Rim, 20, { outward: 0, reach: 12, openness: 16 });

/// The box around [`LEAF_POINTS`] points, or around as many boxes. Empty where `low` is above `high`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SearchNode {
    /// Lowest corner.
    pub low: [f32; 3],
    /// The first of the boxes inside, or [`NONE`]: points are.
    pub child: u32,
    /// Highest corner.
    pub high: [f32; 3],
    /// The box to look at once this one and all inside are done, or [`NONE`].
    pub next: u32,
}
gpu_layout!(SearchNode, 32, { low: 0, child: 12, high: 16, next: 28 });

/// Parameters of `leaf_boxes` and `node_boxes`: one level of the boxes of an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct LevelParams {
    /// Of the object.
    pub first_slot: u32,
    /// Of the object.
    pub point_count: u32,
    /// k.
    pub neighbors: u32,
    /// 0: the boxes of points.
    pub level: u32,
    /// The highest level: it has [`LEAF_POINTS`] boxes.
    pub top: u32,
    /// Boxes of this level, a multiple of [`LEAF_POINTS`].
    pub count: u32,
    /// First box of each level.
    pub offsets: [u32; LEAF_LEVELS as usize],
}
gpu_layout!(LevelParams, 64, {
    first_slot: 0, point_count: 4, neighbors: 8, level: 12, top: 16, count: 20, offsets: 24,
});

/// Parameters of the neighbour search for one batch of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct SearchParams {
    /// Of the object.
    pub first_slot: u32,
    /// Of the object.
    pub point_count: u32,
    /// Place in the object of the batch's first point, a multiple of [`LEAF_POINTS`].
    pub batch_first: u32,
    /// Points of the batch.
    pub batch_count: u32,
    /// k: less than `point_count`, or 1.
    pub neighbors: u32,
    /// Entries of a point in the list of neighbours, a multiple of four.
    pub stride: u32,
    /// Entries of a list of leaves, a multiple of four.
    pub capacity: u32,
    /// The first box of the highest level.
    pub root: u32,
    /// Boxes of points, which come first.
    pub leaf_count: u32,
    /// How many leaves of the batch are looked at again, with a larger capacity; 0: all are looked at.
    pub listed: u32,
}
gpu_layout!(SearchParams, 40, {
    first_slot: 0, point_count: 4, batch_first: 8, batch_count: 12, neighbors: 16, stride: 20,
    capacity: 24, root: 28, leaf_count: 32, listed: 36,
});

/// Parameters of `smooth_sizes` for one batch of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct SmoothParams {
    /// Of the batch.
    pub first_slot: u32,
    /// Points of the batch.
    pub point_count: u32,
    /// Entries of a point in the list of neighbours.
    pub stride: u32,
    /// 0: reaches are written; 1: sizes.
    pub round: u32,
}
gpu_layout!(SmoothParams, 16, { first_slot: 0, point_count: 4, stride: 8, round: 12 });

/// A trust ball that ends at a rim.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct BallClip {
    /// Of the point.
    pub slot: u32,
    /// The ball's radius.
    pub trust: f32,
    /// From the point to the ball's centre.
    pub shift: [f32; 3],
}
gpu_layout!(BallClip, 20, { slot: 0, trust: 4, shift: 8 });

/// Push constants of `clip_balls`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ClipParams {
    /// Balls.
    pub count: u32,
}
gpu_layout!(ClipParams, 4, { count: 0 });

/// Push constants of `shape_spheres` and `shape_discs`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ShapeParams {
    /// First slot of this batch.
    pub first_slot: u32,
    /// Slots in this batch.
    pub count: u32,
    /// Index of the object in the scene.
    pub object: u32,
    /// Slot that the buffers by slot are bound from.
    pub bound_from: u32,
    /// 1: normals are given; 0: of discs, planes were fitted.
    pub has_normals: u32,
}
gpu_layout!(ShapeParams, 20, {
    first_slot: 0, count: 4, object: 8, bound_from: 12, has_normals: 16,
});

/// Push constants of `fit_polynomials`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FitParams {
    /// First slot of this batch.
    pub first_slot: u32,
    /// Points in this batch.
    pub point_count: u32,
    /// Entries a point in the list of neighbours, a multiple of four; of a plan: k.
    pub neighbors: u32,
    /// `FIT_FULL`, `FIT_INCOMPLETE` or `FIT_PLANE`: the first kind tried.
    pub polynomial: u32,
    /// h for all points; 0: the distance to the last neighbour; −1: given for each.
    pub feature_size: f32,
    /// b / h.
    pub trust: f32,
    /// Index of the object in the scene.
    pub object: u32,
    /// Slot whose neighbours come first in the list.
    pub first_listed: u32,
    /// h over the width of the weights.
    pub weight_scale: f32,
    /// 1: b grows, at most to h, where neighbours leave a gap.
    pub close_gaps: u32,
    /// Of the distance to the centroid, over the reach of the neighbours; 0: no rims.
    pub rim_limit: f32,
    /// Slot that the buffers by slot are bound from; points are bound as a whole.
    pub bound_from: u32,
}
gpu_layout!(FitParams, 48, {
    first_slot: 0, point_count: 4, neighbors: 8, polynomial: 12, feature_size: 16, trust: 20,
    object: 24, first_listed: 28, weight_scale: 32, close_gaps: 36, rim_limit: 40,
    bound_from: 44,
});

/// The uniform grid's place and size.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct GridInfo {
    /// Lowest corner, centred scene space.
    pub origin: [f32; 3],
    /// Of a cell.
    pub edge: f32,
    /// Cells along x, y, z.
    pub resolution: [u32; 3],
    /// 1 / edge.
    pub inverse_edge: f32,
}
gpu_layout!(GridInfo, 32, { origin: 0, edge: 12, resolution: 16, inverse_edge: 28 });

impl GridInfo {
    /// Cells in all.
    #[must_use]
    pub fn cell_count(&self) -> u32 {
        self.resolution.iter().product()
    }
}

/// One of the grids of a scene, which share buffers.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct GridLevel {
    /// Where it lies.
    pub grid: GridInfo,
    /// In the cells of all grids.
    pub first_cell: u32,
    /// In the offsets of the points of all grids' cells.
    pub first_offset: u32,
    /// The lowest slot that it lists.
    pub first_slot: u32,
    /// Past the highest.
    pub end_slot: u32,
}
gpu_layout!(GridLevel, 48, {
    grid: 0, first_cell: 32, first_offset: 36, first_slot: 40, end_slot: 44,
});

/// Push constants of the grid build.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct GridParams {
    /// Points of the scene.
    pub point_count: u32,
    /// Pairs of a cell of the slab and a point near it.
    pub pair_count: u32,
    /// Radius listed over trust radius; 0: each point in its own cell alone.
    pub ball_scale: f32,
    /// First layer of cells along z of the slab.
    pub first_layer: u32,
    /// Past the last.
    pub end_layer: u32,
    /// Pairs of the slabs before; of `order_balls`, points of the parts before.
    pub first_pair: u32,
    /// 1 where balls may be large.
    pub any_large: u32,
}
gpu_layout!(GridParams, 28, {
    point_count: 0, pair_count: 4, ball_scale: 8, first_layer: 12, end_layer: 16, first_pair: 20,
    any_large: 24,
});

/// Push constants of the scan.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ScanParams {
    /// Values.
    pub count: u32,
    /// 1 where the sums hold what comes before each run.
    pub has_base: u32,
}
gpu_layout!(ScanParams, 8, { count: 0, has_base: 4 });

/// Push constants of the sort.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SortParams {
    /// Keys.
    pub count: u32,
    /// Lowest bit of the digit.
    pub shift: u32,
    /// Runs of `RUN_LENGTH` keys.
    pub runs: u32,
    /// Bits of the digit, `DIGIT_BITS` at most.
    pub bits: u32,
}
gpu_layout!(SortParams, 16, { count: 0, shift: 4, runs: 8, bits: 12 });

/// Push constants of `camera_rays`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CameraParams {
    /// Centred scene space.
    pub eye: [f32; 3],
    /// Size of a pixel: on the plane at distance 1, or, where rays are parallel, anywhere.
    pub scale: f32,
    /// Unit vector to the right.
    pub right: [f32; 3],
    /// Half the full image's columns.
    pub half_width: f32,
    /// Unit vector upwards.
    pub up: [f32; 3],
    /// Half the full image's rows.
    pub half_height: f32,
    /// Unit vector of the viewing axis.
    pub forward: [f32; 3],
    /// Which sample of its pixel; `NONE` where there is one alone, through the pixel's centre and the
    /// lens's.
    pub sample_index: u32,
    /// The tile's first pixel in the full image.
    pub tile_origin: [u32; 2],
    /// Columns and rows of the tile.
    pub tile_size: [u32; 2],
    /// `PERSPECTIVE` or `ORTHOGRAPHIC`.
    pub projection: u32,
    /// 0: a pinhole.
    pub lens_radius: f32,
    /// Distance along the viewing axis of the plane in focus, greater than 0.
    pub focus: f32,
    /// Of all that is random.
    pub seed: u32,
}
gpu_layout!(CameraParams, 96, {
    eye: 0, scale: 12, right: 16, half_width: 28, up: 32, half_height: 44, forward: 48,
    sample_index: 60, tile_origin: 64, tile_size: 72, projection: 80, lens_radius: 84, focus: 88,
    seed: 92,
});

/// Push constants of `grid_trace`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TraceParams {
    /// Rays of the wave, or of those that are listed.
    pub ray_count: u32,
    /// K: cells a ray may cross in this pass.
    pub cells: u32,
    /// Loop iterations a ray may spend in this pass.
    pub work: u32,
    /// 1: any hit ends a ray.
    pub any_hit: u32,
    /// 1: rays are those of a list, and their state stays where it is.
    pub listed: u32,
    /// Object whose surface is not there, or `NONE`.
    pub passed: u32,
}
gpu_layout!(TraceParams, 24, {
    ray_count: 0, cells: 4, work: 8, any_hit: 12, listed: 16, passed: 20,
});

/// Push constants of `tree_nodes`: some nodes of one level of the tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct TreeLevelParams {
    /// Of these nodes.
    pub first: u32,
    /// Of these nodes.
    pub count: u32,
    /// Of the whole level.
    pub first_of_level: u32,
    /// The first node of the level below.
    pub first_child: u32,
    /// Nodes of the level below; of leaves, points.
    pub children: u32,
    /// The node that what is bound of all begins with.
    pub first_bound: u32,
}
gpu_layout!(TreeLevelParams, 24, {
    first: 0, count: 4, first_of_level: 8, first_child: 12, children: 16, first_bound: 20,
});

/// Where the leaves of the tree are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct TreeInfo {
    /// Their first node, a power of eight.
    pub first_leaf: u32,
    /// So many nodes before it are not there, nor in memory.
    pub gap: u32,
}
gpu_layout!(TreeInfo, 8, { first_leaf: 0, gap: 4 });

/// Push constants of `tree_trace`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct TreeTraceParams {
    /// As in [`TraceParams`].
    pub ray_count: u32,
    /// As in [`TraceParams`].
    pub work: u32,
    /// As in [`TraceParams`].
    pub any_hit: u32,
    /// As in [`TraceParams`].
    pub listed: u32,
    /// As in [`TraceParams`].
    pub passed: u32,
    /// 1: rays are at the root.
    pub starts: u32,
    /// The tree's.
    pub tree: TreeInfo,
}
gpu_layout!(TreeTraceParams, 32, {
    ray_count: 0, work: 4, any_hit: 8, listed: 12, passed: 16, starts: 20, tree: 24,
});

/// Distances between nearest and farthest, ranked by their bits.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct DepthRanks {
    /// Greater than zero; what is nearer has the same rank.
    pub nearest: f32,
    /// What is farther has the same rank.
    pub farthest: f32,
    /// Of a float's bits, so that the rank has few.
    pub shift: u32,
    /// Bits of a rank.
    pub bits: u32,
}
gpu_layout!(DepthRanks, 16, { nearest: 0, farthest: 4, shift: 8, bits: 12 });

/// Push constants of `disc_count`, `disc_emit` and `disc_ranges`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct DiscParams {
    /// The camera, and the tile of the picture.
    pub camera: CameraParams,
    /// How pairs of a screen tile are ordered.
    pub ranks: DepthRanks,
    /// Points of the scene.
    pub point_count: u32,
    /// Pairs of a screen tile and a leaf with points whose discs cover it.
    pub pair_count: u32,
}
gpu_layout!(DiscParams, 120, { camera: 0, ranks: 96, point_count: 112, pair_count: 116 });

/// Push constants of `disc_trace`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct DiscTraceParams {
    /// How pairs of a screen tile are ordered.
    pub ranks: DepthRanks,
    /// Columns and rows of the tile of the picture.
    pub tile_size: [u32; 2],
    /// Loop iterations a ray may spend in this pass.
    pub work: u32,
}
gpu_layout!(DiscTraceParams, 28, { ranks: 0, tile_size: 16, work: 24 });

/// What rays that hit nothing see.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct BackgroundInfo {
    /// Linear RGB.
    pub color: [f32; 3],
    /// An image instead, or `NONE`.
    pub environment: u32,
}
gpu_layout!(BackgroundInfo, 16, { color: 0, environment: 12 });

/// Push constants of `camera_trace`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CameraTraceParams {
    /// As in [`CameraParams`], as are the next six.
    pub eye: [f32; 3],
    /// Half the view's height over half the rows.
    pub scale: f32,
    /// Unit vector.
    pub right: [f32; 3],
    /// Of the full image, in pixels.
    pub half_width: f32,
    /// Unit vector.
    pub up: [f32; 3],
    /// Of the full image, in pixels.
    pub half_height: f32,
    /// Unit vector of the viewing axis.
    pub forward: [f32; 3],
    /// Loop iterations a ray may spend.
    pub work: u32,
    /// The tile's first pixel in the full image.
    pub tile_origin: [u32; 2],
    /// Columns and rows of the tile.
    pub tile_size: [u32; 2],
    /// What rays that hit nothing see.
    pub background: BackgroundInfo,
    /// How pairs of a screen tile are ordered.
    pub ranks: DepthRanks,
    /// What leaves the background out: one of `TRANSPARENT_*`, or 0 for nothing.
    pub transparent: u32,
    /// Interactions after the primary hit.
    pub max_bounces: u32,
    /// The tree's, where rays go through it.
    pub tree: TreeInfo,
}
gpu_layout!(CameraTraceParams, 128, {
    eye: 0, scale: 12, right: 16, half_width: 28, up: 32, half_height: 44, forward: 48, work: 60,
    tile_origin: 64, tile_size: 72, background: 80, ranks: 96, transparent: 112,
    max_bounces: 116, tree: 120,
});

/// A hit on a diffuse surface, where light is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct LitHit {
    /// Centred scene space.
    pub position: [f32; 3],
    /// The point hit.
    pub slot: u32,
    /// Unit normal facing the ray's origin.
    pub normal: [f32; 3],
    /// Unused.
    pub pad: u32,
}
gpu_layout!(LitHit, 32, { position: 0, slot: 12, normal: 16, pad: 28 });

/// Push constants of `count_marked` and `list_marked`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct MarkParams {
    /// Words of 32 marks each.
    pub words: u32,
    /// 1: a word is followed by one whose marks count twice.
    pub pairs: u32,
    /// 1: marks are of the rays of a list.
    pub listed: u32,
}
gpu_layout!(MarkParams, 12, { words: 0, pairs: 4, listed: 8 });

/// Push constants of the kernels that scatter and shade the rays of a wave.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct WaveParams {
    /// Unit vector of the viewing axis.
    pub forward: [f32; 3],
    /// Rays of the wave; for `shadow_rays` and `shade`, hits on diffuse surfaces.
    pub ray_count: u32,
    /// What rays that hit nothing see.
    pub background: BackgroundInfo,
    /// The tile's first pixel in the full image.
    pub tile_origin: [u32; 2],
    /// Columns and rows of the tile.
    pub tile_size: [u32; 2],
    /// `WAVE_*`.
    pub flags: u32,
    /// Interactions after the primary hit.
    pub max_bounces: u32,
    /// 1: glass reflects or refracts at random; 0: it refracts.
    pub fresnel: u32,
    /// Of everything random.
    pub seed: u32,
    /// The light that shadow rays go to now.
    pub light: u32,
    /// Lights of the scene.
    pub light_count: u32,
    /// Which sample of each pixel; `NONE` where there is one alone, and lights have no extent.
    pub sample_index: u32,
    /// What leaves the background out: one of `TRANSPARENT_*`, or 0 for nothing.
    pub transparent: u32,
}
gpu_layout!(WaveParams, 80, {
    forward: 0, ray_count: 12, background: 16, tile_origin: 32, tile_size: 40, flags: 48,
    max_bounces: 52, fresnel: 56, seed: 60, light: 64, light_count: 68, sample_index: 72,
    transparent: 76,
});

/// An image whose texels lie in rows, the top row first. After that of an environment come three whose first three
/// words are the bits of a row of the matrix that turns it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct ImageInfo {
    /// Word of its first texel among all texels.
    pub first: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// One of `IMAGE_*`.
    pub format: u32,
}
gpu_layout!(ImageInfo, 16, { first: 0, width: 4, height: 8, format: 12 });

/// What shading needs of an object.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ObjectInfo {
    /// Linear RGB, where the points' colours do not count; of a mirror, the share reflected.
    pub albedo: [f32; 3],
    /// First float of what its points have: three floats of colour each, or, with a texture, their two
    /// places in it; `NONE` where they have neither.
    pub first_color: u32,
    /// First slot of the object.
    pub first_slot: u32,
    /// `FIT_FULL` or `FIT_INCOMPLETE`: what refinement fits first.
    pub polynomial: u32,
    /// Of the refinement; 0: hits are taken as they are.
    pub max_iterations: u32,
    /// Of the refinement, over h.
    pub tolerance: f32,
    /// Slots that carry the object's surface; its spheres and discs come after these.
    pub slot_count: u32,
    /// h over the width of the weights.
    pub weight_scale: f32,
    /// 1: normals are blended over the polynomials around a hit.
    pub blends: u32,
    /// An image, or `NONE`.
    pub texture: u32,
    /// Column over width at x is dot(xyz, x) + w, where points have no places in the texture.
    pub texture_u: [f32; 4],
    /// Row over height.
    pub texture_v: [f32; 4],
    /// Refractive index of glass, by channel.
    pub ior: [f32; 3],
    /// One of `MATERIAL_*`.
    pub material: u32,
    /// Of glass: σ, per unit of length.
    pub absorption: [f32; 3],
    /// Of glass: the highest counts where media overlap.
    pub priority: i32,
}
gpu_layout!(ObjectInfo, 112, {
    albedo: 0, first_color: 12, first_slot: 16, polynomial: 20, max_iterations: 24, tolerance: 28,
    slot_count: 32, weight_scale: 36, blends: 40, texture: 44, texture_u: 48, texture_v: 64, ior: 80,
    material: 92, absorption: 96, priority: 108,
});

/// One light.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Light {
    /// Unit vector towards a directional light; a point light's position, centred scene space.
    pub vector: [f32; 3],
    /// One of `LIGHT_*`.
    pub kind: u32,
    /// Irradiance on a surface facing it, or intensity.
    pub strength: [f32; 3],
    /// Sine of half the angle of a directional light; a point light's radius. 0: it is hard.
    pub extent: f32,
}
gpu_layout!(Light, 32, { vector: 0, kind: 12, strength: 16, extent: 28 });

/// Where a pixel's ray met a surface.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Hit {
    /// Centred scene space.
    pub position: [f32; 3],
    /// Distance along the ray.
    pub t: f32,
    /// Unit normal facing the ray's origin.
    pub normal: [f32; 3],
    /// One of `HIT_*`, and counts of iterations.
    pub status: u32,
}
gpu_layout!(Hit, 32, { position: 0, t: 12, normal: 16, status: 28 });

/// What a ray has behind it.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Path {
    /// What of the light it finds arrives at the pixel.
    pub throughput: [f32; 3],
    /// Pixel of the tile, row by row; `NONE`: no ray at all.
    pub pixel: u32,
    /// Bits of `CHANNELS_ALL`: 1 red, 2 green, 4 blue; and `PATH_REFLECTED`.
    pub channels: u32,
    /// Interactions with surfaces so far.
    pub bounces: u32,
    /// Surfaces passed through so far that did not change its medium.
    pub crossings: u32,
    /// Objects that it is inside.
    pub media_count: u32,
    /// Those, 16 bits each, in no order.
    pub media: [u32; MEDIA_WORDS as usize],
    /// What volumes on its way have sent to the pixel.
    pub emitted: [f32; 3],
    /// Optical depth of the volumes on its way so far, which is no part of the throughput.
    pub depth: f32,
}
gpu_layout!(Path, 80, {
    throughput: 0, pixel: 12, channels: 16, bounces: 20, crossings: 24, media_count: 28, media: 32,
    emitted: 64, depth: 76,
});

/// A field between points (\[T\] §6).
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct VolumeInfo {
    /// Over the points' bounding box grown by the radius, and up to a cell more.
    pub grid: GridInfo,
    /// In the cells of all volumes.
    pub first_cell: u32,
    /// In the stops of all volumes.
    pub first_stop: u32,
    /// Stops of its transfer function.
    pub stop_count: u32,
    /// One of `VOLUME_*`.
    pub kernel: u32,
    /// Of a point's reach.
    pub square_radius: f32,
    /// 1 / 2ρ.
    pub inverse_width: f32,
    /// Index of the object in the scene.
    pub object: u32,
    /// 1: it counts inside the object's surface alone.
    pub bounded: u32,
    /// Highest corner of the box, whose lowest is the grid's.
    pub high: [f32; 3],
    /// What a ray shows: one of `VOLUME_EMISSION` and so on.
    pub mode: u32,
    /// Scalar on an isosurface.
    pub iso: f32,
    /// Of the polynomial that stands for an isosurface, behind those of all points; of other modes, 1 where anything has an
    /// emission.
    pub slot: u32,
    /// 1: an isosurface of glass, which rays are inside or outside of.
    pub refracts: u32,
    /// What light does in it: one of `VOLUME_EMITS` and so on.
    pub shading: u32,
}
gpu_layout!(VolumeInfo, 96, {
    grid: 0, first_cell: 32, first_stop: 36, stop_count: 40, kernel: 44, square_radius: 48,
    inverse_width: 52, object: 56, bounded: 60, high: 64, mode: 76, iso: 80,
    slot: 84, refracts: 88, shading: 92,
});

/// A cell of a volume's grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct VolumeCell {
    /// Point in the points of all volumes; the next cell's is the end.
    pub first: u32,
    /// One of `CELL_*`.
    pub counts: u32,
}
gpu_layout!(VolumeCell, 8, { first: 0, counts: 4 });

/// A point of a volume.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct VolumePoint {
    /// Centred scene space.
    pub position: [f32; 3],
    /// What it carries; a particle, A (m/ρ) / (π h³).
    pub scalar: f32,
}
gpu_layout!(VolumePoint, 16, { position: 0, scalar: 12 });

/// A stop of a transfer function, ascending in value. Integrals are those from the first stop to this one, each of them
/// the sum of two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct VolumeStop {
    /// Linear RGB.
    pub color: [f32; 3],
    /// σ, per unit of length.
    pub extinction: f32,
    /// The scalar at this stop.
    pub value: f32,
    /// Radiance per unit of length.
    pub emission: [f32; 3],
    /// Of the colour times the extinction, and of the extinction.
    pub scattering_integral: [f32; 4],
    /// The second numbers of these.
    pub scattering_rest: [f32; 4],
    /// Of the emission; the fourth is 0.
    pub emission_integral: [f32; 4],
    /// The second numbers of these.
    pub emission_rest: [f32; 4],
}
gpu_layout!(VolumeStop, 96, {
    color: 0, extinction: 12, value: 16, emission: 20, scattering_integral: 32, scattering_rest: 48,
    emission_integral: 64, emission_rest: 80,
});

/// How far a ray has marched through volumes. Sums over its way are of two numbers: what rounding added is taken from
/// the next term.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct March {
    /// Emitted towards its start so far; of other modes than emission, the greatest scalar or the integral
    /// of all, and the length in reach.
    pub color: [f32; 3],
    /// Optical depth.
    pub depth: f32,
    /// What rounding added to the colour.
    pub color_lost: [f32; 3],
    /// What rounding added to the depth.
    pub depth_lost: f32,
    /// What this step sends per length, of the volumes so far.
    pub step_color: [f32; 3],
    /// Of this step.
    pub step_extinction: f32,
    /// Of this volume's scalar.
    pub numerator: f32,
    /// Of this volume's scalar.
    pub denominator: f32,
    /// 0: not begun, 1: on its way, 2: done, 3: once more, for `along`.
    pub state: u32,
    /// End of a step.
    pub place: u32,
    /// Volume.
    pub volume: u32,
    /// Of cells around the place.
    pub row: u32,
    /// Points of the row that are done.
    pub cursor: u32,
    /// For the channels of volumes: the depth along the viewing axis where half of what is lost is lost, or below 0;
    /// of other modes than emission, the scalar that is shown.
    pub along: f32,
}
gpu_layout!(March, 80, {
    color: 0, depth: 12, color_lost: 16, depth_lost: 28, step_color: 32, step_extinction: 44, numerator: 48,
    denominator: 52, state: 56, place: 60, volume: 64, row: 68, cursor: 72, along: 76,
});

/// What a sample of a lit volume needs beside its scalar.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct MarchLight {
    /// Sum of the weights' gradients, by the scalars.
    pub pull: [f32; 3],
    /// Unused.
    pub pad: u32,
    /// Sum of the weights' gradients.
    pub weights_pull: [f32; 3],
    /// Unused.
    pub pad_end: u32,
    /// Of each light, by the weights.
    pub visible: [f32; 4],
}
gpu_layout!(MarchLight, 48, { pull: 0, pad: 12, weights_pull: 16, pad_end: 28, visible: 32 });

/// How far a ray has looked for isosurfaces.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct IsoSearch {
    /// As in [`MarchLight`], at this place.
    pub pull: [f32; 3],
    /// Of the scalar here.
    pub numerator: f32,
    /// As in [`MarchLight`], at this place.
    pub weights_pull: [f32; 3],
    /// Of the scalar here.
    pub denominator: f32,
    /// Along the ray: the last place on the side that it comes from.
    pub low: f32,
    /// The first known beyond the surface.
    pub high: f32,
    /// Scalar less iso there; 0: not known.
    pub value_low: f32,
    /// The same at the other end.
    pub value_high: f32,
    /// The next place between them.
    pub here: f32,
    /// New, stepping, closing in, turning to the viewer, done.
    pub state: u32,
    /// Sample, or turn.
    pub place: u32,
    /// Volume.
    pub volume: u32,
    /// Of cells around the place.
    pub row: u32,
    /// Points of the row that are done.
    pub cursor: u32,
    /// Of `low`: 0 not known, 1 below, 2 above.
    pub side: u32,
    /// Whether it was looked at, or is known from its cell; then which end moved.
    pub looked: u32,
}
gpu_layout!(IsoSearch, 80, {
    pull: 0, numerator: 12, weights_pull: 16, denominator: 28, low: 32, high: 36, value_low: 40,
    value_high: 44, here: 48, state: 52, place: 56, volume: 60, row: 64, cursor: 68, side: 72, looked: 76,
});

/// Push constants of `shadow_meet` and `shadow_go_on`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct ShadowParams {
    /// Shadow rays.
    pub ray_count: u32,
    /// Object whose surface is not there, or `NONE`.
    pub passed: u32,
    /// 1: the work of rays is counted in the film.
    pub counts: u32,
    /// Objects that the light may be inside of; `NONE`: it is not known which.
    pub lamp_count: u32,
    /// Those, 16 bits each.
    pub lamp_media: [u32; MEDIA_WORDS as usize],
}
gpu_layout!(ShadowParams, 48, { ray_count: 0, passed: 4, counts: 8, lamp_count: 12, lamp_media: 16 });

/// Push constants of `point_rays` and `point_lights`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct PointLightParams {
    /// Point in the points of all volumes.
    pub first: u32,
    /// Points of this batch.
    pub count: u32,
    /// Which.
    pub light: u32,
    /// Whose points they are.
    pub volume: u32,
}
gpu_layout!(PointLightParams, 16, { first: 0, count: 4, light: 8, volume: 12 });

/// Push constants of `march`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct MarchParams {
    /// Viewing axis.
    pub forward: [f32; 3],
    /// Rays.
    pub ray_count: u32,
    /// Volumes of the scene.
    pub volume_count: u32,
    /// Distance of the samples.
    pub step: f32,
    /// Loop iterations a ray may spend in this pass.
    pub work: u32,
    /// Lights, where volumes are lit.
    pub light_count: u32,
    /// 1: `along` is asked for.
    pub wants_depth: u32,
    /// Unused.
    pub pad: [u32; 3],
}
gpu_layout!(MarchParams, 48, {
    forward: 0, ray_count: 12, volume_count: 16, step: 20, work: 24, light_count: 28, wants_depth: 32, pad: 36,
});

/// Light at a diffuse hit.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct LightSum {
    /// Irradiance by the lights before the last, each by its cosine.
    pub sum: [f32; 3],
    /// Unused.
    pub pad: u32,
    /// What the last would add, were nothing in the way.
    pub arriving: [f32; 3],
    /// Unused.
    pub pad_end: u32,
}
gpu_layout!(LightSum, 32, { sum: 0, pad: 12, arriving: 16, pad_end: 28 });

/// A ray as it travels in a queue; all bits as unsigned integers.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct StateRay {
    /// Origin in centred scene space, and the nearest hit so far.
    pub position: [u32; 4],
    /// Unit direction, and how many cells were crossed.
    pub direction: [u32; 4],
    /// Cell or `NONE`, cursor in it, points tested, slot of the hit or `NONE`.
    pub cell: [u32; 4],
    /// The point whose surface it starts on or `NONE`, up to where hits do not count, the cell where it came
    /// into the grid that it is in, of several; one unused.
    pub start: [u32; 4],
}
gpu_layout!(StateRay, 64, { position: 0, direction: 16, cell: 32, start: 48 });

/// What one pixel saw.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FilmPixel {
    /// Radiance, and coverage.
    pub color: [f32; 4],
    /// First surface, centred scene space; distance along the viewing axis, or +inf.
    pub position_depth: [f32; 4],
    /// Unit normal facing the viewer; index of the object, or −1.
    pub normal_object: [f32; 4],
    /// Points tested, cells crossed, slot of the hit or `NONE`, iterations of its refinement.
    pub counts: [u32; 4],
    /// 1 less what each channel lets through of the background, by glass and volumes alone.
    pub alpha: [f32; 3],
    /// Of volumes on the camera ray's way, as in [`March`].
    pub along: f32,
}
gpu_layout!(FilmPixel, 80, {
    color: 0, position_depth: 16, normal_object: 32, counts: 48, alpha: 64, along: 76,
});

/// A pixel's samples so far.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FilmSum {
    /// Sums of colours, alphas and of the first two counts; all else is the first sample's.
    pub pixel: FilmPixel,
    /// What rounding added to the colours' sums.
    pub lost: [f32; 4],
    /// What it added to the alphas'.
    pub lost_alpha: [f32; 3],
    /// Unused.
    pub pad: u32,
}
gpu_layout!(FilmSum, 112, { pixel: 0, lost: 80, lost_alpha: 96, pad: 108 });

/// Push constants of `accumulate`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct AccumulateParams {
    /// Columns and rows of the tile.
    pub tile_size: [u32; 2],
    /// Which sample the film holds.
    pub sample_index: u32,
    /// In all.
    pub samples: u32,
}
gpu_layout!(AccumulateParams, 16, { tile_size: 0, sample_index: 8, samples: 12 });

/// Every struct that host and kernels share.
pub const STRUCTS: &[StructLayout] = &[
    ListedPoint::LAYOUT,
    Polynomial::LAYOUT,
    FitOutcome::LAYOUT,
    Rim::LAYOUT,
    SearchNode::LAYOUT,
    LevelParams::LAYOUT,
    TreeLevelParams::LAYOUT,
    TreeInfo::LAYOUT,
    TreeTraceParams::LAYOUT,
    SearchParams::LAYOUT,
    SmoothParams::LAYOUT,
    BallClip::LAYOUT,
    ClipParams::LAYOUT,
    ShapeParams::LAYOUT,
    FitParams::LAYOUT,
    GridInfo::LAYOUT,
    GridLevel::LAYOUT,
    GridParams::LAYOUT,
    ScanParams::LAYOUT,
    SortParams::LAYOUT,
    CameraParams::LAYOUT,
    TraceParams::LAYOUT,
    DepthRanks::LAYOUT,
    DiscParams::LAYOUT,
    DiscTraceParams::LAYOUT,
    CameraTraceParams::LAYOUT,
    LitHit::LAYOUT,
    MarkParams::LAYOUT,
    WaveParams::LAYOUT,
    BackgroundInfo::LAYOUT,
    ImageInfo::LAYOUT,
    ObjectInfo::LAYOUT,
    Light::LAYOUT,
    Hit::LAYOUT,
    Path::LAYOUT,
    VolumeInfo::LAYOUT,
    VolumeCell::LAYOUT,
    VolumePoint::LAYOUT,
    VolumeStop::LAYOUT,
    March::LAYOUT,
    MarchLight::LAYOUT,
    IsoSearch::LAYOUT,
    PointLightParams::LAYOUT,
    ShadowParams::LAYOUT,
    MarchParams::LAYOUT,
    LightSum::LAYOUT,
    StateRay::LAYOUT,
    FilmPixel::LAYOUT,
    FilmSum::LAYOUT,
    AccumulateParams::LAYOUT,
];
