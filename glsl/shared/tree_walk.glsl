// tree_walk: a ray's way through the tree to its nearest hit.
//
// twin    crates/reference/src/grid_trace.rs (hits are those of any structure)
// reads   nodes, polynomials
// A ray remembers which children of the nodes above it it has yet to visit, eight bits a level, and can stop
// after any few nodes. Points whose boxes it meets are set aside, up to four nodes of them, and then solved together:
// lanes that have found some wait for others no longer than that.
#ifndef TREE_WALK_GLSL
#define TREE_WALK_GLSL
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/search.glsl"
#include "stages/tree.glsl"
#include "stages/rays.glsl"
#include "math.glsl"
#include "nearest_hit.glsl"
#include "scene.glsl"
#include "shape.glsl"
#include "state.glsl"
#include "tree.glsl"

#define NODES_AT_ONCE 8u
#define PARALLEL_INVERSE 1e-20 // of a direction: what is less never arrives
#define TREE_ROUNDING 9.5367e-7 // of distances: 2^-20, some steps of rounding of a ray's own and of a hit's

// Bytes of a word, each b as the float 1 + b / 256: two operations, where a conversion takes three.
vec4 bytes_of(uint word) {
    uvec4 shifted = uvec4(word << 15, word << 7, word >> 1, word >> 9);
    return uintBitsToFloat((shifted & 0x7f8000u) | 0x3f800000u);
}

float inverse_of(float d) {
    return 1.0 / (abs(d) > PARALLEL_INVERSE ? d : PARALLEL_INVERSE);
}

// Which of four boxes, lowest and highest bytes of which these are, the ray meets no farther than `nearest`, a bit each.
uint met_four(uvec3 low, uvec3 high, vec3 size, vec3 enters, vec3 leaves, float nearest) {
    bvec3 back = lessThan(size, vec3(0.0));
    uvec3 first = mix(low, high, back), last = mix(high, low, back);
    vec4 near = larger(larger(bytes_of(first.x) * size.x + enters.x, bytes_of(first.y) * size.y + enters.y),
                       larger(bytes_of(first.z) * size.z + enters.z, vec4(0.0)));
    vec4 far = smaller(smaller(bytes_of(last.x) * size.x + leaves.x, bytes_of(last.y) * size.y + leaves.y),
                       smaller(bytes_of(last.z) * size.z + leaves.z, vec4(nearest)));
    return (near.x <= far.x ? 1u : 0u) | (near.y <= far.y ? 2u : 0u) | (near.z <= far.z ? 4u : 0u)
        | (near.w <= far.w ? 8u : 0u);
}

// The children of the node in memory whose boxes the ray meets no farther than `nearest`, a bit each; in bit 8, whether
// it is to visit the last first. `inverse` is one over d.
uint met_children(uint node, vec3 o, vec3 d, vec3 inverse, float nearest) {
    uint at = 4u * node;
    uvec4 frame = node_part_at(at);
    uvec4 a = node_part_at(at + 1u), b = node_part_at(at + 2u), c = node_part_at(at + 3u);
    vec3 size = (256.0 * uintBitsToFloat((frame.w & 255u) << 23)) * inverse;
    vec3 begin = (uintBitsToFloat(frame.xyz) - o) * inverse;
    vec3 margin = TREE_ROUNDING * (abs(begin) + abs(size));
    begin -= size; // what each byte has too much
    vec3 enters = begin - margin, leaves = begin + margin;
    uint met = met_four(a.xyz, uvec3(a.w, b.xy), size, enters, leaves, nearest)
        | met_four(uvec3(b.zw, c.x), c.yzw, size, enters, leaves, nearest) << 4;
    int way = int(frame.w);
    vec3 toward = vec3(bitfieldExtract(way, 16, 5), bitfieldExtract(way, 21, 5), bitfieldExtract(way, 26, 5));
    return (met & (frame.w >> 8) & 255u) | (dot3(toward, d) < 0.0 ? 256u : 0u);
}

// Where a ray is: at the node whose children it visits, with those yet to visit of it and of the nodes above it, eight
// bits each, and a bit each for those that it visits the last first.
struct TreePlace {
    uint node;
    uvec2 pending;
    uint backwards;
};

