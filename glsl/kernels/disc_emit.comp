// disc_emit: one (key, slot) pair for each screen tile that each point's disc covers.
//
// reads   polynomials
//         offsets          first pair of each point, by slot
// writes  keys             the screen tile, and below it the rank of the ball's nearest distance
//         slots            the point
// runs    one invocation per point; a disc covers the 16 384 screen tiles of a tile at most
// twin    crates/reference/src/disc_bin.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#include "layout.glsl"
#include "disc.glsl"
#include "index.glsl"
#include "records.glsl"

layout(local_size_x = LINE_GROUP) in;
#ifdef QUEUE // as in records.glsl
layout(binding = DISC_OFFSETS) uniform usamplerBuffer offset_texels; // one value each

uint offset_of(uint slot) {
    return texelFetch(offset_texels, int(slot)).x;
}
#else
layout(std430, binding = DISC_OFFSETS) readonly buffer Offsets { uint offsets[]; };

uint offset_of(uint slot) {
    return offsets[slot];
}
#endif
layout(std430, binding = DISC_KEYS) writeonly buffer Keys { uint keys[]; };
layout(std430, binding = DISC_SLOTS) writeonly buffer Slots { uint slots[]; };
layout(push_constant) uniform Push { DiscParams params; };

void main() {
    uint slot = list_index();
    if (slot >= params.point_count) return;
    vec4 ball = center_trust_of(slot);
    vec3 from_eye = ball.xyz - params.camera.eye;
    TileSpan span = disc_tiles(params.camera, from_eye, ball.w);
    float nearest = sqrt(dot3(from_eye, from_eye)) - disc_radius(from_eye, ball.w);
    uint rank = depth_rank(params.ranks, nearest);
    uint across = screen_tiles(params.camera.tile_size).x;
    uint first = offset_of(slot);
    uint count = span.extent.x * span.extent.y;
    uvec2 tile = uvec2(0u);
    for (uint i = 0u; i < count; ++i) {
        uint id = (span.low.y + tile.y) * across + (span.low.x + tile.x);
        keys[first + i] = (id << params.ranks.bits) | rank;
        slots[first + i] = slot;
        bool wraps = tile.x + 1u == span.extent.x;
        tile = wraps ? uvec2(0u, tile.y + 1u) : uvec2(tile.x + 1u, tile.y);
    }
}
