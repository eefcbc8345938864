// sky: directions that light comes from in the background, drawn by how bright it is there (method, section 6).
//
// twin    crates/reference/src/sky.rs
// reads   environment_table    columns and rows; cosines of the borders of rows; the cumulative shares of rows; those of the
//                              columns of each row; densities per steradian
#ifndef SKY_GLSL
#define SKY_GLSL
#include "direction.glsl"
#include "environment.glsl"

layout(std430, binding = ENVIRONMENT_TABLE) readonly buffer EnvironmentTable { float environment_table[]; };

// Columns and rows of cells.
uvec2 table_size() {
    return floatBitsToUint(vec2(environment_table[0], environment_table[1]));
}

// How densely directions are drawn around one of the world, per steradian.
float density_of(BackgroundInfo background, vec3 direction) {
    vec3 own = direction;
    if (scene_has(SCENE_TURNED)) own = turned(background.environment, direction);
    float level = sqrt(own.x * own.x + own.z * own.z);
    float u = 0.5 + arc_tangent(own.x, -own.z) * INVERSE_TURN;
    float v = arc_tangent(level, own.y) * INVERSE_HALF_TURN;
    uvec2 size = table_size();
    uint column = min(uint(max(u, 0.0) * float(size.x)), size.x - 1u);
    uint row = min(uint(max(v, 0.0) * float(size.y)), size.y - 1u);
    return environment_table[3u + 2u * size.y + size.x * (size.y + row) + column];
}

// Which of so many cumulative shares, from `first` on, a number in [0, 1) falls to; `part` is how far within it.
uint fall_to(uint first, uint count, float u, out float part) {
    uint low = 0u, high = count - 1u;
    while (low < high) {
        uint middle = (low + high) / 2u;
        bool above = environment_table[first + middle] > u;
        high = above ? middle : high;
        low = above ? low : middle + 1u;
    }
    float before = low > 0u ? environment_table[first + low - 1u] : 0.0;
    part = (u - before) / (environment_table[first + low] - before);
    return low;
}

struct DrawnDirection {
    vec3 towards; // unit, in the world
    float density; // per steradian
};

// The direction that u in the unit square stands for.
DrawnDirection draw_direction(BackgroundInfo background, vec2 u) {
    uvec2 size = table_size();
    float down, across;
    uint row = fall_to(3u + size.y, size.y, u.y, down);
    uint column = fall_to(3u + 2u * size.y + size.x * row, size.x, u.x, across);
    float border = environment_table[2u + row];
    float y = border + down * (environment_table[3u + row] - border);
    float level = sqrt(max(1.0 - y * y, 0.0));
    // The image's left edge is +z, and a quarter of its width from there is -x.
    vec2 from_edge = on_circle((float(column) + across) / float(size.x));
    vec3 own = vec3(-level * from_edge.y, y, level * from_edge.x);
    vec3 towards = own;
    if (scene_has(SCENE_TURNED)) towards = turned_back(background.environment, own);
    float density = environment_table[3u + 2u * size.y + size.x * (size.y + row) + column];
    return DrawnDirection(towards, density);
}
#endif
