// shadow_go_on: shadow rays on the other side of the surfaces that let them through.
//
// reads   the shadow rays' state, shadow_paths, light_sums, polynomials, objects
// writes  the shadow rays' state      rays that go on, in place; of those that have arrived, so that no volume counts
//                          twice, a way of no length
//         shadow_paths     what they are inside, or that they have ended
//         film             counts, if asked for
//         live             how many go on
//         marks            one bit for each of these; must be zero before
// runs    one invocation per shadow ray
// twin    crates/reference/src/to_light/shadow_go_on.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#define STATE_WRITES
#include "stages/points.glsl"
#include "stages/rays.glsl"
#include "stages/wave.glsl"
#include "stages/film.glsl"
#include "math.glsl"
#include "polynomial.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = LIVE) buffer Live { uint live; };
layout(std430, binding = MARKS) buffer Marks { uint marks[]; };
layout(std430, binding = FILM) buffer Film { FilmPixel film[]; };
layout(std430, binding = LIGHT_SUMS) readonly buffer LightSums { LightSum light_sums[]; };
layout(std430, binding = SHADOW_PATHS) buffer ShadowPaths { Path shadow_paths[]; };
layout(push_constant) uniform Push { ShadowParams params; };

uint media_word(uint ray, uint word) {
    return shadow_paths[ray].media[word];
}
#include "film.glsl"
#include "media.glsl"
#include "way.glsl"

void put_member(uint at, uint place, uint object) {
    uint both = shadow_paths[at].media[place / 2u];
    shadow_paths[at].media[place / 2u] = with_member(both, place, object);
}

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    if (shadow_paths[at].bounces != 0u) return;
    Ray ray = load_ray(at);
    uint slot = shadow_paths[at].channels;
    bool arrives = ray.hit_slot == NONE && any(greaterThan(light_sums[at].arriving, vec3(0.0)));
    if (!arrives || slot == NONE) {
        shadow_paths[at].bounces = 1u;
        if (arrives) {
            ray.hit_t = 0.0;
            store_ray(at, ray);
        }
        return;
    }
    uint object = polynomial_object_at(slot), count = shadow_paths[at].media_count;
    uint way = way_through_point(slot, ray.origin, ray.direction, ray.hit_t);
    uint place = crossing_of(Media(at, count), object, way).place;
    bool leaves = place < count, enters = place == count && count < MOST_MEDIA;
    if (leaves) put_member(at, place, member_of(Media(at, count), count - 1u)); // the last takes its place
    if (enters) put_member(at, count, object);
    shadow_paths[at].media_count = leaves ? count - 1u : count + (enters ? 1u : 0u);
    shadow_paths[at].channels = NONE;
    shadow_paths[at].crossings += 1u;

    if (params.counts != 0u) count_work(shadow_paths[at].pixel, ray.tests, ray.cells);
    Polynomial p = polynomial_at(slot);
    vec3 y, normal;
    surface_at(ray.origin, ray.direction, ray.hit_t, p, y, normal);
    vec3 x = p.center_trust.xyz + y;
    if (scene_has(SCENE_VOLUMES)) {
        bool on_isosurface = any(notEqual(shadow_paths[at].throughput, vec3(0.0)));
        x = on_isosurface ? ray.origin + ray.hit_t * ray.direction : x;
        shadow_paths[at].throughput = vec3(0.0);
    }
    float left = shadow_paths[at].depth;
    left = left < NO_HIT ? max(left - ray.hit_t, 0.0) : left;
    Ray next = new_ray(x, ray.direction, slot);
    next.hit_t = left;
    shadow_paths[at].depth = left;
    store_ray(at, next);
    atomicAdd(live, 1u);
    atomicOr(marks[at / 32u], 1u << (at & 31u));
}
