// disc_trace: the nearest hit of each camera ray among the points whose discs cover its screen tile
// (section 4 of the paper).
//
// reads   the ray state, polynomials
//         tiles            first and past-the-last entry of each screen tile in keys and slots
//         keys             front to back within a tile
//         slots            the points
// writes  the ray state    every ray, also those that are done: the images swap after this
//         live             how many rays have not ended yet
// runs    one invocation per pixel of the tile; dispatched until no ray lives
// twin    crates/reference/src/disc_trace.rs
//
// A workgroup is one screen tile. A ray ends where its hit is nearer than all that the list has
// left, or with the list. A pass can end after any 32 points; the cursor says where to go on.
// A ray that `camera_rays` found to miss the grid misses every point.
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#define STATE_WRITES
#define LISTS // of screen tiles, in place of cells
#include "layout.glsl"
#include "math.glsl"
#include "disc.glsl"
#include "polynomial.glsl"
#include "state.glsl"
#include "records.glsl"
#include "index.glsl"

layout(local_size_x = TILE_GROUP) in;
layout(std430, binding = TRACE_LIVE) buffer Live { uint live; };
#ifdef QUEUE
layout(binding = TRACE_KEYS) uniform usamplerBuffer key_texels; // one value each
#else
layout(std430, binding = TRACE_KEYS) readonly buffer Keys { uint keys[]; };
#endif
layout(push_constant) uniform Push { DiscTraceParams params; };

#define BATCH 32u // points tested before any is solved: one bit each

uint key_at(uint place) {
#ifdef QUEUE
    return texelFetch(key_texels, int(place)).x;
#else
    return keys[place];
#endif
}

void main() {
    uvec2 pixel = tile_pixel();
    uint at = tile_ray(params.tile_size);
    Ray ray = load_ray(at);

    vec3 o = ray.origin, d = ray.direction;
    uvec2 tile = pixel / uint(DISC_TILE);
    uvec2 range = range_of(tile.y * screen_tiles(params.tile_size).x + tile.x);
    uint rank_mask = (1u << params.ranks.bits) - 1u;
    uint work_left = params.work;
    uint next = range.x + ray.cursor;
    bool alive = ray.cell != NONE && next < range.y;
    uint hit_object = NONE, hit_index = NONE;
    if (alive && ray.hit_slot != NONE) {
        Polynomial hit = polynomial_of(ray.hit_slot);
        hit_object = hit.object;
        hit_index = hit.index;
    }

    while (alive && work_left > 0u) {
        uint count = min(range.y - next, BATCH);
        uint candidates = 0u;
        for (uint j = 0u; j < count; ++j) {
            bool near = near_trust_ball(o, d, center_trust_of(slot_at(next + j)), ray.hit_t);
            candidates |= near ? 1u << j : 0u;
        }
        uint solved = 0u;
        while (candidates != 0u) {
            uint slot = slot_at(next + uint(findLSB(candidates)));
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
        next += count;
        ray.tests += count;
        work_left -= min(work_left, count + solved + 1u);
        bool more = next < range.y;
        uint rank = key_at(more ? next : range.x) & rank_mask;
        alive = more && rank <= depth_rank(params.ranks, ray.hit_t);
    }

    ray.cell = alive ? ray.cell : NONE;
    ray.cursor = next - range.x;
    store_progress(at, ray);
    if (alive) atomicAdd(live, 1u);
}
