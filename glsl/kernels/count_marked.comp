// count_marked: how many rays the marks of each word stand for.
//
// reads   marks
// writes  offsets          one count a word; a scan turns them into offsets
// runs    one invocation per word
// twin    none: the CPU follows each ray to its end
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/rays.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = MARKS) readonly buffer Marks { uint marks[]; };
layout(std430, binding = MARK_OFFSETS) writeonly buffer Offsets { uint offsets[]; };
layout(push_constant) uniform Push { MarkParams params; };

void main() {
    uint word = list_index();
    if (word >= params.words) return;
    uint stride = params.pairs + 1u;
    uint twice = params.pairs != 0u ? marks[stride * word + 1u] : 0u;
    offsets[word] = uint(bitCount(marks[stride * word])) + 2u * uint(bitCount(twice));
}
