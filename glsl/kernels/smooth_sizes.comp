// smooth_sizes: the feature size of each point of a batch as a mean over its neighbours (method, section 1).
//
// reads   points
//         lists            neighbours of the batch's points; NONE fills up
//         reaches          of all points of the object, in the second round
// writes  reaches          in the first round: the distance to the last neighbour
//         sizes            in the second: the mean of a point's own reach and its neighbours'
// runs    one invocation per point of the batch
// twin    crates/reference/src/lib.rs, smooth_sizes
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "math.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = NEIGHBORS) readonly buffer Lists { uint lists[]; };
layout(std430, binding = REACHES) buffer Reaches { float reaches[]; };
layout(std430, binding = SIZES) writeonly buffer Sizes { float sizes[]; };
layout(push_constant) uniform Push { SmoothParams params; };

void main() {
    uint i = list_index();
    if (i >= params.point_count) return;
    uint slot = params.first_slot + i;
    uint list = i * params.stride;
    uint count = 0u;
    float sum = params.round > 0u ? reaches[slot] : 0.0;
    uint last = slot;
    while (count < params.stride && lists[list + min(count, params.stride - 1u)] != NONE) {
        last = lists[list + count];
        sum += params.round > 0u ? reaches[last] : 0.0;
        ++count;
    }
    vec3 way = point_position_at(last) - point_position_at(slot);
    if (params.round > 0u)
        sizes[slot] = sum / float(count + 1u);
    else
        reaches[slot] = sqrt(dot3(way, way));
}
