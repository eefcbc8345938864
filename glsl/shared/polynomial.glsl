// polynomial: where a ray meets the polynomial of one point (method, section 1).
//
// twin  crates/reference/src/polynomial.rs
// Solved from the ray's nearest approach to the point: from the eye the same formula loses digits.
#ifndef POLYNOMIAL_GLSL
#define POLYNOMIAL_GLSL
#include "stages/points.glsl"
#include "math.glsl"

vec3 apply_curvature(Polynomial p, vec3 v) {
    return vec3(p.curvature.x * v.x + p.curvature.w * v.y + p.cross_terms.x * v.z,
                p.curvature.w * v.x + p.curvature.y * v.y + p.cross_terms.y * v.z,
                p.cross_terms.x * v.x + p.cross_terms.y * v.y + p.curvature.z * v.z);
}

// Whether the ray comes within the trust ball at a distance that can still matter: every t that
// `intersect` could return lies in [s - b, s + b], and rounding is monotone.
bool near_trust_ball(vec3 o, vec3 d, vec4 center_trust, float nearest) {
    vec3 from_center = o - center_trust.xyz;
    float b = center_trust.w;
    float s = -dot3(from_center, d);
    vec3 y0 = from_center + s * d;
    return dot3(y0, y0) <= b * b && s + b > 0.0 && s - b <= nearest;
}

#define ENTRY_MARGIN 0.0625 // of the trust radius

// The same, and enters the ball on its way from within.x to within.y, or nearly.
bool enters_trust_ball(vec3 o, vec3 d, vec4 center_trust, float nearest, vec2 within) {
    vec3 from_center = o - center_trust.xyz;
    float b = center_trust.w;
    float s = -dot3(from_center, d);
    vec3 y0 = from_center + s * d;
    float under_root = b * b - dot3(y0, y0); // the ray enters at s - sqrt(under_root)
    float margin = ENTRY_MARGIN * b;
    float behind_low = s - (within.x - margin);
    float behind_high = s - (within.y + margin);
    return under_root >= 0.0 && s + b > 0.0 && s - b <= nearest
        && behind_low >= 0.0 && behind_low * behind_low >= under_root
        && (behind_high <= 0.0 || behind_high * behind_high <= under_root);
}

// The unit normal of the polynomial's own level through x.
vec3 normal_at(Polynomial p, vec3 x) {
    return normalize3(p.gradient_offset.xyz - 2.0 * apply_curvature(p, x - p.center_trust.xyz));
}

#define SHEET_REACH 0.5   // of the trust radius: how far a ray may still meet the sheet it starts on
#define SHEET_HEIGHT 0.3 // of the trust radius: how far apart polynomials of one sheet may be
#define SHEET_COSINE 0.5  // of the angle between their normals, 60 degrees

// Whether p is the sheet that a ray starts on at o, where its normal is `normal` (method, section 4).
bool same_sheet(Polynomial p, vec3 o, vec3 normal) {
    vec3 y = o - p.center_trust.xyz;
    vec3 curved = apply_curvature(p, y);
    vec3 gradient = p.gradient_offset.xyz - 2.0 * curved;
    float steepness = sqrt(dot3(gradient, gradient));
    float height = (dot3(p.gradient_offset.xyz, y) - p.gradient_offset.w) - dot3(y, curved);
    return abs(height) < (SHEET_HEIGHT * p.center_trust.w) * steepness
        && abs(dot3(gradient, normal)) > SHEET_COSINE * steepness;
}

bool in_trust_ball(float root, vec3 y0, vec3 d, float s, float b, float from) {
    vec3 y = y0 + root * d;
    return abs(root) <= b && dot3(y, y) <= b * b && s + root > from;
}

// Nearest t > from where o + t d meets the polynomial inside its trust ball, or NO_HIT. d has unit
// length. Roots by q = -(a1 + sign(a1) sqrt(a1 a1 - 4 a2 a0)) / 2, so that none cancels.
float intersect(vec3 o, vec3 d, Polynomial p, float from) {
    float b = p.center_trust.w;
    vec3 from_center = o - p.center_trust.xyz;
    float s = -dot3(from_center, d);
    vec3 y0 = from_center + s * d;
    vec3 m = p.gradient_offset.xyz;
    vec3 curved = apply_curvature(p, d);
    float a2 = -dot3(d, curved);
    float a1 = dot3(m, d) - 2.0 * dot3(y0, curved);
    float a0 = (dot3(m, y0) - p.gradient_offset.w) - dot3(y0, apply_curvature(p, y0));
    float discriminant = a1 * a1 - 4.0 * a2 * a0;
    float root = sqrt(max(discriminant, 0.0));
    float q = -0.5 * (a1 < 0.0 ? a1 - root : a1 + root);
    float r1 = q != 0.0 ? a0 / (q != 0.0 ? q : 1.0) : NO_HIT;
    float r2 = a2 != 0.0 ? q / (a2 != 0.0 ? a2 : 1.0) : NO_HIT;
    float first = r1 < r2 ? r1 : r2;
    float second = r1 < r2 ? r2 : r1;
    bool real = discriminant >= 0.0;
    bool first_counts = real && in_trust_ball(first, y0, d, s, b, from);
    bool second_counts = real && in_trust_ball(second, y0, d, s, b, from);
    return first_counts ? s + first : (second_counts ? s + second : NO_HIT);
}

// The hit at distance t relative to the point, and the unit normal there, facing the ray's origin.
void surface_at(vec3 o, vec3 d, float t, Polynomial p, out vec3 y, out vec3 normal) {
    vec3 from_center = o - p.center_trust.xyz;
    float s = -dot3(from_center, d);
    y = (from_center + s * d) + (t - s) * d;
    vec3 gradient = normalize3(p.gradient_offset.xyz - 2.0 * apply_curvature(p, y));
    normal = dot3(gradient, d) > 0.0 ? -gradient : gradient;
}
#endif
