// gather_leaves: the leaves that hold the neighbours of the points of each leaf of a batch.
//
// reads   points, nodes
//         bounds           d2 within which each point of the batch has k others
// writes  bounds           the same, where a point beside it has a better one
//         leaves           which; in the bits above LEAF_BITS, for which of the points
//         counts           how many; NONE where they were too many, or the search too long
//         groups           leaves of the batch, where some are listed
// runs    one invocation per leaf of the batch, or per listed one; lists and counts lie in that order
// twin    points::NeighborSearch (exact neighbours are one result)
//
// Points that are neighbours in memory look for theirs together: a box costs eight tests and one fetch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "layout.glsl"
#include "math.glsl"
#include "index.glsl"
#include "cloud.glsl"

layout(local_size_x = LINE_GROUP) in;
WORDS(SEARCH_POINTS, points);
WORDS(SEARCH_NODES, nodes); // two a box
layout(std430, binding = SEARCH_BOUNDS) buffer Bounds { float bounds[]; };
layout(std430, binding = SEARCH_LEAVES) writeonly buffer Leaves { uint leaves[]; };
layout(std430, binding = SEARCH_COUNTS) writeonly buffer Counts { uint counts[]; };
layout(std430, binding = SEARCH_GROUPS) readonly buffer Groups { uint groups[]; };
layout(push_constant) uniform Push { SearchParams params; };

// A point of the leaf, and its bound in w; below any distance where the batch has ended.
vec4 ball(uint i) {
    bool is_there = i < params.batch_count;
    uint at = is_there ? i : 0u;
    vec3 center = uintBitsToFloat(words_of(points, params.first_slot + params.batch_first + at).xyz);
    return vec4(center, is_there ? bounds[at] : -1.0);
}

#define NO_REACH 1e18   // of balls that say nothing about others
#define MARGIN 1.00001  // more than the roundings between a distance and its square

float reach_of(vec4 ball) {
    return ball.w >= 0.0 && ball.w < NO_REACH * NO_REACH ? sqrt(ball.w) : NO_REACH;
}

// Where a point has k others within r, another has as many within r and the way between the two.
void relax(inout float a, inout float b, vec3 way, float reach_a, float reach_b) {
    float apart = sqrt(square_of(way));
    a = min(a, apart + reach_b);
    b = min(b, apart + reach_a);
}

vec4 relaxed(vec4 ball, float reach) {
    return vec4(ball.xyz, ball.w < 0.0 ? ball.w : min(ball.w, reach * reach * MARGIN + 1e-37));
}

void keep_bound(uint i, vec4 ball) {
    if (i < params.batch_count) bounds[i] = ball.w;
}

uint touches(vec4 ball, vec3 low, vec3 high, uint bit) {
    vec3 away = max(max(low - ball.xyz, ball.xyz - high), vec3(0.0));
    return square_of(away) <= ball.w ? bit : 0u;
}

void main() {
    uint nth = list_index();
    if (params.listed != 0u && nth >= params.listed) return;
    uint i = (params.listed != 0u ? groups[nth] : nth) * LEAF_POINTS;
    if (i >= params.batch_count) return;
    vec4 b0 = ball(i), b1 = ball(i + 1u), b2 = ball(i + 2u), b3 = ball(i + 3u);
    vec4 b4 = ball(i + 4u), b5 = ball(i + 5u), b6 = ball(i + 6u), b7 = ball(i + 7u);
    float s0 = reach_of(b0), s1 = reach_of(b1), s2 = reach_of(b2), s3 = reach_of(b3);
    float s4 = reach_of(b4), s5 = reach_of(b5), s6 = reach_of(b6), s7 = reach_of(b7);
    float r0 = s0, r1 = s1, r2 = s2, r3 = s3, r4 = s4, r5 = s5, r6 = s6, r7 = s7;
#define RELAX(i, j) relax(r##i, r##j, b##i.xyz - b##j.xyz, s##i, s##j);
    RELAX(0, 1) RELAX(0, 2) RELAX(0, 3) RELAX(0, 4) RELAX(0, 5) RELAX(0, 6) RELAX(0, 7)
    RELAX(1, 2) RELAX(1, 3) RELAX(1, 4) RELAX(1, 5) RELAX(1, 6) RELAX(1, 7)
    RELAX(2, 3) RELAX(2, 4) RELAX(2, 5) RELAX(2, 6) RELAX(2, 7)
    RELAX(3, 4) RELAX(3, 5) RELAX(3, 6) RELAX(3, 7)
    RELAX(4, 5) RELAX(4, 6) RELAX(4, 7) RELAX(5, 6) RELAX(5, 7) RELAX(6, 7)
#define TAKE(j) b##j = relaxed(b##j, r##j); keep_bound(i + uint(j), b##j);
    TAKE(0) TAKE(1) TAKE(2) TAKE(3) TAKE(4) TAKE(5) TAKE(6) TAKE(7)

    uint list = nth * params.capacity;
    uint count = 0u;
    uint steps = 0u;
    uint at = params.root;
    while (at != NONE && count <= params.capacity && steps < LEAF_STEPS) {
        uvec4 first = words_of(nodes, 2u * at), second = words_of(nodes, 2u * at + 1u);
        vec3 low = uintBitsToFloat(first.xyz), high = uintBitsToFloat(second.xyz);
        uint mask = touches(b0, low, high, 1u) | touches(b1, low, high, 2u) | touches(b2, low, high, 4u)
            | touches(b3, low, high, 8u) | touches(b4, low, high, 16u) | touches(b5, low, high, 32u)
            | touches(b6, low, high, 64u) | touches(b7, low, high, 128u);
        bool touched = mask != 0u && low.x <= high.x;
        bool is_leaf = at < params.leaf_count;
        if (touched && is_leaf) {
            if (count < params.capacity) leaves[list + count] = at | (mask << LEAF_BITS);
            ++count;
        }
        at = touched && !is_leaf ? first.w : second.w;
        ++steps;
    }
    counts[nth] = at == NONE && count <= params.capacity ? count : NONE;
}
