// index: which entry of a list, or which pixel of a tile, an invocation works on.
#ifndef INDEX_GLSL
#define INDEX_GLSL
#include "stages/points.glsl"

// Lists longer than one axis of a dispatch may be are spread over rows of LINE_ROW. Not by
// gl_NumWorkGroups: lavapipe 22.3.6 gives wrong values for it past the first row.
uint list_index() {
    return gl_GlobalInvocationID.y * LINE_ROW + gl_GlobalInvocationID.x;
}

// Of `count` things, even ones first. Where a device's threads take workgroups in runs, as lavapipe's do, each
// gets its share of every part of the picture.
uint spread(uint i, uint count) {
    uint evens = (count + 1u) / 2u;
    return i < evens ? 2u * i : 2u * (i - evens) + 1u;
}

// A workgroup covers 8 x 8 pixels, each run of eight invocations 4 x 2 of them: rays that run
// together should see the same cells.
uvec2 pixel_within(uint i) {
    return uvec2((i & 3u) | ((i >> 1) & 4u), ((i >> 2) & 1u) | ((i >> 3) & 6u));
}

uvec2 tile_pixel() {
    return gl_WorkGroupID.xy * 8u + pixel_within(gl_LocalInvocationID.x);
}

// The ray of that pixel in the wave of rays from the camera: workgroup after workgroup, so that
// neighbours stay together, with rays that are none where the tile ends within a workgroup.
uint tile_ray(uvec2 tile_size) {
    uint across = (tile_size.x + 7u) / 8u;
    return (gl_WorkGroupID.y * across + gl_WorkGroupID.x) * uint(TILE_GROUP) + gl_LocalInvocationID.x;
}

// The pixel of a ray from the camera, the other way round.
uvec2 pixel_of_ray(uint ray, uvec2 tile_size) {
    uint across = (tile_size.x + 7u) / 8u;
    uint i = ray % uint(TILE_GROUP), group = ray / uint(TILE_GROUP);
    return uvec2(group % across, group / across) * 8u + pixel_within(i);
}
#endif
