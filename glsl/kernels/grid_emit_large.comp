// grid_emit_large: the pairs of large balls.
//
// reads   grid, balls, order
//         offsets          first pair of each point, in the order of (object, index)
//         large_offsets    the same, were there only large balls
// writes  keys             the cell's place in the slab, or the number of its cells where the ball does not
//                          meet it: the sort takes such pairs to the end
//         slots            the point
// runs    one invocation per cell around a large ball, so that a huge one is no long loop
// twin    none: what it is a step of has one result, which crates/reference/src/grid_build.rs makes at once
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/grid.glsl"
#include "slab.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = GRID_INFO) readonly buffer Info { GridInfo grid; };
layout(std430, binding = GRID_ORDER) readonly buffer Order { uint order[]; };
layout(std430, binding = GRID_OFFSETS) readonly buffer Offsets { uint offsets[]; };
layout(std430, binding = GRID_KEYS) writeonly buffer Keys { uint keys[]; };
layout(std430, binding = GRID_SLOTS) writeonly buffer Slots { uint slots[]; };
layout(std430, binding = GRID_LARGE) readonly buffer LargeOffsets { uint large_offsets[]; };
layout(push_constant) uniform Push { GridParams params; };

void main() {
    uint i = list_index();
    if (i >= params.pair_count) return;
    uint low = 0u; // the last point whose first pair is not behind this one
    uint high = params.point_count;
    while (high - low > 1u) {
        uint middle = (low + high) / 2u;
        bool before = large_offsets[middle] <= i;
        low = before ? middle : low;
        high = before ? high : middle;
    }
    uint slot = order[low];
    vec4 ball = ball_at(low);
    CellBox box = cells_of_slab(grid, params, ball);
    uint nth = i - large_offsets[low];
    uvec3 cell = cell_of_box(box, nth);
    bool listed = meets(grid, cell, ball.xyz, ball.w * params.ball_scale);
    uint pair = offsets[low] + nth;
    keys[pair] = listed ? cell_in_slab(grid, params, cell) : cells_in_slab(grid, params);
    slots[pair] = slot;
}
