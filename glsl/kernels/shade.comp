// shade: Lambert's law at the hit of each ray, the background where there is none (method, section 4).
//
// reads   the ray state, polynomials
//         hits             accepted, or none
//         objects          one an object of the scene
//         grid, cells, slots, colors   the values of the points around a hit, where an object has them
//         images, texels   textures and environment
//         lights
// writes  film             every pixel
// runs    one invocation per pixel of the tile
// twin    crates/reference/src/shade.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#include "layout.glsl"
#include "math.glsl"
#include "albedo.glsl"
#include "environment.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = TILE_GROUP) in;
layout(std430, binding = TRACE_HITS) readonly buffer Hits { Hit hits[]; };
layout(std430, binding = SHADE_LIGHTS) readonly buffer Lights { Light lights[]; };
layout(std430, binding = SHADE_FILM) writeonly buffer Film { FilmPixel film[]; };
layout(push_constant) uniform Push { ShadeParams params; };

#define INVERSE_PI 0.318309886
#define INFINITE_DEPTH uintBitsToFloat(0x7f800000u)

// What one light sends to a surface at x, by Lambert's law.
vec3 irradiance(Light light, vec3 x, vec3 normal) {
    vec3 towards = light.vector - x;
    float square = dot3(towards, towards);
    bool is_point = light.kind == LIGHT_POINT && square > 0.0;
    vec3 l = is_point ? towards / sqrt(square) : light.vector;
    float cosine = max(dot3(normal, l), 0.0);
    vec3 arriving = is_point ? light.strength / square : light.strength;
    return light.kind == LIGHT_POINT && !is_point ? vec3(0.0) : arriving * cosine;
}

void main() {
    uvec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, params.tile_size))) return;
    Ray ray = load_ray(ivec2(pixel));
    uint at = pixel.y * params.tile_size.x + pixel.x;
    Hit hit = hits[at];
    uvec4 counts = uvec4(ray.tests, ray.cells, ray.hit_slot, hit.status >> HIT_TOTAL_SHIFT);
    if (ray.hit_slot == NONE) {
        vec3 behind = background_at(params.background, ray.direction);
        behind = params.transparent != 0u ? vec3(0.0) : behind;
        film[at] = FilmPixel(vec4(ray.color + behind, 0.0), vec4(0.0, 0.0, 0.0, INFINITE_DEPTH),
                             vec4(0.0, 0.0, 0.0, -1.0), counts);
        return;
    }
    uint index = polynomials[ray.hit_slot].object;
    vec3 light = vec3(0.0);
    for (uint i = 0u; i < params.light_count; ++i) light += irradiance(lights[i], hit.position, hit.normal);
    vec3 radiance = ray.color + albedo_at(index, ray.hit_slot, hit.position) * (light * INVERSE_PI);
    float depth = hit.t * dot3(ray.direction, params.forward);
    film[at] = FilmPixel(vec4(radiance, 1.0), vec4(hit.position, depth), vec4(hit.normal, float(index)), counts);
}
