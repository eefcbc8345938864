// search: the search for neighbours.
//
// Made from crates/kernels/src/layout/search.rs by compile-kernels: change that.
#ifndef STAGE_SEARCH_GLSL
#define STAGE_SEARCH_GLSL

#define LEAF_POINTS 8 // Consecutive slots that share a box, and so a list of leaves; children of a node
#define LEAF_LEVELS 10 // Levels of boxes, at most
#define LEAF_BITS 24 // Bits of an entry of a list of leaves that say which; the others say for which points
#define LEAF_STEPS 32768 // Boxes that the search for one list of leaves may look at

// The box around LEAF_POINTS points, or around as many boxes. Empty where low is above high.
struct SearchNode { // 32 bytes
    vec3 low;                        //   0 Lowest corner.
    uint child;                      //  12 The first of the boxes inside, or NONE: points are.
    vec3 high;                       //  16 Highest corner.
    uint next;                       //  28 The box to look at once this one and all inside are done, or NONE.
};

#ifdef TEXELS
SearchNode search_node_from(usamplerBuffer texels, int first) {
    uvec4 t0 = texelFetch(texels, first + 0);
    uvec4 t1 = texelFetch(texels, first + 1);
    return SearchNode(uintBitsToFloat(t0.xyz), t0.w, uintBitsToFloat(t1.xyz), t1.w);
}
#endif

// Parameters of leaf_boxes and node_boxes: one level of the boxes of an object.
struct LevelParams { // 64 bytes
    uint first_slot;                 //   0 The first slot of the object.
    uint point_count;                //   4 How many points the object has.
    uint neighbors;                  //   8 k, how many neighbours are asked for.
    uint level;                      //  12 0: the boxes of points.
    uint top;                        //  16 The highest level: it has LEAF_POINTS boxes.
    uint count;                      //  20 Boxes of this level, a multiple of LEAF_POINTS.
    uint offsets[10];                //  24 First box of each level.
};

// Parameters of the neighbour search for one batch of points.
struct SearchParams { // 40 bytes
    uint first_slot;                 //   0 The first slot of the object.
    uint point_count;                //   4 How many points the object has.
    uint batch_first;                //   8 Place in the object of the batch's first point, a multiple of LEAF_POINTS.
    uint batch_count;                //  12 Points of the batch.
    uint neighbors;                  //  16 k: less than point_count, or 1.
    uint stride;                     //  20 Entries of a point in the list of neighbours, a multiple of four.
    uint capacity;                   //  24 Entries of a list of leaves, a multiple of four.
    uint root;                       //  28 The first box of the highest level.
    uint leaf_count;                 //  32 Boxes of points, which come first.
    uint listed;                     //  36 How many leaves of the batch are looked at again, with a larger capacity; 0: all are looked at.
};

#define SEARCH_NODES 10 // Boxes of an object, level over level
#ifdef TEXELS
layout(binding = SEARCH_NODES) uniform usamplerBuffer search_node_texels;

SearchNode search_node_at(uint at) {
    return search_node_from(search_node_texels, int(2u * at));
}

vec3 search_node_low_at(uint at) {
    return uintBitsToFloat(texelFetch(search_node_texels, int(2u * at)).xyz);
}

uint search_node_child_at(uint at) {
    return texelFetch(search_node_texels, int(2u * at)).w;
}

vec3 search_node_high_at(uint at) {
    return uintBitsToFloat(texelFetch(search_node_texels, int(2u * at) + 1).xyz);
}

uint search_node_next_at(uint at) {
    return texelFetch(search_node_texels, int(2u * at) + 1).w;
}
#else
layout(std430, binding = SEARCH_NODES) readonly buffer SearchNodeList { SearchNode search_node_list[]; };

SearchNode search_node_at(uint at) {
    return search_node_list[at];
}

vec3 search_node_low_at(uint at) {
    return search_node_list[at].low;
}

uint search_node_child_at(uint at) {
    return search_node_list[at].child;
}

vec3 search_node_high_at(uint at) {
    return search_node_list[at].high;
}

uint search_node_next_at(uint at) {
    return search_node_list[at].next;
}
#endif

#define SEARCH_BOUNDS 11 // Of each point of the batch, d² that holds k others

#define SEARCH_LEAVES 12 // Leaves that the balls of each leaf of the batch touch
#ifdef TEXELS
layout(binding = SEARCH_LEAVES) uniform usamplerBuffer search_leaf_texels;

uint search_leaf_at(uint at) {
    return texelFetch(search_leaf_texels, int(at / 4u))[at & 3u];
}

// The four of which that is one, from a multiple of four on.
uvec4 search_leaf_four_at(uint at) {
    return texelFetch(search_leaf_texels, int(at / 4u));
}
#else
layout(std430, binding = SEARCH_LEAVES) readonly buffer SearchLeafList { uint search_leaf_list[]; };

uint search_leaf_at(uint at) {
    return search_leaf_list[at];
}

uvec4 search_leaf_four_at(uint at) {
    uint first = at & ~3u;
    return uvec4(search_leaf_list[first], search_leaf_list[first + 1u], search_leaf_list[first + 2u], search_leaf_list[first + 3u]);
}
#endif

#define SEARCH_COUNTS 13 // How many those are, or NONE: more than there is room for

#define SEARCH_GROUPS 14 // Leaves of the batch that are looked at again

#define SEARCH_TIES 15 // Of a search without ties: which leaves of the batch have some all the same
#endif
