// block: the scalars at up to eight even places along a ray, for which each point is measured once (docs/method.md,
// section 7).
//
// twin  crates/reference/src/block.rs
// Rows of cells are asked for the points within reach of the way from the first place to the last, a bit each, in up to
// four runs of at most 32. Each of these points is then weighed at all eight places: its square distances and its Gaussian
// weights go from one place to the next by recurrences. Sums are in the order of the cells, and of the file in each.
#ifndef BLOCK_GLSL
#define BLOCK_GLSL
#include "stages/volume.glsl"
#include "math.glsl"
#include "grid.glsl"
#include "volume.glsl"

// Places of a block, from the first, which counts from where the way begins, whichever of them are asked for.
struct Block {
    vec3 first;
    vec3 direction;
    float step;
    float from; // how far along the ray from the first place those begin that are asked for
    float to;   // and end
    uint level; // of the steps there
};

#define BLOCK_MARGIN 2e-3 // of a cell, as ROW_MARGIN: more than rounding moves a point or the ray
#define BLOCK_WIDER 4e-6 // of the square of all that a point may be away: more than recurrences move a square
#define RUN_POINTS 32u

// A run of points in a row of cells, and which of them are near.
struct Run {
    uint first;
    uint near;
};

struct BlockRows {
    uvec3 low;
    uvec3 high;
    uint height;
    uint count;
    vec3 begin; // in cells
    vec3 direction; // in cells
    float reach; // in cells
    float wide; // square of the reach, and BLOCK_WIDER
};

BlockRows rows_of(VolumeInfo volume, Block block) {
    GridInfo grid = volume.grid;
    float reach = sqrt(volume.square_radius);
    float farthest = reach + block.to;
    vec3 a = block.first + block.from * block.direction, b = block.first + block.to * block.direction;
    vec3 low_cell = (min(a, b) - reach - grid.origin) * grid.inverse_edge - BLOCK_MARGIN;
    vec3 high_cell = (max(a, b) + reach - grid.origin) * grid.inverse_edge + BLOCK_MARGIN;
    vec3 last = vec3(grid.resolution - 1u);
    uvec3 low = whole_of(min(max(low_cell, vec3(0.0)), last)), high = whole_of(min(max(high_cell, vec3(0.0)), last));
    uint height = high.y - low.y + 1u;
    uint count = height * (high.z - low.z + 1u);
    if (scene_has(SCENE_SIZES)) {
        bool apart = any(lessThan(high_cell, vec3(0.0))) || any(greaterThan(low_cell, vec3(grid.resolution)));
        count = apart ? 0u : count;
    }
    return BlockRows(low, high, height, count,
                     (block.first - grid.origin) * grid.inverse_edge, block.direction * grid.inverse_edge,
                     reach * grid.inverse_edge + BLOCK_MARGIN,
                     volume.square_radius + BLOCK_WIDER * (farthest * farthest));
}

// Points of a row's cells that the way's reach meets.
uvec2 row_range(VolumeInfo volume, Block block, BlockRows rows, uint row) {
    uint layer = whole_of((float(row) + 0.5) / float(rows.height)); // row / height, which drivers divide a lane at a time
    uvec2 yz = min(rows.low.yz + uvec2(row - layer * rows.height, layer), rows.high.yz);
    // Where along the ray it is within reach of the row, in y and in z.
    vec2 low = (vec2(yz) - rows.reach) - rows.begin.yz, high = (vec2(yz + 1u) + rows.reach) - rows.begin.yz;
    vec2 along = rows.direction.yz;
    vec2 inverse = 1.0 / mix(along, vec2(1e-20), lessThan(abs(along), vec2(1e-20)));
    vec2 one = low * inverse, other = high * inverse;
    vec2 enters = min(one, other), leaves = max(one, other);
    float enter = max(max(enters.x, enters.y), block.from), leave = min(min(leaves.x, leaves.y), block.to);
    float x = rows.begin.x + enter * rows.direction.x, x_end = rows.begin.x + leave * rows.direction.x;
    uint first_x = clamp(whole_of(min(max(min(x, x_end) - rows.reach, 0.0), 8388607.0)), rows.low.x, rows.high.x);
    uint last_x = clamp(whole_of(min(max(max(x, x_end) + rows.reach, 0.0), 8388607.0)), first_x, rows.high.x);
    uint row_first = volume.first_cell + cell_id(volume.grid, uvec3(0u, yz));
    uvec2 range = uvec2(volume_cell_at(row_first + first_x).first, volume_cell_at(row_first + last_x + 1u).first);
    return enter <= leave ? range : uvec2(0u);
}

