// find_neighbors: the k nearest others of each point of a batch (method, section 1).
//
// reads   points, bounds
//         leaves, counts   where to look, by leaf of the batch, or by listed one; NONE: nowhere
//         groups           leaves of the batch, where some are listed
// writes  lists            slots, nearest first, ties by place in the file
//         ties             of UNTIED: 1 for a leaf of which any point met two others at the same distance
// runs    one invocation per point of the batch, or of listed leaves
// twin    none: exact neighbours are one result (points::NeighborSearch)
//
// Sixteen points are measured before any is put into its place among the nearest: one bit each. With FEW,
// for k up to 16; else up to 64. With UNTIED, distances alone are compared: where two are equal, the list
// is not right, and ties says so.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/search.glsl"
#include "math.glsl"
#include "index.glsl"
#include "cloud.glsl"
#include "nearest.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = SEARCH_BOUNDS) readonly buffer Bounds { float bounds[]; };
layout(std430, binding = SEARCH_COUNTS) readonly buffer Counts { uint counts[]; };
layout(std430, binding = NEIGHBORS) writeonly buffer Lists { uint lists[]; };
layout(std430, binding = SEARCH_GROUPS) readonly buffer Groups { uint groups[]; };
#ifdef UNTIED
layout(std430, binding = SEARCH_TIES) writeonly buffer Ties { uint ties[]; };
#endif
layout(push_constant) uniform Push { SearchParams params; };

#define LEAF_MASK ((1u << LEAF_BITS) - 1u)

// Distance and order of one candidate.
struct Key {
    float square;
    uint index;
};

bool before(Key a, Key b) {
    return a.square < b.square || (a.square == b.square && a.index < b.index);
}

uint entry(uint at) {
    uvec4 four = search_leaf_four_at(at);
    uint low = (at & 1u) != 0u ? four.y : four.x;
    uint high = (at & 1u) != 0u ? four.w : four.z;
    return (at & 2u) != 0u ? high : low;
}

// Bits of the points of a leaf within a distance, from the lowest on.
uint measured(uint slot, vec3 center, float bound) {
    uint bits = 0u;
#define MEASURE(j) \
    bits |= square_of(point_position_at(slot + j) - center) <= bound ? 1u << j : 0u;
    FOUR(MEASURE, 0u) FOUR(MEASURE, 4u)
    return bits;
}

void main() {
    uint invocation = list_index();
    uint nth = invocation / LEAF_POINTS;
    if (params.listed != 0u && nth >= params.listed) return;
    uint i = (params.listed != 0u ? groups[nth] : nth) * LEAF_POINTS + invocation % LEAF_POINTS;
    if (i >= params.batch_count) return;
    uint slot = params.first_slot + params.batch_first + i;
    uint end = params.first_slot + params.point_count;
    vec3 center = point_position_at(slot);
    uint list = nth * params.capacity;
    uint count = counts[nth];
    count = count != NONE ? count : 0u;
    uint own_bit = uint(LEAF_BITS) + i % LEAF_POINTS;

    uint unused = NEAREST - params.neighbors;
    float d[NEAREST];
    uint found[NEAREST];
#define FIRST(j) d[j] = j < unused ? -1.0 : NO_HIT; found[j] = NONE;
    EACH(FIRST)
#ifdef UNTIED
    bool tied = false;
#else
    uint index[NEAREST];
#define FIRST_INDEX(j) index[j] = NONE;
    EACH(FIRST_INDEX)
#endif
    float bound = bounds[i];
    Key last = Key(bound, NONE);

    uint done = 0u;
    while (done < count) {
        // Which of the next 32 leaves are for this point.
        uint bits = 0u;
        uint e = 0u;
        while (e < 32u && done + e < count) {
            uvec4 four = search_leaf_four_at(list + done + e);
            uvec4 own = ((four >> own_bit) & 1u) << (uvec4(0u, 1u, 2u, 3u) + e);
            bits |= own.x | own.y | own.z | own.w;
            e += 4u;
        }
        uint left = count - done;
        bits &= left < 32u ? (1u << left) - 1u : NONE;
        while (bits != 0u) {
            uint a = uint(findLSB(bits));
            bits &= bits - 1u;
            bool is_pair = bits != 0u;
            uint b = is_pair ? uint(findLSB(bits)) : a;
            bits = is_pair ? bits & (bits - 1u) : 0u;
            uint slot_a = params.first_slot + (entry(list + done + a) & LEAF_MASK) * LEAF_POINTS;
            uint slot_b = params.first_slot + (entry(list + done + b) & LEAF_MASK) * LEAF_POINTS;
            uint near = measured(slot_a, center, last.square);
            near |= is_pair ? measured(slot_b, center, last.square) << LEAF_POINTS : 0u;
            while (near != 0u) {
                uint j = uint(findLSB(near));
                near &= near - 1u;
                uint other = (j < LEAF_POINTS ? slot_a : slot_b) + j % LEAF_POINTS;
                Point point = point_at(other);
                float square = square_of(point.position - center);
                bool counts = other != slot && other < end;
#ifdef UNTIED
                counts = counts && square <= last.square;
                square = counts ? square : NO_HIT;
                bool sinks = square < d[NEAREST - 1u];
                tied = tied || (counts && square == d[NEAREST - 1u]);
#define SINK(j) { \
    bool passes = square < d[(j) - 1u]; \
    tied = tied || (counts && square == d[(j) - 1u]); \
    found[j] = sinks ? (passes ? found[(j) - 1u] : other) : found[j]; \
    d[j] = sinks ? (passes ? d[(j) - 1u] : square) : d[j]; \
    sinks = passes; \
}
                EACH_BUT_FIRST_BACKWARDS(SINK)
                d[0] = sinks ? square : d[0];
                found[0] = sinks ? other : found[0];
                last.square = smaller(bound, d[NEAREST - 1u]);
#else
                Key key = Key(square, point.index);
                counts = counts && before(key, last);
                key.square = counts ? square : NO_HIT;
                key.index = counts ? point.index : NONE;
                bool sinks = before(key, Key(d[NEAREST - 1u], index[NEAREST - 1u]));
#define SINK(j) { \
    bool passes = before(key, Key(d[(j) - 1u], index[(j) - 1u])); \
    d[j] = sinks ? (passes ? d[(j) - 1u] : key.square) : d[j]; \
    index[j] = sinks ? (passes ? index[(j) - 1u] : key.index) : index[j]; \
    found[j] = sinks ? (passes ? found[(j) - 1u] : other) : found[j]; \
    sinks = passes; \
}
                EACH_BUT_FIRST_BACKWARDS(SINK)
                d[0] = sinks ? key.square : d[0];
                index[0] = sinks ? key.index : index[0];
                found[0] = sinks ? other : found[0];
                bool full = d[NEAREST - 1u] <= bound;
                last.square = full ? d[NEAREST - 1u] : bound;
                last.index = full ? index[NEAREST - 1u] : NONE;
#endif
            }
        }
        done += 32u;
    }
    uint at = i * params.stride;
#define KEEP(j) if (j >= unused) lists[at + j - unused] = found[j];
    EACH(KEEP)
#ifdef UNTIED
    if (tied) ties[i / LEAF_POINTS] = 1u;
#endif
}
