// volume: a scalar between points, and what a transfer function makes of it (section 6 of the paper).
//
// twin  crates/reference/src/volume.rs
#ifndef VOLUME_GLSL
#define VOLUME_GLSL
#include "stages/scene.glsl"
#include "stages/volume.glsl"
#include "math.glsl"
#include "grid.glsl"
#include "scene.glsl"

layout(std430, binding = VOLUMES) readonly buffer Volumes { VolumeInfo volumes[]; };

#define SIZE_BITS 24 // of rows, below those of the grid by size that they are of

// How many grids a volume has.
uint grids_of(VolumeInfo volume) {
    return scene_has(SCENE_SIZES) ? max(volume.size_count, 1u) : 1u;
}

// How many of these have points that may be in reach where steps are of a level: all but those of shorter steps.
uint grids_of(VolumeInfo volume, uint level) {
    uint count = grids_of(volume);
    uint by_size = scene_has(SCENE_SIZES) && volume.size_count > 0u ? 1u : 0u;
    while (by_size > 0u) {
        by_size = count > 1u && volumes[volume.first_size + count - 1u].level < level ? 1u : 0u;
        count -= by_size;
    }
    return count;
}

// A volume with one of its grids by size, if it has any.
VolumeInfo grid_of(VolumeInfo volume, uint size) {
    uint by_size = scene_has(SCENE_SIZES) && volume.size_count > 0u ? 1u : 0u;
    while (by_size > 0u) {
        --by_size;
        uint at = volume.first_size + min(size, volume.size_count - 1u);
        volume.grid = volumes[at].grid;
        volume.first_cell = volumes[at].first_cell;
        volume.square_radius = volumes[at].square_radius;
        volume.level = volumes[at].level;
    }
    return volume;
}

// Whether each point has a reach of its own.
bool has_own_reaches(VolumeInfo volume) {
    return scene_has(SCENE_SIZES) && volume.inverse_width == 0.0;
}

vec4 color_of_stop(uint at) {
    return vec4(stop_color_at(at), stop_extinction_at(at));
}

vec3 emission_of_stop(uint at) {
    return vec3(stop_emission_at(at, 0u), stop_emission_at(at, 1u), stop_emission_at(at, 2u));
}

// One of the integrals from the first stop to this one: 2 and 3, 4 and 5 add up.
vec4 integral_to(uint at, uint which) {
    vec4 scattering = which == 2u ? stop_scattering_integral_at(at) : stop_scattering_rest_at(at);
    return which < 4u ? scattering : (which == 4u ? stop_emission_integral_at(at) : stop_emission_rest_at(at));
}

// Where a ray is within a box: x > y, nowhere.
vec2 within_box(vec3 low, vec3 high, vec3 o, vec3 d) {
    vec2 range = vec2(0.0, NO_HIT);
    range = clip_slab(range, low.x, high.x, o.x, d.x);
    range = clip_slab(range, low.y, high.y, o.y, d.y);
    return clip_slab(range, low.z, high.z, o.z, d.z);
}

#define ROW_MARGIN 1e-3 // of a cell: rounding moves no point of a cell farther out of it

// Points of the row-th row of cells, along x, around a sample: in those cells alone that its reach meets. What is left
// out has no weight.
uvec2 row_points(VolumeInfo volume, uvec3 low, uvec3 high, uint row, vec3 x, float reach) {
    uint height = high.y - low.y + 1u;
    uint layer = whole_of((float(row) + 0.5) / float(height)); // row / height, which drivers divide a lane at a time
    uvec2 yz = low.yz + uvec2(row - layer * height, layer);
    vec3 at = (x - volume.grid.origin) * volume.grid.inverse_edge; // in cells, as all of these
    float radius = reach * volume.grid.inverse_edge;
    vec2 away = max(max(vec2(yz) - at.yz, at.yz - vec2(yz + 1u)) - ROW_MARGIN, vec2(0.0));
    float square = radius * radius - (away.x * away.x + away.y * away.y);
    float half_chord = sqrt(max(square, 0.0)) + ROW_MARGIN;
    uint first_x = clamp(whole_of(min(max(at.x - half_chord, 0.0), 8388607.0)), low.x, high.x);
    uint last_x = clamp(whole_of(min(max(at.x + half_chord, 0.0), 8388607.0)), first_x, high.x);
    uint row_first = volume.first_cell + cell_id(volume.grid, uvec3(0u, yz));
    uvec2 range = uvec2(volume_cell_at(row_first + first_x).first, volume_cell_at(row_first + last_x + 1u).first);
    return square >= 0.0 ? range : uvec2(0u);
}

// Points of a row, four at a time, so that they wait for what their weights take together.
struct FourPoints {
    uint at[4];
    vec3 y[4]; // from x
    vec4 scalars;
    vec4 squares; // of their distances from x
    bvec4 are_there; // they are not after the last
};

