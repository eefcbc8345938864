// film: what a ray brings back to its pixel.
//
// twin  crates/reference/src/film.rs
// Each channel of a pixel is written by the one ray that carries it to its end, or, where surfaces on its way are lit and
// send rays on, by each of these in turn, which adds. Counts are integers,
// so that adding them in any order gives the same. What the picture has no use for is not written, nor, of
// pixels that show no surface, what is the same for all of them. Whoever includes this has the buffer `film`.
#ifndef FILM_GLSL
#define FILM_GLSL
#include "stages/scene.glsl"
#include "stages/wave.glsl"
#include "scene.glsl"

// Whether a path that ends in the background leaves it out of a transparent picture.
bool leaves_out(uint transparent, bool from_camera, uint channels) {
    bool refracted = (channels & uint(PATH_REFLECTED)) == 0u;
    return transparent != 0u && (from_camera || (transparent == uint(TRANSPARENT_GLASS) && refracted));
}

// The channels that a path carries; with PATH_ADDS among them, to what lit surfaces on its way have written. Where light
// goes from surface to surface, all that comes is added to what the camera's ray has written.
void write_channels(uint pixel, uint channels, vec3 radiance) {
    if (lighting_has(LIGHTING_PATH)) {
        radiance += film[pixel].color.xyz;
    } else if (scene_has(SCENE_GLOSSY)) {
        if ((channels & uint(PATH_ADDS)) != 0u) radiance += film[pixel].color.xyz;
    }
    if ((channels & 1u) != 0u) film[pixel].color.x = radiance.x;
    if ((channels & 2u) != 0u) film[pixel].color.y = radiance.y;
    if ((channels & 4u) != 0u) film[pixel].color.z = radiance.z;
}

void write_alpha(uint pixel, uint channels, vec3 alpha) {
    if (!scene_has(SCENE_ALPHA)) return;
    if ((channels & 1u) != 0u) film[pixel].alpha.x = alpha.x;
    if ((channels & 2u) != 0u) film[pixel].alpha.y = alpha.y;
    if ((channels & 4u) != 0u) film[pixel].alpha.z = alpha.z;
}

// What the camera's ray of a pixel saw. `colored`: no other ray will write its colour.
void write_first(uint pixel, vec4 color, bool colored, bool found, vec4 position_depth, vec4 normal_object, uvec4 counts,
                 vec3 alpha) {
    film[pixel].color.w = color.w;
    film[pixel].normal_object.w = normal_object.w;
    film[pixel].counts.x = counts.x;
    if (colored) film[pixel].color.xyz = color.xyz;
    if (found) {
        film[pixel].position_depth = position_depth;
        film[pixel].normal_object.xyz = normal_object.xyz;
    }
    if (scene_has(SCENE_DIAGNOSTICS)) film[pixel].counts.yzw = counts.yzw;
    if (scene_has(SCENE_ALPHA)) film[pixel].alpha = alpha;
}

void count_work(uint pixel, uint tests, uint cells) {
    atomicAdd(film[pixel].counts.x, tests);
    if (scene_has(SCENE_DIAGNOSTICS)) atomicAdd(film[pixel].counts.y, cells);
}
#endif
