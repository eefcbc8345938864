// sky_rays: the rays from a wave's lit hits towards the background, one a hit (method, section 6).
//
// reads   lit_hits, paths, polynomials, objects
//         lit_rays         the rays that hit a lit surface
//         images, texels   the environment
//         environment_table    where that is bright
//         the shadow rays' state, light_sums   as `shadow_rays`
// writes  the shadow rays' state      towards a place of the background; none where nothing of it is scattered
//         light_sums       what the lights before have brought, and what this one would
//         tally            hits that sent no ray
//         film             the work of the rays towards the light before
// runs    one invocation per lit hit
// twin    crates/reference/src/wave/sky_rays.rs
//
// Directions are drawn by how the surface scatters, or with TABLE by how bright the environment is. Where both are, what
// each finds counts by the balance heuristic: the light over the sum of the densities at which the two draw the direction
// (Veach and Guibas, Optimally Combining Sampling Techniques for Monte Carlo Rendering, 1995).
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#define STATE_WRITES
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/rays.glsl"
#include "stages/wave.glsl"
#include "stages/film.glsl"
#include "direction.glsl"
#include "math.glsl"
#include "sky.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = FILM) buffer Film { FilmPixel film[]; };
layout(std430, binding = LIGHT_SUMS) buffer LightSums { LightSum light_sums[]; };
layout(std430, binding = TALLY) buffer Tally { uint dark_count; uint reflected_count; uint scattered_count; };
layout(push_constant) uniform Push { WaveParams params; };
#include "film.glsl"
#include "gather.glsl"
#include "path.glsl"
#include "material.glsl"

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    uint ray = lit_ray_at(at);
    LitHit hit = lit_hit_at(ray);
    Path path = path_of(ray);
    vec3 sum = vec3(0.0);
    if (scene_has(SCENE_MANY_LIGHTS)) {
        if (params.light > 0u) sum = gathered(at, path.pixel);
    }
    uvec2 pixel = params.tile_origin + uvec2(path.pixel % params.tile_size.x, path.pixel / params.tile_size.x);
    uint index = params.sample_index == NONE ? 0u : params.sample_index;
    uint dimension = uint(SAMPLE_LIGHT) + params.light;
    if (lighting_has(LIGHTING_PATH)) dimension += uint(SAMPLES_A_BOUNCE) * path.bounces;
    SharedSample own = shared_sample(pixel, index, params.sample_bits);
    vec2 drawn = sample_2d(own.pixel, own.index, params.seed, dimension);
    Place met = Place(vec3(0.0), hit.normal, NONE);
    if (scene_has(SCENE_GLOSSY)) {
        met.d = unpacked_direction(hit.view);
        met.object = polynomial_object_at(hit.slot);
    }
#ifdef TABLE
    DrawnDirection towards = draw_direction(params.background, drawn);
    float both = towards.density + lobe_density(met, towards.towards);
#else
    DrawnDirection towards = DrawnDirection(lobe_direction(met, drawn), 0.0);
    if (lighting_has(LIGHTING_TABLE)) towards.density = density_of(params.background, towards.towards);
    float both = towards.density + lobe_density(met, towards.towards);
#endif
    vec3 light = background_at(params.background, towards.towards) * lobe(met, towards.towards);
    vec3 arriving = both > 0.0 ? light / (both > 0.0 ? both : 1.0) : vec3(0.0);
    bool arrives = any(greaterThan(arriving, vec3(0.0)));
    if (scene_has(SCENE_MANY_LIGHTS)) light_sums[at].sum = sum;
    light_sums[at].arriving = arriving;
    Ray shadow = no_ray();
    if (arrives) {
        shadow = new_ray(hit.position, towards.towards, hit.slot);
        shadow.hit_t = NO_HIT;
    } else {
        atomicAdd(dark_count, 1u);
    }
    store_ray(at, shadow);
}
