// records: how kernels read polynomials, and the lists of the grid (LISTS).
//
// With QUEUE through uniform texel buffers: lavapipe loads from storage buffers lane by lane, from texel
// buffers all lanes at once. Both give the same bits.
#ifndef RECORDS_GLSL
#define RECORDS_GLSL
#include "layout.glsl"

#ifdef QUEUE
layout(binding = TRACE_POLYNOMIALS) uniform usamplerBuffer polynomial_texels; // four a polynomial

vec4 center_trust_of(uint slot) {
    return uintBitsToFloat(texelFetch(polynomial_texels, int(4u * slot)));
}

uint object_of(uint slot) {
    return texelFetch(polynomial_texels, int(4u * slot) + 3).z;
}

vec3 gradient_of(uint slot) {
    return uintBitsToFloat(texelFetch(polynomial_texels, int(4u * slot) + 1).xyz);
}

uint index_of(uint slot) {
    return texelFetch(polynomial_texels, int(4u * slot) + 3).w;
}

Polynomial polynomial_of(uint slot) {
    int at = int(4u * slot);
    uvec4 tail = texelFetch(polynomial_texels, at + 3);
    return Polynomial(center_trust_of(slot), uintBitsToFloat(texelFetch(polynomial_texels, at + 1)),
                      uintBitsToFloat(texelFetch(polynomial_texels, at + 2)), uintBitsToFloat(tail.xy), tail.z, tail.w);
}
#else
layout(std430, binding = TRACE_POLYNOMIALS) readonly buffer Polynomials { Polynomial polynomials[]; };

vec4 center_trust_of(uint slot) {
    return polynomials[slot].center_trust;
}

uint object_of(uint slot) {
    return polynomials[slot].object;
}

vec3 gradient_of(uint slot) {
    return polynomials[slot].gradient_offset.xyz;
}

uint index_of(uint slot) {
    return polynomials[slot].index;
}

Polynomial polynomial_of(uint slot) {
    return polynomials[slot];
}
#endif

#ifdef LISTS
#ifdef QUEUE
layout(binding = TRACE_CELLS) uniform usamplerBuffer range_texels; // two values a cell
layout(binding = TRACE_SLOTS) uniform usamplerBuffer slot_texels; // four

uvec2 range_of(uint cell) {
    return texelFetch(range_texels, int(cell)).xy;
}

uint slot_at(uint place) {
    return texelFetch(slot_texels, int(place / 4u))[place & 3u];
}

uvec4 four_slots_at(uint place) {
    return texelFetch(slot_texels, int(place / 4u));
}
#else
layout(std430, binding = TRACE_CELLS) readonly buffer Cells { uvec2 cells[]; };
layout(std430, binding = TRACE_SLOTS) readonly buffer Slots { uint slots[]; };

// First and past-the-last place of the cell's points in the list of slots.
uvec2 range_of(uint cell) {
    return cells[cell];
}

uint slot_at(uint place) {
    return slots[place];
}

// Those from a multiple of four on; the list has room for four.
uvec4 four_slots_at(uint place) {
    return uvec4(slots[place], slots[place + 1u], slots[place + 2u], slots[place + 3u]);
}
#endif
#endif
#endif
