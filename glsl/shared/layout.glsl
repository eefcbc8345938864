// layout: every struct, binding number and group size that kernels and host share.
//
// host twin  crates/kernels/src/layout.rs; the tests `layout_matches_spirv` and
//            `constants_match_the_host` compare the two.
// Buffers are std430. Indices: a slot is a point's place in memory, its index the place in its
// file, its ordinal the place in the order (object, index).
#ifndef LAYOUT_GLSL
#define LAYOUT_GLSL

#define NONE 0xffffffffu // no slot, no colour, no object; a ray's cell once the ray is done

#define LINE_GROUP 64 // invocations a workgroup of every kernel that runs along a list
#define LINE_ROW 1048576 // invocations a row of such a kernel, where one row is not enough
#define TILE_GROUP 64 // invocations a workgroup of every kernel that runs over pixels, 8 x 8 of them
#define RUN_LENGTH 256 // entries that one invocation of the scan and sort kernels walks
#define DIGIT_BITS 8 // bits of a key sorted in one round at most

// disc_count, disc_emit, disc_ranges
#define DISC_TILE 8 // pixels a screen tile has along each side: those of one workgroup
#define DISC_OFFSETS 1
#define DISC_KEYS 2
#define DISC_LEAVES 3
#define DISC_TILES 4

// fit_polynomials
#define FIT_POINTS 0
#define FIT_NEIGHBORS 1
#define FIT_POLYNOMIALS 2
#define FIT_OUTCOMES 3
#define FIT_SIZES 4
#define FIT_RIMS 5

// leaf_boxes, node_boxes, bound_reach, gather_leaves, find_neighbors
#define SEARCH_POINTS 0
#define SEARCH_NODES 1
#define SEARCH_BOUNDS 2
#define SEARCH_LEAVES 3
#define SEARCH_COUNTS 4
#define SEARCH_LISTS 5
#define SEARCH_GROUPS 6
#define SEARCH_TIES 7
#define LEAF_POINTS 8 // consecutive slots that share a box, and so a list of leaves; children of a node
#define LEAF_LEVELS 10 // of boxes, at most
#define LEAF_BITS 24 // of an entry in a list of leaves: the leaf; the others: which of LEAF_POINTS it is for
#define LEAF_STEPS 32768 // boxes that the search for one list of leaves may look at

// smooth_sizes
#define SMOOTH_POINTS 0
#define SMOOTH_LISTS 1
#define SMOOTH_REACHES 2
#define SMOOTH_SIZES 3

// clip_balls
#define CLIP_CLIPS 0
#define CLIP_POLYNOMIALS 1

// shape_spheres, shape_discs
#define SHAPE_POINTS 0
#define SHAPE_RADII 1
#define SHAPE_POLYNOMIALS 2
#define SHAPE_OUTCOMES 3
#define SHAPE_NORMALS 4

// grid_count, grid_emit, grid_emit_large, grid_ranges
#define GRID_INFO 0
#define GRID_POLYNOMIALS 1
#define GRID_ORDER 2
#define GRID_OFFSETS 3
#define GRID_KEYS 4
#define GRID_SLOTS 5
#define GRID_CELLS 6
#define GRID_LARGE 7
#define GRID_BALLS 8 // centre and radius, in the order of (object, index)
#define SKIP_MARKS_IN 8
#define SKIP_MARKS_OUT 9
#define SKIP_OCCUPIED 10
#define SKIP_BESIDE 11
#define SKIP_NEAR 12
#define SKIP_FAR 13
#define MOST_SKIPPED 4 // cells from an empty one to the next that may not be: no greater distance is told apart

// scan_reduce, scan_apply
#define SCAN_VALUES 0
#define SCAN_SUMS 1
#define SCAN_LIMIT 0x7fffffffu // sums stop here instead of wrapping

// sort_count, sort_scatter
#define SORT_KEYS_IN 0
#define SORT_SLOTS_IN 1
#define SORT_HISTOGRAM 2
#define SORT_KEYS_OUT 3
#define SORT_SLOTS_OUT 4

