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
#include "math.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = FILM) buffer Film { FilmPixel film[]; };
layout(std430, binding = NEXT_PATHS) writeonly buffer WrittenPaths { Path written_paths[]; };
layout(std430, binding = LIT_HITS) writeonly buffer LitHits { LitHit lit_hits[]; };
layout(std430, binding = MARCHES) readonly buffer Marches { March marches[]; };
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
        if (fate.sends) mark_scattering(at, rays_on(fate, path.bounces, path.crossings, params.max_bounces));
    }

    bool from_camera = (params.flags & uint(WAVE_FROM_CAMERA)) != 0u;
    uint channels = path.channels;
    bool left_out = leaves_out(params.transparent, from_camera, channels);
    vec3 alpha = found || (channels & uint(PATH_REFLECTED)) != 0u ? vec3(1.0) : alpha_of(path, throughput);
    vec3 seen = background_at(params.background, ray.direction);
    vec3 background = found || left_out ? vec3(0.0) : through_volumes(path, throughput * seen);
    vec3 behind = path.emitted + background; // of a lit surface, where there is no light
    if (from_camera) {
        float depth = hit.t * dot3(ray.direction, params.forward);
        float coverage = found ? 1.0 : (scene_has(SCENE_VOLUMES) ? absorptance(path.depth) : 0.0);
        uvec4 counts = uvec4(ray.tests, ray.cells, ray.hit_slot, hit.status >> HIT_TOTAL_SHIFT);
        write_first(pixel, vec4(fate.sends ? vec3(0.0) : behind, coverage), !is_lit, found,
                    vec4(hit.position, depth), vec4(hit.normal, found ? float(object) : -1.0), counts, alpha);
        if (scene_has(SCENE_VOLUMES)) film[pixel].along = marches[at].along;
    } else {
        count_work(pixel, ray.tests, ray.cells);
        if (scene_has(SCENE_VOLUMES)) {
            bool shows = (channels & 1u) != 0u && (channels & uint(PATH_REFLECTED)) == 0u;
            if (shows) show_later(pixel, ray, marches[at].along);
        }
        if (!found || !(is_lit || fate.sends)) write_channels(pixel, channels, behind);
        if (!found) write_alpha(pixel, channels, alpha);
    }
}