TreePlace before_root() {
    return TreePlace(0u, uvec2(1u, 0u), 0u); // the root is the first child of what would be above it
}

// Goes on with a ray from where it is; whether it has not ended. With LEAVING it starts on a surface, whose own sheet it
// does not meet again at once, and ends at `any_hit`, if so; an object is `passed`.
bool walk_tree(inout Ray ray, inout TreePlace place, TreeInfo tree, uint work, bool any_hit, uint passed) {
    vec3 o = ray.origin, d = ray.direction;
    vec3 inverse = vec3(inverse_of(d.x), inverse_of(d.y), inverse_of(d.z));
    uint node = place.node, backwards = place.backwards;
    uvec2 pending = place.pending;
    bool alive = ray.cell != NONE;
    Nearest nearest = nearest_of(ray, alive);
    LeftSheet left = left_sheet(ray, alive);
    uint work_left = work;
    while (alive && work_left > 0u) {
        uint looks = NODES_AT_ONCE;
        uint set0 = 0u, set1 = 0u, set2 = 0u, set3 = 0u; // leaves set aside: number and children
        while ((pending.x | pending.y) != 0u && set3 == 0u && looks > 0u) {
            // Up to where children are left.
            bool far_up = pending.x == 0u;
            uint up = uint(findLSB(far_up ? pending.y : pending.x)) / 8u;
            pending = far_up ? uvec2(pending.y, 0u) : pending;
            uint shift = 8u * up;
            uint from_above = shift == 0u ? 0u : pending.y << (32u - shift);
            pending = uvec2((pending.x >> shift) | from_above, pending.y >> shift);
            up += far_up ? 4u : 0u;
            node >>= 3u * up;
            backwards >>= up;

            uint children_left = pending.x & 255u;
            uint child = (backwards & 1u) != 0u ? uint(findMSB(children_left)) : uint(findLSB(children_left));
            pending.x &= ~(1u << child);
            uint below = node * LEAF_POINTS + child;
            bool is_leaf = below >= tree.first_leaf;
            uint met = met_children(is_leaf ? below - tree.gap : below, o, d, inverse, ray.hit_t);
            uint children = met & 255u;
            bool sets_aside = is_leaf && children != 0u;
            bool descends = !is_leaf && children != 0u;
            set3 = sets_aside ? set2 : set3;
            set2 = sets_aside ? set1 : set2;
            set1 = sets_aside ? set0 : set1;
            set0 = sets_aside ? ((below - tree.first_leaf) << 8) | children : set0;
            node = descends ? below : node;
            uvec2 deeper = uvec2((pending.x << 8) | children, (pending.y << 8) | (pending.x >> 24));
            pending = descends ? deeper : pending;
            backwards = descends ? (backwards << 1) | (met >> 8) : backwards;
            --looks;
        }
        uint solved = 0u;
        while (set0 != 0u) {
            uint slot = (set0 >> 8) * LEAF_POINTS + uint(findLSB(set0));
            set0 &= set0 - 1u;
            bool done = (set0 & 255u) == 0u;
            set0 = done ? set1 : set0;
            set1 = done ? set2 : set1;
            set2 = done ? set3 : set2;
            set3 = done ? 0u : set3;
            Polynomial p = polynomial_at(slot);
            // The test of all lists: from far away, what `intersect` says of a ball's rim is a matter of rounding.
            bool near = near_trust_ball(o, d, p.center_trust, ray.hit_t);
            float t = near ? meeting_distance(ray, slot, p, left, passed) : NO_HIT;
            take_nearer(ray, nearest, slot, p, t);
            ++solved;
        }
        ray.tests += solved;
        ray.cells += NODES_AT_ONCE - looks;
        work_left -= min(work_left, solved + (NODES_AT_ONCE - looks) + 2u);
        alive = (pending.x | pending.y) != 0u;
#ifdef LEAVING
        alive = alive && !(any_hit && ray.hit_slot != NONE);
#endif
    }
    place = TreePlace(node, pending, backwards);
    return alive;
}
#endif
