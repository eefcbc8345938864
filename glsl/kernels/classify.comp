// classify: what becomes of each ray of a wave that has met a surface, or nothing (section 5 of the
// paper).
//
// reads   the ray state, objects, polynomials, paths
//         hits             accepted, or none
//         images, texels   the environment
//         march            what channels of volumes show
// writes  written_paths    the same paths: absorption on the way is taken from their throughput
//         film             every pixel in the first wave; after that, the background where a ray ends
//         lit, lit_hits    marks of rays that hit a lit surface, if there is light, and where
//         scattering, next_marks   marks of those that hit one that sends rays on, and how many each makes; all marks
//                          must be zero before
// runs    one invocation per ray of the wave
// twin    crates/reference/src/wave/classify.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/rays.glsl"
#include "stages/wave.glsl"
#include "stages/volume.glsl"
#include "stages/film.glsl"
#include "direction.glsl"
#include "environment.glsl"
#include "light.glsl"
#include "math.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = FILM) buffer Film { FilmPixel film[]; };
layout(std430, binding = NEXT_PATHS) writeonly buffer WrittenPaths { Path written_paths[]; };
layout(std430, binding = LIT_HITS) writeonly buffer LitHits { LitHit lit_hits[]; };
layout(std430, binding = MARCHES) readonly buffer Marches { March marches[]; };
layout(std430, binding = LIGHTS) readonly buffer Lights { Light lights[]; };
layout(push_constant) uniform Push { WaveParams params; };
#include "path.glsl"
#include "media.glsl"
#include "way.glsl"
#include "material.glsl"
#include "film.glsl"
#include "marks.glsl"

// What channels of volumes show of a later part of the camera's way, where no part before had anything. Depth goes on
// from the first surface.
void show_later(uint pixel, Ray ray, float along) {
    float shown = film[pixel].along;
    if ((params.flags & uint(WAVE_VALUES)) != 0u && shown == 0.0) film[pixel].along = along;
    if ((params.flags & uint(WAVE_LOSSES)) != 0u && shown < 0.0 && along >= 0.0) {
        vec4 first = film[pixel].position_depth;
        film[pixel].along = (first.w + dot3(ray.origin - first.xyz, params.forward)) + along;
    }
}

// What lamps with an extent send along a ray that ends at a distance.
vec3 lamps_met(Ray ray, float end) {
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < params.light_count; ++i) {
        sum += met_of(lights[i], ray.origin, ray.direction, end);
    }
    return sum;
}

