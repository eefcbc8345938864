// blend: how much a polynomial says about the normal, or its point about the colour, at a hit near it.
//
// twin  crates/reference/src/blend.rs
// Its weight falls to zero, smoothly, at the rim of its trust ball and where its own surface passes the
// hit at a tenth of the trust radius: what lies farther is another sheet.
#ifndef BLEND_GLSL
#define BLEND_GLSL
#include "stages/points.glsl"
#include "polynomial.glsl"

#define OTHER_SHEET 0.1 // of the trust radius

// The weight of p at x, not under 0, and its unit normal there.
float weight_at(Polynomial p, vec3 x, out vec3 normal) {
    float b = p.center_trust.w;
    vec3 y = x - p.center_trust.xyz;
    vec3 curved = apply_curvature(p, y);
    vec3 gradient = p.gradient_offset.xyz - 2.0 * curved;
    float steepness = sqrt(dot3(gradient, gradient));
    float height = (dot3(p.gradient_offset.xyz, y) - p.gradient_offset.w) - dot3(y, curved);
    float inner = 1.0 - dot3(y, y) / (b * b);
    float apart = height / (steepness * (OTHER_SHEET * b));
    float sheet = 1.0 - apart * apart;
    normal = gradient / steepness;
    return inner > 0.0 && sheet > 0.0 ? (inner * inner) * sheet : 0.0;
}

// The unit normal of p at x, turned to the side of `towards`, times its weight; zero where it has none.
vec3 weighted_normal(Polynomial p, vec3 x, vec3 towards) {
    vec3 normal;
    float weight = weight_at(p, x, normal);
    return dot3(normal, towards) < 0.0 ? -weight * normal : weight * normal;
}
#endif