// cell_offsets
#define OFFSETS_INFO 0
#define OFFSETS_KEYS 1
#define OFFSETS_OUT 2
#define OFFSETS_SLOTS 3
#define OFFSETS_POLYNOMIALS 4
#define OFFSETS_POINTS 5

// the kernels that run over pixels: the ray state, four images, and four more to write
#define STATE_IN 0   // then 1, 2, 3
#define STATE_OUT 4  // then 5, 6, 7
#define TRACE_INFO 8
#define TRACE_CELLS 9
#define TRACE_SLOTS 10
#define TRACE_POLYNOMIALS 11
#define TRACE_LIVE 12
#define SHADE_OBJECTS 13
#define SHADE_COLORS 14
#define SHADE_LIGHTS 15
#define SHADE_FILM 16
#define TRACE_HITS 17
#define REFINE_OFFSETS 18
#define REFINE_POINTS 19
#define REFINE_OUTCOMES 20
#define WAVE_PATHS 21
#define WAVE_NEXT_PATHS 22
#define WAVE_LIT 23
#define WAVE_NEXT 24
#define WAVE_TALLY 25
#define WAVE_LIT_RAYS 26
#define WAVE_LIGHT_SUMS 27

#define MOST_LEVELS 16 // grids of a scene
#define STATE_ROW 1024 // texels a row of the ray state's images
#define MEDIA_WORDS 8 // of a path: two media each

// How a surface scatters.
#define MATERIAL_DIFFUSE 0
#define MATERIAL_MIRROR 1
#define MATERIAL_GLASS 2

// How a volume's points are blended.
#define VOLUME_SHEPARD 0
#define VOLUME_SUM 1
#define VOLUME_SPH 2

// What a ray through a volume shows.
#define VOLUME_EMISSION 0
#define VOLUME_MAXIMUM 1
#define VOLUME_AVERAGE 2
#define VOLUME_ISOSURFACE 3 // a surface where the scalar is one number; nothing along the way
#define VOLUME_INTEGRAL 4

// What the light of the scene does in a volume.
#define VOLUME_EMITS 0    // nothing: colours are emitted
#define VOLUME_GRADIENT 1 // Lambert's law, with the scalar's gradient for a normal
#define VOLUME_SCATTERS 2 // it is scattered evenly to all sides
#define VOLUME_LIGHTS 4   // lights that a scene with such volumes may have

// What may be seen from a volume's cell.
#define CELL_NOTHING 0
#define CELL_LOOK 1  // look
#define CELL_ABOVE 2 // of an isosurface: the scalar is above it wherever there is one
#define CELL_BELOW 3

#define MOST_CROSSINGS 1024 // surfaces a path may pass through that do not change its medium
#define CHANNELS_ALL 7 // a path's channels: 1 red, 2 green, 4 blue
#define PATH_REFLECTED 8 // beside them: the path was reflected somewhere
#define PASSED_NEAR 0x80000000u // beside an object that is passed: its surface is not there near the ray's start alone

// Of a wave.
#define WAVE_FROM_CAMERA 1  // its rays come from there
#define WAVE_SHARES_PATH 2  // and have one path, but for the pixel
#define WAVE_VALUES 4       // where paths have shown no scalar of a volume yet, this part of the way does
#define WAVE_LOSSES 8       // where they have lost no light to volumes yet, this part of the way says where

