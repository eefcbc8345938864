// camera_rays: the ray through each pixel's centre, in the first cell that it meets.
//
// reads   grid
// writes  the ray state, paths   every pixel, and rays that are none where the tile ends before its
//                          last workgroup does
// runs    one invocation per pixel of the tile
// twin    crates/reference/src/camera_rays.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_WRITES
#include "layout.glsl"
#include "math.glsl"
#include "grid.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = TILE_GROUP) in;
layout(std430, binding = TRACE_INFO) readonly buffer Info { GridInfo grid; };
layout(std430, binding = WAVE_PATHS) writeonly buffer Paths { Path paths[]; };
layout(push_constant) uniform Push { CameraParams params; };

void main() {
    uvec2 pixel = tile_pixel();
    uint ray = tile_ray(params.tile_size);
    bool outside = any(greaterThanEqual(pixel, params.tile_size));
    paths[ray] = Path(vec3(1.0), outside ? NONE : pixel.y * params.tile_size.x + pixel.x, CHANNELS_ALL, 0u, 0u, 0u,
                      uint[MEDIA_WORDS](0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u));
    vec2 center = vec2(params.tile_origin + pixel) + 0.5;
    float x = (center.x - params.half_width) * params.scale;
    float y = (params.half_height - center.y) * params.scale;
    vec3 direction = normalize3((params.forward + x * params.right) + y * params.up);
    uint cell = enter_grid(grid, params.eye, direction);
    store_ray(ray, new_ray(params.eye, direction, outside ? NONE : cell, NONE));
}
