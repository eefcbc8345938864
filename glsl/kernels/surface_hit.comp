// surface_hit: where each ray that has ended met the polynomial it hit.
//
// reads   the ray state, polynomials, objects
//         grid, cells, slots   the polynomials around a hit, where normals are blended
// writes  hits             accepted, or pending where the object's hits are refined; a hit that stands
//                          already is left alone; must be zero before the first time
//         live             how many are pending
// runs    one invocation per ray of the wave
// twin    crates/reference/src/surface_hit.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#define LISTS
#include "layout.glsl"
#include "grid.glsl"
#include "polynomial.glsl"
#include "blend.glsl"
#include "state.glsl"
#include "records.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = TRACE_INFO) readonly buffer Info { GridInfo grid; };
layout(std430, binding = TRACE_LIVE) buffer Live { uint live; };
layout(std430, binding = SHADE_OBJECTS) readonly buffer Objects { ObjectInfo objects[]; };
layout(std430, binding = TRACE_HITS) buffer Hits { Hit hits[]; };
layout(push_constant) uniform Push { TraceParams params; };

#define ASKED_AT_ONCE 32u
#define MOST_BLENDED 4096u // points of a cell that are asked: a cell of very many says enough

// The mean of the normals of the object's polynomials around x, by their weights. First the trust balls
// that hold x, up to 32 into a bit mask, then their normals: few of a cell do.
vec3 blended_normal(vec3 x, vec3 normal, uint object) {
    uvec2 range = range_of(cell_id(grid, cell_of(grid, x)));
    uint end = min(range.y, range.x + MOST_BLENDED);
    vec3 sum = 1e-6 * normal; // where nothing has a weight, the hit's own
    for (uint first = range.x; first < end; first += ASKED_AT_ONCE) {
        uint count = min(end - first, ASKED_AT_ONCE);
        uint holding = 0u;
        for (uint i = 0u; i < count; ++i) {
            vec4 ball = center_trust_of(slot_at(first + i));
            vec3 y = x - ball.xyz;
            holding |= dot3(y, y) < ball.w * ball.w ? 1u << i : 0u;
        }
        while (holding != 0u) {
            Polynomial p = polynomial_of(slot_at(first + uint(findLSB(holding))));
            holding &= holding - 1u;
            if (p.object == object) sum += weighted_normal(p, x, normal);
        }
    }
    return normalize3(sum);
}

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    uint status = hits[at].status;
    if (bitfieldExtract(status, 0, HIT_STATUS_BITS) == HIT_ACCEPTED) return;
    Ray ray = load_ray(at);
    uint iterations = status >> HIT_TOTAL_SHIFT << HIT_TOTAL_SHIFT;
    if (ray.hit_slot == NONE) {
        hits[at].status = iterations | HIT_NONE;
        return;
    }
    Polynomial p = polynomial_of(ray.hit_slot);
    vec3 y, normal;
    surface_at(ray.origin, ray.direction, ray.hit_t, p, y, normal);
    bool refined = objects[p.object].max_iterations > 0u;
    vec3 x = p.center_trust.xyz + y;
    vec3 blended = objects[p.object].blends != 0u && !refined ? blended_normal(x, normal, p.object) : normal;
    normal = dot3(blended, ray.direction) < 0.0 ? blended : normal; // at an outline it may look away
    hits[at] = Hit(x, ray.hit_t, normal, iterations | (refined ? HIT_PENDING : HIT_ACCEPTED));
    if (refined) atomicAdd(live, 1u);
}
