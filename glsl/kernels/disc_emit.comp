// disc_emit: one (key, slot) pair for each screen tile that each point's disc covers.
//
// reads   polynomials
//         offsets          first pair of each point, by slot
// writes  keys             the screen tile, and below it the rank of the ball's nearest distance
//         slots            the point
// runs    one invocation per pair, so that one huge disc is no long loop
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
    uint pair = list_index();
    if (pair >= params.pair_count) return;
    uint low = 0u; // the last point whose first pair is not behind this one
    uint high = params.point_count;
    while (high - low > 1u) {
        uint middle = (low + high) / 2u;
        bool before = offset_of(middle) <= pair;
        low = before ? middle : low;
        high = before ? high : middle;
    }
    vec4 ball = center_trust_of(low);
    vec3 from_eye = ball.xyz - params.camera.eye;
    TileSpan span = disc_tiles(params.camera, from_eye, ball.w);
    uint nth = pair - offset_of(low);
    uvec2 tile = span.low + uvec2(nth % span.extent.x, nth / span.extent.x);
    float nearest = sqrt(dot3(from_eye, from_eye)) - disc_radius(from_eye, ball.w);
    uint id = tile.y * screen_tiles(params.camera.tile_size).x + tile.x;
    keys[pair] = (id << params.ranks.bits) | depth_rank(params.ranks, nearest);
    slots[pair] = low;
}
