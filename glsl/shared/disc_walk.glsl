// disc_walk: a camera ray through the points whose discs cover its screen tile (section 4 of the paper).
//
// twin    crates/reference/src/disc_trace.rs
// reads   the lists of screen tiles
//         ranges           first and past-the-last entry of each in keys and slots
//         keys             front to back within a tile
//         leaves           four at a time, and which of their points cover the tile
// A ray ends where its hit is nearer than all that the list has left, or with the list. The way can end after
// any four leaves; the cursor says where to go on.
#ifndef DISC_WALK_GLSL
#define DISC_WALK_GLSL
#include "stages/points.glsl"
#include "stages/search.glsl"
#include "stages/discs.glsl"
#include "disc.glsl"
#include "levels.glsl"
#ifdef PACKETS
#include "packet.glsl"
#endif
#include "nearest_hit.glsl"
#include "state.glsl"

#define LEAF_MASK ((1u << LEAF_BITS) - 1u)
#define LEAVES_AT_ONCE 4u // a bit for each of their points

uint one_of(uvec4 four, uint i) {
    return i < 2u ? (i == 0u ? four.x : four.y) : (i == 2u ? four.z : four.w);
}

uint slot_of_bit(uvec4 leaves, uint bit) {
    return (one_of(leaves, bit / LEAF_POINTS) & LEAF_MASK) * LEAF_POINTS + bit % LEAF_POINTS;
}

// Which points of four leaves the list has from `next` on and before `end`, a bit each.
uint listed_points(uvec4 leaves, uint first, uint next, uint end) {
    uvec4 points = leaves >> LEAF_BITS;
    uint all = (points.x | (points.y << LEAF_POINTS)) | ((points.z << (2u * LEAF_POINTS)) | (points.w << (3u * LEAF_POINTS)));
    uint before = LEAF_POINTS * (next - first), behind = LEAF_POINTS * (first + LEAVES_AT_ONCE - end);
    return all & (~0u << before) & (~0u >> behind); // next < end
}

#ifdef PACKETS
// Which of those points a ray of the packet may meet: each lane asks for one of a leaf. What is voted on is which the
// packet misses, so that of a lane that should be absent nothing is lost.
uint met_by_packet(uint points, uvec4 leaves, Packet packet, vec3 eye) {
    uint missed = 0u;
    for (uint i = 0u; i < LEAVES_AT_ONCE; ++i) {
        uint shift = LEAF_POINTS * i;
        if (((points >> shift) & 255u) != 0u) {
            vec4 ball = polynomial_center_trust_at(slot_of_bit(leaves, shift + packet_lane()));
            vec3 from_eye = ball.xyz - eye;
            missed |= packet_ballot(!meets_packet(packet, from_eye, disc_radius(from_eye, ball.w))) << shift;
        }
    }
    return points & ~missed;
}
#endif

// A ray that misses the boxes of all grids misses every point, and tests none.
void begin_discs(inout Ray ray) {
    if (ray.cell == RAY_STARTS) ray.cell = enter_scene(ray.origin, ray.direction, 0.0);
}

// Goes on with the ray, whose cell is NONE if it has ended, and afterwards where it has. In PACKETS the rays of one
// go together, from the beginning of their list.
#ifdef PACKETS
void walk_discs(inout Ray ray, uvec2 range, DepthRanks ranks, uint work, Packet packet) {
#else
void walk_discs(inout Ray ray, uvec2 range, DepthRanks ranks, uint work) {
#endif
    vec3 o = ray.origin, d = ray.direction;
    uint rank_mask = (1u << ranks.bits) - 1u;
    uint work_left = work;
    uint next = range.x + ray.cursor;
    bool alive = ray.cell != NONE && next < range.y;
    Nearest nearest = nearest_of(ray, alive);

#ifdef PACKETS
    while (packet_ballot(alive) != 0u && work_left > 0u) {
#else
    while (alive && work_left > 0u) {
#endif
        uint first = next & ~(LEAVES_AT_ONCE - 1u);
        uint end = min(range.y, first + LEAVES_AT_ONCE);
        uvec4 leaves = disc_leaf_four_at(first);
        uint asked = listed_points(leaves, first, next, end);
        ray.tests += alive ? uint(bitCount(asked)) : 0u;
#ifdef PACKETS
        asked = met_by_packet(asked, leaves, packet, o);
#endif
        uint tested = uint(bitCount(asked));
        uint candidates = 0u;
        while (asked != 0u) {
            uint bit = uint(findLSB(asked));
            asked &= asked - 1u;
            bool near = near_trust_ball(o, d, polynomial_center_trust_at(slot_of_bit(leaves, bit)), ray.hit_t);
            candidates |= near && alive ? 1u << bit : 0u;
        }
        while (candidates != 0u) {
            uint slot = slot_of_bit(leaves, uint(findLSB(candidates)));
            candidates &= candidates - 1u;
            Polynomial p = polynomial_at(slot);
            take_nearer(ray, nearest, slot, p, intersect(o, d, p, 0.0));
        }
        next = end;
        work_left -= min(work_left, 2u * tested + 2u); // the same for all of a packet
        bool more = next < range.y;
        uint rank = disc_key_at(more ? next : range.x) & rank_mask;
        alive = alive && more && rank <= depth_rank(ranks, ray.hit_t);
    }
    ray.cell = alive ? ray.cell : NONE;
    ray.cursor = next - range.x;
}
#endif
