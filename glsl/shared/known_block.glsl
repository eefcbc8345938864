// known_block: the scalars of a block of places, kept from pass to pass.
//
// twin    crates/reference/src/block.rs
// Whoever includes this has a buffer `blocks`.
#ifndef KNOWN_BLOCK_GLSL
#define KNOWN_BLOCK_GLSL
#include "block.glsl"

#define UNREACHED NO_HIT // the scalar where no point is in reach
#define LARGEST 1e38 // scalar

// Goes on with the scalars of a block; whether all points are weighed.
bool block_of(VolumeInfo volume, Block block, uint block_at, inout March march, inout uint work_left) {
    float numerators[BLOCK_PLACES], denominators[BLOCK_PLACES];
    for (int k = 0; k < BLOCK_PLACES; ++k) numerators[k] = denominators[k] = 0.0;
    uint resumes = march.row > 0u || march.cursor > 0u ? 1u : 0u;
    while (resumes > 0u) {
        --resumes;
        for (int k = 0; k < BLOCK_PLACES; ++k) {
            numerators[k] = blocks[block_at].scalars[k];
            denominators[k] = blocks[block_at].weights[k];
        }
    }
    bool weighed = weigh_points(volume, block, numerators, denominators, march.row, march.cursor, work_left);
    for (int k = 0; k < BLOCK_PLACES; ++k) {
        bool reached = denominators[k] > 0.0;
        bool mean = volume.kernel == VOLUME_SHEPARD && reached;
        float scalar = (numerators[k] * place_factor(volume, block.step, k)) / (mean ? denominators[k] : 1.0);
        float known = reached ? min(max(scalar, -LARGEST), LARGEST) : UNREACHED;
        blocks[block_at].scalars[k] = weighed ? known : numerators[k];
    }
    uint stops = weighed ? 0u : 1u;
    while (stops > 0u) {
        --stops;
        for (int k = 0; k < BLOCK_PLACES; ++k) blocks[block_at].weights[k] = denominators[k];
    }
    return weighed;
}
#endif
