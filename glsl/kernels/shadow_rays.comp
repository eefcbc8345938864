// shadow_rays: the rays from the lit hits of a wave towards one light (section 5 of the paper).
//
// reads   the shadow rays' state      as the rays towards the light before this one left it
//         lit_hits, lights, polynomials, objects
//         lit_rays         the rays that hit a lit surface
// writes  the shadow rays' state      towards this light; none where it scatters nothing of it
//         light_sums       what the lights before this one bring, and what this one would
//         film             counts
//         tally            hits that send none
// runs    one invocation per lit hit
// twin    crates/reference/src/wave/shadow_rays.rs
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
#include "light.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = LIGHTS) readonly buffer Lights { Light lights[]; };
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
    uint tile_at = path_of(ray).pixel;
    vec3 sum = vec3(0.0);
    if (scene_has(SCENE_MANY_LIGHTS)) {
        if (params.light > 0u) sum = gathered(at, tile_at);
    }
    vec2 place = vec2(0.5); // of a light: its centre, unless it is sampled
    if (scene_has(SCENE_SAMPLES)) {
        uvec2 pixel = params.tile_origin + uvec2(tile_at % params.tile_size.x, tile_at / params.tile_size.x);
        uint dimension = uint(SAMPLE_LIGHT) + params.light;
        if (lighting_has(LIGHTING_PATH)) dimension += uint(SAMPLES_A_BOUNCE) * path_of(ray).bounces;
        SharedSample own = SharedSample(pixel, params.sample_index);
        bool shares = lighting_has(LIGHTING_SKY) || lighting_has(LIGHTING_PATH);
        if (shares) own = shared_sample(pixel, params.sample_index, params.sample_bits);
        vec2 drawn = sample_2d(own.pixel, own.index, params.seed, dimension);
        place = params.sample_index == NONE ? place : drawn; // of the pixel's centre: the centre
    }
    LightSample light = sample_light(lights[params.light], hit.position, place);
    Place met = Place(vec3(0.0), hit.normal, NONE);
    if (scene_has(SCENE_GLOSSY)) {
        met.d = unpacked_direction(hit.view);
        met.object = polynomial_object_at(hit.slot);
    }
    vec3 arriving = light.arriving * lobe(met, light.towards);
    bool arrives = any(greaterThan(arriving, vec3(0.0)));
    if (scene_has(SCENE_MANY_LIGHTS)) light_sums[at].sum = sum;
    light_sums[at].arriving = arriving;
    Ray shadow = no_ray();
    if (arrives) {
        shadow = new_ray(hit.position, light.towards, hit.slot);
        shadow.hit_t = light.distance;
    } else {
        atomicAdd(dark_count, 1u);
    }
    store_ray(at, shadow);
}
