// fit_polynomials: the local polynomial of each point of one batch (method, section 1).
//
// reads   points           every point of the scene
//         neighbors        per point of the batch, nearest first, slots; NONE fills up
// writes  polynomials      one a point, in world form
//         outcomes         how each fit ended
// runs    one invocation per point of the batch
// twin    crates/reference/src/fit_polynomials.rs
//
// Lengths are divided by h first. full -> incomplete -> plane -> no surface, each where the one
// before is singular.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "layout.glsl"
#include "math.glsl"
#include "eigen.glsl"
#include "fit.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = FIT_POINTS) readonly buffer Points { Point points[]; };
layout(std430, binding = FIT_NEIGHBORS) readonly buffer Neighbors { uint neighbors[]; };
layout(std430, binding = FIT_POLYNOMIALS) writeonly buffer Polynomials { Polynomial polynomials[]; };
layout(std430, binding = FIT_OUTCOMES) writeonly buffer Outcomes { FitOutcome outcomes[]; };
layout(push_constant) uniform Push { FitParams params; };

#define SMALLEST_FEATURE 1e-15   // h under this: every neighbour lies on the point

vec3 neighbor_offset(uint list, uint j, vec3 center) {
    return points[neighbors[list + j]].position - center;
}

// How many distinct positions the neighbourhood holds, the point included; counted up to 6.
uint count_distinct(uint list, uint count, vec3 center) {
    uint distinct = 1u;
    uint j = 0u;
    while (j < count && distinct < 6u) {
        vec3 y = neighbor_offset(list, j, center);
        bool seen = y == vec3(0.0);
        uint i = 0u;
        while (i < j && !seen) {
            seen = neighbor_offset(list, i, center) == y;
            ++i;
        }
        distinct += seen ? 0u : 1u;
        ++j;
    }
    return distinct;
}

void main() {
    uint i = list_index();
    if (i >= params.point_count) return;
    uint slot = params.first_slot + i;
    uint list = (slot - params.first_listed) * params.neighbors;
    vec3 center = points[slot].position;

    uint count = 0u;
    while (count < params.neighbors && neighbors[list + min(count, params.neighbors - 1u)] != NONE) ++count;
    vec3 farthest = count > 0u ? neighbor_offset(list, max(count, 1u) - 1u, center) : vec3(0.0);
    float reach = sqrt(dot3(farthest, farthest));
    float h = params.feature_size > 0.0 ? params.feature_size : reach;
    bool spread_out = h > SMALLEST_FEATURE && reach > SMALLEST_FEATURE;
    float inverse_h = 1.0 / (spread_out ? h : 1.0);

    // The point itself is the first term of every sum: weight 1 at the origin.
    float total = 1.0;
    vec3 sum = vec3(0.0);
    for (uint j = 0u; j < count; ++j) {
        vec3 y = neighbor_offset(list, j, center) * inverse_h;
        float weight = exp_negative(-dot3(y, y));
        total += weight;
        sum += weight * y;
    }
    vec3 mean = sum / total;
    vec3 diagonal = mean * mean;
    vec3 off = vec3(mean.x * mean.y, mean.x * mean.z, mean.y * mean.z);
    for (uint j = 0u; j < count; ++j) {
        vec3 y = neighbor_offset(list, j, center) * inverse_h;
        float weight = exp_negative(-dot3(y, y));
        vec3 c = y - mean;
        vec3 wc = weight * c;
        diagonal += wc * c;
        off += vec3(wc.x * c.y, wc.x * c.z, wc.y * c.z);
    }
    vec3 values, n, u;
    eigen_symmetric(diagonal, off, values, n, u);
    n = normalize3(n);
    vec3 v = cross3(n, u);

    NormalEquations eq = no_samples();
    add_sample(eq, 0.0, 0.0, 0.0, 1.0);
    for (uint j = 0u; j < count; ++j) {
        vec3 y = neighbor_offset(list, j, center) * inverse_h;
        add_sample(eq, dot3(y, u), dot3(y, v), dot3(y, n), exp_negative(-dot3(y, y)));
    }

    uint distinct = count_distinct(list, count, center);
    bool spans_plane = values.y > COLLINEAR * values.z;
    float c[6];
    uint kind = fit_coefficients(eq, spread_out && spans_plane ? params.polynomial : FIT_NO_SURFACE, distinct, c);
    float trust = kind != FIT_NO_SURFACE ? params.trust * h : 0.0;
    polynomials[slot] =
        to_world(center, trust, h, inverse_h, n, u, v, c, params.object, points[slot].index);
    outcomes[slot] = FitOutcome(trust, kind, h);
}