// What a scene has need of: bits of the specialization constant 0 (scene.glsl). Drivers leave out what it has not.
#define SCENE_ENVIRONMENT 1 // rays that hit nothing see an image
#define SCENE_BLENDS 2      // normals of an object are blended
#define SCENE_LIGHTS 4      // and shade writes the colours of diffuse hits
#define SCENE_ALPHA 8       // what each channel lets through is written
#define SCENE_DIAGNOSTICS 16 // cells crossed, points hit and iterations are written
#define SCENE_VALUES 32     // points of an object have colours, or places in a texture
#define SCENE_TEXTURES 64
#define SCENE_SAMPLES 128   // a pixel has several
#define SCENE_REFINES 256   // hits of an object are refined
#define SCENE_DIFFUSE 512   // an object is diffuse
#define SCENE_SCATTERS 1024 // one is not
#define SCENE_NESTED 2048   // several are of glass, and rays may be inside more than one
#define SCENE_DISPERSES 4096 // glass has indices by channel, and rays become three
#define SCENE_ABSORBS 8192  // glass does
#define SCENE_CHANCE 16384  // decides whether glass reflects or refracts
#define SCENE_VOLUMES 32768 // paths carry what volumes emit
#define SCENE_MANY_LIGHTS 65536 // more than one
#define SCENE_SKIPS 131072  // rays leave empty cells together
#define SCENE_LEVELS 262144 // several grids
#define SCENE_SHAPES 524288 // some points are spheres or discs
#define SCENE_SPHERES 1048576 // some are spheres
#define SCENE_TURNED 2097152 // the environment is turned
#define SCENE_CLEAR 4194304 // glass may meet a medium of its own index
#define SCENE_WEIGHTS 8388608 // points of a volume have weights, Eq. 3 or their sum
#define SCENE_PARTICLES 16777216 // or smoothing lengths
#define SCENE_MANY_VOLUMES 33554432 // more than one
#define SCENE_WHOLES 67108864 // one scalar stands for the whole way of a ray
#define SCENE_GLOWS 134217728 // a transfer function has an emission
#define SCENE_DEPTHS 268435456 // where half of the light is lost is asked for

// What transparent pictures leave the background out of.
#define TRANSPARENT_CAMERA 1 // camera rays
#define TRANSPARENT_GLASS 2 // and all that was refracted alone
#define CAMERA_FILTER 28
#define FILM_SUMS 29
#define CAMERA_PATH 32
#define MARCH_VOLUMES 33
#define MARCH_CELLS 34
#define MARCH_POINTS 35
#define MARCH_STOPS 36
#define MARCH_STATE 37
#define MARCH_LENGTHS 38
#define LIVE_OFFSETS 39
#define LIVE_RAYS 40
#define ISO_SEARCHES 41
#define MARCH_LIGHT 42 // MarchLight by ray
#define MARCH_VISIBLE 43
#define DISC_RANGES_IN 44 // camera_trace and disc_trace read the lists of screen tiles
#define DISC_KEYS_IN 45
#define DISC_LEAVES_IN 46
#define WAVE_LIT_HITS 47
#define WAVE_MARKS 48
#define WAVE_SCATTERING 49
#define WAVE_NEXT_MARKS 50
#define LIST_IN 51
#define TRACE_NODES 52
#define TREE_BOXES 53
#define TREE_NODES 54
#define MARCH_ENDS 55 // by ray and volume
#define SHADOW_PATHS 56 // of shadow rays, where light may pass surfaces
#define SHADE_IMAGES 30
#define SHADE_TEXELS 31

// What has become of a pixel's hit: the low byte of Hit.status.
#define HIT_NONE 0
#define HIT_ACCEPTED 1
#define HIT_PENDING 2
#define HIT_REJECTED 3
#define HIT_STATUS_BITS 8 // the next 8 bits count the iterations since the stored hit
#define HIT_TOTAL_SHIFT 16 // the bits from here on count all iterations of the ray

// How a point's fit ended.
#define FIT_NO_SURFACE 0
#define FIT_PLANE 1
#define FIT_INCOMPLETE 2
#define FIT_FULL 3
#define FIT_DISC 4 // no fit: the point is drawn as a disc
#define FIT_SPHERE 5

// What an image's texels are.
#define IMAGE_SRGB8 0  // red, green, blue in sRGB, a byte each, from the lowest byte of a word on
#define IMAGE_LINEAR 1 // red, green, blue as three floats

#define LIGHT_DIRECTIONAL 0
#define LIGHT_POINT 1

#define PERSPECTIVE 0
#define ORTHOGRAPHIC 1
#define FILTER_INTERVALS 1024 // of the table that the reconstruction filter is sampled by

// What each two numbers of the low-discrepancy sequence are for (sampler.glsl).
#define SAMPLE_FILM 0
#define SAMPLE_LENS 1
#define SAMPLE_FRESNEL 2 // then one a bounce
#define SAMPLE_LIGHT 4096 // then one a light

struct Point {           // 16 bytes
    vec3 position;       //  0  centred scene space
    uint index;          // 12  place in its file
};

