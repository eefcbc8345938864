// cell_offsets: where each cell's entries begin in a sorted list of cells.
//
// reads   grid
//         keys             cells, ascending; numbers from the count of cells on belong to none
// writes  offsets          one a cell, and one after the last
// runs    one invocation per entry of offsets
// twin    none: what it is a step of has one result, which crates/reference/src/grid_build.rs makes at once
//
// Unlike ranges, offsets tell where a row of cells begins and ends, also through empty ones.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/grid.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = GRID_INFO) readonly buffer Info { GridInfo grid; };
layout(std430, binding = GRID_KEYS) readonly buffer Keys { uint keys[]; };
layout(std430, binding = CELL_OFFSETS) writeonly buffer Offsets { uint offsets[]; };
layout(push_constant) uniform Push { GridParams params; };

void main() {
    uint cell = list_index();
    if (cell > grid.resolution.x * grid.resolution.y * grid.resolution.z) return;
    uint low = 0u; // every entry before it is of an earlier cell
    uint high = params.pair_count; // every entry from it on is not
    while (low < high) {
        uint middle = (low + high) / 2u;
        bool earlier = keys[middle] < cell;
        low = earlier ? middle + 1u : low;
        high = earlier ? high : middle;
    }
    offsets[cell] = params.first_pair + low;
}
