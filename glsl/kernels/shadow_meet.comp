// shadow_meet: what the surfaces that shadow rays have met do to light, where it may pass some.
//
// reads   the shadow rays' state      ended at their nearest hits, or at the light
//         shadow_paths, objects, polynomials
// writes  light_sums       what the media on the way leave of the light, by channel
//         the shadow rays' state      of rays that a surface lets through: no hit, so that isosurfaces and volumes as
//                          far as that surface count
//         shadow_paths     that surface; of rays that have arrived, only media that the light is in
// runs    one invocation per shadow ray
// twin    crates/reference/src/to_light/shadow_meet.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#define STATE_WRITES
#include "stages/points.glsl"
#include "stages/rays.glsl"
#include "stages/wave.glsl"
#include "math.glsl"
#include "polynomial.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = LIGHT_SUMS) buffer LightSums { LightSum light_sums[]; };
layout(std430, binding = SHADOW_PATHS) buffer ShadowPaths { Path shadow_paths[]; };
layout(push_constant) uniform Push { ShadowParams params; };

uint media_word(uint ray, uint word) {
    return shadow_paths[ray].media[word];
}
#include "media.glsl"
#include "way.glsl"
#include "material.glsl"

void put_member(uint at, uint place, uint object) {
    uint both = shadow_paths[at].media[place / 2u];
    shadow_paths[at].media[place / 2u] = with_member(both, place, object);
}

// The last part of the way ends at the light: what that is not inside, the ray has left unseen, as where it grazes a
// surface, or was never in. Whether a volume's own object has a surface is not known.
void leave_what_the_light_is_outside(uint at) {
    uint count = shadow_paths[at].media_count, kept = 0u;
    for (uint i = 0u; i < count; ++i) {
        uint member = member_of(Media(at, count), i);
        bool stays = params.lamp_count == NONE || member == (params.passed & ~PASSED_NEAR);
        uint asked = params.lamp_count == NONE ? 0u : params.lamp_count;
        for (uint j = 0u; j < asked; ++j) {
            stays = stays || member == member_in(params.lamp_media[j / 2u], j);
        }
        put_member(at, kept, member);
        kept += stays ? 1u : 0u;
    }
    shadow_paths[at].media_count = kept;
}

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    vec3 arriving = light_sums[at].arriving;
    if (shadow_paths[at].bounces != 0u || !any(greaterThan(arriving, vec3(0.0)))) return;
    Ray ray = load_ray(at);
    bool found = ray.hit_slot != NONE;
    if (!found) leave_what_the_light_is_outside(at);
    Media media = Media(at, shadow_paths[at].media_count);
    uint medium = medium_without(media, NONE);
    // The volume's own object, whose surface is not there: where its glass ends is not known.
    medium = medium == params.passed ? NONE : medium;
    // Infinitely far away, rays are outside everything: of a grazing one, the way out was not seen.
    medium = ray.hit_t < NO_HIT ? medium : NONE;
    arriving *= transmittance(medium, ray.hit_t);
    bool passes = false;
    if (found) {
        uint way = way_through_point(ray.hit_slot, ray.origin, ray.direction, ray.hit_t);
        vec3 y, normal;
        surface_at(ray.origin, ray.direction, ray.hit_t, polynomial_at(ray.hit_slot), y, normal);
        if (scene_has(SCENE_VOLUMES)) {
            vec3 of_isosurface = shadow_paths[at].throughput; // 0: it is none
            normal = any(notEqual(of_isosurface, vec3(0.0))) ? of_isosurface : normal;
        }
        uint object = polynomial_object_at(ray.hit_slot);
        vec3 share = light_passed(object, media, way, ray.direction, normal, params.tints != 0u);
        passes = any(greaterThan(share, vec3(0.0))) && shadow_paths[at].crossings < uint(MOST_CROSSINGS);
        arriving *= share;
    }
    if (found && !passes) return;
    light_sums[at].arriving = arriving;
    shadow_paths[at].channels = ray.hit_slot;
    ray.hit_slot = NONE;
    store_ray(at, ray);
}
