// grid_emit: one (cell, slot) pair for each cell of a slab that a point's trust ball meets; not for large balls.
//
// reads   grid, balls, order
//         offsets          first pair of each point, in the order of (object, index)
// writes  keys             the cell's place in the slab
//         slots            the point
// runs    one invocation per point
// twin    none: what it is a step of has one result, which crates/reference/src/grid_build.rs makes at once
//
// Pairs come out in the order of the points; the sort that follows is stable.
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
layout(push_constant) uniform Push { GridParams params; };

void main() {
    uint ordinal = list_index();
    if (ordinal >= params.point_count) return;
    uint slot = order[ordinal];
    vec4 ball = ball_at(ordinal);
    float radius = ball.w * params.ball_scale;
    CellBox box = cells_of_slab(grid, params, ball);
    uint end = box.count > SMALL_BALL ? 0u : box.count;
    uint pair = offsets[ordinal];
    uint nth = 0u;
    uvec3 cell = box.low;
    while (nth < end) {
        if (meets(grid, cell, ball.xyz, radius)) {
            keys[pair] = cell_in_slab(grid, params, cell);
            slots[pair] = slot;
            ++pair;
        }
        cell = next_in_box(box, cell);
        ++nth;
    }
}
