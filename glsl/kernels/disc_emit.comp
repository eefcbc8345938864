// disc_emit: one (key, leaf) pair for each screen tile that the discs of each leaf's points cover.
//
// reads   polynomials
//         offsets          first pair of each leaf
// writes  keys             the screen tile, and below it the rank of the leaf's nearest distance
//         leaves           the leaf, and which of its points cover the screen tile
// runs    one invocation per leaf; its discs cover the 16 384 screen tiles of a tile at most
// twin    none: pairs of tile and leaf are one list, which crates/reference/src/disc_bin.rs makes at once
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/search.glsl"
#include "stages/discs.glsl"
#include "disc.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = DISC_KEYS) writeonly buffer Keys { uint keys[]; };
layout(std430, binding = DISC_LEAVES) writeonly buffer Leaves { uint leaves[]; };
layout(push_constant) uniform Push { DiscParams params; };

void main() {
    uint leaf = list_index();
    if (leaf * LEAF_POINTS >= params.point_count) return;
    LeafDiscs discs = discs_of_leaf(params, leaf);
    uint rank = depth_rank(params.ranks, discs.nearest);
    uint across = screen_tiles(params.camera.tile_size).x;
    uint count = discs.around.extent.x * discs.around.extent.y;
    uint to = disc_offset_at(leaf);
    uvec2 tile = discs.around.low;
    for (uint i = 0u; i < count; ++i) {
        uint points = covering(discs, tile);
        if (points != 0u) {
            keys[to] = ((tile.y * across + tile.x) << params.ranks.bits) | rank;
            leaves[to] = leaf | (points << LEAF_BITS);
            ++to;
        }
        tile = tile_after(tile, discs.around);
    }
}
