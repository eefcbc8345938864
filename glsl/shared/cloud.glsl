// cloud: how the build reads points, and what it keeps about them.
//
// Through uniform texel buffers where the device allows ones long enough (records.glsl says why), else
// through storage buffers. Both give the same bits.
#ifndef CLOUD_GLSL
#define CLOUD_GLSL
#include "layout.glsl"

#ifdef POINTS_AS_TEXELS
#define WORDS(at, name) layout(binding = at) uniform usamplerBuffer name
uvec4 words_of(usamplerBuffer texels, uint at) {
    return texelFetch(texels, int(at));
}
#else
#define WORDS(at, name) layout(std430, binding = at) readonly buffer name##_block { uvec4 name[]; }
#define words_of(words, at) words[at]
#endif

// d2 as every neighbour search of the project computes it.
float square_of(vec3 way) {
    return (way.x * way.x + way.y * way.y) + way.z * way.z;
}
#endif
