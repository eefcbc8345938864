// disc_ranges: where each screen tile's points begin and end in the sorted list of pairs.
//
// reads   keys             ascending
// writes  tiles            first and past-the-last pair; empty tiles keep the zeros they hold
// runs    one invocation per pair
// twin    none: pairs of tile and leaf are one list, which crates/reference/src/disc_bin.rs makes at once
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/discs.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = DISC_KEYS) readonly buffer Keys { uint keys[]; };
layout(std430, binding = DISC_TILES) writeonly buffer Tiles { uvec2 tiles[]; };
layout(push_constant) uniform Push { DiscParams params; };

void main() {
    uint pair = list_index();
    if (pair >= params.pair_count) return;
    uint bits = params.ranks.bits;
    uint tile = keys[pair] >> bits;
    uint end = params.pair_count - 1u;
    bool first = pair == 0u || keys[max(pair, 1u) - 1u] >> bits != tile;
    bool last = pair == end || keys[min(pair + 1u, end)] >> bits != tile;
    if (first) tiles[tile].x = pair;
    if (last) tiles[tile].y = pair + 1u;
}
