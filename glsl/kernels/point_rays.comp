// point_rays: the rays from the points of a volume towards one light.
//
// reads   volumes, their cells and points, lights
// writes  the shadow rays' state
//         paths            inside the volume's own object; as shadow_media has them
//         light_sums       1: all of the light
//         lit_rays         each its own path
// runs    one invocation per point of a batch
//
// Points in cells from which nothing is seen send none: no sample that is seen has one of them in reach,
// since cells that show anything are marked with two cells around them.
// twin    crates/reference/src/point_lights.rs, point_rays
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_WRITES
#include "stages/points.glsl"
#include "stages/wave.glsl"
#include "stages/volume.glsl"
#include "math.glsl"
#include "grid.glsl"
#include "light.glsl"
#include "volume.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = LIGHTS) readonly buffer Lights { Light lights[]; };
layout(std430, binding = PATHS) writeonly buffer Paths { Path paths[]; };
layout(std430, binding = LIT_RAYS) writeonly buffer LitRays { uint lit_rays[]; };
layout(std430, binding = LIGHT_SUMS) writeonly buffer LightSums { LightSum light_sums[]; };
layout(push_constant) uniform Push { PointLightParams params; };

void main() {
    uint at = list_index();
    if (at >= params.count) return;
    vec3 x = volume_point_at(params.first + at).position;
    LightSample light = sample_light(lights[params.light], x, vec2(0.5));
    VolumeInfo volume = volumes[params.volume];
    bool seen = volume_cell_at(volume.first_cell + cell_id(volume.grid, cell_of(volume.grid, x))).counts != CELL_NOTHING;
    Ray ray = new_ray(x, light.towards, NONE);
    ray.cell = seen ? ray.cell : NONE;
    ray.hit_t = light.distance;
    store_ray(at, ray);
    paths[at].throughput = vec3(0.0);
    paths[at].pixel = 0u;
    paths[at].channels = NONE;
    paths[at].bounces = 0u;
    paths[at].crossings = 0u;
    paths[at].depth = light.distance;
    paths[at].media_count = 1u;
    paths[at].media[0] = volume.object;
    lit_rays[at] = at;
    light_sums[at] = LightSum(vec3(0.0), 0u, vec3(seen ? 1.0 : 0.0), 0u);
}
