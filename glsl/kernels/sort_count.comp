// sort_count: how often each digit occurs in each run of keys.
//
// reads   keys_in
// writes  histogram        [digit][run]; must be zero before
// runs    one invocation per run of RUN_LENGTH keys, which alone touches its column
// twin    none: a stable sort has but one result
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/grid.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = SORT_KEYS_IN) readonly buffer KeysIn { uint keys_in[]; };
layout(std430, binding = SORT_HISTOGRAM) buffer Histogram { uint histogram[]; };
layout(push_constant) uniform Push { SortParams params; };

void main() {
    uint run = list_index();
    if (run >= params.runs) return;
    uint end = min((run + 1u) * RUN_LENGTH, params.count);
    for (uint i = run * RUN_LENGTH; i < end; ++i) {
        uint digit = bitfieldExtract(keys_in[i], int(params.shift), int(params.bits));
        histogram[digit * params.runs + run] += 1u;
    }
}
