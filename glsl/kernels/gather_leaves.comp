// gather_leaves: the leaves that hold the neighbours of the points of each leaf of a batch.
//
// reads   points, nodes
//         bounds           d2 within which each point of the batch has k others
// writes  leaves           which; in the bits above LEAF_BITS, for which of the points
//         counts           how many; NONE where they were too many, or the search too long
//         groups           leaves of the batch, where some are listed
// runs    one invocation per leaf of the batch, or per listed one; lists and counts lie in that order
// twin    none: exact neighbours are one result (points::NeighborSearch)
//
// Points that are neighbours in memory look for theirs together: a box costs eight tests and one fetch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/search.glsl"
#include "math.glsl"
#include "index.glsl"
#include "cloud.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = SEARCH_BOUNDS) readonly buffer Bounds { float bounds[]; };
layout(std430, binding = SEARCH_LEAVES) writeonly buffer Leaves { uint leaves[]; };
layout(std430, binding = SEARCH_COUNTS) writeonly buffer Counts { uint counts[]; };
layout(std430, binding = SEARCH_GROUPS) readonly buffer Groups { uint groups[]; };
layout(push_constant) uniform Push { SearchParams params; };

// A point of the leaf, and its bound in w; below any distance where the batch has ended.
vec4 ball(uint i) {
    bool is_there = i < params.batch_count;
    uint at = is_there ? i : 0u;
    vec3 center = point_position_at(params.first_slot + params.batch_first + at);
    return vec4(center, is_there ? bounds[at] : -1.0);
}

uint touches(vec4 ball, vec3 low, vec3 high, uint bit) {
    vec3 away = larger(larger(low - ball.xyz, ball.xyz - high), vec3(0.0));
    return square_of(away) <= ball.w ? bit : 0u;
}

void main() {
    uint nth = list_index();
    if (params.listed != 0u && nth >= params.listed) return;
    uint i = (params.listed != 0u ? groups[nth] : nth) * LEAF_POINTS;
    if (i >= params.batch_count) return;
    vec4 b0 = ball(i), b1 = ball(i + 1u), b2 = ball(i + 2u), b3 = ball(i + 3u);
    vec4 b4 = ball(i + 4u), b5 = ball(i + 5u), b6 = ball(i + 6u), b7 = ball(i + 7u);
    uint list = nth * params.capacity;
    uint count = 0u;
    uint steps = 0u;
    uint at = params.root;
    while (at != NONE && count <= params.capacity && steps < LEAF_STEPS) {
        SearchNode node = search_node_at(at);
        vec3 low = node.low, high = node.high;
        uint mask = touches(b0, low, high, 1u) | touches(b1, low, high, 2u) | touches(b2, low, high, 4u)
            | touches(b3, low, high, 8u) | touches(b4, low, high, 16u) | touches(b5, low, high, 32u)
            | touches(b6, low, high, 64u) | touches(b7, low, high, 128u);
        bool touched = mask != 0u && low.x <= high.x;
        bool is_leaf = at < params.leaf_count;
        if (touched && is_leaf) {
            if (count < params.capacity) leaves[list + count] = at | (mask << LEAF_BITS);
            ++count;
        }
        at = touched && !is_leaf ? node.child : node.next;
        ++steps;
    }
    counts[nth] = at == NONE && count <= params.capacity ? count : NONE;
}
