// refine: one iteration of each pending hit towards the point set surface (section 4 of the paper,
// after Adamson and Alexa).
//
// reads   the ray state, grid, polynomials, objects
//         outcomes         h and b of each point
//         offsets, points  the points of each cell, each point once
// writes  hits             projected, and accepted, rejected, or pending still
//         live             how many are pending still
//         rejected         how many are rejected
// runs    one invocation per ray of the wave; dispatched until none is pending
// twin    crates/reference/src/refine.rs
//
// At the hit x the polynomial is fitted anew, as at a point: P(x) = x + g(0, 0) n. Where P(x) is
// farther than the tolerance, the ray meets that polynomial at the next x; where it does not, or
// where x leaves the trust region that it began in, the next stored polynomial is tried.
// Neighbourhoods too large for one dispatch, which only very uneven sets have, keep the stored hit.
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/grid.glsl"
#include "stages/rays.glsl"
#include "stages/wave.glsl"
#include "math.glsl"
#include "levels.glsl"
#include "eigen.glsl"
#include "fit.glsl"
#include "polynomial.glsl"
#include "state.glsl"
#include "objects.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = LIVE) buffer Live { uint live; uint rejected; };
layout(std430, binding = HITS) buffer Hits { Hit hits[]; };
layout(std430, binding = CELL_OFFSETS) readonly buffer Offsets { uint offsets[]; };
layout(std430, binding = OUTCOMES) readonly buffer Outcomes { FitOutcome outcomes[]; };
layout(push_constant) uniform Push { TraceParams params; };

#define REACH 3.0        // of the weights, over h
#define MAX_ROWS 1024u   // of cells that a neighbourhood may span
#define MAX_LISTED 2048u // points in them

// Cells of one grid around a place, as rows along x.
struct RowBox {
    uvec3 low;
    uvec3 high;
    uint count;
};

RowBox row_box(uint level, vec3 x, float radius, uvec2 slots) {
    RowBox box;
    cells_around(levels[level].grid, x, radius, box.low, box.high);
    box.count = lists_some(level, slots) ? (box.high.y - box.low.y + 1u) * (box.high.z - box.low.z + 1u) : 0u;
    return box;
}

// Those of all grids, one grid after another.
struct Rows {
    RowBox first; // of the first grid
    vec3 x;
    float radius;
    uvec2 slots;
    uint count; // 0 where there are too many, or too many points in them
};

uvec2 row_range(Rows rows, uint row) {
    uint level = 0u;
    RowBox box = rows.first;
    if (scene_has(SCENE_LEVELS)) {
        while (row >= box.count && level + 1u < level_count()) {
            row -= box.count;
            ++level;
            box = row_box(level, rows.x, rows.radius, rows.slots);
        }
    }
    uint height = box.high.y - box.low.y + 1u;
    uvec2 yz = box.low.yz + uvec2(row % height, row / height);
    GridLevel at = levels[level];
    return uvec2(offsets[at.first_offset + cell_id(at.grid, uvec3(box.low.x, yz))],
                 offsets[at.first_offset + cell_id(at.grid, uvec3(box.high.x, yz)) + 1u]);
}

// `slots` are those of the object whose points are asked for: the first, and how many.
Rows rows_around(vec3 x, float radius, uvec2 slots) {
    Rows rows = Rows(row_box(0u, x, radius, slots), x, radius, slots, 0u);
    uint count = rows.first.count;
    for (uint level = 1u; level < level_count(); ++level) {
        count += min(row_box(level, x, radius, slots).count, MAX_ROWS + 1u);
    }
    rows.count = count <= MAX_ROWS ? count : 0u;
    uint listed = 0u;
    for (uint row = 0u; row < rows.count; ++row) {
        uvec2 range = row_range(rows, row);
        listed += range.y - range.x;
    }
    rows.count = listed <= MAX_LISTED ? rows.count : 0u;
    return rows;
}

// Slots of one object: the first, and how many.
bool belongs(uint slot, uvec2 slots) {
    return slot - slots.x < slots.y;
}

// The object's point nearest to x; the stored one is near (ties: the lower index), and in the list if
// its ball was clipped, so that its centre lies elsewhere.
uint nearest_slot(Rows rows, vec3 x, uint stored, bool clipped, uvec2 slots) {
    uint best = stored;
    vec3 to_stored = polynomial_center_trust_at(stored).xyz - x;
    float best_square = clipped ? NO_HIT : dot3(to_stored, to_stored);
    for (uint row = 0u; row < rows.count; ++row) {
        uvec2 range = row_range(rows, row);
        for (uint i = range.x; i < range.y; ++i) {
            ListedPoint point = listed_point_at(i);
            vec3 y = point.position - x;
            float square = dot3(y, y);
            bool ties = square == best_square;
            bool nearer = square < best_square || (ties && polynomial_index_at(point.slot) < polynomial_index_at(best));
            bool better = nearer && belongs(point.slot, slots);
            best = better ? point.slot : best;
            best_square = better ? square : best_square;
        }
    }
    return best;
}

#define BATCH 32u // points tested before any is added up: one bit each

// Which of the points from `first` on, up to 32 of them, lie within reach: their places and weights
// are then computed by `neighbor`.
uint within_reach(uint first, uint end, vec3 x, float inverse_h, uvec2 slots) {
    uint inside = 0u;
    uint count = min(end - first, BATCH);
    for (uint j = 0u; j < count; ++j) {
        ListedPoint point = listed_point_at(first + j);
        vec3 y = (point.position - x) * inverse_h;
        bool counts = dot3(y, y) <= REACH * REACH && belongs(point.slot, slots);
        inside |= counts ? 1u << j : 0u;
    }
    return inside;
}

