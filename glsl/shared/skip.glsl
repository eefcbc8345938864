// skip: bits of cells, 32 of a row a word; rows begin with words of their own.
#ifndef SKIP_GLSL
#define SKIP_GLSL
#include "stages/grid.glsl"

uint row_words(GridInfo grid) {
    return (grid.resolution.x + 31u) / 32u;
}

uint mark_words(GridInfo grid) {
    return row_words(grid) * grid.resolution.y * grid.resolution.z;
}

uint first_cell_of(GridInfo grid, uint word) {
    uint across = row_words(grid);
    return word / across * grid.resolution.x + word % across * 32u;
}

uint cells_of_word(GridInfo grid, uint word) {
    return min(grid.resolution.x - word % row_words(grid) * 32u, 32u);
}
#endif
