// meeting: where a ray that has ended met the polynomial that it hit.
//
// twin  crates/reference/src/surface_hit.rs
// Whoever includes this has the lists of the grids.
#ifndef MEETING_GLSL
#define MEETING_GLSL
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/grid.glsl"
#include "stages/wave.glsl"
#include "around.glsl"
#include "blend.glsl"
#include "objects.glsl"
#include "polynomial.glsl"
#include "scene.glsl"
#include "state.glsl"

#define ASKED_AT_ONCE 32u
#define MOST_BLENDED 4096u // points of a cell that are asked: a cell of very many says enough

// The mean of the normals of the object's polynomials around x, by their weights. First the trust balls
// that hold x, up to 32 into a bit mask, then their normals: few of a cell do.
vec3 blended_normal(vec3 x, vec3 normal, uint object) {
    uvec2 slots = uvec2(object_at(object).first_slot, object_at(object).slot_count);
    Around around = points_around(x, slots);
    uvec2 range = around.range;
    uint end = around.several ? range.x : min(range.y, range.x + MOST_BLENDED);
    vec3 sum = 1e-6 * normal; // where nothing has a weight, the hit's own
    if (scene_has(SCENE_LEVELS)) {
        if (around.several) {
            Merge merge = merge_around(x, slots);
            uint near = next_around(merge, x, slots);
            while (near != NONE) {
                sum += weighted_normal(polynomial_at(near), x, normal);
                near = next_around(merge, x, slots);
            }
        }
    }
    for (uint first = range.x; first < end; first += ASKED_AT_ONCE) {
        uint count = min(end - first, ASKED_AT_ONCE);
        uint holding = 0u;
        for (uint i = 0u; i < count; ++i) {
            vec4 ball = polynomial_center_trust_at(slot_at(first + i));
            vec3 y = x - ball.xyz;
            holding |= dot3(y, y) < ball.w * ball.w ? 1u << i : 0u;
        }
        while (holding != 0u) {
            uint near = slot_at(first + uint(findLSB(holding)));
            holding &= holding - 1u;
            if (near - slots.x < slots.y) sum += weighted_normal(polynomial_at(near), x, normal);
        }
    }
    return normalize3(sum);
}

struct Meeting {
    vec3 position; // centred scene space
    vec3 normal;   // unit, facing the ray's origin
    uint object;
    bool refined;  // the object asks for better
};

// Of a ray that hit something.
Meeting meeting_of(Ray ray) {
    Polynomial p = polynomial_at(ray.hit_slot);
    vec3 y, normal;
    surface_at(ray.origin, ray.direction, ray.hit_t, p, y, normal);
    bool is_shape = scene_has(SCENE_SHAPES) && is_shape_of(object_at(p.object), ray.hit_slot);
    bool refined = scene_has(SCENE_REFINES) && object_at(p.object).max_iterations > 0u && !is_shape;
    vec3 x = p.center_trust.xyz + y;
    vec3 blended = normal;
    if (scene_has(SCENE_BLENDS)) {
        if (object_at(p.object).blends != 0u && !refined && !is_shape) blended = blended_normal(x, normal, p.object);
    }
    normal = dot3(blended, ray.direction) < 0.0 ? blended : normal; // at an outline it may look away
    return Meeting(x, normal, p.object, refined);
}
#endif
