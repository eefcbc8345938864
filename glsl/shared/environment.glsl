// environment: what rays that hit nothing see (method, section 6).
//
// twin  crates/reference/src/environment.rs
#ifndef ENVIRONMENT_GLSL
#define ENVIRONMENT_GLSL
#include "image.glsl"
#include "math.glsl"
#include "scene.glsl"

#define INVERSE_TURN 0.159154943 // 1 / 2 pi
#define INVERSE_HALF_TURN 0.318309886

// The colour of an equirectangular image in a direction of any length: +y is its top row, -z its
// middle, +x right of that. The angle from +y is not by the arc cosine, which loses digits at the poles.
vec3 environment(ImageInfo image, vec3 direction) {
    float level = sqrt(direction.x * direction.x + direction.z * direction.z);
    float u = 0.5 + arc_tangent(direction.x, -direction.z) * INVERSE_TURN;
    float v = arc_tangent(level, direction.y) * INVERSE_HALF_TURN;
    return image_at(image, u, v, true);
}

vec3 background_at(BackgroundInfo background, vec3 direction) {
    vec3 color = background.color;
    if (scene_has(SCENE_ENVIRONMENT)) color = environment(images[background.environment], direction);
    return color;
}
#endif
