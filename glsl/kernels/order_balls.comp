// order_balls: the trust balls in the order that the grid lists them in, so that they are read in a row from then on.
//
// reads   polynomials
//         order            slots in the order of (object, index)
// writes  balls            of a part: centre and radius
// runs    one invocation per point of the part
// twin    none: it copies what polynomials have
//
// Files may hold points in any order: each read may be a line of its own from memory. Here nothing else waits for it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/grid.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = GRID_ORDER) readonly buffer Order { uint order[]; };
layout(std430, binding = GRID_BALLS) writeonly buffer Balls { uvec4 balls[]; };
layout(push_constant) uniform Push { GridParams params; };

void main() {
    uint i = list_index();
    if (i >= params.point_count) return;
    balls[i] = floatBitsToUint(polynomial_center_trust_at(order[params.first_pair + i]));
}
