// environment: what rays that hit nothing see (method, section 6).
//
// twin  crates/reference/src/environment.rs
#ifndef ENVIRONMENT_GLSL
#define ENVIRONMENT_GLSL
#include "stages/scene.glsl"
#include "stages/wave.glsl"
#include "image.glsl"
#include "math.glsl"
#include "scene.glsl"

#define INVERSE_TURN 0.159154943 // 1 / 2 pi
#define INVERSE_HALF_TURN 0.318309886

// The colour of an equirectangular image in a direction of its own frame, of any length: +y is its top row, -z its
// middle, +x right of that. The angle from +y is not by the arc cosine, which loses digits at the poles.
vec3 environment(ImageInfo image, vec3 direction) {
    float level = sqrt(direction.x * direction.x + direction.z * direction.z);
    float u = 0.5 + arc_tangent(direction.x, -direction.z) * INVERSE_TURN;
    float v = arc_tangent(level, direction.y) * INVERSE_HALF_TURN;
    return image_at(image, u, v, true);
}

// What a direction of the world is in the environment's own frame: three rows, which lie after the environment
// among the images.
vec3 turned(uint at, vec3 direction) {
    ImageInfo x = images[at + 1u], y = images[at + 2u], z = images[at + 3u];
    return vec3(dot3(uintBitsToFloat(uvec3(x.first, x.width, x.height)), direction),
                dot3(uintBitsToFloat(uvec3(y.first, y.width, y.height)), direction),
                dot3(uintBitsToFloat(uvec3(z.first, z.width, z.height)), direction));
}

// And back: what one of the environment's own frame is in the world.
vec3 turned_back(uint at, vec3 own) {
    ImageInfo x = images[at + 1u], y = images[at + 2u], z = images[at + 3u];
    return (own.x * uintBitsToFloat(uvec3(x.first, x.width, x.height))
        + own.y * uintBitsToFloat(uvec3(y.first, y.width, y.height)))
        + own.z * uintBitsToFloat(uvec3(z.first, z.width, z.height));
}

// What is seen of the sun in a direction of the world.
vec3 sun_at(uint at, vec3 direction) {
    ImageInfo place = images[at + uint(IMAGES_OF_TURN) + 1u], light = images[at + uint(IMAGES_OF_TURN) + 2u];
    vec3 towards = uintBitsToFloat(uvec3(place.first, place.width, place.height));
    vec3 off = cross3(towards, direction);
    bool within = dot3(towards, direction) > 0.0 && dot3(off, off) <= uintBitsToFloat(place.format);
    return within ? uintBitsToFloat(uvec3(light.first, light.width, light.height)) : vec3(0.0);
}

// The background without its sun.
vec3 background_at(BackgroundInfo background, vec3 direction) {
    vec3 color = background.color;
    if (scene_has(SCENE_ENVIRONMENT)) {
        vec3 own = direction;
        if (scene_has(SCENE_TURNED)) own = turned(background.environment, direction);
        color = environment(images[background.environment], own);
    }
    return color;
}

// With its sun.
vec3 seen_at(BackgroundInfo background, vec3 direction) {
    vec3 seen = background_at(background, direction);
    if (lighting_has(LIGHTING_SUN)) seen += sun_at(background.environment, direction);
    return seen;
}
#endif
