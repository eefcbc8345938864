// mark_occupied: a bit for each cell that has points.
//
// reads   grid, cells
// writes  marks            32 cells of a row a word
// runs    one invocation per word
// twin    none: what it is a step of has one result, which crates/reference/src/grid_build.rs makes at once
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/grid.glsl"
#include "skip.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = GRID_INFO) readonly buffer Info { GridInfo grid; };
layout(std430, binding = CELLS) readonly buffer Cells { uvec2 cells[]; };
layout(std430, binding = SKIP_MARKS_OUT) writeonly buffer Marks { uint marks[]; };

void main() {
    uint word = list_index();
    if (word >= mark_words(grid)) return;
    uint first = first_cell_of(grid, word);
    uint count = cells_of_word(grid, word);
    uint marked = 0u;
    for (uint i = 0u; i < count; ++i) {
        uvec2 range = cells[first + i];
        marked |= range.x < range.y ? 1u << i : 0u;
    }
    marks[word] = marked;
}
