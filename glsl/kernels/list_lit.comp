// list_lit: the rays of a wave that hit a diffuse surface, one after another.
//
// reads   lit              offsets of those rays in the list, and one behind the last
// writes  lit_rays         the rays
// runs    one invocation per ray of the wave
// twin    none: the CPU goes on with each ray at once
#version 460
#extension GL_GOOGLE_include_directive : require
#include "layout.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = WAVE_LIT) readonly buffer Lit { uint lit[]; };
layout(std430, binding = WAVE_LIT_RAYS) writeonly buffer LitRays { uint lit_rays[]; };
layout(push_constant) uniform Push { WaveParams params; };

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    if (lit[at] < lit[at + 1u]) lit_rays[lit[at]] = at;
}
