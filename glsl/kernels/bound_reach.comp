// bound_reach: how far the k nearest others of each point of a batch can be, at most.
//
// reads   points
// writes  bounds           d2 of the k-th nearest among the points around it in memory
// runs    one invocation per point of the batch
// twin    none: exact neighbours are one result (points::NeighborSearch)
//
// With FEW, for k up to 16; else up to 64.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/search.glsl"
#include "math.glsl"
#include "index.glsl"
#include "cloud.glsl"
#include "nearest.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = SEARCH_BOUNDS) writeonly buffer Bounds { float bounds[]; };
layout(push_constant) uniform Push { SearchParams params; };

#define AROUND (4u * NEAREST) // points looked at

void main() {
    uint i = list_index();
    if (i >= params.batch_count) return;
    uint place = params.batch_first + i;
    vec3 center = point_position_at(params.first_slot + place);
    uint unused = NEAREST - params.neighbors;
    float d[NEAREST];
#define FIRST(j) d[j] = j < unused ? -1.0 : NO_HIT;
    EACH(FIRST)
    uint last = max(params.point_count, AROUND) - AROUND;
    uint at = min(max(place, AROUND / 2u) - AROUND / 2u, last);
    uint end = min(at + AROUND, params.point_count);
    while (at < end) {
        float square = square_of(point_position_at(params.first_slot + at) - center);
        square = at == place ? NO_HIT : square;
#define SINK(j) d[j] = smaller(d[j], larger(d[j - 1u], square));
        EACH_BUT_FIRST_BACKWARDS(SINK)
        d[0] = smaller(d[0], square);
        ++at;
    }
    bounds[i] = d[NEAREST - 1u];
}
