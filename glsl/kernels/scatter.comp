// scatter: the reflected and refracted rays that a wave makes (section 5 of the paper; method,
// section 4).
//
// reads   the ray state, grid, hits, objects, polynomials, paths
//         scattering_rays  the rays that hit what is not diffuse
//         images, texels   the environment
//         next_marks       which of a wave's rays make one ray or three
//         next_offsets     where those of each 32 rays begin
// writes  the ray state, next_paths   the next wave
//         film             the background, in the direction of rays that may not go on
//         tally            reflected rays
// runs    one invocation per ray that hit what is not diffuse
// twin    crates/reference/src/wave.rs
//
// A ray whose media differ in index between the channels becomes one ray a channel.
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#define STATE_WRITES
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/rays.glsl"
#include "stages/wave.glsl"
#include "stages/film.glsl"
#include "environment.glsl"
#include "math.glsl"
#include "levels.glsl"
#include "optics.glsl"
#include "sampler.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = FILM) buffer Film { FilmPixel film[]; };
layout(std430, binding = NEXT_PATHS) writeonly buffer NextPaths { Path next_paths[]; };
layout(std430, binding = TALLY) buffer Tally { uint dark_count; uint reflected_count; };
layout(push_constant) uniform Push { WaveParams params; };
#include "path.glsl"
#include "media.glsl"
#include "way.glsl"
#include "film.glsl"

// A path after a surface. The object is entered or left where `toggles`.
void store_path(uint to, uint from, Path path, vec3 throughput, uint channels, bool bounces, bool toggles, uint object,
                uint place) {
    uint count = path.media_count;
    bool leaves = place < count, enters = place == count;
    next_paths[to].throughput = throughput;
    next_paths[to].pixel = path.pixel;
    next_paths[to].channels = channels | (bounces && !toggles ? uint(PATH_REFLECTED) : 0u);
    next_paths[to].bounces = path.bounces + (bounces ? 1u : 0u);
    next_paths[to].crossings = path.crossings + (bounces ? 0u : 1u);
    uint after = leaves ? count - 1u : min(count + (enters ? 1u : 0u), MOST_MEDIA);
    next_paths[to].media_count = toggles ? after : count;
    if (scene_has(SCENE_NESTED)) {
        uint last = count > 0u ? count - 1u : 0u; // where one is left, the last takes its place
        uint moved = toggles && (leaves || enters) ? (leaves ? place : count) : MOST_MEDIA;
        uint mover = leaves ? member_of(Media(from, count), last) : object;
        for (uint word = 0u; word < uint(MEDIA_WORDS); ++word) {
            uint both = media_word(from, word);
            uint changed = bitfieldInsert(both, mover, 16 * int(moved & 1u), 16);
            next_paths[to].media[word] = moved / 2u == word ? changed : both;
        }
    } else {
        next_paths[to].media[0] = count > 0u ? media_word(from, 0u) : object;
    }
    if (scene_has(SCENE_VOLUMES)) {
        next_paths[to].emitted = path.emitted;
        next_paths[to].depth = path.depth;
    }
}

// A ray at a surface.
struct Turn {
    uint ray;
    vec3 d;
    Hit hit;
    uint slot;
    uint object;
    bool is_glass;
    Crossing crossing;
    vec3 throughput;
    float chance; // under it, glass reflects
    uint to;      // where the rays that it makes go in the next wave
    bool goes_on;
};

// The ray of these channels.
void send(Turn turn, Path path, uint channels, uint to) {
    vec3 d = turn.d, n = turn.hit.normal;
    uint was_reflected = path.channels & uint(PATH_REFLECTED);
    bool passed = turn.is_glass && passes(turn.crossing, path.channels);
    vec3 n1 = ior_of(turn.crossing.before), n2 = ior_of(turn.crossing.after);
    bool red = (channels & 1u) != 0u, green = channels == 2u;
    float index = red ? n1.x : (green ? n1.y : n1.z), beyond = red ? n2.x : (green ? n2.y : n2.z);
    Refraction bent = refraction(d, n, index, beyond);
    bool by_chance = scene_has(SCENE_CHANCE) && turn.chance < bent.reflectance;
    bool straight = passed || (scene_has(SCENE_CLEAR) && index == beyond);
    bool reflects = !turn.is_glass || (!straight && (bent.total || by_chance));
    vec3 direction = reflects ? reflected(d, n) : (straight ? d : bent.direction);
    if (turn.goes_on) {
        store_path(to, turn.ray, path, turn.throughput, channels | was_reflected, !passed, !reflects, turn.object,
                   turn.crossing.place);
        uint cell = enter_scene(turn.hit.position, direction);
        store_ray(to, new_ray(turn.hit.position, direction, cell, turn.slot));
        if (reflects) atomicAdd(reflected_count, 1u);
    } else {
        uint how = channels | was_reflected | (reflects ? uint(PATH_REFLECTED) : 0u);
        vec3 seen = leaves_out(params.transparent, false, how) ? vec3(0.0) : background_at(params.background, direction);
        write_channels(path.pixel, channels, path.emitted + through_volumes(path, turn.throughput * seen));
        bool refracted = (how & uint(PATH_REFLECTED)) == 0u;
        write_alpha(path.pixel, channels, refracted ? alpha_of(path, turn.throughput) : vec3(1.0));
    }
}

void main() {
    uint index = list_index();
    if (index >= params.ray_count) return;
    uint at = scattering_ray_at(index);
    Ray ray = load_ray(at);
    Path path = path_of(at);
    uint object = polynomial_object_at(ray.hit_slot);
    bool is_glass = object_at(object).material == MATERIAL_GLASS;
    vec3 albedo = object_at(object).albedo;
    uint all = path.channels & uint(CHANNELS_ALL);
    Crossing crossing = Crossing(NONE, NONE, MOST_MEDIA);
    if (is_glass) {
        uint way = way_through_point(ray.hit_slot, ray.origin, ray.direction, ray.hit_t);
        crossing = crossing_of(Media(at, path.media_count), object, way);
    }

    uint bit = at & 31u, below = (1u << bit) - 1u;
    uvec2 marks = next_mark_at(at / 32u);
    uint to = next_offset_at(at / 32u) + uint(bitCount(marks.x & below)) + 2u * uint(bitCount(marks.y & below));
    float chance = 0.0;
    if (scene_has(SCENE_CHANCE)) {
        uvec2 pixel = params.tile_origin + uvec2(path.pixel % params.tile_size.x, path.pixel / params.tile_size.x);
        uint sample_index = params.sample_index == NONE ? 0u : params.sample_index;
        chance = sample_1d(pixel, sample_index, params.seed, uint(SAMPLE_FRESNEL) + path.bounces);
    }
    Turn turn = Turn(at, ray.direction, hit_at(at), ray.hit_slot, object, is_glass, crossing,
                     path.throughput * (is_glass ? vec3(1.0) : albedo), chance, to, (marks.x >> bit & 1u) != 0u);
    if (scene_has(SCENE_DISPERSES)) {
        bool is_split = is_glass && splits(crossing, all) && !passes(crossing, all);
        uint count = is_split ? 3u : 1u;
        for (uint i = 0u; i < count; ++i) send(turn, path, is_split ? 1u << i : all, to + i);
    } else {
        send(turn, path, all, to);
    }
}
