// leaf_boxes: the box around each LEAF_POINTS consecutive points of an object.
//
// reads   points
// writes  nodes            the first level; behind the object's last point, empty boxes
// runs    one invocation per box
// twin    none: exact neighbours are one result (points::NeighborSearch)
//
// Of points that coincide, only the first k + 1 can be neighbours of any point. A leaf that lies behind so
// many, with all its points in the same place, is empty too: so a million of them cost no more than others.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/search.glsl"
#include "index.glsl"
#include "node.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = SEARCH_NODES) writeonly buffer Nodes { SearchNode nodes[]; };
layout(push_constant) uniform Push { LevelParams params; };

// Whether the k + 1 points before this one lie where it does, in the order of the file.
bool is_crowded(uint place) {
    uint slot = params.first_slot + place;
    uint left = place > params.neighbors ? params.neighbors + 1u : 0u;
    bool same = left > 0u;
    while (left > 0u && same) {
        Point before = point_at(slot - 1u), at = point_at(slot);
        same = before.position == at.position && before.index < at.index;
        --slot;
        --left;
    }
    return same;
}

void main() {
    uint i = list_index();
    if (i >= params.count) return;
    uint place = i * LEAF_POINTS;
    uint end = min(place + LEAF_POINTS, params.point_count);
    vec3 low = vec3(NOTHING), high = vec3(-NOTHING);
    bool ordered = true;
    uint at = place;
    while (at < end) {
        Point p = point_at(params.first_slot + at);
        uint before = point_at(params.first_slot + max(at, 1u) - 1u).index;
        ordered = ordered && (at == place || before < p.index);
        low = min(low, p.position);
        high = max(high, p.position);
        ++at;
    }
    bool coincide = place < end && low == high && ordered;
    bool crowded = is_crowded(coincide ? place : 0u);
    nodes[i] = SearchNode(crowded ? vec3(NOTHING) : low, NONE, crowded ? vec3(-NOTHING) : high,
                          next_node(params, i));
}
