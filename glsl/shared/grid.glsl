// grid: cells of the uniform grid, and the steps of a ray through them.
//
// twin  crates/reference/src/grid.rs
// Steps after Amanatides and Woo, A Fast Voxel Traversal Algorithm for Ray Tracing (1987), but
// every exit is computed from the cell itself, never by adding up: a ray can stop anywhere
// and go on in another pass with the same bits.
#ifndef GRID_GLSL
#define GRID_GLSL
#include "stages/points.glsl"
#include "stages/grid.glsl"
#include "math.glsl"

#define PARALLEL 1e-20     // a direction's component under this never crosses a face

uint cell_id(GridInfo grid, uvec3 cell) {
    return cell.x + grid.resolution.x * (cell.y + grid.resolution.y * cell.z);
}

uvec3 cell_of_id(GridInfo grid, uint id) {
    uint row = id / grid.resolution.x;
    return uvec3(id % grid.resolution.x, row % grid.resolution.y, row / grid.resolution.y);
}

// The cell that holds x, or the nearest one where x lies outside.
uvec3 cell_of(GridInfo grid, vec3 x) {
    vec3 at = floor((x - grid.origin) * grid.inverse_edge);
    return whole_of(clamp(at, vec3(0.0), vec3(grid.resolution) - 1.0));
}

bool in_box(GridInfo grid, vec3 x) {
    vec3 at = (x - grid.origin) * grid.inverse_edge;
    return all(greaterThanEqual(at, vec3(0.0))) && all(lessThan(at, vec3(grid.resolution)));
}

// Cells low .. high (inclusive) hold every cell that the ball could meet.
void cells_around(GridInfo grid, vec3 center, float radius, out uvec3 low, out uvec3 high) {
    low = cell_of(grid, center - radius);
    high = cell_of(grid, center + radius);
}

bool ball_meets_cell(GridInfo grid, uvec3 cell, vec3 center, float radius) {
    vec3 low = grid.origin + vec3(cell) * grid.edge;
    vec3 high = grid.origin + vec3(cell + 1u) * grid.edge;
    vec3 away = larger(larger(low - center, center - high), vec3(0.0));
    return dot3(away, away) <= radius * radius;
}

// Distance along the ray to the face that it leaves through of the box of cells at most `around` from the
// cell, along one axis.
float exit_of(float origin, float edge, int cell, int around, float o, float d) {
    bool crosses = abs(d) > PARALLEL;
    float face = origin + float(d > 0.0 ? cell + around + 1 : cell - around) * edge;
    return crosses ? (face - o) / (crosses ? d : 1.0) : NO_HIT;
}

vec3 exits_of(GridInfo grid, uvec3 cell, uint around, vec3 o, vec3 d) {
    return vec3(exit_of(grid.origin.x, grid.edge, int(cell.x), int(around), o.x, d.x),
                exit_of(grid.origin.y, grid.edge, int(cell.y), int(around), o.y, d.y),
                exit_of(grid.origin.z, grid.edge, int(cell.z), int(around), o.z, d.z));
}

float nearest_exit(vec3 t) {
    return min(t.x, min(t.y, t.z));
}

// Where a ray's way through the cell begins and ends.
vec2 way_through(GridInfo grid, uvec3 cell, vec3 o, vec3 d) {
    vec3 enters = -exits_of(grid, cell, 0u, o, -d);
    return vec2(max(enters.x, max(enters.y, enters.z)), nearest_exit(exits_of(grid, cell, 0u, o, d)));
}

// One axis of the slabs of the grid's box: narrows [range.x, range.y].
vec2 clip_slab(vec2 range, float low, float high, float o, float d) {
    bool crosses = abs(d) > PARALLEL;
    float divisor = crosses ? d : 1.0;
    float a = (low - o) / divisor;
    float b = (high - o) / divisor;
    bool inside = o >= low && o <= high;
    vec2 clipped = vec2(max(range.x, min(a, b)), min(range.y, max(a, b)));
    return crosses ? clipped : (inside ? range : vec2(NO_HIT, -NO_HIT));
}

// The first cell of a ray within a range of distances, or NONE where it misses the grid there.
uint enter_grid(GridInfo grid, vec3 o, vec3 d, vec2 range) {
    vec3 high = grid.origin + vec3(grid.resolution) * grid.edge;
    range = clip_slab(range, grid.origin.x, high.x, o.x, d.x);
    range = clip_slab(range, grid.origin.y, high.y, o.y, d.y);
    range = clip_slab(range, grid.origin.z, high.z, o.z, d.z);
    bool misses = range.x > range.y;
    uvec3 cell = cell_of(grid, misses ? o : o + range.x * d);
    return misses ? NONE : cell_id(grid, cell);
}

// How many cells around one of these are empty with it, where `range` is its range of points: the range of
// an empty one begins at the distance to the next that is not (skip_cells.comp).
uint empty_around(uvec2 range) {
    return range.x == range.y ? max(range.x, 1u) - 1u : 0u;
}

// The next cell behind the face at the nearest of the exits t of the box of cells `around` the cell (ties:
// the lower axis); outside the grid, one past some axis. Along the other axes it is where the ray is
// then, in the box, and never behind where it was. Unless `skips`, the box is the cell alone.
uvec3 next_cell(GridInfo grid, uvec3 cell, uint around, bool skips, vec3 t, vec3 o, vec3 d) {
    ivec3 from = ivec3(cell);
    ivec3 reached = from;
    if (skips) reached = ivec3(cell_of(grid, o + nearest_exit(t) * d));
    ivec3 ahead = ivec3(greaterThan(d, vec3(0.0)));
    ivec3 low = from - (1 - ahead) * int(around);
    ivec3 high = from + ahead * int(around);
    bool along_x = t.x <= t.y && t.x <= t.z;
    bool along_y = !along_x && t.y <= t.z;
    bool along_z = !along_x && !along_y;
    bvec3 axis = bvec3(along_x, along_y, along_z);
    ivec3 beyond = mix(low - 1, high + 1, equal(ahead, ivec3(1)));
    return uvec3(mix(clamp(reached, low, high), beyond, axis)); // under 0: a number past every resolution
}

bool in_grid(GridInfo grid, uvec3 cell) {
    return all(lessThan(cell, grid.resolution));
}
#endif
