// hits: how kernels read the hits of a wave; with QUEUE as in records.glsl.
#ifndef HITS_GLSL
#define HITS_GLSL
#include "layout.glsl"

#ifdef QUEUE
layout(binding = TRACE_HITS) uniform usamplerBuffer hit_texels; // two a ray

Hit hit_of(uint ray) {
    uvec4 position = texelFetch(hit_texels, int(2u * ray)), normal = texelFetch(hit_texels, int(2u * ray + 1u));
    return Hit(uintBitsToFloat(position.xyz), uintBitsToFloat(position.w), uintBitsToFloat(normal.xyz), normal.w);
}
#else
layout(std430, binding = TRACE_HITS) readonly buffer Hits { Hit hits[]; };

Hit hit_of(uint ray) {
    return hits[ray];
}
#endif
#endif
