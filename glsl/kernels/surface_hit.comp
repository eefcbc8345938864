// surface_hit: where each ray that has ended met the polynomial it hit.
//
// reads   the ray state, polynomials, objects
//         grid, cells, slots   the polynomials around a hit, where normals are blended
// writes  hits             accepted, or pending where the object's hits are refined; a hit that stands
//                          already is left alone; zero before the first time, where hits are refined
//         live             how many are pending
// runs    one invocation per ray of the wave
// twin    crates/reference/src/surface_hit.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/rays.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = LIVE) buffer Live { uint live; };
layout(std430, binding = HITS) buffer Hits { Hit hits[]; };
layout(push_constant) uniform Push { TraceParams params; };
#include "meeting.glsl"

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    uint iterations = 0u;
    if (scene_has(SCENE_REFINES)) {
        uint status = hits[at].status;
        if (bitfieldExtract(status, 0, HIT_STATUS_BITS) == HIT_ACCEPTED) return;
        iterations = status >> HIT_TOTAL_SHIFT << HIT_TOTAL_SHIFT;
    }
    Ray ray = load_ray(at);
    if (ray.hit_slot == NONE) {
        hits[at].status = iterations | HIT_NONE;
        return;
    }
    Meeting met = meeting_of(ray);
    hits[at] = Hit(met.position, ray.hit_t, met.normal, iterations | (met.refined ? HIT_PENDING : HIT_ACCEPTED));
    if (scene_has(SCENE_REFINES)) {
        if (met.refined) atomicAdd(live, 1u);
    }
}
