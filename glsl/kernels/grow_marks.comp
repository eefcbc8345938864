// grow_marks: marks the cells beside marked ones, too, along any axis and across.
//
// reads   grid, marks_in
// writes  marks_out
// runs    one invocation per word of 32 cells
// twin    none: what it is a step of has one result, which crates/reference/src/grid_build.rs makes at once
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/grid.glsl"
#include "skip.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = GRID_INFO) readonly buffer Info { GridInfo grid; };
layout(std430, binding = SKIP_MARKS_IN) readonly buffer MarksIn { uint marks_in[]; };
layout(std430, binding = SKIP_MARKS_OUT) writeonly buffer MarksOut { uint marks_out[]; };

void main() {
    uint word = list_index();
    if (word >= mark_words(grid)) return;
    uint across = row_words(grid);
    uint column = word % across;
    uvec2 row = uvec2((word / across) % grid.resolution.y, word / across / grid.resolution.y);
    uvec2 last = min(row + 1u, grid.resolution.yz - 1u);
    uint grown = 0u;
    for (uint z = row.y - min(row.y, 1u); z <= last.y; ++z) {
        for (uint y = row.x - min(row.x, 1u); y <= last.x; ++y) {
            uint first = across * (y + grid.resolution.y * z);
            uint here = marks_in[first + column];
            uint before = column > 0u ? marks_in[first + max(column, 1u) - 1u] : 0u;
            uint after = column + 1u < across ? marks_in[first + min(column + 1u, across - 1u)] : 0u;
            grown |= here | here << 1 | before >> 31 | here >> 1 | after << 31;
        }
    }
    marks_out[word] = grown;
}