// Those from a place on and before the end, which is behind it.
FourPoints four_points(uint first, uint end, vec3 x) {
    FourPoints four;
    uint last = end - 1u;
#define POINT_OF_FOUR(i) { \
    four.are_there[i] = first + i <= last; \
    four.at[i] = min(first + i, last); \
    VolumePoint point = volume_point_at(four.at[i]); \
    four.y[i] = point.position - x; \
    four.scalars[i] = point.scalar; \
    four.squares[i] = dot3(four.y[i], four.y[i]); \
}
    POINT_OF_FOUR(0u) POINT_OF_FOUR(1u) POINT_OF_FOUR(2u) POINT_OF_FOUR(3u)
    return four;
}

bvec4 both(bvec4 a, bvec4 b) {
    return bvec4(a.x && b.x, a.y && b.y, a.z && b.z, a.w && b.w);
}


// In the order of the points, as if one by one.
float add_up(float sum, vec4 terms) {
    return (((sum + terms.x) + terms.y) + terms.z) + terms.w;
}

vec3 add_up(vec3 sum, vec4 weights, FourPoints four) {
    return (((sum + weights.x * four.y[0]) + weights.y * four.y[1]) + weights.z * four.y[2]) + weights.w * four.y[3];
}

// Monaghan's cubic spline times pi h^3, at q = d / h: 1 - 3/2 q^2 + 3/4 q^3 below 1, (2 - q)^3 / 4 below 2.
#define SPLINE(Floats) \
Floats spline(Floats q) { \
    Floats far = max(2.0 - q, Floats(0.0)); \
    Floats near = max(1.0 - q, Floats(0.0)); \
    return 0.25 * (far * far * far) - near * near * near; \
}
SPLINE(float) SPLINE(vec4)

vec4 inverse_lengths_of(FourPoints four) {
    return vec4(inverse_length_at(four.at[0]), inverse_length_at(four.at[1]), inverse_length_at(four.at[2]),
                inverse_length_at(four.at[3]));
}

// Weights; `inverse_squares` of reaches are asked for where points have their own.
vec4 gaussians(VolumeInfo volume, FourPoints four, vec4 inverse_squares) {
    vec4 limits = vec4(volume.square_radius), widths = vec4(volume.inverse_width);
    if (scene_has(SCENE_SIZES)) {
        bool own = has_own_reaches(volume);
        limits = own ? 1.0 / inverse_squares : limits;
        widths = own ? 2.0 * inverse_squares : widths;
    }
    bvec4 count = both(four.are_there, lessThanEqual(four.squares, limits));
    return mix(vec4(0.0), exp_negative(-four.squares * widths), count);
}

// 1/r^2 of points with reaches r of their own; 1 of others.
vec4 inverse_squares_of(VolumeInfo volume, FourPoints four) {
    if (!scene_has(SCENE_SIZES)) return vec4(1.0);
    vec4 inverse = inverse_lengths_of(four);
    return has_own_reaches(volume) ? inverse * inverse : vec4(1.0);
}

vec4 splines(FourPoints four, vec4 inverse_lengths) {
    return mix(vec4(0.0), spline(sqrt(four.squares) * inverse_lengths), four.are_there);
}

// What the gradient of the cubic spline is along y = p - x, by 1 / h.
float spline_pull(float q, float inverse_length) {
    float far = max(2.0 - q, 0.0);
    bool near = q < 1.0;
    float slope = near ? 3.0 - 2.25 * q : 0.75 * (far * far) / (near ? 1.0 : q);
    return slope * (inverse_length * inverse_length);
}

vec4 spline_pulls(vec4 q, vec4 inverse_lengths) {
    return vec4(spline_pull(q.x, inverse_lengths.x), spline_pull(q.y, inverse_lengths.y),
                spline_pull(q.z, inverse_lengths.z), spline_pull(q.w, inverse_lengths.w));
}

// The direction of a scalar's gradient, from the sums of the weights' gradients.
vec3 gradient_of(VolumeInfo volume, float scalar, vec3 pull, vec3 weights_pull) {
    return volume.kernel == VOLUME_SHEPARD ? pull - scalar * weights_pull : pull;
}

// Means of a transfer function: what is sent along the ray per length.
struct Shown {
    vec4 scattering; // colour by extinction, and the extinction
    vec3 emission;
};

// Values of eight stops of a volume, evenly among all; after the last, what no scalar reaches. They are read where a volume is
// the only one: rays that go from one to another and back at each step would read them each time.
struct Pivots {
    vec4 low;
    vec4 high;
    uint stride;
};

Pivots pivots_of(VolumeInfo volume) {
    Pivots pivots = Pivots(vec4(NO_HIT), vec4(NO_HIT), 0u);
    pivots.stride = scene_has(SCENE_MANY_VOLUMES) ? 0u : (volume.stop_count + 7u) / 8u;
    if (scene_has(SCENE_MANY_VOLUMES)) return pivots;
#define PIVOT(i, part, at) { \
        uint stop = i * pivots.stride; \
        pivots.part[at] = stop < volume.stop_count ? stop_value_at(volume.first_stop + stop) : NO_HIT; \
    }
    PIVOT(0u, low, 0) PIVOT(1u, low, 1) PIVOT(2u, low, 2) PIVOT(3u, low, 3)
    PIVOT(4u, high, 0) PIVOT(5u, high, 1) PIVOT(6u, high, 2) PIVOT(7u, high, 3)
    return pivots;
}

