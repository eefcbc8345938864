// math: the few functions whose bits must not depend on a driver.
//
// twin  crates/reference/src/real.rs
// Made of + - * /, sqrt and bit operations alone, in one fixed order. Every float operation of
// every kernel carries NoContraction (crates/kernels/src/exact.rs), so none is fused or reordered.
#ifndef MATH_GLSL
#define MATH_GLSL

#define BY_BITS 8388608.0 // 2^23: added to a whole number below that, it leaves the number in the lowest 23 bits

// What uint(x) is for x from 0 to below 2^23.
#define WHOLE_OF(Floats, Uints) \
Uints whole_of(Floats x) { \
    return floatBitsToUint(floor(x) + BY_BITS) & 0x7fffffu; \
}
WHOLE_OF(float, uint) WHOLE_OF(vec3, uvec3)

#define NO_HIT 3.0e38 // farther than any hit; finite, so that no infinity enters a sum

// The larger of two numbers, unless both are negative: then one of them. By their bits, which compare as integers do:
// what GLSL's max does with NaNs costs lavapipe three operations more.
#define LARGER(Floats) \
Floats larger(Floats a, Floats b) { \
    return intBitsToFloat(max(floatBitsToInt(a), floatBitsToInt(b))); \
}
// The smaller of two numbers; where both are negative, one of them.
#define SMALLER(Floats) \
Floats smaller(Floats a, Floats b) { \
    return intBitsToFloat(min(floatBitsToInt(a), floatBitsToInt(b))); \
}
LARGER(float) LARGER(vec3) LARGER(vec4)
SMALLER(float) SMALLER(vec4)

