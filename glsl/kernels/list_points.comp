// list_points: the points of each cell with their positions, so that refinement reads them in a row.
//
// reads   slots            cell after cell
//         polynomials
// writes  points           in the order of slots
// runs    one invocation per entry of slots
// twin    crates/reference/src/grid_build.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#include "layout.glsl"
#include "cloud.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = OFFSETS_SLOTS) readonly buffer Slots { uint slots[]; };
WORDS(OFFSETS_POLYNOMIALS, polynomials); // four each
layout(std430, binding = OFFSETS_POINTS) writeonly buffer Points { ListedPoint points[]; };
layout(push_constant) uniform Push { GridParams params; };

void main() {
    uint i = list_index();
    if (i >= params.pair_count) return;
    uint slot = slots[i];
    points[params.first_pair + i] = ListedPoint(uintBitsToFloat(words_of(polynomials, 4u * slot).xyz), slot);
}
