// classify: what becomes of each ray of a wave that has met a surface, or nothing (section 5 of the
// paper).
//
// reads   the ray state, objects, polynomials
//         hits             accepted, or none
//         images, texels   the environment
// writes  paths            absorption on the way is taken from their throughput
//         film             every pixel in the first wave; after that, the background where a ray ends
//         lit              1 for a ray that hit a diffuse surface
//         lit_hits         its hit
//         next             how many rays of the next wave this one makes
// runs    one invocation per ray of the wave
// twin    crates/reference/src/wave.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#include "layout.glsl"
#include "environment.glsl"
#include "math.glsl"
#include "state.glsl"
#include "records.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = TRACE_HITS) readonly buffer Hits { Hit hits[]; };
layout(std430, binding = SHADE_OBJECTS) readonly buffer Objects { ObjectInfo objects[]; };
layout(std430, binding = SHADE_FILM) buffer Film { FilmPixel film[]; };
layout(std430, binding = WAVE_PATHS) buffer Paths { Path paths[]; };
layout(std430, binding = WAVE_LIT) writeonly buffer Lit { uint lit[]; };
layout(std430, binding = WAVE_LIT_HITS) writeonly buffer LitHits { LitHit lit_hits[]; };
layout(std430, binding = WAVE_NEXT) writeonly buffer Next { uint next[]; };
layout(push_constant) uniform Push { WaveParams params; };
#include "media.glsl"
#include "film.glsl"

// Rays that a ray makes at a surface that is not diffuse.
uint rays_behind(uint ray, uint object) {
    bool spent = paths[ray].bounces >= params.max_bounces;
    if (objects[object].material != MATERIAL_GLASS) return spent ? 0u : 1u;
    Crossing crossing = crossing_of(ray, object);
    bool passes = crossing.before == crossing.after;
    uint count = splits(crossing, paths[ray].channels) ? 3u : 1u;
    return passes ? (paths[ray].crossings < MOST_CROSSINGS ? 1u : 0u) : (spent ? 0u : count);
}

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    uint pixel = paths[at].pixel;
    if (pixel == NONE) {
        lit[at] = 0u;
        next[at] = 0u;
        return;
    }
    Ray ray = load_ray(at);
    Hit hit = hits[at];
    bool found = ray.hit_slot != NONE;
    uint object = found ? object_of(ray.hit_slot) : NONE;
    vec3 throughput = paths[at].throughput;
    if (paths[at].media_count > 0u) {
        throughput *= transmittance(medium_without(at, NONE), found ? hit.t : NO_HIT);
        paths[at].throughput = throughput;
    }
    bool is_diffuse = found && objects[object].material == MATERIAL_DIFFUSE;
    lit[at] = is_diffuse ? 1u : 0u;
    if (is_diffuse) lit_hits[at] = LitHit(hit.position, ray.hit_slot, hit.normal, 0u);
    next[at] = found && !is_diffuse ? rays_behind(at, object) : 0u;

    bool from_camera = (params.flags & uint(WAVE_FROM_CAMERA)) != 0u;
    uint channels = paths[at].channels;
    bool left_out = leaves_out(params.transparent, from_camera, channels);
    vec3 alpha = vec3(1.0) - (found || (channels & uint(PATH_REFLECTED)) != 0u ? vec3(0.0) : throughput);
    vec3 background = found || left_out ? vec3(0.0) : throughput * background_at(params.background, ray.direction);
    vec3 behind = paths[at].emitted + background; // of a diffuse surface, where there is no light
    if (from_camera) {
        float depth = hit.t * dot3(ray.direction, params.forward);
        uvec4 counts = uvec4(ray.tests, ray.cells, ray.hit_slot, hit.status >> HIT_TOTAL_SHIFT);
        bool colored = !(is_diffuse && scene_has(SCENE_LIGHTS));
        write_first(pixel, vec4(found && !is_diffuse ? vec3(0.0) : behind, found ? 1.0 : paths[at].coverage), colored, found,
                    vec4(hit.position, depth), vec4(hit.normal, found ? float(object) : -1.0), counts, alpha);
    } else {
        count_work(pixel, ray.tests, ray.cells);
        if (!found || (is_diffuse && !scene_has(SCENE_LIGHTS))) write_channels(pixel, channels, behind);
        if (!found) write_alpha(pixel, channels, alpha);
    }
}
