// count_marked: how many bits of each word of marks are set.
//
// reads   marks
// writes  offsets          one count a word; a scan turns them into offsets
// runs    one invocation per word
// twin    none: the CPU follows each ray to its end
#version 460
#extension GL_GOOGLE_include_directive : require
#include "layout.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = WAVE_MARKS) readonly buffer Marks { uint marks[]; };
layout(std430, binding = LIVE_OFFSETS) writeonly buffer Offsets { uint offsets[]; };
layout(push_constant) uniform Push { MarkParams params; };

void main() {
    uint word = list_index();
    if (word >= params.words) return;
    offsets[word] = uint(bitCount(marks[word]));
}
