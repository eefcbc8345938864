// material: what surfaces do with light and with rays. Each kind of material has its functions in a file below materials/;
// here they are called by kind. Whether a kind is lit, sends rays on and has an inside are bits of its number.
//
// twin  crates/reference/src/material.rs
// Whoever includes this has media_word(ray, word), as media.glsl says. A kind that has no case here gives no light and
// sends rays without weight; the test `every_kind_has_its_case_on_both_sides` finds it first.
#ifndef MATERIAL_GLSL
#define MATERIAL_GLSL
#include "direction.glsl"
#include "stages/scene.glsl"
#include "stages/wave.glsl"
#include "media.glsl"
#include "sampler.glsl"
#include "scene.glsl"

// What becomes of a ray at a surface.
struct Fate {
    bool lit;          // lights of the scene light the surface
    bool sends;        // rays go on from it
    bool passes;       // the ray goes through as if there were nothing: no bounce
    bool splits;       // it becomes one ray a channel
    Crossing crossing; // how rays go through it, where it has an inside
};

Fate no_fate() {
    return Fate(false, false, false, false, Crossing(NONE, NONE, MOST_MEDIA));
}

// The fate of a ray of these channels, which is inside `media`.
Fate fate_at(uint object, Media media, uint way, uint channels) {
    Fate fate = no_fate();
    fate.lit = true;
    if (!scene_has(SCENE_SCATTERS)) return fate;
    uint material = object_material_at(object);
    fate.lit = (material & uint(MATERIAL_LIT)) != 0u;
    fate.sends = (material & uint(MATERIAL_SENDS)) != 0u;
    if ((material & uint(MATERIAL_INSIDE)) != 0u) {
        fate.crossing = crossing_of(media, object, way);
        fate.passes = passes(fate.crossing, channels);
        fate.splits = !fate.passes && splits(fate.crossing, channels);
    }
    return fate;
}

// The chance that a path with this throughput goes on.
float survival_of(vec3 throughput, uint channels, uint bounces) {
    float red = (channels & 1u) != 0u ? throughput.x : 0.0;
    float green = (channels & 2u) != 0u ? throughput.y : 0.0;
    float blue = (channels & 4u) != 0u ? throughput.z : 0.0;
    return bounces < uint(FIRST_CHANCE) ? 1.0 : min(max(max(red, green), blue), 1.0);
}

// How many rays go on after so many bounces and crossings.
uint rays_on(Fate fate, uint bounces, uint crossings, uint max_bounces) {
    bool spent = fate.passes ? crossings >= uint(MOST_CROSSINGS) : bounces >= max_bounces;
    return spent ? 0u : (fate.splits ? 3u : 1u);
}

// Where a ray meets a surface.
struct Place {
    vec3 d;      // the ray's direction
    vec3 normal; // of the surface, facing the ray's origin; in a cloud, the colour there
    uint object;
};

// The numbers of a pixel's sample that decide what happens at a bounce.
struct Drawn {
    float chance; // under it, glass reflects
    vec2 place;   // in the unit square: where scattered light goes
};

Drawn drawn_at(uvec2 pixel, uint sample_index, uint bits, uint seed, uint bounce) {
    uint index = sample_index == NONE ? 0u : sample_index;
    float chance = 0.0;
    if (scene_has(SCENE_CHANCE)) chance = sample_1d(pixel, index, seed, uint(SAMPLE_FRESNEL) + bounce);
    vec2 place = vec2(0.0);
    SharedSample own = shared_sample(pixel, index, bits);
    if (lighting_has(LIGHTING_PATH)) place = sample_2d(own.pixel, own.index, seed, uint(SAMPLE_SCATTER) + bounce);
    return Drawn(chance, place);
}

// A ray that goes on from a surface.
struct Sent {
    vec3 direction;
    vec3 weight;   // what it keeps of its throughput
    bool reflects; // it stays on the side that it came from
};

#include "materials/cloud.glsl"
#include "materials/diffuse.glsl"
#include "materials/glass.glsl"
#include "materials/mirror.glsl"

// The ray of these channels that goes on.
Sent sent_on(Place place, Fate fate, uint channels, Drawn drawn) {
    switch (object_material_at(place.object)) {
    case uint(MATERIAL_MIRROR): return mirror_sends(place);
    case uint(MATERIAL_GLASS): return glass_sends(place, fate, channels, drawn);
    case uint(MATERIAL_MATTE): return matte_sends(place, drawn);
    case uint(MATERIAL_CLOUD): return cloud_sends(place, drawn);
    }
    return Sent(place.d, vec3(0.0), false);
}

// What of light from `towards` a surface scatters to where the ray came from, but for what is the same for all
// directions.
vec3 lobe(Place place, vec3 towards) {
    if (!scene_has(SCENE_GLOSSY)) return diffuse_lobe(place, towards);
    switch (object_material_at(place.object)) {
    case uint(MATERIAL_DIFFUSE): return diffuse_lobe(place, towards);
    case uint(MATERIAL_MATTE): return diffuse_lobe(place, towards);
    case uint(MATERIAL_CLOUD): return cloud_lobe(place, towards);
    }
    return vec3(0.0);
}

// What of the light that `lobe` left a surface scatters. `albedo` is that of the place.
vec3 scattered(uint object, vec3 light, vec3 albedo) {
    if (!scene_has(SCENE_GLOSSY)) return diffuse_scattered(light, albedo);
    switch (object_material_at(object)) {
    case uint(MATERIAL_DIFFUSE): return diffuse_scattered(light, albedo);
    case uint(MATERIAL_MATTE): return diffuse_scattered(light, albedo);
    case uint(MATERIAL_CLOUD): return albedo * light;
    }
    return vec3(0.0);
}

// A direction that light comes from, drawn by how a lit surface scatters, for u in the unit square.
vec3 lobe_direction(Place place, vec2 u) {
    if (!scene_has(SCENE_GLOSSY)) return diffuse_direction(place, u);
    switch (object_material_at(place.object)) {
    case uint(MATERIAL_DIFFUSE): return diffuse_direction(place, u);
    case uint(MATERIAL_MATTE): return diffuse_direction(place, u);
    case uint(MATERIAL_CLOUD): return cloud_direction(place, u);
    }
    return place.normal;
}

// How densely that draws directions around one, per steradian.
float lobe_density(Place place, vec3 towards) {
    if (!scene_has(SCENE_GLOSSY)) return diffuse_density(place, towards);
    switch (object_material_at(place.object)) {
    case uint(MATERIAL_DIFFUSE): return diffuse_density(place, towards);
    case uint(MATERIAL_MATTE): return diffuse_density(place, towards);
    case uint(MATERIAL_CLOUD): return cloud_density(place, towards);
    }
    return 0.0;
}

// Of each channel, what of light goes straight on through a surface on its way to a place inside `media`: all of it or, where
// it `tints`, what glass does not reflect. `d` is the direction of the shadow ray, `normal` of unit length.
vec3 light_passed(uint object, Media media, uint way, vec3 d, vec3 normal, bool tints) {
    float cosine = min(abs(dot3(d, normal)), 1.0);
    switch (object_material_at(object)) {
    case uint(MATERIAL_GLASS): return glass_light_passed(crossing_of(media, object, way), cosine, tints);
    }
    return vec3(0.0);
}
#endif
