// shape_spheres: the spheres of one batch, as polynomials (method, section 1).
//
// reads   points           of the batch
//         radii            of the batch
// writes  polynomials      one a point
//         outcomes         how large it is; no surface where it has no radius
// runs    one invocation per point of the batch
// twin    crates/reference/src/shape.rs, shape_spheres
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "shape.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = POINTS) readonly buffer Points { Point points[]; };
layout(std430, binding = RADII) readonly buffer Radii { float radii[]; };
layout(std430, binding = POLYNOMIALS) writeonly buffer Polynomials { Polynomial polynomials[]; };
layout(std430, binding = OUTCOMES) writeonly buffer Outcomes { FitOutcome outcomes[]; };
layout(push_constant) uniform Push { ShapeParams params; };

void main() {
    uint i = list_index();
    if (i >= params.count) return;
    uint at = params.first_slot - params.bound_from + i;
    Point point = points[at];
    Polynomial p = sphere_polynomial(point.position, radii[i], params.object, point.index);
    polynomials[at] = p;
    outcomes[at] = FitOutcome(p.center_trust.w, p.center_trust.w > 0.0 ? FIT_SPHERE : FIT_NO_SURFACE, radii[i]);
}
