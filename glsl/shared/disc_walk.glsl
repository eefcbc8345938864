// disc_walk: a camera ray through the points whose discs cover its screen tile (section 4 of the paper).
//
// twin    crates/reference/src/disc_trace.rs
// reads   the lists of screen tiles
//         ranges           first and past-the-last entry of each in keys and slots
//         keys             front to back within a tile
//         slots            the points
// A ray ends where its hit is nearer than all that the list has left, or with the list. The way can end after
// any 32 points; the cursor says where to go on.
#ifndef DISC_WALK_GLSL
#define DISC_WALK_GLSL
#include "disc.glsl"
#include "polynomial.glsl"
#include "records.glsl"
#include "state.glsl"

#ifdef QUEUE
layout(binding = DISC_RANGES_IN) uniform usamplerBuffer disc_ranges; // two values a tile
layout(binding = DISC_KEYS_IN) uniform usamplerBuffer disc_keys; // one each
layout(binding = DISC_SLOTS_IN) uniform usamplerBuffer disc_slots; // four

uvec2 disc_range_of(uint tile) {
    return texelFetch(disc_ranges, int(tile)).xy;
}

uint disc_key_at(uint place) {
    return texelFetch(disc_keys, int(place)).x;
}

uint disc_slot_at(uint place) {
    return texelFetch(disc_slots, int(place / 4u))[place & 3u];
}

uvec4 four_disc_slots_at(uint place) {
    return texelFetch(disc_slots, int(place / 4u));
}
#else
layout(std430, binding = DISC_RANGES_IN) readonly buffer DiscRanges { uvec2 disc_ranges[]; };
layout(std430, binding = DISC_KEYS_IN) readonly buffer DiscKeys { uint disc_keys[]; };
layout(std430, binding = DISC_SLOTS_IN) readonly buffer DiscSlots { uint disc_slots[]; };

uvec2 disc_range_of(uint tile) {
    return disc_ranges[tile];
}

uint disc_key_at(uint place) {
    return disc_keys[place];
}

uint disc_slot_at(uint place) {
    return disc_slots[place];
}

// Those from a multiple of four on; the list has room for four.
uvec4 four_disc_slots_at(uint place) {
    return uvec4(disc_slots[place], disc_slots[place + 1u], disc_slots[place + 2u], disc_slots[place + 3u]);
}
#endif

#define BATCH 32u // points tested before any is solved: one bit each

// Goes on with the ray, whose cell is NONE if it has ended, and afterwards where it has.
void walk_discs(inout Ray ray, uvec2 range, DepthRanks ranks, uint work) {
    vec3 o = ray.origin, d = ray.direction;
    uint rank_mask = (1u << ranks.bits) - 1u;
    uint work_left = work;
    uint next = range.x + ray.cursor;
    bool alive = ray.cell != NONE && next < range.y;
    uint hit_object = NONE, hit_index = NONE;
    if (alive && ray.hit_slot != NONE) {
        Polynomial hit = polynomial_of(ray.hit_slot);
        hit_object = hit.object;
        hit_index = hit.index;
    }

    while (alive && work_left > 0u) {
        uint first = next & ~3u; // slots are read four at a time
        uint end = min(range.y, first + BATCH);
        uint candidates = 0u;
        for (uint at_four = first; at_four < end; at_four += 4u) {
            uvec4 four = four_disc_slots_at(at_four);
            uint near = near_trust_ball(o, d, center_trust_of(four.x), ray.hit_t) ? 1u : 0u;
            near |= near_trust_ball(o, d, center_trust_of(four.y), ray.hit_t) ? 2u : 0u;
            near |= near_trust_ball(o, d, center_trust_of(four.z), ray.hit_t) ? 4u : 0u;
            near |= near_trust_ball(o, d, center_trust_of(four.w), ray.hit_t) ? 8u : 0u;
            candidates |= near << (at_four - first);
        }
        candidates &= (~0u << (next - first)) & (~0u >> (first + BATCH - end)); // next < end
        uint solved = 0u;
        while (candidates != 0u) {
            uint slot = disc_slot_at(first + uint(findLSB(candidates)));
            candidates &= candidates - 1u;
            Polynomial p = polynomial_of(slot);
            float t = intersect(o, d, p, 0.0);
            bool first_of_equals = p.object < hit_object || (p.object == hit_object && p.index < hit_index);
            bool nearer = t < ray.hit_t || (t == ray.hit_t && t < NO_HIT && first_of_equals);
            bool better = nearer && t > ray.after;
            ray.hit_t = better ? t : ray.hit_t;
            ray.hit_slot = better ? slot : ray.hit_slot;
            hit_object = better ? p.object : hit_object;
            hit_index = better ? p.index : hit_index;
            ++solved;
        }
        ray.tests += end - next;
        next = end;
        work_left -= min(work_left, (end - first + 3u) / 4u + solved + 2u);
        bool more = next < range.y;
        uint rank = disc_key_at(more ? next : range.x) & rank_mask;
        alive = more && rank <= depth_rank(ranks, ray.hit_t);
    }
    ray.cell = alive ? ray.cell : NONE;
    ray.cursor = next - range.x;
}
#endif
