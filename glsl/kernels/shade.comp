// shade: Lambert's law at the hit of each ray, the background where there is none (method, section 4).
//
// reads   the ray state, polynomials
//         hits             accepted, or none
//         objects          one an object of the scene
//         colors           three floats a point of each object that has colours, by slot
//         lights
// writes  film             every pixel
// runs    one invocation per pixel of the tile
// twin    crates/reference/src/shade.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#include "layout.glsl"
#include "math.glsl"
#include "light.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = TILE_GROUP) in;
layout(std430, binding = TRACE_POLYNOMIALS) readonly buffer Polynomials { Polynomial polynomials[]; };
layout(std430, binding = TRACE_HITS) readonly buffer Hits { Hit hits[]; };
layout(std430, binding = SHADE_OBJECTS) readonly buffer Objects { ObjectInfo objects[]; };
layout(std430, binding = SHADE_COLORS) readonly buffer Colors { float colors[]; };
layout(std430, binding = SHADE_LIGHTS) readonly buffer Lights { Light lights[]; };
layout(std430, binding = SHADE_FILM) writeonly buffer Film { FilmPixel film[]; };
layout(push_constant) uniform Push { ShadeParams params; };

#define INVERSE_PI 0.318309886
#define INFINITE_DEPTH uintBitsToFloat(0x7f800000u)

vec3 point_color(ObjectInfo object, uint slot) {
    bool has_colors = object.first_color != NONE;
    uint at = has_colors ? object.first_color + 3u * (slot - object.first_slot) : 0u;
    vec3 color = vec3(colors[at], colors[at + 1u], colors[at + 2u]);
    return has_colors ? color : object.albedo;
}

// What light i sends to a surface at x, by Lambert's law: from its centre, unless it is sampled.
vec3 irradiance(uint i, uvec2 pixel, vec3 x, vec3 normal) {
    bool sampled = params.sample_index != NONE;
    vec2 u = vec2(0.5);
    if (sampled) u = sample_2d(params.tile_origin + pixel, params.sample_index, params.seed, uint(SAMPLE_LIGHT) + i);
    LightSample light = sample_light(lights[i], x, u);
    return light.arriving * max(dot3(normal, light.towards), 0.0);
}

void main() {
    uvec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, params.tile_size))) return;
    Ray ray = load_ray(ivec2(pixel));
    uint at = pixel.y * params.tile_size.x + pixel.x;
    Hit hit = hits[at];
    uvec4 counts = uvec4(ray.tests, ray.cells, ray.hit_slot, hit.status >> HIT_TOTAL_SHIFT);
    if (ray.hit_slot == NONE) {
        vec3 behind = params.transparent != 0u ? vec3(0.0) : params.background;
        film[at] = FilmPixel(vec4(ray.color + behind, 0.0), vec4(0.0, 0.0, 0.0, INFINITE_DEPTH),
                             vec4(0.0, 0.0, 0.0, -1.0), counts);
        return;
    }
    uint index = polynomials[ray.hit_slot].object;
    vec3 light = vec3(0.0);
    for (uint i = 0u; i < params.light_count; ++i) light += irradiance(i, pixel, hit.position, hit.normal);
    vec3 radiance = ray.color + point_color(objects[index], ray.hit_slot) * (light * INVERSE_PI);
    float depth = hit.t * dot3(ray.direction, params.forward);
    film[at] = FilmPixel(vec4(radiance, 1.0), vec4(hit.position, depth), vec4(hit.normal, float(index)), counts);
}
