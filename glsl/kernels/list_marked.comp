// list_marked: the rays whose bits are set, one after another.
//
// reads   marks
//         list_in          with `listed`: the rays that these are marks of
//         offsets          of the first ray of each word in the list
// writes  list             the rays
// runs    one invocation per word
// twin    none: the CPU follows each ray to its end
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/rays.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = MARKS) readonly buffer Marks { uint marks[]; };
layout(std430, binding = MARK_OFFSETS) readonly buffer Offsets { uint offsets[]; };
layout(std430, binding = LIST_IN) readonly buffer ListIn { uint list_in[]; };
layout(std430, binding = LIVE_RAYS) writeonly buffer List { uint list[]; };
layout(push_constant) uniform Push { MarkParams params; };

void main() {
    uint word = list_index();
    if (word >= params.words) return;
    uint bits = marks[word];
    uint to = offsets[word];
    while (bits != 0u) {
        uint place = 32u * word + uint(findLSB(bits));
        list[to] = params.listed != 0u ? list_in[place] : place;
        bits &= bits - 1u;
        ++to;
    }
}
