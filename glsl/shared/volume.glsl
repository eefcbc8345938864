// volume: a scalar between points, and what a transfer function makes of it (section 6 of the paper).
//
// twin  crates/reference/src/volume.rs
#ifndef VOLUME_GLSL
#define VOLUME_GLSL
#include "layout.glsl"
#include "math.glsl"
#include "grid.glsl"

layout(std430, binding = MARCH_VOLUMES) readonly buffer Volumes { VolumeInfo volumes[]; };
layout(std430, binding = MARCH_CELLS) readonly buffer VolumeCells { VolumeCell volume_cells[]; };
layout(std430, binding = MARCH_POINTS) readonly buffer VolumePoints { VolumePoint volume_points[]; };
layout(std430, binding = MARCH_LENGTHS) readonly buffer Lengths { float inverse_lengths[]; };
layout(std430, binding = MARCH_STOPS) readonly buffer Stops { VolumeStop stops[]; };

// Where a ray is within a box: x > y, nowhere.
vec2 within_box(vec3 low, vec3 high, vec3 o, vec3 d) {
    vec2 range = vec2(0.0, NO_HIT);
    range = clip_slab(range, low.x, high.x, o.x, d.x);
    range = clip_slab(range, low.y, high.y, o.y, d.y);
    return clip_slab(range, low.z, high.z, o.z, d.z);
}

// Points of the row-th row of cells, along x, around a sample.
uvec2 row_points(VolumeInfo volume, uvec3 low, uvec3 high, uint row) {
    uint height = high.y - low.y + 1u;
    uvec2 yz = low.yz + uvec2(row % height, row / height);
    uint first = volume.first_cell + cell_id(volume.grid, uvec3(low.x, yz));
    return uvec2(volume_cells[first].first, volume_cells[first + (high.x - low.x) + 1u].first);
}

// Monaghan's cubic spline times pi h^3, at q = d / h: 1 - 3/2 q^2 + 3/4 q^3 below 1, (2 - q)^3 / 4 below 2.
float spline(float q) {
    float far = max(2.0 - q, 0.0);
    float near = max(1.0 - q, 0.0);
    return 0.25 * (far * far * far) - near * near * near;
}

// What the gradient of the cubic spline is along y = p - x, by 1 / h.
float spline_pull(float q, float inverse_length) {
    float far = max(2.0 - q, 0.0);
    bool near = q < 1.0;
    float slope = near ? 3.0 - 2.25 * q : 0.75 * (far * far) / (near ? 1.0 : q);
    return slope * (inverse_length * inverse_length);
}

// The direction of a scalar's gradient, from the sums of the weights' gradients.
vec3 gradient_of(VolumeInfo volume, float scalar, vec3 pull, vec3 weights_pull) {
    return volume.kernel == VOLUME_SHEPARD ? pull - scalar * weights_pull : pull;
}

// Colour and extinction of a scalar: linear between stops, constant beyond the outer ones.
vec4 transfer(VolumeInfo volume, float scalar) {
    uint low = volume.first_stop; // the last stop not above the scalar, or the first
    uint high = volume.first_stop + volume.stop_count; // one behind
    while (high - low > 1u) {
        uint middle = (low + high) / 2u;
        bool above = stops[middle].value > scalar;
        high = above ? middle : high;
        low = above ? low : middle;
    }
    VolumeStop from = stops[low];
    VolumeStop to = stops[min(low + 1u, volume.first_stop + volume.stop_count - 1u)];
    float span = to.value - from.value;
    float part = span > 0.0 ? min(max((scalar - from.value) / (span > 0.0 ? span : 1.0), 0.0), 1.0) : 0.0;
    return vec4(from.color + part * (to.color - from.color), from.extinction + part * (to.extinction - from.extinction));
}
#endif
