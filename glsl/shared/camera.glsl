// camera: the direction of a camera's ray (method, section 6).
//
// twin  crates/reference/src/camera_rays.rs
// Whoever includes this has push constants `params` with a camera.
#ifndef CAMERA_GLSL
#define CAMERA_GLSL
#include "math.glsl"

// A place in the picture, `offset` pixels from the centre of a pixel of the full image: at distance 1, if the
// projection is perspective.
vec2 place_in_view(uvec2 pixel, vec2 offset) {
    vec2 center = vec2(pixel) + 0.5;
    return vec2(((center.x - params.half_width) + offset.x) * params.scale,
                ((params.half_height - center.y) - offset.y) * params.scale);
}

vec3 camera_direction(vec2 slope) {
    return normalize3((params.forward + slope.x * params.right) + slope.y * params.up);
}
#endif
