// tree: the tree of boxes that rays go through.
//
// Made from crates/kernels/src/layout/tree.rs by compile-kernels: change that.
#ifndef STAGE_TREE_GLSL
#define STAGE_TREE_GLSL
#include "stages/search.glsl"
#include "stages/rays.glsl"

// Where the leaves of the tree are.
struct TreeInfo { // 8 bytes
    uint first_leaf;                 //   0 Their first node, a power of eight.
    uint gap;                        //   4 So many nodes before it are not there, nor in memory.
};

// Push constants of tree_nodes: some nodes of one level of the tree.
struct TreeLevelParams { // 24 bytes
    uint first;                      //   0 The first of these nodes.
    uint count;                      //   4 How many they are.
    uint first_of_level;             //   8 The first node of the whole level.
    uint first_child;                //  12 The first node of the level below.
    uint children;                   //  16 Nodes of the level below; of leaves, points.
    uint first_bound;                //  20 The node that what is bound of all begins with.
};

// Push constants of tree_trace.
struct TreeTraceParams { // 32 bytes
    TraceParams wave;                //   0 Of any structure.
    TreeInfo tree;                   //  24 The tree's.
};

#define TREE_BOXES 41 // The boxes around the nodes

#define TREE_NODES 42 // The nodes, four times four words each (tree.glsl)
#ifdef TEXELS
layout(binding = TREE_NODES) uniform usamplerBuffer node_part_texels;

uvec4 node_part_at(uint at) {
    return texelFetch(node_part_texels, int(at)).xyzw;
}
#else
layout(std430, binding = TREE_NODES) readonly buffer NodePartList { uvec4 node_part_list[]; };

uvec4 node_part_at(uint at) {
    return node_part_list[at];
}
#endif
#endif
