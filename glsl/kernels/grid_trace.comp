// grid_trace: lets each live ray cross up to K cells of the grid (section 5 of the paper).
//
// reads   the ray state, grid, polynomials
//         cells            first and past-the-last entry of each cell in slots
//         slots            the points of each cell
//         live_rays        those that live, where few of a wave do
// writes  the ray state    every ray, also those that are done: the images swap after this. Of listed rays
//                          in place, theirs alone
//         live             how many rays have not ended yet
//         marks            one bit for each of these, by its place in the list; must be zero before
// runs    one invocation per ray of the wave; dispatched until no ray lives
// twin    crates/reference/src/grid_trace.rs
//
// A ray keeps the nearest hit over all points it tested, whatever cell the hit lies in, and ends
// where that hit is no farther than the exit of its cell, or where it leaves the grid. K = 1 is the
// paper's loop; cells without points do not count. Any K gives the same bits: a pass can end after any
// cell, and, so that no dispatch runs away, after any 32 points of one; cell and cursor say where to go on.
// LEAVING as in structure.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#define STATE_WRITES
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/grid.glsl"
#include "stages/rays.glsl"
#include "math.glsl"
#include "levels.glsl"
#include "scene.glsl"
#include "shape.glsl"
#include "nearest_hit.glsl"
#include "state.glsl"
#include "structure.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(push_constant) uniform Push { TraceParams params; };

#define BATCH 32u // points tested before any is solved: one bit each

void main() {
    uint place = list_index();
    if (place >= params.ray_count) return;
    uint index = ray_at(place, params.listed);
    Ray ray = load_ray(index);

    vec3 o = ray.origin, d = ray.direction;
    uint cells_left = params.cells;
    uint work_left = params.work;
    uint cell = ray.cell;
    if (cell == RAY_STARTS) {
        cell = enter_scene(o, d, ray.after);
        ray.entry = cell;
    }
    bool alive = cell != NONE;
    uint level = alive ? level_of_cell(cell) : 0u;
    GridLevel here = levels[level];
    uvec3 at = cell_of_id(here.grid, alive ? cell - here.first_cell : 0u); // once: lavapipe divides integers lane by lane
    uvec2 range = alive ? range_at(cell) : uvec2(0u);
    uint next = range.x + ray.cursor;
    Nearest nearest = nearest_of(ray, alive);
    LeftSheet left = left_sheet(ray, alive);

    while (alive && cells_left > 0u && work_left > 0u) {
        uint first = next & ~3u; // slots are read four at a time
        uint end = min(range.y, first + BATCH);
        uint candidates = 0u;
        bool later = scene_has(SCENE_REFINES) && ray.after > 0.0;
        bool enters = scene_has(SCENE_LEVELS) ? cell == ray.entry : ray.cells == 0u;
        bool everything = enters || later;
        vec2 within = way_through(here.grid, at, o, d);
        within.x = everything ? -NO_HIT : within.x;
        within.y = later ? NO_HIT : within.y;
        for (uint at_four = first; at_four < end; at_four += 4u) {
            uvec4 four = slot_four_at(at_four);
            uint near = enters_trust_ball(o, d, polynomial_center_trust_at(four.x), ray.hit_t, within) ? 1u : 0u;
            near |= enters_trust_ball(o, d, polynomial_center_trust_at(four.y), ray.hit_t, within) ? 2u : 0u;
            near |= enters_trust_ball(o, d, polynomial_center_trust_at(four.z), ray.hit_t, within) ? 4u : 0u;
            near |= enters_trust_ball(o, d, polynomial_center_trust_at(four.w), ray.hit_t, within) ? 8u : 0u;
            candidates |= near << (at_four - first);
        }
        candidates &= first < end ? (~0u << (next - first)) & (~0u >> (first + BATCH - end)) : 0u;
        uint solved = 0u;
        while (candidates != 0u) {
            uint slot = slot_at(first + uint(findLSB(candidates)));
            candidates &= candidates - 1u;
            Polynomial p = polynomial_at(slot);
            float t = meeting_distance(ray, slot, p, left, params.passed);
            take_nearer(ray, nearest, slot, p, t);
            ++solved;
        }
        ray.tests += end - next;
        next = end;
        work_left -= min(work_left, (end - first + 3u) / 4u + solved + 2u);

#ifdef LEAVING
        bool stops = params.any_hit != 0u && ray.hit_slot != NONE;
        alive = !stops;
        cell = stops ? NONE : cell;
#endif
        // On to the next cell that holds points, once this one is exhausted.
        bool seeking = alive && next == range.y;
        while (seeking && cells_left > 0u && work_left > 0u) {
            uint around = scene_has(SCENE_SKIPS) ? empty_around(range) : 0u;
            vec3 exits = exits_of(here.grid, at, around, o, d);
            bool ends = ray.hit_t <= nearest_exit(exits);
            at = next_cell(here.grid, at, around, scene_has(SCENE_SKIPS), exits, o, d);
            alive = !ends && in_grid(here.grid, at);
            cell = alive ? here.first_cell + cell_id(here.grid, at) : NONE;
            if (scene_has(SCENE_LEVELS)) {
                if (!alive) { // on to the next grid
                    cell = enter_from(level + 1u, o, d, vec2(ray.after, ray.hit_t));
                    alive = cell != NONE;
                    level = alive ? level_of_cell(cell) : level;
                    here = levels[level];
                    at = cell_of_id(here.grid, alive ? cell - here.first_cell : 0u);
                    ray.entry = cell;
                }
            }
            range = alive ? range_at(cell) : uvec2(0u);
            next = range.x;
            seeking = alive && range.x == range.y;
            ray.cells += alive ? 1u : 0u;
            cells_left -= seeking ? 0u : 1u; // of cells with points only
            --work_left;
        }
    }

    ray.cell = cell;
    ray.cursor = next - range.x;
    store_progress(index, ray);
    if (alive) count_live(place);
}
