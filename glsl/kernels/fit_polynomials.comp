// fit_polynomials: the local polynomial of each point of one batch (method, section 1).
//
// reads   points           every point of the scene
//         sizes            h by slot, where params.feature_size asks for it
//         neighbors        per point of the batch, nearest first, slots; NONE fills up to a multiple of four
// writes  polynomials      one a point, in world form
//         outcomes         how each fit ended
//         rims             of the batch's points, where params.rim_limit asks for them
// runs    one invocation per point of the batch
// twin    crates/reference/src/fit_polynomials.rs
//
// With FEW, for lists of up to 16, which are then read once and kept. Lengths are divided by h first. full -> incomplete -> plane -> no surface, each where the one
// before is singular.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "math.glsl"
#include "eigen.glsl"
#include "fit.glsl"
#include "gap.glsl"
#include "rim.glsl"
#include "index.glsl"
#include "nearest.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = POLYNOMIALS) writeonly buffer Polynomials { Polynomial polynomials[]; };
layout(std430, binding = OUTCOMES) writeonly buffer Outcomes { FitOutcome outcomes[]; };
layout(std430, binding = SIZES) readonly buffer Sizes { float sizes[]; };
layout(std430, binding = RIMS) writeonly buffer Rims { Rim rims[]; };
layout(push_constant) uniform Push { FitParams params; };

#define SMALLEST_FEATURE 1e-15   // h under this: every neighbour lies on the point

vec3 position_of(uint slot) {
    return point_position_at(slot);
}

uint neighbor(uint list, uint j) {
    uvec4 four = neighbor_four_at(list + j);
    uint low = (j & 1u) != 0u ? four.y : four.x;
    uint high = (j & 1u) != 0u ? four.w : four.z;
    return (j & 2u) != 0u ? high : low;
}

vec3 neighbor_offset(uint list, uint j, vec3 center) {
    return position_of(neighbor(list, j)) - center;
}

// Positions that differ, counted up to 6: the first is the point's, and what the others are until they are found.
struct Distinct {
    uint count;
    vec3 first, second, third, fourth, fifth;
};

void count_position(inout Distinct seen, vec3 p) {
    bool is_first = p == seen.first, is_second = p == seen.second, is_third = p == seen.third;
    bool is_fourth = p == seen.fourth, is_fifth = p == seen.fifth;
    bool known = is_first || is_second || is_third || is_fourth || is_fifth || seen.count > 5u;
    seen.second = !known && seen.count == 1u ? p : seen.second;
    seen.third = !known && seen.count == 2u ? p : seen.third;
    seen.fourth = !known && seen.count == 3u ? p : seen.fourth;
    seen.fifth = !known && seen.count == 4u ? p : seen.fifth;
    seen.count += known ? 0u : 1u;
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
    Point point = point_at(slot);
    vec3 center = point.position;

    Distinct distinct = Distinct(1u, center, center, center, center, center);
#ifdef FEW
    uvec4 slots[4];
#define READ_LIST(j) slots[j] = neighbor_four_at(list + 4u * min(uint(j), params.neighbors / 4u - 1u));
    FOUR(READ_LIST, 0u)
    uint count = 0u;
    vec3 offsets[NEAREST];
    vec3 farthest = vec3(0.0);
#define READ_NEIGHBOR(j) { \
    uint other = slots[(j) / 4u][(j) % 4u]; \
    bool is_there = j < params.neighbors && other != NONE; \
    vec3 position = position_of(is_there ? other : slot); \
    offsets[j] = position - center; \
    farthest = is_there ? offsets[j] : farthest; \
    count += is_there ? 1u : 0u; \
    count_position(distinct, position); \
}
    EACH(READ_NEIGHBOR)
#else
    uint count = 0u;
    while (count < params.neighbors && neighbor(list, min(count, params.neighbors - 1u)) != NONE) ++count;
    uint nearest = 0u;
    while (nearest < count && distinct.count < 6u) {
        count_position(distinct, position_of(neighbor(list, nearest)));
        ++nearest;
    }
    vec3 farthest = count > 0u ? neighbor_offset(list, max(count, 1u) - 1u, center) : vec3(0.0);
#endif
    float reach = sqrt(dot3(farthest, farthest));
    float h = params.feature_size > 0.0 ? params.feature_size : reach;
    if (params.feature_size < 0.0) h = sizes[slot - params.bound_from];
    bool spread_out = h > SMALLEST_FEATURE && reach > SMALLEST_FEATURE;
    float inverse_h = 1.0 / (spread_out ? h : 1.0);
    float weight_square = params.weight_scale * params.weight_scale;

    // What is done to each neighbour: its offset y from the point, and its weight. Those that are not there
    // have weight 0.
#ifdef FEW
    float weights[NEAREST];