// A point in the list of its cell.
struct ListedPoint {     // 16 bytes
    vec3 position;       //  0  centred scene space
    uint slot;           // 12
};

// The surface near one point: with y = x - center,
// dot(gradient, y) - offset - y' M y = 0 where |y| <= trust (method, section 1, step 3).
struct Polynomial {       // 64 bytes
    vec4 center_trust;    //  0  p, and b; b = 0: the point carries no surface; at a rim, a ball inside that one
    vec4 gradient_offset; // 16  m = n - E u - F v, and D
    vec4 curvature;       // 32  M: xx, yy, zz, xy
    vec2 cross_terms;     // 48  M: xz, yz
    uint object;          // 56
    uint index;           // 60  place in its file
};

struct FitOutcome {      // 12 bytes
    float trust;         // 0  b, or 0 where the point carries no surface
    uint kind;           // 4  FIT_*
    float feature_size;  // 8  h
};

// What a point's neighbours say about a rim of the set.
struct Rim {             // 20 bytes
    float outward[3];    //  0  unit, in the tangent plane; 0 where the cell is not open
    float reach;         // 12  along it: from the point to where the surface ends
    float openness;      // 16  reach of the Voronoi cell over that of the neighbours
};

// The box around LEAF_POINTS points, or around as many boxes. Empty: low above high.
struct SearchNode {      // 32 bytes
    vec3 low;            //  0
    uint child;          // 12  the first of the boxes inside; NONE: points are
    vec3 high;           // 16
    uint next;           // 28  the box to look at once this one and all inside are done; NONE: none
};

// One level of the boxes of an object.
struct LevelParams {     // 64 bytes
    uint first_slot;     //  0  of the object
    uint point_count;    //  4  of the object
    uint neighbors;      //  8  k
    uint level;          // 12  0: the boxes of points
    uint top;            // 16  the highest level: it has LEAF_POINTS boxes
    uint count;          // 20  boxes of this level, a multiple of LEAF_POINTS
    uint offsets[10];    // 24  first box of each level
};

// Of the neighbours of one batch.
struct SearchParams {    // 40 bytes
    uint first_slot;     //  0  of the object
    uint point_count;    //  4  of the object
    uint batch_first;    //  8  place in the object of the batch's first point, a multiple of LEAF_POINTS
    uint batch_count;    // 12
    uint neighbors;      // 16  k, less than point_count, or 1
    uint stride;         // 20  entries of a point in the list of neighbours, a multiple of four
    uint capacity;       // 24  entries of a list of leaves, a multiple of four
    uint root;           // 28  the first box of the highest level
    uint leaf_count;     // 32  boxes of points, which come first
    uint listed;         // 36  leaves of the batch that are looked at again, with a larger capacity; 0: all are
};

// Of one batch.
struct SmoothParams {    // 16 bytes
    uint first_slot;     //  0  of the batch
    uint point_count;    //  4  in the batch
    uint stride;         //  8  entries of a point in the list of neighbours
    uint round;          // 12  0: reaches are written; 1: sizes
};

// A trust ball that ends at a rim.
struct BallClip {        // 20 bytes
    uint slot;           //  0
    float trust;         //  4  its radius
    float shift[3];      //  8  from the point to its centre
};

struct ClipParams {      // 4 bytes
    uint count;          // 0
};

// Of one batch of spheres or discs.
struct ShapeParams {     // 20 bytes
    uint first_slot;     //  0  of this batch
    uint count;          //  4  in this batch
    uint object;         //  8
    uint bound_from;     // 12  slot that the buffers by slot are bound from
    uint has_normals;    // 16  1: normals are given; 0: of discs, planes were fitted
};

