// grid_count: how many cells lie around each point's trust ball, before the exact test.
//
// reads   grid, polynomials
//         order            slots in the order of (object, index)
// writes  offsets          one count a point, in that order; a scan turns them into offsets
// runs    one invocation per point
// twin    crates/reference/src/grid_build.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#include "layout.glsl"
#include "grid.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = GRID_INFO) readonly buffer Info { GridInfo grid; };
layout(std430, binding = GRID_POLYNOMIALS) readonly buffer Polynomials { Polynomial polynomials[]; };
layout(std430, binding = GRID_ORDER) readonly buffer Order { uint order[]; };
layout(std430, binding = GRID_OFFSETS) writeonly buffer Offsets { uint offsets[]; };
layout(push_constant) uniform Push { GridParams params; };

void main() {
    uint ordinal = list_index();
    if (ordinal >= params.point_count) return;
    vec4 ball = polynomials[order[ordinal]].center_trust;
    uvec3 low, high;
    cells_around(grid, ball.xyz, ball.w * params.ball_scale, low, high);
    uvec3 extent = high - low + 1u;
    offsets[ordinal] = ball.w > 0.0 ? extent.x * extent.y * extent.z : 0u;
}
