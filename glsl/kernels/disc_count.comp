// disc_count: how many screen tiles the discs of each leaf's points cover (section 4 of the paper).
//
// reads   polynomials
// writes  offsets          one count a leaf; a scan turns them into offsets
// runs    one invocation per leaf
// twin    none: pairs of tile and leaf are one list, which crates/reference/src/disc_bin.rs makes at once
//
// A leaf is eight consecutive slots: neighbours in memory, and mostly on the screen.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/search.glsl"
#include "stages/discs.glsl"
#include "disc.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = DISC_OFFSETS) writeonly buffer Offsets { uint offsets[]; };
layout(push_constant) uniform Push { DiscParams params; };

void main() {
    uint leaf = list_index();
    if (leaf * LEAF_POINTS >= params.point_count) return;
    LeafDiscs discs = discs_of_leaf(params, leaf);
    uint count = discs.around.extent.x * discs.around.extent.y;
    uint covered = 0u;
    uvec2 tile = discs.around.low;
    for (uint i = 0u; i < count; ++i) {
        covered += covering(discs, tile) != 0u ? 1u : 0u;
        tile = tile_after(tile, discs.around);
    }
    offsets[leaf] = covered;
}