struct FitParams {       // 48 bytes
    uint first_slot;     //  0  of this batch
    uint point_count;    //  4  in this batch
    uint neighbors;      //  8  entries a point in the list of neighbours, a multiple of four
    uint polynomial;     // 12  FIT_FULL, FIT_INCOMPLETE or FIT_PLANE: the first kind tried
    float feature_size;  // 16  h for all points; 0: the distance to the last neighbour; -1: sizes
    float trust;         // 20  b / h
    uint object;         // 24
    uint first_listed;   // 28  slot whose neighbours come first in the list
    float weight_scale;  // 32  h over the width of the weights
    uint close_gaps;     // 36  1: b grows, at most to h, where neighbours leave a gap
    float rim_limit;     // 40  of the distance to the centroid, over the neighbours' reach; 0: no rims
    uint bound_from;     // 44  slot that the buffers by slot are bound from; points are bound as a whole
};

struct GridInfo {        // 32 bytes
    vec3 origin;         //  0  lowest corner
    float edge;          // 12  of a cell
    uvec3 resolution;    // 16  cells along x, y, z
    float inverse_edge;  // 28
};

// One of the grids of a scene.
struct GridLevel {       // 48 bytes
    GridInfo grid;       //  0
    uint first_cell;     // 32  in the cells of all grids
    uint first_offset;   // 36  in the offsets of the points of all grids' cells
    uint first_slot;     // 40  the lowest slot that it lists
    uint end_slot;       // 44  past the highest
};

// Of one slab: some layers of cells along z.
struct GridParams {      // 28 bytes
    uint point_count;    //  0
    uint pair_count;     //  4  of the slab
    float ball_scale;    //  8  radius listed over trust radius; 0: each point in its own cell alone
    uint first_layer;    // 12
    uint end_layer;      // 16  past the last
    uint first_pair;     // 20  pairs of the slabs and grids before; of order_balls: points of the parts before
    uint any_large;      // 24  1: balls may be large
};

struct ScanParams {      // 8 bytes
    uint count;          // 0
    uint has_base;       // 4  1: sums holds what comes before each run
};

struct SortParams {      // 16 bytes
    uint count;          //  0
    uint shift;          //  4  lowest bit of the digit
    uint runs;           //  8
    uint bits;           // 12  of the digit, DIGIT_BITS at most
};

struct CameraParams {    // 96 bytes
    vec3 eye;            //  0  centred scene space
    float scale;         // 12  half the view's height, over half the rows; perspective: at distance 1
    vec3 right;          // 16
    float half_width;    // 28  of the full image, pixels
    vec3 up;             // 32
    float half_height;   // 44  of the full image, pixels
    vec3 forward;        // 48
    uint sample_index;   // 60  of the pixel; NONE: there is one alone, through its centre
    uvec2 tile_origin;   // 64  in the full image, pixels
    uvec2 tile_size;     // 72
    uint projection;     // 80  PERSPECTIVE or ORTHOGRAPHIC
    float lens_radius;   // 84
    float focus;         // 88  distance of the plane in focus along the viewing axis
    uint seed;           // 92
};

struct TraceParams {     // 24 bytes
    uint ray_count;      //  0  of the wave, or of those that are listed
    uint cells;          //  4  K: how many cells a ray may cross in this pass
    uint work;           //  8  loop iterations a ray may spend in this pass
    uint any_hit;        // 12  1: any hit ends a ray
    uint listed;         // 16  1: rays are those of a list, and their state stays where it is
    uint passed;         // 20  object whose surface is not there, or NONE; with PASSED_NEAR
};

// Some nodes of one level of the tree.
struct TreeLevelParams { // 24 bytes
    uint first;          //  0  of these nodes
    uint count;          //  4  of these nodes
    uint first_of_level; //  8  of the whole level
    uint first_child;    // 12  the first node of the level below
    uint children;       // 16  nodes of the level below; of leaves, points
    uint first_bound;    // 20  the node that what is bound of all begins with
};

// Of shadow rays where light may pass surfaces. Of their paths, `channels` is the slot of the surface that a ray has
// met and goes through, or NONE; `bounces` 1 once it has ended; `depth` what is left of the way to the light.
struct ShadowParams {    // 48 bytes
    uint ray_count;      //  0
    uint passed;         //  4  object whose surface is not there, or NONE
    uint counts;         //  8  1: the work of rays is counted in the film
    uint lamp_count;     // 12  objects that the light may be inside; NONE: it is not known which
    uint lamp_media[MEDIA_WORDS]; // 16  those, 16 bits each
};

