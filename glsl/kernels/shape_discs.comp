// shape_discs: the discs of one batch, as polynomials (method, section 1).
//
// reads   points           of the batch
//         radii            of the batch
//         normals          of the batch, where they are given
//         polynomials, outcomes   else: the planes that were fitted
// writes  polynomials      one a point
//         outcomes         how large it is; no surface where it has no radius
// runs    one invocation per point of the batch
// twin    crates/reference/src/shape.rs, shape_discs
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "shape.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = POINTS) readonly buffer Points { Point points[]; };
layout(std430, binding = RADII) readonly buffer Radii { float radii[]; };
layout(std430, binding = POLYNOMIALS) buffer Polynomials { Polynomial polynomials[]; };
layout(std430, binding = OUTCOMES) buffer Outcomes { FitOutcome outcomes[]; };
layout(std430, binding = NORMALS) readonly buffer Normals { float normals[]; };
layout(push_constant) uniform Push { ShapeParams params; };

void main() {
    uint i = list_index();
    if (i >= params.count) return;
    uint at = params.first_slot - params.bound_from + i;
    Point point = points[at];
    vec3 normal = vec3(0.0);
    if (params.has_normals != 0u)
        normal = vec3(normals[3u * i], normals[3u * i + 1u], normals[3u * i + 2u]);
    else if (outcomes[at].kind != FIT_NO_SURFACE)
        normal = polynomials[at].gradient_offset.xyz;
    Polynomial p = disc_polynomial(point.position, radii[i], normal, params.object, point.index);
    polynomials[at] = p;
    outcomes[at] = FitOutcome(p.center_trust.w, p.center_trust.w > 0.0 ? FIT_DISC : FIT_NO_SURFACE, radii[i]);
}