// How many stops are at or below a scalar.
uint piece_of(VolumeInfo volume, Pivots pivots, float scalar) {
    uvec4 below = uvec4(lessThanEqual(pivots.low, vec4(scalar))) + uvec4(lessThanEqual(pivots.high, vec4(scalar)));
    uint count = (below.x + below.y) + (below.z + below.w);
    bool any = !scene_has(SCENE_MANY_VOLUMES);
    uint high = any ? min(count * pivots.stride, volume.stop_count) : volume.stop_count;
    uint low = any && count > 0u ? (count - 1u) * pivots.stride + 1u : 0u;
    while (low < high) {
        uint middle = (low + high) / 2u;
        bool above = stop_value_at(volume.first_stop + middle) > scalar;
        high = above ? middle : high;
        low = above ? low : middle + 1u;
    }
    return low;
}

// How many stops at or below a scalar bound a steep piece.
float steep_stops(VolumeInfo volume, Pivots pivots, float scalar) {
    uint piece = piece_of(volume, pivots, scalar);
    float count = integral_to(volume.first_stop + max(piece, 1u) - 1u, 4u).w;
    return piece > 0u ? count : 0.0;
}

// Whether a step between two scalars that ends at x is divided: the scalar may pass a steep piece within it.
bool is_divided(VolumeInfo volume, Pivots pivots, float a, float b, vec3 x) {
    uint cell = volume.first_cell + cell_id(volume.grid, cell_of(volume.grid, x));
    float margin = uintBitsToFloat(volume_cell_at(cell).counts & ~uint(CELL_MARKS));
    return steep_stops(volume, pivots, min(a, b) - margin) < steep_stops(volume, pivots, max(a, b) + margin);
}

// The mean from one scalar to another, neither of them beyond the stops of a piece, the higher of which has that value. Colour and extinction are linear
// there, and so is emission; constant beyond the outer stops.
Shown mean_within(VolumeInfo volume, uint piece, float value_high, float a, float b) {
    uint low = volume.first_stop + max(piece, 1u) - 1u;
    uint high = volume.first_stop + min(piece, volume.stop_count - 1u);
    float value_low = stop_value_at(low);
    float span = value_high - value_low;
    float divisor = span > 0.0 ? span : 1.0;
    float from = span > 0.0 ? min(max((a - value_low) / divisor, 0.0), 1.0) : 0.0;
    float to = span > 0.0 ? min(max((b - value_low) / divisor, 0.0), 1.0) : 0.0;
    float middle = 0.5 * (from + to), width = to - from;
    vec4 color_low = color_of_stop(low);
    vec4 change = color_of_stop(high) - color_low;
    vec4 color = color_low + middle * change;
    float bend = (width * width) * 8.33333333e-2;
    vec3 scattering = color.xyz * color.w + (bend * change.w) * change.xyz;
    vec3 emission = vec3(0.0);
    uint glows = scene_has(SCENE_GLOWS) ? volume.slot : 0u; // most do not, and need no more texels
    while (glows > 0u) {
        glows = 0u;
        vec3 emission_low = emission_of_stop(low);
        emission = emission_low + middle * (emission_of_stop(high) - emission_low);
    }
    return Shown(vec4(scattering, color.w), emission);
}

// The mean of the transfer function over all scalars from one to another: pre-integration (Engel et al. 2001), exact
// between stops. What lies between the outer two pieces comes from integrals that the plan made, in two floats each.
Shown mean_of(VolumeInfo volume, Pivots pivots, float a, float b) {
    float low = min(a, b), high = max(a, b);
    uint piece = piece_of(volume, pivots, low);
    uint first = volume.first_stop + min(piece, volume.stop_count - 1u); // the first stop above the lower scalar
    float stop = stop_value_at(first);
    bool several = piece < volume.stop_count && stop <= high;
    float end = several ? stop : high;
    Shown mean = mean_within(volume, piece, stop, low, end);
    uint others = several ? 1u : 0u;
    while (others > 0u) {
        --others;
        uint upper_piece = piece_of(volume, pivots, high);
        uint last = volume.first_stop + upper_piece - 1u; // the last stop not above the higher one
        float begin = stop_value_at(last);
        Shown upper = mean_within(volume, upper_piece, stop_value_at(volume.first_stop + min(upper_piece, volume.stop_count - 1u)), begin, high);
        float lower_part = end - low, upper_part = high - begin, inverse = 1.0 / (high - low);
        vec4 scattering = (integral_to(last, 2u) - integral_to(first, 2u)) + (integral_to(last, 3u) - integral_to(first, 3u));
        vec4 emission = (integral_to(last, 4u) - integral_to(first, 4u)) + (integral_to(last, 5u) - integral_to(first, 5u));
        mean.scattering =
            ((lower_part * mean.scattering + upper_part * upper.scattering) + scattering) * inverse;
        mean.emission = ((lower_part * mean.emission + upper_part * upper.emission) + emission.xyz) * inverse;
    }
    return mean;
}
#endif