// Where the leaves of the tree are.
struct TreeInfo {        // 8 bytes
    uint first_leaf;     //  0  their first node, a power of eight
    uint gap;            //  4  so many nodes before it are not there, nor in memory
};

struct TreeTraceParams { // 32 bytes
    uint ray_count;      //  0  these as in TraceParams
    uint work;           //  4
    uint any_hit;        //  8
    uint listed;         // 12
    uint passed;         // 16
    uint starts;         // 20  1: rays are at the root
    TreeInfo tree;       // 24
};

// Distances between nearest and farthest, ranked by their bits.
struct DepthRanks {      // 16 bytes
    float nearest;       //  0  > 0
    float farthest;      //  4
    uint shift;          //  8  of a float's bits, so that the rank has few
    uint bits;           // 12  of a rank
};

struct DiscParams {      // 120 bytes
    CameraParams camera; //  0
    DepthRanks ranks;    // 96
    uint point_count;    // 112
    uint pair_count;     // 116
};

struct DiscTraceParams { // 28 bytes
    DepthRanks ranks;    //  0
    uvec2 tile_size;     // 16
    uint work;           // 24  loop iterations a ray may spend in this pass
};

// What rays that hit nothing see.
struct BackgroundInfo {  // 16 bytes
    vec3 color;          //  0
    uint environment;    // 12  an image, or NONE: color counts
};

struct CameraTraceParams { // 128 bytes
    vec3 eye;            //  0  these as in CameraParams
    float scale;         // 12
    vec3 right;          // 16
    float half_width;    // 28
    vec3 up;             // 32
    float half_height;   // 44
    vec3 forward;        // 48
    uint work;           // 60  loop iterations a ray may spend
    uvec2 tile_origin;   // 64  in the full image, pixels
    uvec2 tile_size;     // 72
    BackgroundInfo background; // 80
    DepthRanks ranks;    // 96
    uint transparent;    // 112 TRANSPARENT_*, or 0: nothing leaves the background out
    uint max_bounces;    // 116
    TreeInfo tree;       // 120 with TREE; else ranks counts
};

// Where light is asked for.
struct LitHit {          // 32 bytes
    vec3 position;       //  0  centred scene space
    uint slot;           // 12  the point hit
    vec3 normal;         // 16  unit, facing the ray's origin
    uint pad;            // 28
};

struct MarkParams {      // 12 bytes
    uint words;          // 0  of 32 marks each
    uint pairs;          // 4  1: a word is followed by one whose marks count twice
    uint listed;         // 8  1: marks are of the rays of a list
};

// Of the kernels that scatter and shade the rays of a wave.
struct WaveParams {      // 80 bytes
    vec3 forward;        //  0  viewing axis
    uint ray_count;      // 12  of the wave; of shadow_rays and shade: hits on diffuse surfaces
    BackgroundInfo background; // 16
    uvec2 tile_origin;   // 32  in the full image, pixels
    uvec2 tile_size;     // 40
    uint flags;          // 48  WAVE_*
    uint max_bounces;    // 52
    uint fresnel;        // 56  1: glass reflects or refracts at random, 0: it refracts
    uint seed;           // 60
    uint light;          // 64  the one that shadow rays go to now
    uint light_count;    // 68
    uint sample_index;   // 72  of the pixel; NONE: there is one alone, and lights have no extent
    uint transparent;    // 76  TRANSPARENT_*, or 0: nothing leaves the background out
};

// An image whose texels lie in rows, the top row first. After that of an environment come three whose first three
// words are the bits of a row of the matrix that turns it.
struct ImageInfo {       // 16 bytes
    uint first;          //  0  word of its first texel in texels
    uint width;          //  4
    uint height;         //  8
    uint format;         // 12  IMAGE_*
};

