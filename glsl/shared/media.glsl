// media: the objects that a ray is inside, and which of them counts (method, section 4).
//
// twin  crates/reference/src/media.rs
// After Schmidt and Budge, Simple Nested Dielectrics in Ray Traced Images (2002): a ray carries the
// set of glass objects that it is inside, a hit on one toggles its membership, and the member of the
// highest priority is the medium (ties: the last in the scene). Whoever includes this has buffers
// `objects` and `paths`.
#ifndef MEDIA_GLSL
#define MEDIA_GLSL
#include "layout.glsl"
#include "math.glsl"

#define MOST_MEDIA (2u * uint(MEDIA_WORDS)) // a ray inside more forgets the last it entered

uint member_of(uint ray, uint nth) {
    return bitfieldExtract(paths[ray].media[nth / 2u], 16 * int(nth & 1u), 16);
}

bool outranks(uint a, uint b) {
    int of_a = objects[a].priority, of_b = objects[b].priority;
    return of_a > of_b || (of_a == of_b && a > b);
}

// The member of the highest priority, apart from `skipped`; NONE: the ray is outside of everything.
uint medium_without(uint ray, uint skipped) {
    uint best = NONE;
    for (uint i = 0u; i < paths[ray].media_count; ++i) {
        uint member = member_of(ray, i);
        bool better = best == NONE || outranks(member, best == NONE ? member : best);
        best = member != skipped && better ? member : best;
    }
    return best;
}

// The place of an object among the members, or how many there are.
uint place_of(uint ray, uint object) {
    uint place = paths[ray].media_count;
    for (uint i = 0u; i < paths[ray].media_count; ++i) {
        place = member_of(ray, i) == object ? i : place;
    }
    return place;
}

// A ray's way through the surface of a glass object.
struct Crossing {
    uint before; // the medium that it comes from, or NONE
    uint after;  // the one that it would go on in, or NONE
    uint place;  // of the object among the members; their count: it is entered
};

Crossing crossing_of(uint ray, uint object) {
    uint place = place_of(ray, object);
    bool leaves = place < paths[ray].media_count;
    uint others = medium_without(ray, object);
    bool rules = others == NONE || outranks(object, others == NONE ? object : others);
    uint with = rules ? object : others;
    return Crossing(leaves ? with : others, leaves ? others : with, place);
}

vec3 ior_of(uint medium) {
    return medium == NONE ? vec3(1.0) : objects[medium == NONE ? 0u : medium].ior;
}

bool disperses(uint medium) {
    vec3 ior = ior_of(medium);
    return ior.x != ior.y || ior.y != ior.z;
}

// Whether a ray becomes one a channel at this crossing.
bool splits(Crossing crossing, uint channels) {
    return (channels & uint(CHANNELS_ALL)) == uint(CHANNELS_ALL) && (disperses(crossing.before) || disperses(crossing.after));
}

// What of the light comes through a way inside a medium.
vec3 transmittance(uint medium, float way) {
    vec3 depth = medium == NONE ? vec3(0.0) : objects[medium == NONE ? 0u : medium].absorption * way;
    return vec3(exp_negative(-depth.x), exp_negative(-depth.y), exp_negative(-depth.z));
}
#endif
