// skip_cells: how far each empty cell is from the next one with points.
//
// reads   grid
//         occupied, beside, near, far   the cells with points, and those at most 1, 2, 3 cells from one
// writes  cells            of an empty cell, an empty range that begins at the distance, in cells along any axis, and
//                          is MOST_SKIPPED at most
// runs    one invocation per word of 32 cells
// twin    crates/reference/src/grid_build.rs, skip_cells
//
// A ray in an empty cell leaves all cells that are nearer at once (grid.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/grid.glsl"
#include "skip.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = GRID_INFO) readonly buffer Info { GridInfo grid; };
layout(std430, binding = CELLS) writeonly buffer Cells { uvec2 cells[]; };
layout(std430, binding = SKIP_OCCUPIED) readonly buffer Occupied { uint occupied[]; };
layout(std430, binding = SKIP_BESIDE) readonly buffer Beside { uint beside[]; };
layout(std430, binding = SKIP_NEAR) readonly buffer Near { uint near[]; };
layout(std430, binding = SKIP_FAR) readonly buffer Far { uint far[]; };

void main() {
    uint word = list_index();
    if (word >= mark_words(grid)) return;
    uint first = first_cell_of(grid, word);
    uint count = cells_of_word(grid, word);
    uvec4 marked = uvec4(occupied[word], beside[word], near[word], far[word]);
    for (uint i = 0u; i < count; ++i) {
        uvec4 within = (marked >> i) & 1u;
        uint distance = uint(MOST_SKIPPED) - (within.y + within.z + within.w);
        if (within.x == 0u) cells[first + i] = uvec2(distance);
    }
}
