// grid: the grid: scan, sort, cells, and the lists that rays and hits read.
//
// Made from crates/kernels/src/layout/grid.rs by compile-kernels: change that.
#ifndef STAGE_GRID_GLSL
#define STAGE_GRID_GLSL

#define RUN_LENGTH 256 // Entries that one invocation of the scan and sort kernels walks
#define DIGIT_BITS 8 // Bits of a key sorted in one round
#define MOST_SKIPPED 4 // The greatest distance, in cells, from an empty cell to the next occupied one that is recorded; greater ones count as this
#define SCAN_LIMIT 0x7fffffffu // Where sums stop instead of wrapping
#define MOST_LEVELS 16 // Grids of a scene, at most

// The uniform grid's place and size.
struct GridInfo { // 32 bytes
    vec3 origin;                     //   0 Lowest corner, centred scene space.
    float edge;                      //  12 Of a cell.
    uvec3 resolution;                //  16 Cells along x, y, z.
    float inverse_edge;              //  28 1 / edge.
};

// One of the grids of a scene, which share buffers.
struct GridLevel { // 48 bytes
    GridInfo grid;                   //   0 Where it lies.
    uint first_cell;                 //  32 In the cells of all grids.
    uint first_offset;               //  36 In the offsets of the points of all grids' cells.
    uint first_slot;                 //  40 The lowest slot that it lists.
    uint end_slot;                   //  44 Past the highest.
};

// A point in the list of its cell.
struct ListedPoint { // 16 bytes
    vec3 position;                   //   0 Centred scene space.
    uint slot;                       //  12 Its slot.
};

#ifdef TEXELS
ListedPoint listed_point_from(usamplerBuffer texels, int first) {
    uvec4 t0 = texelFetch(texels, first + 0);
    return ListedPoint(uintBitsToFloat(t0.xyz), t0.w);
}
#endif

// Push constants of the grid build.
struct GridParams { // 28 bytes
    uint point_count;                //   0 Points of the scene.
    uint pair_count;                 //   4 Pairs of a cell of the slab and a point near it.
    float ball_scale;                //   8 Radius listed over trust radius; 0: each point only in its own cell.
    uint first_layer;                //  12 First layer of cells along z of the slab.
    uint end_layer;                  //  16 Past the last.
    uint first_pair;                 //  20 Pairs of the slabs before; of order_balls, points of the parts before.
    uint any_large;                  //  24 1 where balls may be large.
};

// Push constants of the scan.
struct ScanParams { // 8 bytes
    uint count;                      //   0 Values.
    uint has_base;                   //   4 1 where the sums hold what comes before each run.
};

// Push constants of the sort.
struct SortParams { // 16 bytes
    uint count;                      //   0 Keys.
    uint shift;                      //   4 Lowest bit of the digit.
    uint runs;                       //   8 Runs of RUN_LENGTH keys.
    uint bits;                       //  12 Bits of the digit, DIGIT_BITS at most.
};

#define GRID_INFO 16 // The grid that is built

#define GRID_ORDER 17 // Slots by ordinal

#define GRID_OFFSETS 18 // Counts, then offsets, by ordinal

#define GRID_KEYS 19 // The cell of each pair, ascending once they are sorted

#define GRID_SLOTS 20 // The slot of each pair

#define GRID_LARGE 21 // Counts, then offsets, of large balls only, by ordinal

#define GRID_BALLS 22 // Trust balls in the order of (object, index): centre and radius
#ifdef TEXELS
layout(binding = GRID_BALLS) uniform usamplerBuffer ball_texels;

vec4 ball_at(uint at) {
    return uintBitsToFloat(texelFetch(ball_texels, int(at)).xyzw);
}
#else
layout(std430, binding = GRID_BALLS) readonly buffer BallList { vec4 ball_list[]; };

vec4 ball_at(uint at) {
    return ball_list[at];
}
#endif

#define SKIP_MARKS_IN 23 // Cells that are marked, 32 of a row a word

#define SKIP_MARKS_OUT 24 // Those that are marked next

#define SKIP_OCCUPIED 25 // Cells with points

#define SKIP_BESIDE 26 // Those at most one cell from these

#define SKIP_NEAR 27 // At most two

#define SKIP_FAR 28 // At most three

#define SCAN_VALUES 29 // Turned into prefix sums in place

#define SCAN_SUMS 30 // Sums of runs, or what comes before each

#define SORT_KEYS_IN 31 // Keys to sort

#define SORT_SLOTS_IN 32 // What travels with them

#define SORT_HISTOGRAM 33 // [digit][run]

#define SORT_KEYS_OUT 34 // Sorted keys

#define SORT_SLOTS_OUT 35 // What travelled with them

#define CELL_OFFSETS 36 // First entry of each cell among the listed points

#define LISTED_POINTS 37 // Points, cell after cell
#ifdef TEXELS
layout(binding = LISTED_POINTS) uniform usamplerBuffer listed_point_texels;

ListedPoint listed_point_at(uint at) {
    return listed_point_from(listed_point_texels, int(at));
}

vec3 listed_point_position_at(uint at) {
    return uintBitsToFloat(texelFetch(listed_point_texels, int(at)).xyz);
}

uint listed_point_slot_at(uint at) {
    return texelFetch(listed_point_texels, int(at)).w;
}
#else
layout(std430, binding = LISTED_POINTS) readonly buffer ListedPointList { ListedPoint listed_point_list[]; };

ListedPoint listed_point_at(uint at) {
    return listed_point_list[at];
}

vec3 listed_point_position_at(uint at) {
    return listed_point_list[at].position;
}

uint listed_point_slot_at(uint at) {
    return listed_point_list[at].slot;
}
#endif

#define LEVELS 38 // The grids of the scene

#define CELLS 39 // First and past-the-last entry of each cell in SLOTS
#ifdef TEXELS
layout(binding = CELLS) uniform usamplerBuffer range_texels;

uvec2 range_at(uint at) {
    return texelFetch(range_texels, int(at)).xy;
}
#else
layout(std430, binding = CELLS) readonly buffer RangeList { uvec2 range_list[]; };

uvec2 range_at(uint at) {
    return range_list[at];
}
#endif

#define SLOTS 40 // The points of each cell, with room for four after the last
#ifdef TEXELS
layout(binding = SLOTS) uniform usamplerBuffer slot_texels;

uint slot_at(uint at) {
    return texelFetch(slot_texels, int(at / 4u))[at & 3u];
}

// The four of which that is one, from a multiple of four on.
uvec4 slot_four_at(uint at) {
    return texelFetch(slot_texels, int(at / 4u));
}
#else
layout(std430, binding = SLOTS) readonly buffer SlotList { uint slot_list[]; };

uint slot_at(uint at) {
    return slot_list[at];
}

uvec4 slot_four_at(uint at) {
    uint first = at & ~3u;
    return uvec4(slot_list[first], slot_list[first + 1u], slot_list[first + 2u], slot_list[first + 3u]);
}
#endif
#endif