struct ObjectInfo {      // 112 bytes
    vec3 albedo;         //  0  of a mirror: the share reflected
    uint first_color;    // 12  in colors: three floats a point, with a texture two; NONE: none
    uint first_slot;     // 16
    uint polynomial;     // 20  FIT_FULL or FIT_INCOMPLETE: what refinement fits first
    uint max_iterations; // 24  of the refinement; 0: hits are taken as they are
    float tolerance;     // 28  of the refinement, over h
    uint slot_count;     // 32  that carry its surface; behind these its spheres and discs
    float weight_scale;  // 36  h over the width of the weights
    uint blends;         // 40  1: normals are blended over the polynomials around a hit
    uint texture;        // 44  an image, or NONE
    vec4 texture_u;      // 48  column over width at x is dot(xyz, x) + w, where first_color is NONE
    vec4 texture_v;      // 64  row over height
    vec3 ior;            // 80  of glass, by channel
    uint material;       // 92  MATERIAL_*
    vec3 absorption;     // 96  of glass, per unit of length
    int priority;        // 108 of glass, among overlapping media
};

struct Light {           // 32 bytes
    vec3 vector;         //  0  unit, towards a directional light; a point light's position
    uint kind;           // 12  LIGHT_*
    vec3 strength;       // 16  irradiance, or intensity
    float extent;        // 28  sine of half its angle, or radius; 0: hard
};

struct Hit {             // 32 bytes
    vec3 position;       //  0  centred scene space
    float t;             // 12
    vec3 normal;         // 16  unit, facing the ray's origin
    uint status;         // 28  HIT_*, and counts of iterations
};

// What a ray has behind it.
struct Path {            // 80 bytes
    vec3 throughput;     //  0  what of the light it finds arrives at the pixel
    uint pixel;          // 12  of the tile, row by row; NONE: no ray at all
    uint channels;       // 16  bits of CHANNELS_ALL, and PATH_REFLECTED
    uint bounces;        // 20  interactions with surfaces so far
    uint crossings;      // 24  surfaces passed through so far
    uint media_count;    // 28  objects that it is inside
    uint media[MEDIA_WORDS]; // 32  those, 16 bits each, in no order
    vec3 emitted;        // 64  what volumes on its way have sent to the pixel
    float depth;         // 76  optical, of volumes on its way so far; no part of the throughput
};

// A field between points (section 6 of the paper).
struct VolumeInfo {      // 96 bytes
    GridInfo grid;       //  0  over the points' bounding box grown by the radius, and up to a cell more
    uint first_cell;     // 32  in the cells of all volumes
    uint first_stop;     // 36  in the stops of all volumes
    uint stop_count;     // 40
    uint kernel;         // 44  VOLUME_*
    float square_radius; // 48  of a point's reach
    float inverse_width; // 52  1 / 2 rho
    uint object;         // 56
    uint bounded;        // 60  1: it counts inside the object's surface alone
    vec3 high;           // 64  of the box, whose lowest corner is the grid's
    uint mode;           // 76  VOLUME_EMISSION and so on; maximum, average, integral: the scene's only volume
    float iso;           // 80  scalar on an isosurface
    uint slot;           // 84  of the polynomial that stands for an isosurface, behind those of all points; of other
                         //     modes, 1 where anything has an emission
    uint refracts;       // 88  1: an isosurface of glass, which rays are inside or outside of
    uint shading;        // 92  VOLUME_EMITS and so on
};

struct VolumeCell {      // 8 bytes
    uint first;          //  0  point in the points of all volumes; the next cell's is the end
    uint counts;         //  4  CELL_*
};

struct VolumePoint {     // 16 bytes
    vec3 position;       //  0  centred scene space
    float scalar;        // 12  of a particle, A (m / rho) / (pi h^3)
};

// Of a transfer function, ascending in value. Integrals are those from the first stop to this one, each of them the sum
// of two numbers.
struct VolumeStop {      // 96 bytes
    vec3 color;          //  0
    float extinction;    // 12
    float value;         // 16
    float emission[3];   // 20  radiance per length
    vec4 scattering_integral; // 32  of colour by extinction, and of extinction
    vec4 scattering_rest; // 48
    vec4 emission_integral; // 64
    vec4 emission_rest;  // 80
};

