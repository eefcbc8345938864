// point_lights: what of one light's reaches the points of a volume.
//
// reads   the shadow rays' state      as the rays towards the light left it
//         light_sums       what the volumes on their ways left of it
// writes  visible          of this light
// runs    one invocation per point of a batch
// twin    crates/reference/src/point_lights.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#include "stages/points.glsl"
#include "stages/wave.glsl"
#include "stages/volume.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = LIGHT_SUMS) readonly buffer LightSums { LightSum light_sums[]; };
layout(std430, binding = VISIBLE) writeonly buffer Visible { float visible[]; };
layout(push_constant) uniform Push { PointLightParams params; };

void main() {
    uint at = list_index();
    if (at >= params.count) return;
    bool blocked = load_ray(at).hit_slot != NONE;
    vec3 arriving = light_sums[at].arriving; // by channel where media absorb
    bool is_grey = arriving.x == arriving.y && arriving.y == arriving.z;
    float share = is_grey ? arriving.x : ((arriving.x + arriving.y) + arriving.z) / 3.0;
    visible[(params.first + at) * uint(VOLUME_LIGHTS) + params.light] = blocked ? 0.0 : share;
}
