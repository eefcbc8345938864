// tree_nodes: the nodes of one level of the tree, each around eight boxes of the level below.
//
// reads   polynomials      with SURFACES: the level below are the surfaces of points
//         boxes            else: the boxes around the nodes of the level below
// writes  nodes            of this level
//         boxes            around them; no box where all children are empty
// runs    one invocation per node
// twin    none: hits are those of any structure; boxes are tested for what they hold (tests/cases/tree.rs)
#version 460
#extension GL_GOOGLE_include_directive : require
#define TEXELS
#include "stages/points.glsl"
#include "stages/search.glsl"
#include "stages/tree.glsl"
#include "index.glsl"
#include "math.glsl"
#include "node.glsl"
#include "tree.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = TREE_BOXES) buffer Boxes { SearchNode boxes[]; };
layout(std430, binding = TREE_NODES) writeonly buffer Nodes { uint nodes[]; };
layout(push_constant) uniform Push { TreeLevelParams params; };

// The box of the child at `at`, of those of the level below, if anything is inside.
bool child_box(uint at, out vec3 low, out vec3 high) {
#ifdef SURFACES
    Polynomial p = polynomial_at(at);
    patch_box(p, low, high);
    return p.center_trust.w > 0.0;
#else
    SearchNode child = boxes[params.first_child + at];
    low = child.low;
    high = child.high;
    return low.x <= high.x;
#endif
}

void main() {
    uint i = list_index();
    if (i >= params.count) return;
    uint node = params.first + i;
    // Of the level below; the root's begin at its second.
    uint skipped = node == 0u ? 1u : 0u;
    uint first = (node - params.first_of_level) * LEAF_POINTS;
    uint end = min(first + LEAF_POINTS - skipped, params.children);
    vec3 low = vec3(NOTHING), high = vec3(-NOTHING), way = vec3(0.0);
    uint there = 0u;
    for (uint at = first; at < end; ++at) {
        vec3 child_low, child_high;
        bool is_there = child_box(at, child_low, child_high);
        low = is_there ? min(low, child_low) : low;
        high = is_there ? max(high, child_high) : high;
        vec3 middle = 0.5 * child_low + 0.5 * child_high;
        way += is_there ? (at - first < LEAF_POINTS / 2u ? -middle : middle) : vec3(0.0);
        there |= is_there ? 1u << (at - first + skipped) : 0u;
    }
    boxes[node].low = low;
    boxes[node].high = high;
    // Where one half is missing, the way says nothing: any will do.
    float longest = max(max(abs(way.x), abs(way.y)), max(abs(way.z), 1e-30));
    ivec3 toward = ivec3(clamp(way / longest, vec3(-1.0), vec3(1.0)) * 15.0);
    vec3 size = there != 0u ? high - low : vec3(0.0);
    float extent = max(max(size.x, size.y), max(size.z, 1e-30));
    // The least power of two of which 254 reach across.
    uint exponent = clamp((floatBitsToUint(extent / 254.0) >> 23) + 1u, 1u, 254u);
    float steps = 1.0 / uintBitsToFloat(exponent << 23);
    vec3 origin = there != 0u ? low : vec3(0.0);
    uint to = (node - params.first_bound) * 16u;
    nodes[to] = floatBitsToUint(origin.x);
    nodes[to + 1u] = floatBitsToUint(origin.y);
    nodes[to + 2u] = floatBitsToUint(origin.z);
    nodes[to + 3u] = exponent | (there << 8) | (uint(toward.x & 31) << 16) | (uint(toward.y & 31) << 21)
        | (uint(toward.z & 31) << 26);
    for (uint part = 0u; part < 2u; ++part) {
        uvec3 lows = uvec3(0u), highs = uvec3(0u);
        for (uint k = 0u; k < 4u; ++k) {
            uint at = first + 4u * part + k - skipped; // before the first: past all
            vec3 child_low = low, child_high = low;
            if (at < end) {
                if (!child_box(at, child_low, child_high)) child_high = child_low = low;
            }
            uvec3 from = uvec3(clamp(floor((child_low - low) * steps - 0.02), 0.0, TREE_STEPS));
            uvec3 reach = uvec3(clamp(ceil((child_high - low) * steps + 0.02), 0.0, TREE_STEPS));
            lows |= from << (8u * k);
            highs |= reach << (8u * k);
        }
        uint words = to + 4u + 6u * part;
        nodes[words] = lows.x;
        nodes[words + 1u] = lows.y;
        nodes[words + 2u] = lows.z;
        nodes[words + 3u] = highs.x;
        nodes[words + 4u] = highs.y;
        nodes[words + 5u] = highs.z;
    }
}
