// discs: the leaves that cover each screen tile.
//
// Made from crates/kernels/src/layout/discs.rs by compile-kernels: change that.
#ifndef STAGE_DISCS_GLSL
#define STAGE_DISCS_GLSL
#include "stages/rays.glsl"

#define DISC_TILE 8 // Pixels that a screen tile has along each side

// Distances between nearest and farthest, ranked by their bits.
struct DepthRanks { // 16 bytes
    float nearest;                   //   0 Greater than zero; what is nearer has the same rank.
    float farthest;                  //   4 What is farther has the same rank.
    uint shift;                      //   8 Of a float's bits, so that the rank has few.
    uint bits;                       //  12 Bits of a rank.
};

// Push constants of disc_count, disc_emit and disc_ranges.
struct DiscParams { // 120 bytes
    CameraParams camera;             //   0 The camera, and the tile of the picture.
    DepthRanks ranks;                //  96 How pairs of a screen tile are ordered.
    uint point_count;                // 112 Points of the scene.
    uint pair_count;                 // 116 Pairs of a screen tile and a leaf with points whose discs cover it.
};

// Push constants of disc_trace.
struct DiscTraceParams { // 40 bytes
    TraceParams wave;                //   0 Of any structure.
    DepthRanks ranks;                //  24 How pairs of a screen tile are ordered.
};

#define DISC_OFFSETS 43 // Counts, then offsets, by leaf
#ifdef TEXELS
layout(binding = DISC_OFFSETS) uniform usamplerBuffer disc_offset_texels;

uint disc_offset_at(uint at) {
    return texelFetch(disc_offset_texels, int(at)).x;
}
#else
layout(std430, binding = DISC_OFFSETS) readonly buffer DiscOffsetList { uint disc_offset_list[]; };

uint disc_offset_at(uint at) {
    return disc_offset_list[at];
}
#endif

#define DISC_KEYS 44 // Screen tile and rank of each pair, front to back within a tile once they are sorted
#ifdef TEXELS
layout(binding = DISC_KEYS) uniform usamplerBuffer disc_key_texels;

uint disc_key_at(uint at) {
    return texelFetch(disc_key_texels, int(at)).x;
}
#else
layout(std430, binding = DISC_KEYS) readonly buffer DiscKeyList { uint disc_key_list[]; };

uint disc_key_at(uint at) {
    return disc_key_list[at];
}
#endif

#define DISC_LEAVES 45 // The leaf of each pair, and which of its points cover the tile; with room for four after the last
#ifdef TEXELS
layout(binding = DISC_LEAVES) uniform usamplerBuffer disc_leaf_texels;

uint disc_leaf_at(uint at) {
    return texelFetch(disc_leaf_texels, int(at / 4u))[at & 3u];
}

// The four of which that is one, from a multiple of four on.
uvec4 disc_leaf_four_at(uint at) {
    return texelFetch(disc_leaf_texels, int(at / 4u));
}
#else
layout(std430, binding = DISC_LEAVES) readonly buffer DiscLeafList { uint disc_leaf_list[]; };

uint disc_leaf_at(uint at) {
    return disc_leaf_list[at];
}

uvec4 disc_leaf_four_at(uint at) {
    uint first = at & ~3u;
    return uvec4(disc_leaf_list[first], disc_leaf_list[first + 1u], disc_leaf_list[first + 2u], disc_leaf_list[first + 3u]);
}
#endif

#define DISC_TILES 46 // First and past-the-last pair of each screen tile
#ifdef TEXELS
layout(binding = DISC_TILES) uniform usamplerBuffer disc_range_texels;

uvec2 disc_range_at(uint at) {
    return texelFetch(disc_range_texels, int(at)).xy;
}
#else
layout(std430, binding = DISC_TILES) readonly buffer DiscRangeList { uvec2 disc_range_list[]; };

uvec2 disc_range_at(uint at) {
    return disc_range_list[at];
}
#endif
#endif
