// sort_scatter: moves each pair to its place after sorting by one digit, keeping order (stable).
//
// reads   keys_in, slots_in
//         histogram        scanned: where the next key of [digit][run] goes; counted up
// writes  keys_out, slots_out
// runs    one invocation per run of RUN_LENGTH keys, which alone touches its column
// twin    none: a stable sort has but one result
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/grid.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = SORT_KEYS_IN) readonly buffer KeysIn { uint keys_in[]; };
layout(std430, binding = SORT_SLOTS_IN) readonly buffer SlotsIn { uint slots_in[]; };
layout(std430, binding = SORT_HISTOGRAM) buffer Histogram { uint histogram[]; };
layout(std430, binding = SORT_KEYS_OUT) writeonly buffer KeysOut { uint keys_out[]; };
layout(std430, binding = SORT_SLOTS_OUT) writeonly buffer SlotsOut { uint slots_out[]; };
layout(push_constant) uniform Push { SortParams params; };

void main() {
    uint run = list_index();
    if (run >= params.runs) return;
    uint end = min((run + 1u) * RUN_LENGTH, params.count);
    for (uint i = run * RUN_LENGTH; i < end; ++i) {
        uint key = keys_in[i];
        uint column = bitfieldExtract(key, int(params.shift), int(params.bits)) * params.runs + run;
        uint place = histogram[column];
        histogram[column] = place + 1u;
        keys_out[place] = key;
        slots_out[place] = slots_in[i];
    }
}
