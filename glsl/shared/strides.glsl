// strides: how long the steps of rays through volumes are, where points reach unevenly (docs/method.md, section 7).
//
// twin    crates/reference/src/steps.rs, and look_by_size in crates/reference/src/volume.rs
#ifndef STRIDES_GLSL
#define STRIDES_GLSL
#include "stages/volume.glsl"
#include "grid.glsl"
#include "volume.glsl"

// How long steps are, as powers of two of the shortest: those from a place on, and the one before it. Places count shortest
// steps.
struct Stride {
    uint level;
    uint before;
};

#define LEVEL_BITS 5 // of each, in March::state
#define STATE_BITS 2 // below them
#define LOG_STRIDE_STEPS 3u // of STRIDE_STEPS

Stride stride_of(uint state) {
    if (!scene_has(SCENE_SIZES)) return Stride(0u, 0u);
    return Stride(bitfieldExtract(state, STATE_BITS, LEVEL_BITS),
                  bitfieldExtract(state, STATE_BITS + LEVEL_BITS, LEVEL_BITS));
}

uint with_stride(uint state, Stride stride) {
    return state | stride.level << STATE_BITS | stride.before << (STATE_BITS + LEVEL_BITS);
}

// The place after one, of so many steps; after the last, one more.
uint place_after(uint place, Stride stride, uint steps) {
    if (!scene_has(SCENE_SIZES)) return place + 1u;
    return place >= steps ? steps + 1u : min(place + (1u << stride.level), steps);
}

// What a volume's grids say of a place.
struct Look {
    uint kind; // one of CELL_*, of all places of a stretch of steps from there
    uint level; // of steps among the smallest points around
};

// Where smaller points may be near, the finer grid knows more. The marks of a grid hold for a stretch of its steps; where the
// step before the place is longer than that, it knows only of levels.
Look look_by_size(VolumeInfo volume, vec3 x, uint before) {
    // Out of one grid, what is seen is not known.
    Look look = Look(volume.size_count > 0u ? CELL_NOTHING : CELL_LOOK, volume.level);
    uint size = 0u, left = max(volume.size_count, 1u);
    bool holds = true;
    while (left > 0u) {
        uint at = volume.first_size + size;
        GridInfo grid = volume.grid;
        uint first_cell = volume.first_cell, level = volume.level;
        if (volume.size_count > 0u) {
            grid = volumes[at].grid;
            first_cell = volumes[at].first_cell;
            level = volumes[at].level;
        }
        vec3 cells_off = (x - grid.origin) * grid.inverse_edge;
        bool inside = all(greaterThanEqual(cells_off, vec3(0.0))) && all(lessThan(cells_off, vec3(grid.resolution)));
        uint counts = volume_cell_at(first_cell + cell_id(grid, cell_of(grid, x))).counts;
        holds = holds && (size == 0u || level + LOG_STRIDE_STEPS >= before);
        look.kind = inside && holds ? counts & uint(CELL_KINDS) : look.kind;
        look.level = inside ? level : look.level;
        left = inside && (counts & uint(CELL_FINER)) != 0u ? left - 1u : 0u;
        ++size;
    }
    return look;
}

bool begins_stretch(Stride stride, uint place) {
    return (place & ((uint(STRIDE_STEPS) << stride.level) - 1u)) == 0u;
}

// The longest step of which a stretch may begin at a place.
uint longest_at(uint place) {
    return place > 0u ? uint(findLSB(place)) - LOG_STRIDE_STEPS : 31u;
}
#endif