// Where light goes from surface to surface: whether rays still go on from there.
Fate fate_of_path(Fate fate, Path path, vec3 throughput, uvec2 pixel) {
    // Beyond the last bounce, a ray only looks for the background.
    if (path.bounces > params.max_bounces && !fate.passes) return no_fate();
    bool scatters = fate.sends && fate.lit;
    bool finds_nothing = path.bounces == params.max_bounces && !lighting_has(LIGHTING_SKY);
    uint index = params.sample_index == NONE ? 0u : params.sample_index;
    float drawn = sample_1d(pixel, index, params.seed, uint(SAMPLE_SURVIVAL) + path.bounces);
    bool dies = drawn >= survival_of(throughput, path.channels, path.bounces);
    fate.sends = fate.sends && !(scatters && (finds_nothing || dies));
    return fate;
}

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    Path path = path_of(at);
    uint pixel = path.pixel;
    if (pixel == NONE) return;
    Ray ray = load_ray(at);
    Hit hit = hit_at(at);
    bool found = ray.hit_slot != NONE;
    uint object = found ? polynomial_object_at(ray.hit_slot) : NONE;
    vec3 throughput = path.throughput;
    Media media = Media(at, path.media_count);
    vec3 before = throughput;
    float depth_of_way = 0.0;
    if (lighting_has(LIGHTING_PATH) && scene_has(SCENE_VOLUMES)) {
        depth_of_way = marches[at].depth;
        throughput *= exp_negative(-depth_of_way);
        written_paths[at].throughput = throughput;
    }
    if (scene_has(SCENE_ABSORBS)) {
        if (media.count > 0u) {
            uint medium = medium_without(media, NONE);
            // Of a ray that grazes glass of the air's index, the way out may not have been seen.
            medium = !found && ior_of(medium) == vec3(1.0) ? NONE : medium;
            throughput *= transmittance(medium, found ? hit.t : NO_HIT);
            written_paths[at].throughput = throughput;
        }
    }
    Fate fate = no_fate();
    if (found) {
        uint way = way_through_point(ray.hit_slot, ray.origin, ray.direction, ray.hit_t);
        fate = fate_at(object, media, way, path.channels);
        if (lighting_has(LIGHTING_PATH)) {
            uvec2 place = uvec2(pixel % params.tile_size.x, pixel / params.tile_size.x);
            fate = fate_of_path(fate, path, throughput, params.tile_origin + place);
        }
    }
    bool is_lit = fate.lit && scene_has(SCENE_LIGHTS);
    if (scene_has(SCENE_LIGHTS) && scene_has(SCENE_LIT)) {
        if (is_lit) {
            lit_hits[at].position = hit.position;
            lit_hits[at].slot = ray.hit_slot;
            lit_hits[at].normal = hit.normal;
            if (scene_has(SCENE_GLOSSY)) lit_hits[at].view = packed_direction(ray.direction);
            mark_lit(at);
        }
    }
    if (scene_has(SCENE_SCATTERS)) {
        uint most = params.max_bounces;
        if (lighting_has(LIGHTING_PATH)) most += fate.lit ? 1u : 0u; // the last looks for the background
        if (fate.sends) mark_scattering(at, rays_on(fate, path.bounces, path.crossings, most));
    }

    bool from_camera = (params.flags & uint(WAVE_FROM_CAMERA)) != 0u;
    uint channels = path.channels;
    bool left_out = leaves_out(params.transparent, from_camera, channels);
    vec3 alpha = found || (channels & uint(PATH_REFLECTED)) != 0u ? vec3(1.0) : alpha_of(path, throughput);
    vec3 seen = background_at(params.background, ray.direction);
    bool scattered = lighting_has(LIGHTING_PATH) && (channels & uint(PATH_SCATTERED)) != 0u;
    if (lighting_has(LIGHTING_SUN)) {
        seen += scattered ? vec3(0.0) : sun_at(params.background.environment, ray.direction);
    }
    if (lighting_has(LIGHTING_PATH)) seen *= path.depth;
    vec3 background = found || left_out ? vec3(0.0) : through_volumes(path, throughput * seen);
    vec3 behind = path.emitted + background; // of a lit surface, where there is no light
    if (lighting_has(LIGHTING_PATH)) {
        if (scene_has(SCENE_VOLUMES)) behind += before * marches[at].color;
        if (lighting_has(LIGHTING_LAMPS)) {
            bool meets = !scattered && path.bounces > 0u;
            behind += meets ? throughput * lamps_met(ray, found ? hit.t : NO_HIT) : vec3(0.0);
        }
        if (lighting_has(LIGHTING_CLAMP)) {
            behind = (channels & uint(PATH_INDIRECT)) != 0u ? limited(channels, behind) : behind;
        }
    }
    if (from_camera) {
        float depth = hit.t * dot3(ray.direction, params.forward);
        float taken = lighting_has(LIGHTING_PATH) ? depth_of_way : path.depth;
        float coverage = found ? 1.0 : (scene_has(SCENE_VOLUMES) ? absorptance(taken) : 0.0);
        uvec4 counts = uvec4(ray.tests, ray.cells, ray.hit_slot, hit.status >> HIT_TOTAL_SHIFT);
        bool all_adds = lighting_has(LIGHTING_PATH);
        bool on_surface = found; // rather than in a volume
        if (lighting_has(LIGHTING_SCATTERS)) on_surface = found && object_material_at(object) != uint(MATERIAL_CLOUD);
        write_first(pixel, vec4(fate.sends && !all_adds ? vec3(0.0) : behind, coverage), all_adds || !is_lit, on_surface,
                    vec4(hit.position, depth), vec4(hit.normal, on_surface ? float(object) : -1.0), counts, alpha);
        if (scene_has(SCENE_VOLUMES)) film[pixel].along = marches[at].along;
    } else {
        count_work(pixel, ray.tests, ray.cells);
        if (scene_has(SCENE_VOLUMES)) {
            bool shows = (channels & 1u) != 0u && (channels & uint(PATH_REFLECTED)) == 0u;
            if (shows) show_later(pixel, ray, marches[at].along);
        }
        bool all_adds = lighting_has(LIGHTING_PATH);
        if (all_adds || !found || !(is_lit || fate.sends)) write_channels(pixel, channels, behind);
        if (!found) write_alpha(pixel, channels, alpha);
    }
}