// The next run of the rows, from a row and a place in it on, which it moves.
Run next_run(VolumeInfo volume, Block block, BlockRows rows, inout uint row, inout uint cursor, inout uint work_left) {
    bool any = row < rows.count;
    uvec2 range = row_range(volume, block, rows, min(row, rows.count - 1u));
    uint first = range.x + cursor;
    uint count = any ? min(range.y - first, RUN_POINTS) : 0u;
    uint near = 0u;
    for (uint i = 0u; i < count; i += 4u) {
        uint few = 0u;
#define NEAR_OF_FOUR(k) { \
        vec3 y = volume_point_position_at(first + i + k) - block.first; \
        float along = dot3(y, block.direction); \
        float t = smaller(larger(along, block.from), block.to); \
        few |= dot3(y, y) + t * (t - 2.0 * along) <= rows.wide ? 1u << k : 0u; \
        }
        NEAR_OF_FOUR(0u) NEAR_OF_FOUR(1u) NEAR_OF_FOUR(2u) NEAR_OF_FOUR(3u)
        near |= few << i;
    }
    near &= count < RUN_POINTS ? (1u << count) - 1u : ~0u;
    bool more = first + count < range.y && any;
    cursor = more ? cursor + count : 0u;
    row += more || !any ? 0u : 1u;
    work_left -= min(work_left, any ? count / 4u + uint(bitCount(near)) + 2u : 0u); // turns of loops
    return Run(first, near);
}

#define LEAST_POWER -126.0
#define LEAST_WEIGHT -115.415604 // the power of two that is e^-80: less does not matter

