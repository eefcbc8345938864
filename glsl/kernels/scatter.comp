// scatter: the reflected and refracted rays that a wave makes (section 5 of the paper; method,
// section 4).
//
// reads   the ray state, hits, objects, polynomials, paths
//         scattering_rays  the rays that hit a surface that sends rays on
//         images, texels   the environment
//         environment_table    where that is bright, and
//         grid, cells, slots, colors   the values of points around a hit, where light goes from surface to surface
//         next_marks       which of a wave's rays make one ray or three
//         next_offsets     where those of each 32 rays begin
// writes  the ray state, next_paths   the next wave
//         film             the background, in the direction of rays that may not go on
//         tally            reflected rays
// runs    one invocation per such ray
// twin    crates/reference/src/wave/scatter.rs
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
#include "sky.glsl"
#include "albedo.glsl"
#include "math.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = FILM) buffer Film { FilmPixel film[]; };
layout(std430, binding = NEXT_PATHS) writeonly buffer NextPaths { Path next_paths[]; };
layout(std430, binding = TALLY) buffer Tally { uint dark_count; uint reflected_count; uint scattered_count; };
layout(push_constant) uniform Push { WaveParams params; };
#include "path.glsl"
#include "media.glsl"
#include "way.glsl"
#include "material.glsl"
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
            uint changed = with_member(both, moved, mover);
            next_paths[to].media[word] = moved / 2u == word ? changed : both;
        }
    } else {
        next_paths[to].media[0] = count > 0u ? media_word(from, 0u) : object;
    }
    if (keeps_depths()) next_paths[to].emitted = path.emitted;
    if (keeps_depths() || lighting_has(LIGHTING_PATH)) next_paths[to].depth = path.depth;
}

// Of a path that light takes from surface to surface: what it is after a surface sent it on, as which of its flags say, and
// the share of the background that it counts from now on; what it asks the lamps for, others do not find.
void go_on(inout Path path, inout uint how, inout vec3 throughput, Place place, Sent sent, Fate fate, Hit hit, uint slot) {
    bool scattered = (path.channels & uint(PATH_SCATTERED)) != 0u;
    if (fate.passes) return;
    how = (how & ~uint(PATH_SCATTERED)) | (scattered ? uint(PATH_INDIRECT) : 0u);
    path.depth = 1.0;
    if (!fate.lit) return;
    how |= uint(PATH_SCATTERED);
    float own = lobe_density(place, sent.direction);
    float share = lighting_has(LIGHTING_SKY) ? 1.0 : 0.0;
    if (lighting_has(LIGHTING_TABLE)) {
        float both = own + density_of(params.background, sent.direction);
        share = both > 0.0 ? own / (both > 0.0 ? both : 1.0) : 0.0;
    }
    path.depth = share;
    float survival = survival_of(path.throughput, path.channels, path.bounces);
    bool is_cloud = lighting_has(LIGHTING_SCATTERS) && object_material_at(place.object) == uint(MATERIAL_CLOUD);
    vec3 albedo = vec3(0.0);
    if (!is_cloud) albedo = albedo_at(place.object, slot, hit.position);
    throughput *= (is_cloud ? hit.normal : albedo) / survival;
}

// The ray of these channels, which is the `to`th of the next wave where it goes on.
void send(uint ray, Path path, Place place, Fate fate, Hit hit, uint slot, uint channels, Drawn drawn, uint to, bool goes_on) {
    Sent sent = sent_on(place, fate, channels, drawn);
    uint how = channels | (path.channels & ~uint(CHANNELS_ALL));
    if (scene_has(SCENE_GLOSSY)) {
        if (fate.lit && scene_has(SCENE_LIGHTS)) {
            how |= uint(PATH_ADDS);
            path.emitted = vec3(0.0); // what volumes before a lit surface have sent is in the pixel with its light
        }
    }
    vec3 throughput = path.throughput * sent.weight;
    if (lighting_has(LIGHTING_PATH)) go_on(path, how, throughput, place, sent, fate, hit, slot);
    if (goes_on) {
        store_path(to, ray, path, throughput, how, !fate.passes, !sent.reflects, place.object, fate.crossing.place);
        store_ray(to, new_ray(hit.position, sent.direction, slot));
        bool scatters = lighting_has(LIGHTING_PATH) && fate.lit;
        if (scatters) atomicAdd(scattered_count, 1u);
        if (sent.reflects && !scatters) atomicAdd(reflected_count, 1u);
    } else {
        how |= sent.reflects ? uint(PATH_REFLECTED) : 0u;
        bool left_out = leaves_out(params.transparent, false, how);
        vec3 seen = left_out ? vec3(0.0) : seen_at(params.background, sent.direction);
        vec3 brought = path.emitted + through_volumes(path, throughput * seen);
        if (lighting_has(LIGHTING_CLAMP)) {
            brought = (how & uint(PATH_INDIRECT)) != 0u ? limited(how, brought) : brought;
        }
        write_channels(path.pixel, how, brought);
        bool refracted = (how & uint(PATH_REFLECTED)) == 0u;
        write_alpha(path.pixel, how, refracted ? alpha_of(path, throughput) : vec3(1.0));
    }
}

void main() {
    uint index = list_index();
    if (index >= params.ray_count) return;
    uint at = scattering_ray_at(index);
    Ray ray = load_ray(at);
    Path path = path_of(at);
    Hit hit = hit_at(at);
    uint object = polynomial_object_at(ray.hit_slot);
    uint all = path.channels & uint(CHANNELS_ALL);
    uint way = way_through_point(ray.hit_slot, ray.origin, ray.direction, ray.hit_t);
    Fate fate = fate_at(object, Media(at, path.media_count), way, all);
    Place place = Place(ray.direction, hit.normal, object);

    uint bit = at & 31u, below = (1u << bit) - 1u;
    uvec2 marks = next_mark_at(at / 32u);
    uint to = next_offset_at(at / 32u) + uint(bitCount(marks.x & below)) + 2u * uint(bitCount(marks.y & below));
    bool goes_on = (marks.x >> bit & 1u) != 0u;
    uvec2 pixel = params.tile_origin + uvec2(path.pixel % params.tile_size.x, path.pixel / params.tile_size.x);
    Drawn drawn = drawn_at(pixel, params.sample_index, params.sample_bits, params.seed, path.bounces);
    if (scene_has(SCENE_DISPERSES)) {
        uint count = fate.splits ? 3u : 1u;
        for (uint i = 0u; i < count; ++i) {
            send(at, path, place, fate, hit, ray.hit_slot, fate.splits ? 1u << i : all, drawn, to + i, goes_on);
        }
    } else {
        send(at, path, place, fate, hit, ray.hit_slot, all, drawn, to, goes_on);
    }
}
