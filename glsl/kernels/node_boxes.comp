// node_boxes: the box around each LEAF_POINTS consecutive boxes of the level below.
//
// reads   nodes            the level below
// writes  nodes            one level
// runs    one invocation per box
// twin    none: exact neighbours are one result (points::NeighborSearch)
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/search.glsl"
#include "index.glsl"
#include "node.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = SEARCH_NODES) buffer Nodes { SearchNode nodes[]; };
layout(push_constant) uniform Push { LevelParams params; };

void main() {
    uint i = list_index();
    if (i >= params.count) return;
    uint below = params.offsets[params.level - 1u];
    uint child = below + i * LEAF_POINTS;
    uint end = min(child + LEAF_POINTS, params.offsets[params.level]);
    vec3 low = vec3(NOTHING), high = vec3(-NOTHING);
    uint at = child;
    while (at < end) {
        low = min(low, nodes[at].low);
        high = max(high, nodes[at].high);
        ++at;
    }
    nodes[params.offsets[params.level] + i] = SearchNode(low, child, high, next_node(params, i));
}
