// around: the points of an object whose trust balls hold a place, in the order of their indices.
//
// twin  crates/reference/src/around.rs
// One grid lists them so. Of several, most often only one has any; else their lists are merged.
#ifndef AROUND_GLSL
#define AROUND_GLSL
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/grid.glsl"
#include "levels.glsl"
#include "math.glsl"

#define MOST_LISTED_AROUND 2048u // of each list, and
#define MOST_MERGED 1024u        // of all: with MOST_LEVELS lists, as many turns as lavapipe allows a dispatch

bool holds(uint slot, vec3 x, uvec2 slots) {
    vec4 ball = polynomial_center_trust_at(slot);
    vec3 y = x - ball.xyz;
    return slot - slots.x < slots.y && dot3(y, y) < ball.w * ball.w;
}

// The first place from `next` on whose point holds x; `end` where there is none.
uint next_holding(uint next, uint end, vec3 x, uvec2 slots) {
    while (next < end && !holds(slot_at(next), x, slots)) ++next;
    return next;
}

// The list of one of the grids around x: empty where x lies outside, or none of the object's points is listed.
uvec2 listed_around(uint level, vec3 x, uvec2 slots) {
    uvec2 range = range_at(cell_around(level, x));
    range.y = min(range.y, range.x + MOST_LISTED_AROUND);
    return lists_some(level, slots) && in_box(levels[level].grid, x) ? range : uvec2(0u);
}

// The list that has the object's points around x, `slots` being its first slot and their number.
struct Around {
    uvec2 range;
    bool several; // there are others
};

Around points_around(vec3 x, uvec2 slots) {
    Around around = Around(uvec2(0u), false);
    if (scene_has(SCENE_LEVELS)) {
        for (uint level = 0u; level < level_count(); ++level) {
            uvec2 listed = listed_around(level, x, slots);
            bool has = listed.x < listed.y;
            around.several = around.several || (has && around.range.x < around.range.y);
            around.range = has ? listed : around.range;
        }
    } else {
        around.range = range_at(cell_around(0u, x));
    }
    return around;
}

// Where each list goes on.
struct Merge {
    uint next[MOST_LEVELS];
    uint end[MOST_LEVELS];
    uint left; // of the points that are asked
};

Merge merge_around(vec3 x, uvec2 slots) {
    Merge merge;
    merge.left = MOST_MERGED;
    for (uint level = 0u; level < level_count(); ++level) {
        uvec2 listed = listed_around(level, x, slots);
        merge.next[level] = next_holding(listed.x, listed.y, x, slots);
        merge.end[level] = listed.y;
    }
    return merge;
}

// The next of them all, or NONE.
uint next_around(inout Merge merge, vec3 x, uvec2 slots) {
    uint slot = NONE, index = NONE, from = 0u;
    for (uint level = 0u; level < level_count(); ++level) {
        bool more = merge.left > 0u && merge.next[level] < merge.end[level];
        uint candidate = slot_at(more ? merge.next[level] : 0u);
        uint candidate_index = polynomial_index_at(candidate);
        bool earlier = more && (slot == NONE || candidate_index < index);
        slot = earlier ? candidate : slot;
        index = earlier ? candidate_index : index;
        from = earlier ? level : from;
    }
    if (slot != NONE) {
        merge.next[from] = next_holding(merge.next[from] + 1u, merge.end[from], x, slots);
        --merge.left;
    }
    return slot;
}
#endif
