// grid_ranges: where each cell's points begin and end in the sorted lists of all slabs.
//
// reads   grid
//         keys             cells of one slab, ascending
// writes  cells            first and past-the-last pair; empty cells keep the zeros they hold
// runs    one invocation per pair
// twin    none: what it is a step of has one result, which crates/reference/src/grid_build.rs makes at once
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/grid.glsl"
#include "slab.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = GRID_INFO) readonly buffer Info { GridInfo grid; };
layout(std430, binding = GRID_KEYS) readonly buffer Keys { uint keys[]; };
layout(std430, binding = CELLS) writeonly buffer Cells { uvec2 cells[]; };
layout(push_constant) uniform Push { GridParams params; };

void main() {
    uint pair = list_index();
    if (pair >= params.pair_count) return;
    uint key = keys[pair];
    if (key >= cells_in_slab(grid, params)) return; // a pair that met no cell
    bool first = pair == 0u || keys[max(pair, 1u) - 1u] != key;
    bool last = pair + 1u == params.pair_count || keys[min(pair + 1u, params.pair_count - 1u)] != key;
    uint cell = key + cell_id(grid, uvec3(0u, 0u, params.first_layer));
    if (first) cells[cell].x = params.first_pair + pair;
    if (last) cells[cell].y = params.first_pair + pair + 1u;
}
