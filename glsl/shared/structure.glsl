// structure: what rays go through to their nearest hits: grids, the tree, discs. What each provides is here; no other
// kernel knows which one it is.
//
// twin    crates/reference/src/grid_trace.rs (hits are those of any structure)
// host    crates/render/src/structure/mod.rs
//
// The kernel of a structure, NAME_trace, runs once per ray of the wave, or per ray that is listed, again and again until
// no ray lives. `new_ray` leaves RAY_STARTS in a ray's cell: the structure begins with it. To go on with it in another
// pass, the structure keeps what it likes in cell and cursor, and in two words more (keep_words, kept_words; `entry` is the
// grids' own); NONE in the cell says that the ray is done.
//
// Which polynomial a ray hits, nearest_hit.glsl says. Of all that a ray meets beyond `after` it is the nearest, of equals the first in the order of (object,
// index), to the bit what any other structure finds. (Discs ask the grids only whether a ray meets their boxes.) With LEAVING, rays start on surfaces, whose own sheet they
// do not meet again at once, and may end at any hit: those towards lights. Light for the points of a volume passes the
// surface of its own object.
#ifndef STRUCTURE_GLSL
#define STRUCTURE_GLSL
#include "index.glsl"
#include "stages/rays.glsl"

layout(std430, binding = LIVE) buffer Live { uint live; };
layout(std430, binding = MARKS) buffer Marks { uint marks[]; };
layout(std430, binding = LIVE_RAYS) readonly buffer LiveRays { uint live_rays[]; };

// The ray at a place of the wave or, where rays are listed, of the list.
uint ray_at(uint place, uint listed) {
    return listed != 0u ? live_rays[place] : place;
}

// That ray has not ended.
void count_live(uint place) {
    atomicAdd(live, 1u);
    atomicOr(marks[place / 32u], 1u << (place & 31u));
}
#endif
