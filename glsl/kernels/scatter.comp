// scatter: the reflected and refracted rays that a wave makes (section 5 of the paper; method,
// section 4).
//
// reads   the ray state, grid, hits, objects, polynomials, paths
//         images, texels   the environment
//         next             offsets of each ray's rays in the next wave, and one behind the last
// writes  the ray state, next_paths   the next wave
//         film             the background, in the direction of rays that may not go on
//         tally            reflected and refracted rays
// runs    one invocation per ray of the wave
// twin    crates/reference/src/wave.rs
//
// A ray whose media differ in index between the channels becomes one ray a channel.
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#define STATE_WRITES
#include "layout.glsl"
#include "environment.glsl"
#include "math.glsl"
#include "grid.glsl"
#include "optics.glsl"
#include "sampler.glsl"
#include "state.glsl"
#include "records.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = TRACE_INFO) readonly buffer Info { GridInfo grid; };
layout(std430, binding = TRACE_HITS) readonly buffer Hits { Hit hits[]; };
layout(std430, binding = SHADE_OBJECTS) readonly buffer Objects { ObjectInfo objects[]; };
layout(std430, binding = SHADE_FILM) buffer Film { FilmPixel film[]; };
layout(std430, binding = WAVE_PATHS) readonly buffer Paths { Path paths[]; };
layout(std430, binding = WAVE_NEXT_PATHS) writeonly buffer NextPaths { Path next_paths[]; };
layout(std430, binding = WAVE_NEXT) readonly buffer Next { uint next[]; };
layout(std430, binding = WAVE_TALLY) buffer Tally { uint shadow_count; uint reflected_count; uint refracted_count; };
layout(push_constant) uniform Push { WaveParams params; };
#include "media.glsl"
#include "film.glsl"

// A path after a surface. The object is entered or left where `toggles`.
void store_path(uint to, uint from, vec3 throughput, uint channels, bool bounces, bool toggles, uint object,
                uint place) {
    uint count = paths[from].media_count;
    bool leaves = place < count;
    next_paths[to].throughput = throughput;
    next_paths[to].pixel = paths[from].pixel;
    next_paths[to].channels = channels | (bounces && !toggles ? uint(PATH_REFLECTED) : 0u);
    next_paths[to].bounces = paths[from].bounces + (bounces ? 1u : 0u);
    next_paths[to].crossings = paths[from].crossings + (bounces ? 0u : 1u);
    uint last = count > 0u ? count - 1u : 0u; // where one is left, the last takes its place
    uint moved = toggles ? (leaves ? place : count) : MOST_MEDIA;
    uint mover = leaves ? member_of(from, last) : object;
    for (uint word = 0u; word < uint(MEDIA_WORDS); ++word) {
        uint both = paths[from].media[word];
        uint changed = bitfieldInsert(both, mover, 16 * int(moved & 1u), 16);
        next_paths[to].media[word] = moved / 2u == word ? changed : both;
    }
    uint after = leaves ? count - 1u : min(count + 1u, MOST_MEDIA);
    next_paths[to].media_count = toggles ? after : count;
    next_paths[to].emitted = paths[from].emitted;
    next_paths[to].coverage = paths[from].coverage;
}

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    if (paths[at].pixel == NONE) return;
    Ray ray = load_ray(at);
    if (ray.hit_slot == NONE) return;
    uint object = object_of(ray.hit_slot);
    uint material = objects[object].material;
    if (material == MATERIAL_DIFFUSE) return;

    Hit hit = hits[at];
    vec3 d = ray.direction, n = hit.normal;
    bool is_glass = material == MATERIAL_GLASS;
    uint all = paths[at].channels & uint(CHANNELS_ALL);
    uint was_reflected = paths[at].channels & uint(PATH_REFLECTED);
    Crossing crossing = Crossing(NONE, NONE, MOST_MEDIA);
    if (is_glass) crossing = crossing_of(at, object);
    bool passes = is_glass && crossing.before == crossing.after;
    uint count = is_glass && splits(crossing, all) ? 3u : 1u;
    vec3 throughput = paths[at].throughput * (is_glass ? vec3(1.0) : objects[object].albedo);
    uvec2 pixel = params.tile_origin + uvec2(paths[at].pixel % params.tile_size.x, paths[at].pixel / params.tile_size.x);
    uint sample_index = params.sample_index == NONE ? 0u : params.sample_index;
    float chance = sample_1d(pixel, sample_index, params.seed, uint(SAMPLE_FRESNEL) + paths[at].bounces);
    uint to = next[at];
    bool goes_on = next[at + 1u] > to;
    for (uint i = 0u; i < count; ++i) {
        uint channels = count > 1u ? 1u << i : all;
        vec3 n1 = ior_of(crossing.before), n2 = ior_of(crossing.after);
        bool red = (channels & 1u) != 0u, green = channels == 2u;
        Refraction bent = refraction(d, n, red ? n1.x : (green ? n1.y : n1.z), red ? n2.x : (green ? n2.y : n2.z));
        bool by_chance = params.fresnel != 0u && chance < bent.reflectance;
        bool reflects = !is_glass || (!passes && (bent.total || by_chance));
        vec3 direction = reflects ? reflected(d, n) : (passes ? d : bent.direction);
        if (goes_on) {
            store_path(to + i, at, throughput, channels | was_reflected, !passes, !reflects, object, crossing.place);
            uint cell = enter_grid(grid, hit.position, direction);
            store_ray(to + i, new_ray(hit.position, direction, cell, ray.hit_slot));
            if (reflects) atomicAdd(reflected_count, 1u);
            else atomicAdd(refracted_count, 1u);
        } else {
            uint how = channels | was_reflected | (reflects ? uint(PATH_REFLECTED) : 0u);
            vec3 seen = leaves_out(params.transparent, false, how) ? vec3(0.0) : background_at(params.background, direction);
            write_channels(paths[at].pixel, channels, paths[at].emitted + throughput * seen);
            bool refracted = (how & uint(PATH_REFLECTED)) == 0u;
            write_alpha(paths[at].pixel, channels, vec3(1.0) - (refracted ? throughput : vec3(0.0)));
        }
    }
}
