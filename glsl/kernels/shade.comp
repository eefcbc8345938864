// shade: Lambert's law at the diffuse hits of a wave (method, section 4).
//
// reads   the shadow rays' state      as the rays towards the last light left it
//         polynomials, objects, paths
//         lit_rays         the rays that hit a diffuse surface
//         light_sums       what the lights bring, and what the last one would
//         colors           three floats a point of each object that has colours, by slot
// writes  film             the channels that the rays carry
// runs    one invocation per diffuse hit
// twin    crates/reference/src/shade.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#include "layout.glsl"
#include "math.glsl"
#include "light.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = TRACE_POLYNOMIALS) readonly buffer Polynomials { Polynomial polynomials[]; };
layout(std430, binding = SHADE_OBJECTS) readonly buffer Objects { ObjectInfo objects[]; };
layout(std430, binding = SHADE_COLORS) readonly buffer Colors { float colors[]; };
layout(std430, binding = SHADE_FILM) buffer Film { FilmPixel film[]; };
layout(std430, binding = WAVE_PATHS) readonly buffer Paths { Path paths[]; };
layout(std430, binding = WAVE_LIT_RAYS) readonly buffer LitRays { uvec2 lit_rays[]; };
layout(std430, binding = WAVE_LIGHT_SUMS) readonly buffer LightSums { LightSum light_sums[]; };
layout(push_constant) uniform Push { WaveParams params; };
#include "film.glsl"
#include "gather.glsl"

#define INVERSE_PI 0.318309886

vec3 point_color(ObjectInfo object, uint slot) {
    bool has_colors = object.first_color != NONE;
    uint at = has_colors ? object.first_color + 3u * (slot - object.first_slot) : 0u;
    vec3 color = vec3(colors[at], colors[at + 1u], colors[at + 2u]);
    return has_colors ? color : object.albedo;
}

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    uint ray = lit_rays[at].x, slot = lit_rays[at].y;
    uint pixel = paths[ray].pixel;
    vec3 light = params.light_count > 0u ? gathered(at, pixel) : vec3(0.0);
    vec3 albedo = point_color(objects[polynomials[slot].object], slot);
    write_channels(pixel, paths[ray].channels, paths[ray].throughput * (albedo * (light * INVERSE_PI)));
}
