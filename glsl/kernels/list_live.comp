// list_live: the rays of a wave that have not ended, one after another.
//
// reads   live_offsets     of those rays in the list, and one behind the last
// writes  live_rays        the rays
// runs    one invocation per ray of the wave
// twin    none: the CPU follows each ray to its end
#version 460
#extension GL_GOOGLE_include_directive : require
#include "layout.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = LIVE_OFFSETS) readonly buffer Offsets { uint live_offsets[]; };
layout(std430, binding = LIVE_RAYS) writeonly buffer LiveRays { uint live_rays[]; };
layout(push_constant) uniform Push { TraceParams params; };

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    if (live_offsets[at] < live_offsets[at + 1u]) live_rays[live_offsets[at]] = at;
}