// How far a ray has marched through volumes. Sums over its way are of two numbers: what rounding added is taken from
// the next term.
struct March {           // 80 bytes
    vec3 color;          //  0  emitted towards its start so far; of other modes than emission, the greatest
                         //     scalar or the integral of all, the length in reach, and whether any was found
    float depth;         // 12  optical depth
    vec3 color_lost;     // 16
    float depth_lost;    // 28
    vec3 step_color;     // 32  of this step, of the volumes so far: what it sends per length
    float step_extinction; // 44
    float numerator;     // 48  of this volume's scalar
    float denominator;   // 52
    uint state;          // 56  0: not begun, 1: on its way, 2: done, 3: once more, for `along`
    uint place;          // 60  end of a step
    uint volume;         // 64
    uint row;            // 68  of cells around the place
    uint cursor;         // 72  points of the row that are done
    float along;         // 76  for the channels of volumes: the depth along the viewing axis where half of what is
                         //     lost is lost, or below 0; of other modes than emission, the scalar that is shown
};

// What a sample of a lit volume needs beside its scalar, so far.
struct MarchLight {      // 48 bytes
    vec3 pull;           //  0  sum of the weights' gradients, by the scalars
    uint pad;            // 12
    vec3 weights_pull;   // 16  sum of the weights' gradients
    uint pad_end;        // 28
    vec4 visible;        // 32  of each light, by the weights
};

// How far a ray has looked for isosurfaces.
struct IsoSearch {       // 80 bytes
    vec3 pull;           //  0  as in MarchLight, at this place
    float numerator;     // 12  of the scalar here
    vec3 weights_pull;   // 16
    float denominator;   // 28
    float low;           // 32  along the ray: the last place on the side that it comes from
    float high;          // 36  the first known beyond the surface
    float value_low;     // 40  scalar less iso there; 0: not known
    float value_high;    // 44
    float here;          // 48  the next place between them
    uint state;          // 52  ISO_*
    uint place;          // 56  sample, or turn
    uint volume;         // 60
    uint row;            // 64  of cells around the place
    uint cursor;         // 68  points of the row that are done
    uint side;           // 72  of `low`: 0 not known, 1 below, 2 above
    uint looked;         // 76  whether it was looked at, or is known from its cell; then which end moved
};

struct MarchParams {     // 48 bytes
    vec3 forward;        //  0  viewing axis
    uint ray_count;      // 12
    uint volume_count;   // 16
    float step;          // 20
    uint work;           // 24  loop iterations a ray may spend in this pass
    uint light_count;    // 28  of march_lit
    uint wants_depth;    // 32  1: `along` is asked for
    uint pad[3];         // 36
};

// Of the kernels that light a volume's points.
struct PointLightParams { // 16 bytes
    uint first;          //  0  point in the points of all volumes
    uint count;          //  4
    uint light;          //  8
    uint volume;         // 12
};

// A ray as it travels in a queue.
struct StateRay {        // 64 bytes
    uvec4 position;      //  0  origin, nearest hit so far
    uvec4 direction;     // 16  direction, cells crossed
    uvec4 cell;          // 32  cell, cursor, tests, slot of the hit
    uvec4 start;         // 48  the point that it left, hits to pass over, the cell where it came into this grid
};

// At a diffuse hit.
struct LightSum {        // 32 bytes
    vec3 sum;            //  0  irradiance by the lights before the last, each by its cosine
    uint pad;            // 12
    vec3 arriving;       // 16  what the last would add, were nothing in the way
    uint pad_end;        // 28
};

struct FilmPixel {       // 80 bytes
    vec4 color;          //  0  radiance and coverage
    vec4 position_depth; // 16  centred scene space; distance along the viewing axis
    vec4 normal_object;  // 32  facing the viewer; object, or -1
    uvec4 counts;        // 48  tests, cells, slot of the hit or NONE, iterations
    vec3 alpha;          // 64  1 less what the channel lets through of the background
    float along;         // 76  as in March
};

// A pixel's samples so far: sums of colours, alphas and of the first two counts; all else is the first's.
struct FilmSum {         // 112 bytes
    FilmPixel pixel;     //  0
    vec4 lost;           // 80  what rounding added to the colours' sums
    vec3 lost_alpha;     // 96
    uint pad;            // 108
};

struct AccumulateParams { // 16 bytes
    uvec2 tile_size;     //  0
    uint sample_index;   //  8  of the samples in film
    uint samples;        // 12  in all
};
#endif
