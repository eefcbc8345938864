// shade: what lit surfaces scatter of the lights that reach the hits of a wave (method, section 4).
//
// reads   the shadow rays' state      as the rays towards the last light left it
//         lit_hits, polynomials, objects, paths
//         lit_rays         the rays that hit a lit surface
//         light_sums       what the lights bring, and what the last one would
//         grid, cells, slots, colors   the values of the points around a hit, where an object has them
//         images, texels   textures
// writes  film             the channels that the rays carry
// runs    one invocation per lit hit
// twin    crates/reference/src/wave/shade.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#include "stages/points.glsl"
#include "stages/wave.glsl"
#include "stages/film.glsl"
#include "math.glsl"
#include "albedo.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = FILM) buffer Film { FilmPixel film[]; };
layout(std430, binding = LIGHT_SUMS) readonly buffer LightSums { LightSum light_sums[]; };
layout(push_constant) uniform Push { WaveParams params; };
#include "film.glsl"
#include "gather.glsl"
#include "path.glsl"
#include "material.glsl"

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    uint ray = lit_ray_at(at);
    Path path = path_of(ray);
    LitHit hit = lit_hit_at(ray);
    vec3 light = gathered(at, path.pixel);
    uint object = polynomial_object_at(hit.slot);
    bool is_cloud = lighting_has(LIGHTING_SCATTERS) && object_material_at(object) == uint(MATERIAL_CLOUD);
    vec3 albedo = vec3(0.0);
    if (!is_cloud) albedo = albedo_at(object, hit.slot, hit.position);
    albedo = is_cloud ? hit.normal : albedo;
    vec3 seen = through_volumes(path, path.throughput * scattered(object, light, albedo));
    if (lighting_has(LIGHTING_CLAMP)) {
        bool indirect = (path.channels & uint(PATH_SCATTERED | PATH_INDIRECT)) != 0u;
        seen = indirect ? limited(path.channels, seen) : seen;
    }
    write_channels(path.pixel, path.channels, path.emitted + seen);
}
