// fit_polynomials: the local polynomial of each point of one batch (method, section 1).
//
// reads   points           every point of the scene
//         sizes            h by slot, where params.feature_size asks for it
//         neighbors        per point of the batch, nearest first, slots; NONE fills up
// writes  polynomials      one a point, in world form
//         outcomes         how each fit ended
//         rims             of the batch's points, where params.rim_limit asks for them
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
#include "gap.glsl"
#include "rim.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = FIT_POINTS) readonly buffer Points { Point points[]; };
layout(std430, binding = FIT_NEIGHBORS) readonly buffer Neighbors { uint neighbors[]; };
layout(std430, binding = FIT_POLYNOMIALS) writeonly buffer Polynomials { Polynomial polynomials[]; };
layout(std430, binding = FIT_OUTCOMES) writeonly buffer Outcomes { FitOutcome outcomes[]; };
layout(std430, binding = FIT_SIZES) readonly buffer Sizes { float sizes[]; };
layout(std430, binding = FIT_RIMS) writeonly buffer Rims { Rim rims[]; };
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

// How far along e, in units of the reach of the neighbours, the surface goes on; no steps: not asked.
float reach_of_rim(uint list, uint count, vec3 center, float inverse_reach, vec3 e, uint steps) {
    float s = 0.0;
    for (uint i = 0u; i < steps; ++i) {
        Centroid c = centroid_at(s);
        for (uint j = 0u; j < count; ++j) add_neighbor(c, neighbor_offset(list, j, center) * inverse_reach, e, s);
        s = step_to_rim(c, s, params.rim_limit);
    }
    return max(s, RIM_LEAST);
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
    if (params.feature_size < 0.0) h = sizes[slot];
    bool spread_out = h > SMALLEST_FEATURE && reach > SMALLEST_FEATURE;
    float inverse_h = 1.0 / (spread_out ? h : 1.0);

    float weight_square = params.weight_scale * params.weight_scale;

    // The point itself is the first term of every sum: weight 1 at the origin.
    float total = 1.0;
    vec3 sum = vec3(0.0);
    for (uint j = 0u; j < count; ++j) {
        vec3 y = neighbor_offset(list, j, center) * inverse_h;
        float weight = exp_negative(-dot3(y, y) * weight_square);
        total += weight;
        sum += weight * y;
    }
    vec3 mean = sum / total;
    vec3 diagonal = mean * mean;
    vec3 off = vec3(mean.x * mean.y, mean.x * mean.z, mean.y * mean.z);
    for (uint j = 0u; j < count; ++j) {
        vec3 y = neighbor_offset(list, j, center) * inverse_h;
        float weight = exp_negative(-dot3(y, y) * weight_square);
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
        add_sample(eq, dot3(y, u), dot3(y, v), dot3(y, n), exp_negative(-dot3(y, y) * weight_square));
    }

    uint distinct = count_distinct(list, count, center);
    bool spans_plane = values.y > COLLINEAR * values.z;
    float c[6];
    uint kind = fit_coefficients(eq, spread_out && spans_plane ? params.polynomial : FIT_NO_SURFACE, distinct, c);
    float reach_needed = 0.0;
    float openness = 0.0;
    bool finds_rims = params.rim_limit > 0.0;
    if ((params.close_gaps != 0u || finds_rims) && kind != FIT_NO_SURFACE) {
        vec4 e0 = vec4(UNBOUNDED), e1 = e0, e2 = e0, e3 = e0, e4 = e0, e5 = e0;
        for (uint j = 0u; j < count; ++j) {
            vec3 y = neighbor_offset(list, j, center) * inverse_h;
            vec2 q = vec2(dot3(y, u), dot3(y, v));
            float half_square = 0.5 * (q.x * q.x + q.y * q.y);
            e0 = narrow(e0, GAP_COSINES[0], GAP_SINES[0], q, half_square);
            e1 = narrow(e1, GAP_COSINES[1], GAP_SINES[1], q, half_square);
            e2 = narrow(e2, GAP_COSINES[2], GAP_SINES[2], q, half_square);
            e3 = narrow(e3, GAP_COSINES[3], GAP_SINES[3], q, half_square);
            e4 = narrow(e4, GAP_COSINES[4], GAP_SINES[4], q, half_square);
            e5 = narrow(e5, GAP_COSINES[5], GAP_SINES[5], q, half_square);
        }
        float f0 = extent_of_cell(e0, GAP_COSINES[0], GAP_SINES[0], c);
        float f1 = extent_of_cell(e1, GAP_COSINES[1], GAP_SINES[1], c);
        float f2 = extent_of_cell(e2, GAP_COSINES[2], GAP_SINES[2], c);
        float f3 = extent_of_cell(e3, GAP_COSINES[3], GAP_SINES[3], c);
        float f4 = extent_of_cell(e4, GAP_COSINES[4], GAP_SINES[4], c);
        float f5 = extent_of_cell(e5, GAP_COSINES[5], GAP_SINES[5], c);
        bool closed = bounded(e0) && bounded(e1) && bounded(e2) && bounded(e3) && bounded(e4) && bounded(e5);
        float square = max(max(max(f0, f1), max(f2, f3)), max(f4, f5));
        reach_needed = closed && params.close_gaps != 0u ? GAP_MARGIN * sqrt(square) : 0.0;
        float extent = max(max(max(farthest_of(e0), farthest_of(e1)), max(farthest_of(e2), farthest_of(e3))),
                           max(farthest_of(e4), farthest_of(e5)));
        openness = extent * (h / reach);
    }
    float ratio = max(params.trust, min(reach_needed, 1.0));
    float trust = kind != FIT_NO_SURFACE ? ratio * h : 0.0;
    polynomials[slot] =
        to_world(center, trust, h, inverse_h, n, u, v, c, params.object, points[slot].index);
    outcomes[slot] = FitOutcome(trust, kind, h);

    float mean_u = dot3(mean, u), mean_v = dot3(mean, v);
    float away = sqrt(mean_u * mean_u + mean_v * mean_v);
    bool open = finds_rims && openness > RIM_OPEN && away > RIM_SHORTEST;
    vec3 outward = open ? -((mean_u * u + mean_v * v) / away) : vec3(0.0);
    float inverse_reach = 1.0 / (open ? reach : 1.0);
    float s = reach_of_rim(list, count, center, inverse_reach, outward, open ? RIM_STEPS : 0u);
    if (finds_rims)
        rims[i] = Rim(float[3](outward.x, outward.y, outward.z), open ? s * reach : 0.0, open ? openness : 0.0);
}
