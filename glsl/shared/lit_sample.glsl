// lit_sample: a volume at one place of a ray, with the light that reaches its points.
//
// twin  Sums in crates/reference/src/volume.rs
// Whoever includes this has push constants `params` of a march, lights, and the light of points.
#ifndef LIT_SAMPLE_GLSL
#define LIT_SAMPLE_GLSL
#include "math.glsl"
#include "volume.glsl"
#include "light.glsl"
#include "phase.glsl"
#include "scene.glsl"

#define AT_ONCE 64u // points of a row

// What reaches the points, by their weights.
vec4 visible_sum(vec4 sum, vec4 weights, FourPoints four) {
    return (((sum + weights.x * visible_at(four.at[0])) + weights.y * visible_at(four.at[1]))
        + weights.z * visible_at(four.at[2])) + weights.w * visible_at(four.at[3]);
}

// Adds the points of the rows of cells around x, where steps are of a level, from the march's row on, to its sums, until all are added or the work is
// done; whether they are.
bool weigh_lit(VolumeInfo volume, vec3 x, uint level, inout March march, inout MarchLight sums, inout uint work_left) {
    bool particles = scene_has(SCENE_PARTICLES) && (!scene_has(SCENE_WEIGHTS) || volume.kernel == VOLUME_SPH);
    uint grids = grids_of(volume, level);
    uint size = march.row >> SIZE_BITS, row = bitfieldExtract(march.row, 0, SIZE_BITS);
    while (size < grids && work_left > 0u) {
        VolumeInfo grid = grid_of(volume, size);
        float reach = sqrt(grid.square_radius);
        uvec3 low, high;
        cells_around(grid.grid, x, reach, low, high);
        uint rows = (high.y - low.y + 1u) * (high.z - low.z + 1u);
        while (row < rows && work_left > 0u) {
            uvec2 range = row_points(grid, low, high, row, x, reach);
            uint first = range.x + march.cursor;
            uint count = min(range.y - first, AT_ONCE);
            uint end = first + count;
            if (scene_has(SCENE_WEIGHTS)) {
                for (uint i = particles ? end : first; i < end; i += 4u) {
                    FourPoints four = four_points(i, end, x);
                    vec4 inverse_squares = inverse_squares_of(volume, four);
                    vec4 weights = gaussians(volume, four, inverse_squares);
                    vec4 weighted = weights * four.scalars;
                    march.numerator = add_up(march.numerator, weighted);
                    march.denominator = add_up(march.denominator, weights);
                    vec4 pulls = weights * inverse_squares;
                    sums.pull = add_up(sums.pull, pulls * four.scalars, four);
                    sums.weights_pull = add_up(sums.weights_pull, pulls, four);
                    sums.visible = visible_sum(sums.visible, weights, four);
                }
            }
            if (scene_has(SCENE_PARTICLES)) {
                for (uint i = particles ? first : end; i < end; i += 4u) {
                    FourPoints four = four_points(i, end, x);
                    vec4 inverse_lengths = inverse_lengths_of(four);
                    vec4 weights = splines(four, inverse_lengths);
                    march.numerator = add_up(march.numerator, weights * four.scalars);
                    march.denominator = add_up(march.denominator, weights);
                    vec4 pulls = spline_pulls(sqrt(four.squares) * inverse_lengths, inverse_lengths);
                    sums.pull = add_up(sums.pull, mix(vec4(0.0), pulls * four.scalars, four.are_there), four);
                    sums.visible = visible_sum(sums.visible, weights, four);
                }
            }
            bool row_ends = first + count >= range.y;
            march.cursor = row_ends ? 0u : march.cursor + count;
            row += row_ends ? 1u : 0u;
            work_left -= min(work_left, count + 2u);
        }
        bool ends = row >= rows;
        size += ends ? 1u : 0u;
        row = ends ? 0u : row;
    }
    march.row = row | size << SIZE_BITS;
    return size >= grids;
}

#define INVERSE_PI 0.318309886
#define INVERSE_FOUR_PI 0.0795774715
#define FLATTEST 1e-5 // a gradient over a point's reach, by the scalar: less is rounding

// What of the light at x goes towards the viewer, by the colour there. By Lambert's law for a surface across
// the gradient, or evenly to all sides, as is the mean of that over all surfaces.
vec3 scattered(VolumeInfo volume, float numerator, float weights, MarchLight sums, vec3 x, vec3 d) {
    float scalar = volume.kernel == VOLUME_SHEPARD ? numerator / weights : numerator;
    vec3 gradient = gradient_of(volume, scalar, sums.pull, sums.weights_pull);
    float square = dot3(gradient, gradient);
    float reach = volume.square_radius;
    bool per_length = volume.kernel == VOLUME_SPH || has_own_reaches(volume);
    float most = (numerator * numerator) * (per_length ? 1.0 / reach : reach);
    bool steep = volume.shading == VOLUME_GRADIENT && square > (FLATTEST * FLATTEST) * most;
    vec3 normal = steep ? gradient / (steep ? sqrt(square) : 1.0) : vec3(0.0);
    normal = dot3(normal, d) > 0.0 ? -normal : normal;
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < params.light_count; ++i) {
        LightSample light = sample_light(lights[i], x, vec2(0.5));
        float even = INVERSE_FOUR_PI;
        if (lighting_has(LIGHTING_ANISOTROPY)) even = phase(volume.iso, dot3(d, light.towards));
        float share = steep ? max(dot3(normal, light.towards), 0.0) * INVERSE_PI : even;
        sum += ((sums.visible[i] / weights) * share) * light.arriving;
    }
    return sum;
}
#endif
