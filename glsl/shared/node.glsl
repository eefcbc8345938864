// node: boxes in boxes over the points of an object, in the order of memory.
//
// Each box of a level holds LEAF_POINTS consecutive ones of the level below, the lowest as many points.
// Levels have whole multiples of that many boxes, the highest just so many; boxes after the last are
// empty. A walk keeps one number: where it is. Every box says where it goes on.
#ifndef NODE_GLSL
#define NODE_GLSL
#include "stages/points.glsl"
#include "stages/search.glsl"

#define NOTHING 3.0e38 // lowest corner of an empty box; minus that, its highest

// Where a walk goes on that is done with box i of a level and all inside.
uint next_node(LevelParams params, uint i) {
    uint behind = i + 1u;
    uint up = min(uint(findLSB(behind)) / 3u, params.top - params.level); // LEAF_POINTS is 2^3
    uint level = params.level + up;
    uint at = behind >> (3u * up);
    return level == params.top && at == LEAF_POINTS ? NONE : params.offsets[level] + at;
}
#endif
