// fit: from normal equations to the polynomial in world form (method, section 1).
//
// twin  crates/reference/src/fit.rs
#ifndef FIT_GLSL
#define FIT_GLSL
#include "stages/points.glsl"
#include "least_squares.glsl"

#define MAX_SLOPE 1.0     // sqrt(E E + F F)
#define MAX_OFFSET 0.3    // |D| / h
#define MAX_CURVATURE 2.0 // |eigenvalue| of h M
#define COLLINEAR 1e-6    // middle eigenvalue of the covariance over the largest

bool enough_points(uint kind, uint distinct) {
    return distinct >= (kind == FIT_FULL ? 6u : (kind == FIT_INCOMPLETE ? 4u : 3u));
}

// Limits that stop spikes on scans; the coefficients are in units of h.
bool within_limits(float c[6]) {
    float mean = 0.5 * (c[0] + c[1]);
    float half_difference = 0.5 * (c[0] - c[1]);
    float spread = sqrt(half_difference * half_difference + 0.25 * c[2] * c[2]);
    return abs(mean) + spread <= MAX_CURVATURE && abs(c[5]) <= MAX_OFFSET
        && sqrt(c[3] * c[3] + c[4] * c[4]) <= MAX_SLOPE;
}

// Coefficients A B C E F D of the first kind, from `kind` down, that is not singular; returns it.
uint fit_coefficients(NormalEquations eq, uint kind, uint distinct, out float c[6]) {
    bool found = false;
    c = float[6](0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    while (kind != FIT_NO_SURFACE && !found) {
        float solution[6];
        bool regular = solve(eq, kind, solution);
        found = regular && enough_points(kind, distinct) && within_limits(solution);
        if (found) c = solution;
        kind = found ? kind : kind - 1u;
    }
    return kind;
}

// The polynomial over the plane through `center` with normal n and axes u, v; coefficients in units
// of h.
Polynomial to_world(vec3 center, float trust, float h, float inverse_h, vec3 n, vec3 u, vec3 v,
                    float c[6], uint object, uint index) {
    float a = c[0] * inverse_h, b = c[1] * inverse_h, half_c = 0.5 * (c[2] * inverse_h);
    vec3 m = (n - c[3] * u) - c[4] * v;
    vec3 au = a * u + half_c * v; // M = u (A u + C/2 v)' + v (C/2 u + B v)'
    vec3 bv = half_c * u + b * v;
    Polynomial p;
    p.center_trust = vec4(center, trust);
    p.gradient_offset = vec4(m, c[5] * h);
    p.curvature = vec4(u.x * au.x + v.x * bv.x, u.y * au.y + v.y * bv.y, u.z * au.z + v.z * bv.z,
                       u.x * au.y + v.x * bv.y);
    p.cross_terms = vec2(u.x * au.z + v.x * bv.z, u.y * au.z + v.y * bv.z);
    p.object = object;
    p.index = index;
    return p;
}
#endif
