// grid_emit: one (cell, slot) pair for each cell around each point's trust ball.
//
// reads   grid, polynomials, order
//         offsets          first pair of each point, in the order of (object, index)
// writes  keys             the cell, or the number of cells where the ball does not meet it
//         slots            the point
// runs    one invocation per pair, so that one huge ball is no long loop
// twin    crates/reference/src/grid_build.rs
//
// Pairs come out in the order of the points; the sort that follows is stable and takes the pairs
// that meet no cell to the end.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "layout.glsl"
#include "grid.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = GRID_INFO) readonly buffer Info { GridInfo grid; };
layout(std430, binding = GRID_POLYNOMIALS) readonly buffer Polynomials { Polynomial polynomials[]; };
layout(std430, binding = GRID_ORDER) readonly buffer Order { uint order[]; };
layout(std430, binding = GRID_OFFSETS) readonly buffer Offsets { uint offsets[]; };
layout(std430, binding = GRID_KEYS) writeonly buffer Keys { uint keys[]; };
layout(std430, binding = GRID_SLOTS) writeonly buffer Slots { uint slots[]; };
layout(push_constant) uniform Push { GridParams params; };

void main() {
    uint pair = list_index();
    if (pair >= params.pair_count) return;
    uint low_ordinal = 0u; // the last point whose first pair is not behind this one
    uint high_ordinal = params.point_count;
    while (high_ordinal - low_ordinal > 1u) {
        uint middle = (low_ordinal + high_ordinal) / 2u;
        bool before = offsets[middle] <= pair;
        low_ordinal = before ? middle : low_ordinal;
        high_ordinal = before ? high_ordinal : middle;
    }
    uint slot = order[low_ordinal];
    vec4 ball = polynomials[slot].center_trust;
    float radius = ball.w * params.ball_scale;
    uvec3 low, high;
    cells_around(grid, ball.xyz, radius, low, high);
    uvec3 extent = high - low + 1u;
    uint nth = pair - offsets[low_ordinal];
    uint row = nth / extent.x;
    uvec3 cell = low + uvec3(nth % extent.x, row % extent.y, row / extent.y);
    uint cell_count = grid.resolution.x * grid.resolution.y * grid.resolution.z;
    bool listed = radius == 0.0 || ball_meets_cell(grid, cell, ball.xyz, radius);
    keys[pair] = listed ? cell_id(grid, cell) : cell_count;
    slots[pair] = slot;
}
