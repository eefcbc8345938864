// camera_rays: the camera's ray of each pixel (method, section 6).
//
// reads   filter_steps     where the integral of the reconstruction filter takes equal steps, in pixels
//                          from the centre of a pixel
//         start            the path of every ray, but for its pixel
// writes  the ray state, paths   every pixel, and rays that are none where the tile ends before its
//                          last workgroup does
// runs    one invocation per pixel of the tile
// twin    crates/reference/src/camera_rays.rs
//
// The one ray of a pixel goes through the pixel's centre and the lens's. One of many goes through a
// place that is drawn from the filter, so that all count alike (Ernst, Stamminger and Greiner 2006).
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_WRITES
#include "stages/points.glsl"
#include "stages/rays.glsl"
#include "stages/wave.glsl"
#include "sampler.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = TILE_GROUP) in;
layout(std430, binding = CAMERA_PATH) readonly buffer Start { Path start; };
layout(std430, binding = PATHS) writeonly buffer Paths { Path paths[]; };
layout(std430, binding = CAMERA_FILTER) readonly buffer Filter { float filter_steps[]; };
layout(push_constant) uniform Push { CameraParams params; };
#include "camera.glsl"

float filter_place(float u) {
    float at = u * float(FILTER_INTERVALS);
    float low = floor(at);
    float a = filter_steps[uint(low)], b = filter_steps[uint(low) + 1u];
    return a + (at - low) * (b - a);
}

void main() {
    uvec2 pixel = tile_pixel();
    uint ray = tile_ray(params.tile_size);
    bool outside = any(greaterThanEqual(pixel, params.tile_size));
    paths[ray] = start;
    paths[ray].pixel = outside ? NONE : pixel.y * params.tile_size.x + pixel.x;
    uvec2 at = params.tile_origin + pixel;
    vec2 offset = vec2(0.0), lens = vec2(0.0);
    if (params.sample_index != NONE) {
        vec2 u = sample_2d(at, params.sample_index, params.seed, uint(SAMPLE_FILM));
        offset = vec2(filter_place(u.x), filter_place(u.y));
        u = sample_2d(at, params.sample_index, params.seed, uint(SAMPLE_LENS));
        lens = params.lens_radius * concentric_disc(u);
    }
    vec2 place = place_in_view(at, offset);
    bool parallel = params.projection == ORTHOGRAPHIC;
    vec2 slope = (parallel ? vec2(0.0) : place) - lens / params.focus;
    vec2 start = (parallel ? place : vec2(0.0)) + lens;
    vec3 direction = camera_direction(slope);
    bool from_eye = start.x == 0.0 && start.y == 0.0;
    vec3 origin = from_eye ? params.eye : (params.eye + start.x * params.right) + start.y * params.up;
    Ray made = new_ray(origin, direction, NONE);
    made.cell = outside ? NONE : made.cell;
    store_ray(ray, made);
}
