// image: colours of textures and of the environment, decoded to linear RGB before they are blended.
//
// twin    crates/reference/src/image.rs
// reads   images
//         texels   the linear value of each byte of sRGB, 256 of them; then the images' texels
// Not through samplers: how those filter and decode differs from driver to driver.
#ifndef IMAGE_GLSL
#define IMAGE_GLSL
#include "stages/wave.glsl"

layout(std430, binding = IMAGES) readonly buffer Images { ImageInfo images[]; };
layout(std430, binding = TEXELS_OF_IMAGES) readonly buffer Texels { uint texels[]; };

vec3 texel_of(ImageInfo image, uint column, uint row) {
    uint at = row * image.width + column;
    bool is_srgb = image.format == IMAGE_SRGB8;
    uint first = image.first + (is_srgb ? at : 3u * at);
    uint word = texels[first];
    uvec3 place = is_srgb ? uvec3(word, word >> 8, word >> 16) & 255u : first + uvec3(0u, 1u, 2u);
    return uintBitsToFloat(uvec3(texels[place.x], texels[place.y], texels[place.z]));
}

// The two texels on either side of a place along one axis, and how far it is from the first to the
// second. The centre of texel i is at (i + 1/2) / count; beyond the outer ones the image goes on with
// them or, where it wraps, with those of the other side. Any `at` is legal where it does not wrap;
// else it is from 0 to 1.
uvec2 texels_around(float at, uint count, bool wraps, out float part) {
    float last = float(count) - 1.0;
    float place = at * float(count) - 0.5;
    place = clamp(place, wraps ? -1.0 : 0.0, wraps ? float(count) : last);
    float below = floor(place);
    part = place - below;
    float first = below < 0.0 ? last : (below > last ? 0.0 : below);
    float second = first < last ? first + 1.0 : (wraps ? 0.0 : last);
    return uvec2(uint(first), uint(second));
}

// The colour at u of its width and v of its height, from the upper left corner, bilinear.
vec3 image_at(ImageInfo image, float u, float v, bool wraps) {
    float across, down;
    uvec2 columns = texels_around(u, image.width, wraps, across);
    uvec2 rows = texels_around(v, image.height, false, down);
    vec3 upper_left = texel_of(image, columns.x, rows.x);
    vec3 upper_right = texel_of(image, columns.y, rows.x);
    vec3 lower_left = texel_of(image, columns.x, rows.y);
    vec3 lower_right = texel_of(image, columns.y, rows.y);
    vec3 upper = upper_left + across * (upper_right - upper_left);
    vec3 lower = lower_left + across * (lower_right - lower_left);
    return upper + down * (lower - upper);
}
#endif