#define WEIGH(j) { \
    offsets[j] = offsets[j] * inverse_h; \
    weights[j] = j < count ? exp_negative(-dot3(offsets[j], offsets[j]) * weight_square) : 0.0; \
}
    EACH(WEIGH)
#define DO(j) { vec3 y = offsets[j]; float weight = weights[j]; STEP }
#define EACH_NEIGHBOR EACH(DO)
#else
#define EACH_NEIGHBOR \
    for (uint j = 0u; j < count; ++j) { \
        vec3 y = neighbor_offset(list, j, center) * inverse_h; \
        float weight = exp_negative(-dot3(y, y) * weight_square); \
        STEP \
    }
#endif

    // The point itself is the first term of every sum: weight 1 at the origin.
    float total = 1.0;
    vec3 sum = vec3(0.0);
#define STEP total += weight; sum += weight * y;
    EACH_NEIGHBOR
#undef STEP
    vec3 mean = sum / total;
    vec3 diagonal = mean * mean;
    vec3 off = vec3(mean.x * mean.y, mean.x * mean.z, mean.y * mean.z);
#define STEP \
    vec3 c = y - mean; \
    vec3 wc = weight * c; \
    diagonal += wc * c; \
    off += vec3(wc.x * c.y, wc.x * c.z, wc.y * c.z);
    EACH_NEIGHBOR
#undef STEP
    vec3 values, n, u;
    eigen_symmetric(diagonal, off, values, n, u);
    n = normalize3(n);
    vec3 v = cross3(n, u);

    NormalEquations eq = no_samples();
    add_sample(eq, 0.0, 0.0, 0.0, 1.0);
#define STEP add_sample(eq, dot3(y, u), dot3(y, v), dot3(y, n), weight);
    EACH_NEIGHBOR
#undef STEP

    bool spans_plane = values.y > COLLINEAR * values.z;
    float c[6];
    uint kind = fit_coefficients(eq, spread_out && spans_plane ? params.polynomial : FIT_NO_SURFACE, distinct.count, c);
    float reach_needed = 0.0;
    float openness = 0.0;
    bool finds_rims = params.rim_limit > 0.0;
    if ((params.close_gaps != 0u || finds_rims) && kind != FIT_NO_SURFACE) {
        float square = 0.0, extent = 0.0;
#ifdef FEW
        // The neighbours are at hand: once through them for each group is the shortest code.
        for (int group = 0; group < GAP_GROUPS; ++group) {
            vec4 cosines = GAP_COSINES[group], sines = GAP_SINES[group];
            Extents extents = no_bisectors();
#define STEP \
    vec2 q = vec2(dot3(y, u), dot3(y, v)); \
    narrow(extents, cosines, sines, q, 0.5 * (q.x * q.x + q.y * q.y));
            EACH_NEIGHBOR
#undef STEP
            add_extents(extents, cosines, sines, c, square, extent);
        }
#else
        Extents extents[GAP_GROUPS] = Extents[GAP_GROUPS](no_bisectors(), no_bisectors(), no_bisectors());
#define STEP \
    vec2 q = vec2(dot3(y, u), dot3(y, v)); \
    float half_square = 0.5 * (q.x * q.x + q.y * q.y); \
    for (int i = 0; i < GAP_GROUPS; ++i) narrow(extents[i], GAP_COSINES[i], GAP_SINES[i], q, half_square);
        EACH_NEIGHBOR
#undef STEP
        for (int i = 0; i < GAP_GROUPS; ++i) add_extents(extents[i], GAP_COSINES[i], GAP_SINES[i], c, square, extent);
#endif
        bool closed = extent <= 1.0;
        reach_needed = closed && params.close_gaps != 0u ? GAP_MARGIN * sqrt(square) : 0.0;
        openness = extent * (h / reach);
    }
    float ratio = max(params.trust, min(reach_needed, 1.0));
    float trust = kind != FIT_NO_SURFACE ? ratio * h : 0.0;
    polynomials[slot - params.bound_from] =
        to_world(center, trust, h, inverse_h, n, u, v, c, params.object, point.index);
    outcomes[slot - params.bound_from] = FitOutcome(trust, kind, h);

    float mean_u = dot3(mean, u), mean_v = dot3(mean, v);
    float away = sqrt(mean_u * mean_u + mean_v * mean_v);
    bool open = finds_rims && openness > RIM_OPEN && away > RIM_SHORTEST;
    vec3 outward = open ? -((mean_u * u + mean_v * v) / away) : vec3(0.0);
    float inverse_reach = 1.0 / (open ? reach : 1.0);
    float s = reach_of_rim(list, count, center, inverse_reach, outward, open ? RIM_STEPS : 0u);
    if (finds_rims)
        rims[i] = Rim(float[3](outward.x, outward.y, outward.z), open ? s * reach : 0.0, open ? openness : 0.0);
}
