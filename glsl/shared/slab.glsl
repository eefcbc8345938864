// slab: cells around a trust ball, within the layers of the grid that are listed in one go.
//
// twin  crates/reference/src/grid_build.rs
#ifndef SLAB_GLSL
#define SLAB_GLSL
#include "stages/grid.glsl"
#include "grid.glsl"

#define SMALL_BALL 64u // cells around a ball that one invocation goes through

struct CellBox {
    uvec3 low;
    uvec3 extent;
    uint count;
};

// None where the ball has no radius, or lies in other layers.
CellBox cells_of_slab(GridInfo grid, GridParams params, vec4 ball) {
    uvec3 low, high;
    cells_around(grid, ball.xyz, ball.w * params.ball_scale, low, high);
    low.z = max(low.z, params.first_layer);
    high.z = min(high.z, params.end_layer - 1u);
    bool is_here = ball.w > 0.0 && low.z <= high.z;
    uvec3 extent = is_here ? high - low + 1u : uvec3(1u);
    return CellBox(low, extent, is_here ? extent.x * extent.y * extent.z : 0u);
}

uvec3 cell_of_box(CellBox box, uint nth) {
    uint row = nth / box.extent.x;
    return box.low + uvec3(nth % box.extent.x, row % box.extent.y, row / box.extent.y);
}

// The cell that comes after this one; after the last, any. Without the divisions above: a lane at a time, they
// took half of the time that a grid took to list.
uvec3 next_in_box(CellBox box, uvec3 cell) {
    uint x = cell.x + 1u;
    bool row_ends = x == box.low.x + box.extent.x;
    uint y = cell.y + (row_ends ? 1u : 0u);
    bool layer_ends = y == box.low.y + box.extent.y;
    return uvec3(row_ends ? box.low.x : x, layer_ends ? box.low.y : y, cell.z + (layer_ends ? 1u : 0u));
}

// Points alone are in the one cell around them.
bool meets(GridInfo grid, uvec3 cell, vec3 center, float radius) {
    return radius == 0.0 || ball_meets_cell(grid, cell, center, radius);
}

// A cell's place in its slab.
uint cell_in_slab(GridInfo grid, GridParams params, uvec3 cell) {
    return cell_id(grid, cell - uvec3(0u, 0u, params.first_layer));
}

uint cells_in_slab(GridInfo grid, GridParams params) {
    return grid.resolution.x * grid.resolution.y * (params.end_layer - params.first_layer);
}
#endif
