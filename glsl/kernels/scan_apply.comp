// scan_apply: turns each run of values into what comes before each of them, in place.
//
// reads   sums             what comes before each run, where params.has_base says so
// writes  values           the exclusive prefix sum, or SCAN_LIMIT where it would be more
// runs    one invocation per run
// twin    none: a prefix sum has but one result
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/grid.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = SCAN_VALUES) buffer Values { uint values[]; };
layout(std430, binding = SCAN_SUMS) readonly buffer Sums { uint sums[]; };
layout(push_constant) uniform Push { ScanParams params; };

void main() {
    uint run = list_index();
    uint first = run * RUN_LENGTH;
    if (first >= params.count) return;
    uint end = min(first + RUN_LENGTH, params.count);
    uint before = params.has_base != 0u ? sums[run] : 0u;
    for (uint i = first; i < end; ++i) {
        uint value = values[i];
        values[i] = before;
        before = min(before + min(value, SCAN_LIMIT), SCAN_LIMIT);
    }
}
