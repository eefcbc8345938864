// list_points: the points of each cell with their positions, so that refinement reads them in a row.
//
// reads   slots            cell after cell
//         polynomials
// writes  points           in the order of slots
// runs    one invocation per entry of slots
// twin    crates/reference/src/grid_build.rs, list_points
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/grid.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = GRID_SLOTS) readonly buffer Slots { uint slots[]; };
layout(std430, binding = LISTED_POINTS) writeonly buffer Points { ListedPoint points[]; };
layout(push_constant) uniform Push { GridParams params; };

void main() {
    uint i = list_index();
    if (i >= params.pair_count) return;
    uint slot = slots[i];
    points[params.first_pair + i] = ListedPoint(polynomial_center_trust_at(slot).xyz, slot);
}
