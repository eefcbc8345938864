// nearest_hit: which of the polynomials that a ray meets it hits. The rules are those of every structure, so they stand here.
//
// twin    crates/reference/src/grid_trace.rs
// With LEAVING, rays start on surfaces: they do not meet their own sheet again at once, and an object may be passed.
#ifndef NEAREST_HIT_GLSL
#define NEAREST_HIT_GLSL
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/rays.glsl"
#include "math.glsl"
#include "polynomial.glsl"
#include "scene.glsl"
#include "shape.glsl"
#include "state.glsl"

// The polynomial of the nearest hit so far, by which equals are told apart; NONE: there is none.
struct Nearest {
    uint object;
    uint index;
};

Nearest nearest_of(Ray ray, bool alive) {
    Nearest nearest = Nearest(NONE, NONE);
    if (alive && ray.hit_slot != NONE) {
        Polynomial hit = polynomial_at(ray.hit_slot);
        nearest = Nearest(hit.object, hit.index);
    }
    return nearest;
}

// The sheet that a ray starts on.
struct LeftSheet {
    vec3 normal;
    uint object; // NONE: it starts on none
};

LeftSheet left_sheet(Ray ray, bool alive) {
    LeftSheet sheet = LeftSheet(vec3(0.0), NONE);
#ifdef LEAVING
    if (alive && ray.left != NONE) {
        Polynomial left = polynomial_at(ray.left);
        sheet = LeftSheet(normal_at(left, ray.origin), left.object);
    }
#endif
    return sheet;
}

// How far along the ray it meets the surface of a point, if it does. `passed` as in TraceParams.
float meeting_distance(Ray ray, uint slot, Polynomial p, LeftSheet left, uint passed) {
    float from = 0.0;
#ifdef LEAVING
    bool own = p.object == left.object && same_sheet(p, ray.origin, left.normal);
    from = own ? SHEET_REACH * p.center_trust.w : 0.0;
    if (scene_has(SCENE_VOLUMES) && scene_has(SCENE_CLEAR)) {
        bool starts_near = ray.left == NONE && p.object == (passed ^ PASSED_NEAR);
        from = starts_near ? SHEET_REACH * p.center_trust.w : from;
    }
    if (scene_has(SCENE_SPHERES)) from = is_sphere(p.gradient_offset.xyz) ? 0.0 : from;
#endif
    float t = intersect(ray.origin, ray.direction, p, from);
#ifdef LEAVING
    if (scene_has(SCENE_SPHERES)) {
        bool is_left = slot == ray.left && is_sphere(p.gradient_offset.xyz);
        t = is_left ? far_side(ray.origin, ray.direction, p.center_trust.xyz) : t;
    }
    if (scene_has(SCENE_VOLUMES)) t = p.object == passed ? NO_HIT : t;
#endif
    return t;
}

// The ray hits it where no hit so far is nearer; of equals, the first in the order of (object, index).
void take_nearer(inout Ray ray, inout Nearest nearest, uint slot, Polynomial p, float t) {
    bool first_of_equals = p.object < nearest.object || (p.object == nearest.object && p.index < nearest.index);
    bool nearer = t < ray.hit_t || (t == ray.hit_t && t < NO_HIT && first_of_equals);
    bool better = nearer && (!scene_has(SCENE_REFINES) || t > ray.after);
    ray.hit_t = better ? t : ray.hit_t;
    ray.hit_slot = better ? slot : ray.hit_slot;
    nearest.object = better ? p.object : nearest.object;
    nearest.index = better ? p.index : nearest.index;
}
#endif
