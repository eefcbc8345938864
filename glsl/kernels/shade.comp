// shade: Lambert's law at the diffuse hits of a wave (method, section 4).
//
// reads   the shadow rays' state      as the rays towards the last light left it
//         hits, polynomials, objects, paths
//         lit_rays         the rays that hit a diffuse surface
//         light_sums       what the lights bring, and what the last one would
//         grid, cells, slots, colors   the values of the points around a hit, where an object has them
//         images, texels   textures
// writes  film             the channels that the rays carry
// runs    one invocation per diffuse hit
// twin    crates/reference/src/shade.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#include "layout.glsl"
#include "math.glsl"
#include "albedo.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = TRACE_HITS) readonly buffer Hits { Hit hits[]; };
layout(std430, binding = SHADE_FILM) buffer Film { FilmPixel film[]; };
layout(std430, binding = WAVE_PATHS) readonly buffer Paths { Path paths[]; };
layout(std430, binding = WAVE_LIT_RAYS) readonly buffer LitRays { uvec2 lit_rays[]; };
layout(std430, binding = WAVE_LIGHT_SUMS) readonly buffer LightSums { LightSum light_sums[]; };
layout(push_constant) uniform Push { WaveParams params; };
#include "film.glsl"
#include "gather.glsl"

#define INVERSE_PI 0.318309886

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    uint ray = lit_rays[at].x, slot = lit_rays[at].y;
    uint pixel = paths[ray].pixel;
    vec3 light = params.light_count > 0u ? gathered(at, pixel) : vec3(0.0);
    vec3 albedo = albedo_at(object_of(slot), slot, hits[ray].position);
    vec3 scattered = paths[ray].throughput * (albedo * (light * INVERSE_PI));
    write_channels(pixel, paths[ray].channels, paths[ray].emitted + scattered);
}
