// clip_balls: trust balls at the rims of open sets end there (method, section 2).
//
// reads   clips            one a ball: its new centre and radius; each slot at most once
// writes  polynomials      the same surface, seen from the new centre
// runs    one invocation per clip
// twin    crates/reference/src/rim.rs, clip_balls
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "polynomial.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = CLIPS) readonly buffer Clips { BallClip clips[]; };
layout(std430, binding = POLYNOMIALS) buffer Polynomials { Polynomial polynomials[]; };
layout(push_constant) uniform Push { ClipParams params; };

void main() {
    uint i = list_index();
    if (i >= params.count) return;
    BallClip clip = clips[i];
    Polynomial p = polynomials[clip.slot];
    vec3 center = p.center_trust.xyz + vec3(clip.shift[0], clip.shift[1], clip.shift[2]);
    vec3 moved = center - p.center_trust.xyz; // the shift as it was rounded
    vec3 curved = apply_curvature(p, moved);
    float offset = (p.gradient_offset.w - dot3(p.gradient_offset.xyz, moved)) + dot3(moved, curved);
    polynomials[clip.slot].center_trust = vec4(center, clip.trust);
    polynomials[clip.slot].gradient_offset = vec4(p.gradient_offset.xyz - 2.0 * curved, offset);
}
