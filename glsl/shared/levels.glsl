// levels: the grids of a scene, one after another on a ray's way: one, or where the sizes of trust balls differ
// much, one a size and place.
//
// twin  crates/reference/src/levels.rs
// A cell's number counts through all grids. Rays go through the grids one by one, the finest first, and know the
// nearest hit of those before; whatever lies in the way of a ray is listed in one of them.
#ifndef LEVELS_GLSL
#define LEVELS_GLSL
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/grid.glsl"
#include "grid.glsl"
#include "scene.glsl"

layout(std430, binding = LEVELS) readonly buffer Info { GridLevel levels[]; };

uint level_count() {
    return scene_has(SCENE_LEVELS) ? uint(levels.length()) : 1u;
}

uint level_of_cell(uint cell) {
    uint level = 0u;
    if (scene_has(SCENE_LEVELS)) {
        while (level + 1u < level_count() && cell >= levels[level + 1u].first_cell) ++level;
    }
    return level;
}

// The first cell of a ray in the first of the grids from `level` on that it meets within a range of distances;
// NONE where it meets none.
uint enter_from(uint level, vec3 o, vec3 d, vec2 range) {
    uint cell = NONE;
    while (cell == NONE && level < level_count()) {
        uint entered = enter_grid(levels[level].grid, o, d, range);
        cell = entered == NONE ? NONE : levels[level].first_cell + entered;
        ++level;
    }
    return cell;
}

// The first cell of a ray of which hits up to `after` do not count; NONE where it misses all grids beyond.
uint enter_scene(vec3 o, vec3 d, float after) {
    vec2 range = vec2(after, NO_HIT);
    uint cell = NONE;
    if (scene_has(SCENE_LEVELS)) {
        cell = enter_from(0u, o, d, range);
    } else {
        cell = enter_grid(levels[0].grid, o, d, range);
    }
    return cell;
}

// Whether one of the grids may list points of an object, `slots` being its first slot and their number.
bool lists_some(uint level, uvec2 slots) {
    return level_count() == 1u || (levels[level].first_slot < slots.x + slots.y && slots.x < levels[level].end_slot);
}

// The cell of one of the grids around x.
uint cell_around(uint level, vec3 x) {
    GridLevel at = levels[level];
    return at.first_cell + cell_id(at.grid, cell_of(at.grid, x));
}
#endif
