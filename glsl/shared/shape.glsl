// shape: spheres and discs as polynomials (method, section 1), and what tells a sphere from all others.
//
// twin  crates/reference/src/shape.rs
#ifndef SHAPE_GLSL
#define SHAPE_GLSL
#include "stages/points.glsl"
#include "math.glsl"

#define SPHERE_MARGIN 1.00001 // trust radius over radius: rounding puts no place of the sphere outside
#define SMALLEST_RADIUS 1e-15 // what is less is not drawn
#define NO_NORMAL 0.5 // of its squared length, which is 1 or 0

// (|y|^2 - r^2) / 2r: the distance from the sphere, near it.
Polynomial sphere_polynomial(vec3 center, float radius, uint object, uint index) {
    bool is_drawn = radius >= SMALLEST_RADIUS;
    float r = is_drawn ? radius : 1.0;
    Polynomial p;
    p.center_trust = vec4(center, is_drawn ? r * SPHERE_MARGIN : 0.0);
    p.gradient_offset = vec4(vec3(0.0), 0.5 * r);
    p.curvature = vec4(vec3(-0.5 / r), 0.0);
    p.cross_terms = vec2(0.0);
    p.object = object;
    p.index = index;
    return p;
}

// Across the normal, or, where there is none, across z.
Polynomial disc_polynomial(vec3 center, float radius, vec3 normal, uint object, uint index) {
    bool is_known = dot3(normal, normal) > NO_NORMAL;
    Polynomial p;
    p.center_trust = vec4(center, radius >= SMALLEST_RADIUS ? radius : 0.0);
    p.gradient_offset = vec4(normalize3(is_known ? normal : vec3(0.0, 0.0, 1.0)), 0.0);
    p.curvature = vec4(0.0);
    p.cross_terms = vec2(0.0);
    p.object = object;
    p.index = index;
    return p;
}

// No other polynomial has m = 0.
bool is_sphere(vec3 m) {
    return m == vec3(0.0);
}

// Where a ray that starts on a sphere meets it again: if it goes inwards, on the far side, however short the way, and
// never if it goes outwards. The rounding of its origin has no part in it.
float far_side(vec3 o, vec3 d, vec3 center) {
    float s = -dot3(o - center, d);
    return s > 0.0 ? 2.0 * s : NO_HIT;
}
#endif
