// scan_reduce: the sum of each run of values, or SCAN_LIMIT where it would be more.
//
// reads   values
// writes  sums             one a run of RUN_LENGTH values
// runs    one invocation per run
// twin    none: a prefix sum has but one result
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/grid.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = SCAN_VALUES) readonly buffer Values { uint values[]; };
layout(std430, binding = SCAN_SUMS) writeonly buffer Sums { uint sums[]; };
layout(push_constant) uniform Push { ScanParams params; };

void main() {
    uint run = list_index();
    uint first = run * RUN_LENGTH;
    if (first >= params.count) return;
    uint end = min(first + RUN_LENGTH, params.count);
    uint sum = 0u;
    for (uint i = first; i < end; ++i) sum = min(sum + min(values[i], SCAN_LIMIT), SCAN_LIMIT);
    sums[run] = sum;
}
