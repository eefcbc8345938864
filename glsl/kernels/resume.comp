// resume: sends the rays whose hit was refined away on to the next.
//
// reads   the ray state
//         hits
// writes  the ray state    rejected rays alone, in place: their structure begins with them again, after the hit they lost
//         marks            one bit for each of these; must be zero before
// runs    one invocation per ray of the wave
// twin    crates/reference/src/refine.rs, resume
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#define STATE_WRITES
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/rays.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = HITS) readonly buffer Hits { Hit hits[]; };
layout(std430, binding = MARKS) buffer Marks { uint marks[]; };
layout(push_constant) uniform Push { TraceParams params; };

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    uint status = hits[at].status;
    if (bitfieldExtract(status, 0, HIT_STATUS_BITS) != HIT_REJECTED) return;
    Ray ray = load_ray(at);
    ray.after = ray.hit_t;
    ray.hit_t = NO_HIT;
    ray.hit_slot = NONE;
    ray.cell = RAY_STARTS;
    ray.cursor = 0u;
    store_ray(at, ray);
    atomicOr(marks[at / 32u], 1u << (at & 31u));
}
