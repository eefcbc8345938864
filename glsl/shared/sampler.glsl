// sampler: the low-discrepancy numbers of a pixel's samples, from (pixel, sample, seed) alone.
//
// twin  crates/reference/src/sampler.rs
// The first two dimensions of Sobol's sequence, padded: each pair of numbers that a sample needs is
// its own copy of them, shuffled and Owen-scrambled by hashes (Burley, Practical Hash-based Owen
// Scrambling, JCGT 2020; the hash of Laine and Karras). So the first 2^k samples of a pixel put one
// into each elementary interval of area 2^-k, and no two pixels or dimensions know of each other.
#ifndef SAMPLER_GLSL
#define SAMPLER_GLSL
#include "math.glsl"

// Every bit depends on every bit. Constants of lowbias32 (Wellons, Prospecting for Hash Functions).
uint mix_bits(uint x) {
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

uint sample_key(uvec2 pixel, uint seed, uint dimension) {
    return mix_bits(pixel.x + mix_bits(pixel.y + mix_bits(dimension + mix_bits(seed + 0x9e3779b9u))));
}

// Owen's scrambling of the binary digits: whether a digit flips depends on those before it.
uint owen_scramble(uint x, uint key) {
    x = bitfieldReverse(x) + key;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return bitfieldReverse(x);
}

// The second dimension of Sobol's sequence, whose matrix is Pascal's triangle modulo 2: digit i is
// the sum of the index's digits k whose bits hold those of i. The first is bitfieldReverse.
uint sobol_second(uint index) {
    uint x = bitfieldReverse(index);
    x ^= x << 16;
    x ^= (x & 0x00ff00ffu) << 8;
    x ^= (x & 0x0f0f0f0fu) << 4;
    x ^= (x & 0x33333333u) << 2;
    x ^= (x & 0x55555555u) << 1;
    return x;
}

// In [0, 1): a float holds 24 bits.
float unit_float(uint x) {
    return float(x >> 8) * 5.9604644775390625e-8;
}

float sample_1d(uvec2 pixel, uint sample_index, uint seed, uint dimension) {
    uint key = sample_key(pixel, seed, dimension);
    uint index = owen_scramble(sample_index, key);
    return unit_float(owen_scramble(bitfieldReverse(index), mix_bits(key + 1u)));
}

vec2 sample_2d(uvec2 pixel, uint sample_index, uint seed, uint dimension) {
    uint key = sample_key(pixel, seed, dimension);
    uint index = owen_scramble(sample_index, key);
    return vec2(unit_float(owen_scramble(bitfieldReverse(index), mix_bits(key + 1u))),
                unit_float(owen_scramble(sobol_second(index), mix_bits(key + 2u))));
}

#define BLOCK_BITS 7u // of a pixel's place in a block that shares a sequence

// Which sample of which sequence a pixel's is where the pixels of a block share one: along a curve of quadrants within
// quadrants, so that those of any quadrant are a run of it, and what one pixel lacks its neighbours have (Ahmed and Wonka,
// Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error, 2020).
struct SharedSample {
    uvec2 pixel;
    uint index;
};

// The bits of a number below 2^16, with a 0 above each.
uint spread_bits(uint x) {
    x = (x | (x << 8)) & 0x00ff00ffu;
    x = (x | (x << 4)) & 0x0f0f0f0fu;
    x = (x | (x << 2)) & 0x33333333u;
    return (x | (x << 1)) & 0x55555555u;
}

// Of a pixel that has at most 2^bits samples.
SharedSample shared_sample(uvec2 pixel, uint index, uint bits) {
    uvec2 within = pixel & ((1u << BLOCK_BITS) - 1u);
    uint along = spread_bits(within.x) | (spread_bits(within.y) << 1);
    return SharedSample(pixel >> BLOCK_BITS, (along << bits) | index);
}

// The unit disc from the unit square, areas kept, (1/2, 1/2) to the very centre (Shirley and Chiu, A
// Low Distortion Map Between Disk and Square, 1997).
vec2 concentric_disc(vec2 u) {
    vec2 a = 2.0 * u - 1.0;
    bool wide = abs(a.x) > abs(a.y);
    float radius = wide ? a.x : a.y;
    float other = wide ? a.y : a.x;
    float angle = 0.785398163 * (other / (radius != 0.0 ? radius : 1.0));
    float along = radius * cos_octant(angle);
    float across = radius * sin_octant(angle);
    return wide ? vec2(along, across) : vec2(across, along);
}
#endif
