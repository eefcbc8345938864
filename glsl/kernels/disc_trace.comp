// disc_trace: the nearest hit of each camera ray among the points whose discs cover its screen tile
// (section 4 of the paper).
//
// reads   the ray state, polynomials, the lists of screen tiles
// writes  the ray state    every ray, also those that are done: the images swap after this
//         live             how many rays have not ended yet
// runs    one invocation per pixel of the tile; dispatched until no ray lives
// twin    crates/reference/src/disc_trace.rs
//
// A workgroup is one screen tile. A ray that `camera_rays` found to miss the grid misses every point.
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#define STATE_WRITES
#include "stages/points.glsl"
#include "stages/discs.glsl"
#include "stages/rays.glsl"
#include "disc_walk.glsl"
#include "index.glsl"

layout(local_size_x = TILE_GROUP) in;
layout(std430, binding = LIVE) buffer Live { uint live; };
layout(push_constant) uniform Push { DiscTraceParams params; };

void main() {
    uvec2 tile = tile_pixel() / uint(DISC_TILE);
    uint at = tile_ray(params.tile_size);
    Ray ray = load_ray(at);
    walk_discs(ray, disc_range_at(tile.y * screen_tiles(params.tile_size).x + tile.x), params.ranks, params.work);
    store_progress(at, ray);
    if (ray.cell != NONE) atomicAdd(live, 1u);
}
