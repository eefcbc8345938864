// mark_live: which rays of a wave have not ended.
//
// reads   the ray state
// writes  live_offsets     1 for a ray that lives
// runs    one invocation per ray of the wave
// twin    none: the CPU follows each ray to its end
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#include "layout.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = LIVE_OFFSETS) writeonly buffer Offsets { uint live_offsets[]; };
layout(push_constant) uniform Push { TraceParams params; };

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    live_offsets[at] = load_ray(at).cell != NONE ? 1u : 0u;
}
