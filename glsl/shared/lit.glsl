// lit: the rays of a wave that hit a diffuse surface, and where.
#ifndef LIT_GLSL
#define LIT_GLSL
#include "layout.glsl"

#ifdef QUEUE
layout(binding = WAVE_LIT_RAYS) uniform usamplerBuffer lit_ray_texels; // one value each
layout(binding = WAVE_LIT_HITS) uniform usamplerBuffer lit_hit_texels; // two a ray

uint lit_ray(uint at) {
    return texelFetch(lit_ray_texels, int(at)).x;
}

LitHit lit_hit_of(uint ray) {
    uvec4 position = texelFetch(lit_hit_texels, int(2u * ray));
    vec3 normal = uintBitsToFloat(texelFetch(lit_hit_texels, int(2u * ray + 1u)).xyz);
    return LitHit(uintBitsToFloat(position.xyz), position.w, normal, 0u);
}
#else
layout(std430, binding = WAVE_LIT_RAYS) readonly buffer LitRays { uint lit_rays[]; };
layout(std430, binding = WAVE_LIT_HITS) readonly buffer LitHits { LitHit lit_hits[]; };

uint lit_ray(uint at) {
    return lit_rays[at];
}

LitHit lit_hit_of(uint ray) {
    return lit_hits[ray];
}
#endif
#endif
