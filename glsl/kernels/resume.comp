// resume: sends the rays whose hit was refined away on to the next.
//
// reads   the ray state, grid
//         hits
// writes  the ray state    rejected rays alone, in place: they are in the cell of the hit they lost
// runs    one invocation per pixel of the tile
// twin    crates/reference/src/refine.rs
//
// A polynomial that is hit behind that point is listed in the cell of its hit, which no ray has passed
// there.
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#define STATE_WRITES
#include "layout.glsl"
#include "grid.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = TILE_GROUP) in;
layout(std430, binding = TRACE_INFO) readonly buffer Info { GridInfo grid; };
layout(std430, binding = TRACE_HITS) readonly buffer Hits { Hit hits[]; };
layout(push_constant) uniform Push { TraceParams params; };

void main() {
    uvec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, params.tile_size))) return;
    uint status = hits[pixel.y * params.tile_size.x + pixel.x].status;
    if (bitfieldExtract(status, 0, HIT_STATUS_BITS) != HIT_REJECTED) return;
    Ray ray = load_ray(ivec2(pixel));
    ray.after = ray.hit_t;
    ray.hit_t = NO_HIT;
    ray.hit_slot = NONE;
    ray.cell = cell_id(grid, cell_of(grid, ray.origin + ray.after * ray.direction));
    ray.cursor = 0u;
    store_ray(ivec2(pixel), ray);
}
