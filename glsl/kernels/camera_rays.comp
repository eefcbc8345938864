// camera_rays: the ray through each pixel's centre, in the first cell that it meets.
//
// reads   grid
// writes  the ray state    every pixel
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
layout(push_constant) uniform Push { CameraParams params; };

void main() {
    uvec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, params.tile_size))) return;
    vec2 center = vec2(params.tile_origin + pixel) + 0.5;
    float x = (center.x - params.half_width) * params.scale;
    float y = (params.half_height - center.y) * params.scale;
    vec3 direction = normalize3((params.forward + x * params.right) + y * params.up);
    uint cell = enter_grid(grid, params.eye, direction);
    store_ray(ivec2(pixel), Ray(params.eye, NO_HIT, direction, 0u, cell, 0u, 0u, NONE, vec3(0.0), 0.0));
}