// Adds the points of the rows of a grid, from a row and a place in it on, to the sums of eight places, until all are added
// or the work is done.
void weigh_rows(VolumeInfo volume, Block block, inout float numerators[BLOCK_PLACES],
                inout float denominators[BLOCK_PLACES], BlockRows rows, inout uint row, inout uint cursor,
                inout uint work_left) {
    bool particles = scene_has(SCENE_PARTICLES) && (!scene_has(SCENE_WEIGHTS) || volume.kernel == VOLUME_SPH);
    bool own = has_own_reaches(volume);
    float s = block.step;
    float width = volume.inverse_width * -1.44269504; // of weights as powers of two
    float square_radius = volume.square_radius;
    float bend = 2.0 * (s * s);
    while (row < rows.count && work_left > 0u) {
        Run one = next_run(volume, block, rows, row, cursor, work_left);
        Run two = next_run(volume, block, rows, row, cursor, work_left);
        Run three = next_run(volume, block, rows, row, cursor, work_left);
        Run four = next_run(volume, block, rows, row, cursor, work_left);
        while ((one.near | two.near | three.near | four.near) != 0u) {
            // The first of those that are left.
            bool of_one = one.near != 0u, of_two = two.near != 0u, of_three = three.near != 0u;
            uint near = of_one ? one.near : (of_two ? two.near : (of_three ? three.near : four.near));
            uint first = of_one ? one.first : (of_two ? two.first : (of_three ? three.first : four.first));
            uint left = near & (near - 1u);
            one.near = of_one ? left : one.near;
            two.near = !of_one && of_two ? left : two.near;
            three.near = !of_one && !of_two && of_three ? left : three.near;
            four.near = of_one || of_two || of_three ? four.near : left;
            uint index = first + findLSB(near);
            VolumePoint point = volume_point_at(index);
            vec3 y = point.position - block.first;
            float along = dot3(y, block.direction);
            float square = dot3(y, y);
            float more = s * s - (2.0 * s) * along;
            float weight = 0.0, ratio = 0.0, fade = 1.0, inverse_length = 0.0;
            if (scene_has(SCENE_PARTICLES) || scene_has(SCENE_SIZES)) inverse_length = inverse_length_at(index);
            if (scene_has(SCENE_WEIGHTS)) {
                float further = 0.0; // of powers from one place to the next
                if (scene_has(SCENE_SIZES)) {
                    float inverse_square = inverse_length * inverse_length;
                    width = own ? (2.0 * inverse_square) * -1.44269504 : width;
                    square_radius = own ? 1.0 / inverse_square : square_radius;
                    further = own ? width * (s * s) : 0.0;
                    fade = power_of_two(max(2.0 * further, LEAST_POWER));
                }
                float power = width * square;
                weight = power < LEAST_WEIGHT ? 0.0 : power_of_two(max(power, LEAST_POWER));
                float more_powers = (-2.0 * width * s) * along;
                if (scene_has(SCENE_SIZES)) more_powers += further;
                ratio = power_of_two(min(max(more_powers, LEAST_POWER), -LEAST_POWER));
            }
#define ADD_AT(k) { \
            float here = 0.0; \
            if (scene_has(SCENE_WEIGHTS)) here = square <= square_radius ? weight : 0.0; \
            if (scene_has(SCENE_PARTICLES)) { \
                float of_particle = spline(sqrt(max(square, 0.0)) * inverse_length); \
                here = particles ? of_particle : here; \
            } \
            denominators[k] += here; \
            numerators[k] += here * point.scalar; \
            weight *= ratio; \
            if (scene_has(SCENE_SIZES)) ratio *= fade; \
            square += more; \
            more += bend; \
            }
            ADD_AT(0) ADD_AT(1) ADD_AT(2) ADD_AT(3) ADD_AT(4) ADD_AT(5) ADD_AT(6) ADD_AT(7)
        }
    }
}

// Adds the points of all grids, from a row and a place in it on, to the sums of eight places, until all are added or the
// work is done; whether all are. Weights of points with one reach lack the factor that is the same for all points of a place
// (place_factor).
bool weigh_points(VolumeInfo volume, Block block, inout float numerators[BLOCK_PLACES],
                  inout float denominators[BLOCK_PLACES], inout uint row_of_size, inout uint cursor, inout uint work_left) {
    if (!scene_has(SCENE_SIZES)) {
        BlockRows rows = rows_of(volume, block);
        weigh_rows(volume, block, numerators, denominators, rows, row_of_size, cursor, work_left);
        return row_of_size >= rows.count;
    }
    uint grids = grids_of(volume, block.level);
    uint size = row_of_size >> SIZE_BITS, row = bitfieldExtract(row_of_size, 0, SIZE_BITS);
    while (size < grids && work_left > 0u) {
        VolumeInfo grid = grid_of(volume, size);
        BlockRows rows = rows_of(grid, block);
        weigh_rows(grid, block, numerators, denominators, rows, row, cursor, work_left);
        work_left -= min(work_left, 2u);
        bool ends = row >= rows.count;
        size += ends ? 1u : 0u;
        row = ends ? 0u : row;
    }
    row_of_size = row | size << SIZE_BITS;
    return size >= grids;
}

// What weigh_points leaves out of the weights of a volume at a place of a block.
float place_factor(VolumeInfo volume, float step, int k) {
    float away = float(k) * step;
    return volume.kernel == VOLUME_SUM && !has_own_reaches(volume)
        ? power_of_two(max((volume.inverse_width * -1.44269504) * (away * away), LEAST_POWER))
        : 1.0;
}
#endif
