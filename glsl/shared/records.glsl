// records: how the traversal reads polynomials.
//
// Through a uniform texel buffer where the device allows one long enough (lavapipe reads it in
// three quarters of the time), else through a storage buffer. Both give the same bits.
#ifndef RECORDS_GLSL
#define RECORDS_GLSL
#include "layout.glsl"

#ifdef RECORDS_AS_TEXELS
layout(binding = TRACE_POLYNOMIALS) uniform usamplerBuffer texels; // four a polynomial

vec4 center_trust_of(uint slot) {
    return uintBitsToFloat(texelFetch(texels, int(4u * slot)));
}

Polynomial polynomial_of(uint slot) {
    int at = int(4u * slot);
    uvec4 tail = texelFetch(texels, at + 3);
    return Polynomial(center_trust_of(slot), uintBitsToFloat(texelFetch(texels, at + 1)),
                      uintBitsToFloat(texelFetch(texels, at + 2)), uintBitsToFloat(tail.xy), tail.z, tail.w);
}
#else
layout(std430, binding = TRACE_POLYNOMIALS) readonly buffer Polynomials { Polynomial polynomials[]; };

vec4 center_trust_of(uint slot) {
    return polynomials[slot].center_trust;
}

Polynomial polynomial_of(uint slot) {
    return polynomials[slot];
}
#endif
#endif
