// grid_count: how many cells of a slab of the grid each point's trust ball meets.
//
// reads   grid
//         balls            in the order of (object, index)
// writes  offsets          one count a point, in that order; a scan turns them into offsets
//         large_offsets    the same of large balls alone, where params.any_large; theirs are cells around the
//                          ball, before the exact test
// runs    one invocation per point
// twin    none: what it is a step of has one result, which crates/reference/src/grid_build.rs makes at once
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/grid.glsl"
#include "slab.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = GRID_INFO) readonly buffer Info { GridInfo grid; };
layout(std430, binding = GRID_OFFSETS) writeonly buffer Offsets { uint offsets[]; };
layout(std430, binding = GRID_LARGE) writeonly buffer LargeOffsets { uint large_offsets[]; };
layout(push_constant) uniform Push { GridParams params; };

void main() {
    uint ordinal = list_index();
    if (ordinal >= params.point_count) return;
    vec4 ball = ball_at(ordinal);
    float radius = ball.w * params.ball_scale;
    CellBox box = cells_of_slab(grid, params, ball);
    bool is_large = box.count > SMALL_BALL;
    uint count = is_large ? box.count : 0u;
    uint nth = is_large ? box.count : 0u;
    uvec3 cell = box.low;
    while (nth < box.count) {
        count += meets(grid, cell, ball.xyz, radius) ? 1u : 0u;
        cell = next_in_box(box, cell);
        ++nth;
    }
    offsets[ordinal] = count;
    if (params.any_large != 0u) large_offsets[ordinal] = is_large ? count : 0u;
}
