// disc_trace: the nearest hit of each camera ray among the points whose discs cover its screen tile
// (section 4 of the paper).
//
// reads   the ray state, polynomials, the lists of screen tiles
//         live_rays        those that live, where few of a wave do
// writes  the ray state    every ray, also those that are done: the images swap after this. Of listed rays
//                          in place, theirs alone
//         live             how many rays have not ended yet
//         marks            one bit for each of these, by its place in the list; must be zero before
// runs    one invocation per ray of the wave; dispatched until no ray lives
// twin    crates/reference/src/disc_trace.rs
//
// Where no rays are listed, a workgroup is one screen tile.
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#define STATE_WRITES
#include "stages/points.glsl"
#include "stages/discs.glsl"
#include "stages/rays.glsl"
#include "disc_walk.glsl"
#include "structure.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(push_constant) uniform Push { DiscTraceParams params; };

void main() {
    uint place = list_index();
    if (place >= params.wave.ray_count) return;
    uint index = ray_at(place, params.wave.listed);
    Ray ray = load_ray(index);
    begin_discs(ray);
    walk_discs(ray, disc_range_at(index / uint(TILE_GROUP)), params.ranks, params.wave.work);
    store_progress(index, ray);
    if (ray.cell != NONE) count_live(place);
}
