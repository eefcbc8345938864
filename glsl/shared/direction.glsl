// direction: unit vectors: about an axis, and in 32 bits.
//
// twin  crates/reference/src/direction.rs
#ifndef DIRECTION_GLSL
#define DIRECTION_GLSL
#include "math.glsl"

// The direction at sines (s.x, s.y) about a unit axis (frame after Duff et al., Building an
// Orthonormal Basis, Revisited, JCGT 2017).
vec3 about_axis(vec3 axis, vec2 s, float cosine) {
    float side = axis.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (side + axis.z);
    float b = axis.x * axis.y * a;
    vec3 first = vec3(1.0 + side * axis.x * axis.x * a, side * b, -side * axis.x);
    vec3 second = vec3(b, side + axis.y * axis.y * a, -axis.y);
    return (s.x * first + s.y * second) + cosine * axis;
}

#define TURN 6.28318531

// Cosine and sine of an angle in turns, 0 to 1.
vec2 on_circle(float turns) {
    float quarters = floor(4.0 * turns + 0.5);
    float rest = (turns - 0.25 * quarters) * TURN;
    float s = sin_octant(rest), c = cos_octant(rest);
    uint quarter = uint(quarters) & 3u;
    return quarter == 0u ? vec2(c, s) : (quarter == 1u ? vec2(-s, c) : (quarter == 2u ? vec2(-c, -s) : vec2(s, -c)));
}

// The outer corners of the square, which are the lower half of the octahedron, are folded inwards, and back.
vec2 folded(vec2 p) {
    return (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
}

// Through an octahedron that is unfolded to a square (Meyer et al., On Floating-Point Normal Vectors, 2010), 16 bits an
// axis. What comes back is less than 7e-5 off.
uint packed_direction(vec3 v) {
    vec2 p = v.xy / (abs(v.x) + abs(v.y) + abs(v.z));
    p = v.z < 0.0 ? folded(p) : p;
    uvec2 word = uvec2(p * 32767.0 + 32767.5);
    return word.x | word.y << 16;
}

vec3 unpacked_direction(uint packed) {
    vec2 p = (vec2(packed & 0xffffu, packed >> 16) - 32767.0) / 32767.0;
    float z = (1.0 - abs(p.x)) - abs(p.y);
    return normalize3(vec3(z < 0.0 ? folded(p) : p, z));
}
#endif