// A neighbour's place in units of h, and its weight.
vec4 neighbor(uint i, vec3 x, float inverse_h, float weight_square) {
    vec3 y = (listed_point_at(i).position - x) * inverse_h;
    return vec4(y, exp_negative(-dot3(y, y) * weight_square));
}

// The polynomial fitted at x over the plane of its neighbourhood; kind FIT_NO_SURFACE where there is
// none.
Polynomial fit_at(Rows rows, vec3 x, float h, float trust, uint object, uvec2 slots, out uint kind) {
    float inverse_h = 1.0 / h;
    float weight_scale = object_at(object).weight_scale;
    float weight_square = weight_scale * weight_scale;
    float total = 0.0;
    vec3 sum = vec3(0.0), diagonal = vec3(0.0), off = vec3(0.0);
    for (uint row = 0u; row < rows.count; ++row) {
        uvec2 range = row_range(rows, row);
        for (uint first = range.x; first < range.y; first += BATCH) {
            uint inside = within_reach(first, range.y, x, inverse_h, slots);
            while (inside != 0u) {
                vec4 yw = neighbor(first + uint(findLSB(inside)), x, inverse_h, weight_square);
                inside &= inside - 1u;
                vec3 y = yw.xyz, wy = yw.w * yw.xyz;
                total += yw.w;
                sum += wy;
                diagonal += wy * y;
                off += vec3(wy.x * y.y, wy.x * y.z, wy.y * y.z);
            }
        }
    }
    vec3 mean = sum / max(total, 1e-30);
    diagonal -= sum * mean;
    off -= vec3(sum.x * mean.y, sum.x * mean.z, sum.y * mean.z);
    vec3 values, n, u;
    eigen_symmetric(diagonal, off, values, n, u);
    n = normalize3(n);
    vec3 v = cross3(n, u);

    NormalEquations eq = no_samples();
    for (uint row = 0u; row < rows.count; ++row) {
        uvec2 range = row_range(rows, row);
        for (uint first = range.x; first < range.y; first += BATCH) {
            uint inside = within_reach(first, range.y, x, inverse_h, slots);
            while (inside != 0u) {
                vec4 yw = neighbor(first + uint(findLSB(inside)), x, inverse_h, weight_square);
                inside &= inside - 1u;
                add_sample(eq, dot3(yw.xyz, u), dot3(yw.xyz, v), dot3(yw.xyz, n), yw.w);
            }
        }
    }
    bool spans_plane = values.y > COLLINEAR * values.z;
    float c[6];
    kind = fit_coefficients(eq, spans_plane ? object_at(object).polynomial : FIT_NO_SURFACE, UNKNOWNS, c);
    return to_world(x, trust, h, inverse_h, n, u, v, c, object, 0u);
}

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    Hit hit = hits[at];
    if (bitfieldExtract(hit.status, 0, HIT_STATUS_BITS) != HIT_PENDING) return;
    Ray ray = load_ray(at);
    vec4 stored = polynomial_center_trust_at(ray.hit_slot);
    uint object = polynomial_object_at(ray.hit_slot);
    uvec2 slots = uvec2(object_at(object).first_slot, object_at(object).slot_count);
    vec3 from_stored = hit.position - stored.xyz;

    float moved = outcomes[ray.hit_slot].trust - stored.w; // > 0 where the ball was clipped: from point to centre
    Rows near = rows_around(hit.position, sqrt(dot3(from_stored, from_stored)) + moved, slots);
    FitOutcome nearest = outcomes[nearest_slot(near, hit.position, ray.hit_slot, moved > 0.0, slots)];
    float h = nearest.feature_size;
    Rows rows = rows_around(hit.position, REACH * h, slots);
    uint kind;
    Polynomial p = fit_at(rows, hit.position, h, nearest.trust, object, slots, kind);

    bool settled = abs(p.gradient_offset.w) <= object_at(object).tolerance * h;
    float t = settled ? hit.t : intersect(ray.origin, ray.direction, p, 0.0);
    vec3 y, normal;
    surface_at(ray.origin, ray.direction, t < NO_HIT ? t : hit.t, p, y, normal);
    vec3 x = settled ? hit.position : hit.position + y;
    from_stored = x - stored.xyz;
    bool inside = t < NO_HIT && dot3(from_stored, from_stored) <= stored.w * stored.w;
    bool affordable = near.count > 0u && rows.count > 0u;
    bool keeps = kind != FIT_NO_SURFACE && inside;
    uint iterations = bitfieldExtract(hit.status, HIT_STATUS_BITS, HIT_STATUS_BITS) + 1u;
    uint counted = hit.status + (1u << HIT_STATUS_BITS) + (1u << HIT_TOTAL_SHIFT) - HIT_PENDING;
    bool last = settled || (iterations >= object_at(object).max_iterations);
    uint status = keeps ? (last ? HIT_ACCEPTED : HIT_PENDING) : HIT_REJECTED;
    hits[at] = affordable ? Hit(x, t, normal, counted + status)
                          : Hit(hit.position, hit.t, hit.normal, hit.status - HIT_PENDING + HIT_ACCEPTED);
    if (affordable && status == HIT_PENDING) atomicAdd(live, 1u);
    if (affordable && status == HIT_REJECTED) atomicAdd(rejected, 1u);
}
