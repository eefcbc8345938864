// light: what a light sends to a point (method, section 4).
//
// twin  crates/reference/src/light.rs
#ifndef LIGHT_GLSL
#define LIGHT_GLSL
#include "layout.glsl"
#include "math.glsl"

struct LightSample {
    vec3 towards;   // unit, to the light
    float distance; // of it, or NO_HIT
    vec3 arriving;  // irradiance on a surface that faces it
};

LightSample sample_light(Light light, vec3 x, vec2 u) {
    vec3 towards = light.vector - x;
    float square = dot3(towards, towards);
    bool is_point = light.kind == LIGHT_POINT && square > 0.0;
    vec3 l = is_point ? towards / sqrt(square) : light.vector;
    vec3 arriving = is_point ? light.strength / square : light.strength;
    vec3 nothing = vec3(0.0);
    return LightSample(l, is_point ? sqrt(square) : NO_HIT, light.kind == LIGHT_POINT && !is_point ? nothing : arriving);
}
#endif
