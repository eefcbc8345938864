// disc_count: how many screen tiles the disc of each point covers (section 4 of the paper).
//
// reads   polynomials
// writes  offsets          one count a point, by slot; a scan turns them into offsets
// runs    one invocation per point
// twin    crates/reference/src/disc_bin.rs
//
// By slot, not by ordinal: no picture depends on the order in a list, and slots that follow each
// other are neighbours in memory and on the screen.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "layout.glsl"
#include "disc.glsl"
#include "index.glsl"
#include "records.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = DISC_OFFSETS) writeonly buffer Offsets { uint offsets[]; };
layout(push_constant) uniform Push { DiscParams params; };

void main() {
    uint slot = list_index();
    if (slot >= params.point_count) return;
    vec4 ball = center_trust_of(slot);
    uvec2 extent = disc_tiles(params.camera, ball.xyz - params.camera.eye, ball.w).extent;
    offsets[slot] = extent.x * extent.y;
}