float dot3(vec3 a, vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

vec3 cross3(vec3 a, vec3 b) {
    return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

vec3 normalize3(vec3 v) {
    return v / sqrt(dot3(v, v));
}

// e^x for -80 <= x <= 0, and 0 below -80, where a weight no longer matters. Error under 2 ulp.
// Reduction after Cody and Waite, Software Manual for the Elementary Functions, ch. 6. Of one number, or of four: each
// step waits for the one before, and four do so together.
#define EXP_NEGATIVE(Floats, Ints, Uints, below) \
Floats exp_negative(Floats x) { \
    Floats clamped = max(x, Floats(-80.0)); \
    Floats n = floor(clamped * 1.44269504 + 0.5); \
    Floats r = (clamped - n * 0.693359375) + n * 2.12194440e-4; \
    Floats p = r * 1.9875691500e-4 + 1.3981999507e-3; \
    p = p * r + 8.3334519073e-3; \
    p = p * r + 4.1665795894e-2; \
    p = p * r + 1.6666665459e-1; \
    p = p * r + 5.0000001201e-1; \
    Floats e = (p * (r * r) + r) + 1.0; \
    Floats scale = uintBitsToFloat(floatBitsToUint(n + (BY_BITS + 127.0)) << 23); \
    return mix(e * scale, Floats(0.0), below(x, Floats(-80.0))); \
}
#define IS_BELOW(a, b) ((a) < (b))
EXP_NEGATIVE(float, int, uint, IS_BELOW)
EXP_NEGATIVE(vec4, ivec4, uvec4, lessThan)

// 2^x from -126 to 126. Error under 3e-7 of it: the polynomial of the fifth degree that is 1 at 0 and departs least, 1e-7, in
// three parts that wait for each other less than one term for the next.
float power_of_two(float x) {
    float n = floor(x + 0.5);
    float r = x - n;
    float square = r * r;
    float low = r * 6.93147004e-1 + 1.0;
    float middle = r * 5.55073358e-2 + 2.40222424e-1;
    float high = r * 1.3264725e-3 + 9.67151299e-3;
    float p = low + square * (middle + square * high);
    return p * uintBitsToFloat(floatBitsToUint(n + (BY_BITS + 127.0)) << 23);
}

// 1 - e^-x for x >= 0, what a way of the optical depth x takes from its light, with all digits however small x is.
// Error under 3 ulp. e^r - 1 by the polynomial of exp_negative, to which the 1 is never added.
float absorptance(float x) {
    float clamped = max(-x, -80.0);
    float n = floor(clamped * 1.44269504 + 0.5);
    float r = (clamped - n * 0.693359375) + n * 2.12194440e-4;
    float p = r * 1.9875691500e-4 + 1.3981999507e-3;
    p = p * r + 8.3334519073e-3;
    p = p * r + 4.1665795894e-2;
    p = p * r + 1.6666665459e-1;
    p = p * r + 5.0000001201e-1;
    float less = p * (r * r) + r;
    float scale = uintBitsToFloat(floatBitsToUint(n + (BY_BITS + 127.0)) << 23);
    return x > 80.0 ? 1.0 : (1.0 - scale) - scale * less;
}

#define SHALLOW 1e-30 // optical depth of which nothing is seen

// (1 - e^-x) / x for x >= 0, and 1 for 0: the mean transmittance from the places of a way to its end.
float mean_transmittance(float x) {
    return x > SHALLOW ? absorptance(x) / (x > SHALLOW ? x : 1.0) : 1.0;
}

// -ln(1 - x) for 0 <= x <= 1/2: the optical depth that takes x, with all digits. Error under 4 ulp. Twice the area
// tangent of x / (2 - x), by its series.
float depth_of_absorptance(float x) {
    float t = x / (2.0 - x);
    float z = t * t;
    float p = 6.66666667e-2 * z + 7.69230769e-2;
    p = p * z + 9.09090909e-2;
    p = p * z + 1.11111111e-1;
    p = p * z + 1.42857143e-1;
    p = p * z + 2.00000000e-1;
    p = p * z + 3.33333333e-1;
    return 2.0 * (t + t * (z * p));
}

// -ln(1 - u) for u from 0 to 1 - 2^-24: the optical depth that takes u. Error under 4 ulp, and 1e-7 near 0.
float depth_of_chance(float u) {
    uint bits = floatBitsToUint(1.0 - u);
    float halvings = float(126 - int(bits >> 23)); // 1 - u is m by 2^-halvings, and m from 1/2 to 1
    float m = uintBitsToFloat((bits & 0x7fffffu) | 0x3f000000u);
    return max(depth_of_absorptance(1.0 - m) + halvings * 0.693147181, 0.0);
}

// Sine and cosine for |x| <= pi / 4. Error under 1 ulp. Polynomials after Moshier's Cephes, sinf.c.
float sin_octant(float x) {
    float z = x * x;
    float p = -1.9515295891e-4;
    p = p * z + 8.3321608736e-3;
    p = p * z - 1.6666654611e-1;
    return p * z * x + x;
}

float cos_octant(float x) {
    float z = x * x;
    float p = 2.443315711809948e-5;
    p = p * z - 1.388731625493765e-3;
    p = p * z + 4.166664568298827e-2;
    return (p * z * z - 0.5 * z) + 1.0;
}

// The angle of (x, y) from the x axis, -pi to pi; 0 for (0, 0). Error under 4 ulp.
// Of the smaller part over the larger, less a quarter of pi where that is over tan(pi / 8): the
// polynomial is that of atanf in S. Moshier's Cephes library.
float arc_tangent(float y, float x) {
    float across = abs(y);
    float along = abs(x);
    float lesser = min(across, along);
    float larger = max(across, along);
    bool steep = lesser > 0.414213562 * larger;
    float over = steep ? lesser - larger : lesser;
    float under = steep ? lesser + larger : larger;
    float t = over / (under > 0.0 ? under : 1.0);
    float z = t * t;
    float p = 8.05374449538e-2;
    p = p * z - 1.38776856032e-1;
    p = p * z + 1.99777106478e-1;
    p = p * z - 3.33329491539e-1;
    float angle = (p * z * t + t) + (steep ? 0.785398163 : 0.0);
    angle = across > along ? 1.57079633 - angle : angle;
    angle = x < 0.0 ? 3.14159265 - angle : angle;
    return y < 0.0 ? -angle : angle;
}
#endif
