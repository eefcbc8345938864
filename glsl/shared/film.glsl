// film: what a ray brings back to its pixel.
//
// twin  crates/reference/src/wave.rs
// Each channel of a pixel is written by the one ray that carries it to its end. Counts are integers,
// so that adding them in any order gives the same. Whoever includes this has the buffer `film`.
#ifndef FILM_GLSL
#define FILM_GLSL
#include "layout.glsl"

// Whether a path that ends in the background leaves it out of a transparent picture.
bool leaves_out(uint transparent, bool from_camera, uint channels) {
    bool refracted = (channels & uint(PATH_REFLECTED)) == 0u;
    return transparent != 0u && (from_camera || (transparent == uint(TRANSPARENT_GLASS) && refracted));
}

void write_channels(uint pixel, uint channels, vec3 radiance) {
    if ((channels & 1u) != 0u) film[pixel].color.x = radiance.x;
    if ((channels & 2u) != 0u) film[pixel].color.y = radiance.y;
    if ((channels & 4u) != 0u) film[pixel].color.z = radiance.z;
}

void write_alpha(uint pixel, uint channels, vec3 alpha) {
    if ((channels & 1u) != 0u) film[pixel].alpha.x = alpha.x;
    if ((channels & 2u) != 0u) film[pixel].alpha.y = alpha.y;
    if ((channels & 4u) != 0u) film[pixel].alpha.z = alpha.z;
}

void count_work(uint pixel, uint tests, uint cells) {
    atomicAdd(film[pixel].counts.x, tests);
    atomicAdd(film[pixel].counts.y, cells);
}
#endif
