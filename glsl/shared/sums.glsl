// sums: long sums that lose no digits.
//
// twin  Sum in crates/reference/src/march.rs
#ifndef SUMS_GLSL
#define SUMS_GLSL
#include "math.glsl"

// Kahan's summation: `lost` is what rounding added to the sum.
float add_to(float sum, float term, inout float lost) {
    float more = term - lost;
    float total = sum + more;
    float left = (total - sum) - more;
    lost = abs(total) < NO_HIT ? left : 0.0; // infinity loses nothing
    return total;
}

vec3 add_to(vec3 sum, vec3 terms, inout vec3 lost) {
    vec3 more = terms - lost;
    vec3 total = sum + more;
    vec3 left = (total - sum) - more;
    lost = mix(vec3(0.0), left, lessThan(abs(total), vec3(NO_HIT)));
    return total;
}
#endif
