// iso_search: how a ray closes in on an isosurface, by blocks of places (docs/method.md, section 7).
//
// twin  crates/reference/src/isosurface.rs
// Whoever includes this has push constants `params` of a march, and blocks by ray.
#ifndef ISO_SEARCH_GLSL
#define ISO_SEARCH_GLSL
#include "stages/volume.glsl"
#include "volume.glsl"
#include "block.glsl"

#define LARGEST 1e38 // scalar
#define ON_IT -1e-20 // the value of a place on the surface: 0 is not known
#define UNKNOWN 0u // sides
#define BELOW 1u
#define ABOVE 2u
#define SKIPPED 0u // IsoSearch::looked, of the sample before
#define LOOKED 1u
#define TO_LOOK 2u // this sample, whatever its cell tells
#define WIDE 3u // places of a turn: evenly between the ends,
#define NARROW 4u // or close about where the straight line between their values is 0
#define NARROWER 0.015625 // of the way between the ends: from one of these to the next
#define TURNS 4u // at most
#define TURNS_OF_FEW 8u // where a block has fewer than BLOCK_PLACES

// The scalar less that of the isosurface; 0: not known.
uint side_of_value(float value) {
    return value == 0.0 ? UNKNOWN : (value > 0.0 ? ABOVE : BELOW);
}

// Between two places on either side: on the line between their values, or in the middle.
float between(IsoSearch search) {
    float span = search.value_low - search.value_high;
    bool apart = search.value_low * search.value_high < 0.0;
    float part = apart ? search.value_low / (apart ? span : 1.0) : 0.5;
    return search.low + part * (search.high - search.low);
}

// The places of a turn: the first, and from one to the next.
vec2 places_of_turn(IsoSearch search, uint places) {
    float way = search.high - search.low;
    bool narrow = search.looked == NARROW;
    float apart = narrow ? way * NARROWER : way / float(places + 1u);
    float span = float(places - 1u) * apart;
    float about = max(search.low, min(between(search) - 0.5 * span, search.high - span));
    return vec2(narrow ? about : search.low + apart, apart);
}

// The value of a sum at a place of a block.
float value_of_sums(VolumeInfo volume, float numerator, float denominator, float step, int k) {
    bool reached = denominator > 0.0;
    bool mean = volume.kernel == VOLUME_SHEPARD;
    float scalar = (numerator * place_factor(volume, step, k)) / (mean && reached ? denominator : 1.0);
    float exact = (reached ? min(max(scalar, -LARGEST), LARGEST) : 0.0) - volume.iso;
    float value = exact == 0.0 ? ON_IT : exact;
    return mean && !reached ? 0.0 : value;
}

// Goes on with the values at the places of a block; whether all points are weighed.
bool weigh_block(VolumeInfo volume, Block block, uint block_at, bool weighs, inout IsoSearch search, inout uint work_left) {
    float numerators[BLOCK_PLACES], denominators[BLOCK_PLACES];
    for (int k = 0; k < BLOCK_PLACES; ++k) numerators[k] = denominators[k] = 0.0;
    uint resumes = weighs && (search.row > 0u || search.cursor > 0u) ? 1u : 0u;
    while (resumes > 0u) {
        --resumes;
        for (int k = 0; k < BLOCK_PLACES; ++k) {
            numerators[k] = blocks[block_at].scalars[k];
            denominators[k] = blocks[block_at].weights[k];
        }
    }
    uint row = weighs ? search.row : 0u, cursor = weighs ? search.cursor : 0u;
    bool weighed = false;
    uint asks = weighs ? 1u : 0u;
    while (asks > 0u) {
        --asks;
        weighed = weigh_points(volume, block, numerators, denominators, row, cursor, work_left);
    }
    uint ends = weighed ? 1u : 0u, stops = weighs && !weighed ? 1u : 0u;
    while (ends > 0u) {
        --ends;
        for (int k = 0; k < BLOCK_PLACES; ++k) {
            blocks[block_at].scalars[k] = value_of_sums(volume, numerators[k], denominators[k], block.step, k);
        }
    }
    while (stops > 0u) {
        --stops;
        for (int k = 0; k < BLOCK_PLACES; ++k) {
            blocks[block_at].scalars[k] = numerators[k];
            blocks[block_at].weights[k] = denominators[k];
        }
    }
    search.row = weighed ? 0u : (weighs ? row : search.row);
    search.cursor = weighed ? 0u : (weighs ? cursor : search.cursor);
    return weighed;
}

#define AT_ONCE 64u // points of a row

// Goes on with the sums of a place and of their gradients; whether all points are weighed.
bool weigh_pulls(VolumeInfo volume, vec3 x, bool weighs, inout IsoSearch search, inout uint work_left) {
    bool particles = scene_has(SCENE_PARTICLES) && (!scene_has(SCENE_WEIGHTS) || volume.kernel == VOLUME_SPH);
    uint grids = weighs ? grids_of(volume) : 0u;
    uint size = search.row >> SIZE_BITS, row = bitfieldExtract(search.row, 0, SIZE_BITS);
    while (size < grids && work_left > 0u) {
        VolumeInfo grid = grid_of(volume, size);
        float reach = sqrt(grid.square_radius);
        uvec3 low, high;
        cells_around(grid.grid, x, reach, low, high);
        uint rows = (high.y - low.y + 1u) * (high.z - low.z + 1u);
        while (row < rows && work_left > 0u) {
            uvec2 range = row_points(grid, low, high, row, x, reach);
            uint first = range.x + search.cursor;
            uint count = min(range.y - first, AT_ONCE);
            uint end = first + count;
            if (scene_has(SCENE_WEIGHTS)) {
                for (uint i = particles ? end : first; i < end; i += 4u) {
                    FourPoints four = four_points(i, end, x);
                    vec4 inverse_squares = inverse_squares_of(volume, four);
                    vec4 weights = gaussians(volume, four, inverse_squares);
                    search.numerator = add_up(search.numerator, weights * four.scalars);
                    search.denominator = add_up(search.denominator, weights);
                    vec4 pulls = weights * inverse_squares;
                    search.pull = add_up(search.pull, pulls * four.scalars, four);
                    search.weights_pull = add_up(search.weights_pull, pulls, four);
                }
            }
            if (scene_has(SCENE_PARTICLES)) {
                for (uint i = particles ? first : end; i < end; i += 4u) {
                    FourPoints four = four_points(i, end, x);
                    vec4 inverse_lengths = inverse_lengths_of(four);
                    vec4 weights = splines(four, inverse_lengths);
                    search.numerator = add_up(search.numerator, weights * four.scalars);
                    search.denominator = add_up(search.denominator, weights);
                    vec4 pulls = spline_pulls(sqrt(four.squares) * inverse_lengths, inverse_lengths);
                    search.pull = add_up(search.pull, mix(vec4(0.0), pulls * four.scalars, four.are_there), four);
                }
            }
            bool row_ends = first + count >= range.y;
            search.cursor = row_ends ? 0u : search.cursor + count;
            row += row_ends ? 1u : 0u;
            work_left -= min(work_left, count + 2u);
        }
        bool ends = row >= rows;
        size += ends ? 1u : 0u;
        row = ends ? 0u : row;
    }
    search.row = weighs ? row | size << SIZE_BITS : search.row;
    return weighs && size >= grids;
}
#endif
