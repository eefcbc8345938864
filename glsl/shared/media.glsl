// media: the objects that a ray is inside, and which of them counts (method, section 4).
//
// twin  crates/reference/src/media.rs
// After Schmidt and Budge, Simple Nested Dielectrics in Ray Traced Images (2002): a ray carries the
// set of glass objects that it is inside, a hit on one toggles its membership, and the member of the
// highest priority is the medium (ties: the last in the scene). Whoever includes this has media_word(ray, word),
// and tells the count of media. Where a scene has one object of glass, that is the one member there may be, but for
// an object of spheres, which is a member once for each sphere that the ray is inside.
#ifndef MEDIA_GLSL
#define MEDIA_GLSL
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/wave.glsl"
#include "math.glsl"
#include "members.glsl"
#include "objects.glsl"
#include "scene.glsl"

#define MOST_MEDIA (2u * uint(MEDIA_WORDS)) // a ray inside more forgets the last it entered

// What a ray is inside.
struct Media {
    uint ray;
    uint count;
};

uint member_of(Media media, uint nth) {
    return member_in(media_word(media.ray, nth / 2u), nth);
}

bool outranks(uint a, uint b) {
    int of_a = object_at(a).priority, of_b = object_at(b).priority;
    return of_a > of_b || (of_a == of_b && a > b);
}

// The member of the highest priority, apart from `skipped`; NONE: the ray is outside everything.
uint medium_without(Media media, uint skipped) {
    if (!scene_has(SCENE_NESTED)) {
        uint member = member_of(media, 0u);
        return media.count > 0u && member != skipped ? member : NONE;
    }
    uint best = NONE;
    for (uint i = 0u; i < media.count; ++i) {
        uint member = member_of(media, i);
        bool better = best == NONE || outranks(member, best == NONE ? member : best);
        best = member != skipped && better ? member : best;
    }
    return best;
}

// The place of an object among the members, or how many there are.
uint place_of(Media media, uint object) {
    if (!scene_has(SCENE_NESTED)) return 0u;
    uint place = media.count;
    for (uint i = 0u; i < media.count; ++i) {
        place = member_of(media, i) == object ? i : place;
    }
    return place;
}

// A ray's way through the surface of a glass object.
struct Crossing {
    uint before; // the medium that it comes from, or NONE
    uint after;  // the one that it would go on in, or NONE
    uint place;  // of the object among the members; their count: it is entered; NONE: neither entered nor left
};

// Which way a ray goes through a surface.
#define WAY_EITHER 0u // into the object, unless it is inside
#define WAY_IN 1u
#define WAY_OUT 2u

// Spheres of an object that overlap are one body: how many of them the ray is inside.
uint times_in(Media media, uint object) {
    uint times = 0u;
    for (uint i = 0u; i < media.count; ++i) times += member_of(media, i) == object ? 1u : 0u;
    return times;
}

Crossing crossing_of(Media media, uint object, uint way) {
    uint place = place_of(media, object);
    bool leaves = place < media.count;
    uint others = NONE;
    bool rules = true;
    if (scene_has(SCENE_NESTED)) {
        others = medium_without(media, object);
        rules = others == NONE || outranks(object, others == NONE ? object : others);
    }
    uint with = rules ? object : others;
    uint before = leaves ? with : others, after = leaves ? others : with;
    if (scene_has(SCENE_SPHERES)) {
        uint times = times_in(media, object);
        bool goes_in = way == WAY_IN, goes_out = way == WAY_OUT;
        uint beside = times > (goes_in ? 0u : 1u) ? with : others;
        before = goes_in ? beside : (goes_out ? with : before);
        after = goes_in ? with : (goes_out ? beside : after);
        place = goes_in ? media.count : (goes_out && times == 0u ? NONE : place);
    }
    return Crossing(before, after, place);
}

vec3 ior_of(uint medium) {
    vec3 ior = object_at(medium == NONE ? 0u : medium).ior;
    return medium == NONE ? vec3(1.0) : ior;
}

// Whether a ray of these channels goes through as if there were nothing: the medium stays, or has the same index.
bool passes(Crossing crossing, uint channels) {
    bool passed = crossing.before == crossing.after;
    if (scene_has(SCENE_CLEAR)) {
        bvec3 differs = notEqual(ior_of(crossing.before), ior_of(crossing.after));
        bvec3 carried = notEqual(uvec3(channels) & uvec3(1u, 2u, 4u), uvec3(0u));
        bvec3 bent = equal(uvec3(differs) & uvec3(carried), uvec3(1u));
        passed = passed || !any(bent);
    }
    return passed;
}

bool disperses(uint medium) {
    vec3 ior = ior_of(medium);
    return ior.x != ior.y || ior.y != ior.z;
}

// Whether a ray becomes one a channel at this crossing.
bool splits(Crossing crossing, uint channels) {
    return scene_has(SCENE_DISPERSES) && (channels & uint(CHANNELS_ALL)) == uint(CHANNELS_ALL)
        && (disperses(crossing.before) || disperses(crossing.after));
}

// What of the light comes through a way inside a medium.
vec3 transmittance(uint medium, float way) {
    vec3 absorption = object_at(medium == NONE ? 0u : medium).absorption;
    vec3 depth = medium == NONE ? vec3(0.0) : absorption * way;
    return vec3(exp_negative(-depth.x), exp_negative(-depth.y), exp_negative(-depth.z));
}
#endif
