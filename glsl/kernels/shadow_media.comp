// shadow_media: what shadow rays start inside, where light may pass surfaces (method, section 6).
//
// reads   the shadow rays' state      as they start towards a light
//         paths
//         lit_rays         the rays that hit a lit surface
// writes  shadow_paths     the media of the paths that ended there; the way to the light
// runs    one invocation per lit hit
// twin    crates/reference/src/to_light/shadow_media.rs
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#include "stages/points.glsl"
#include "stages/wave.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = SHADOW_PATHS) writeonly buffer ShadowPaths { Path shadow_paths[]; };
layout(push_constant) uniform Push { WaveParams params; };
#include "path.glsl"

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    uint ray = lit_ray_at(at);
    Path path = path_of(ray);
    shadow_paths[at].throughput = vec3(0.0); // no isosurface is met
    shadow_paths[at].pixel = path.pixel;
    shadow_paths[at].channels = NONE;
    shadow_paths[at].bounces = 0u;
    shadow_paths[at].crossings = 0u;
    shadow_paths[at].media_count = path.media_count;
    for (uint word = 0u; word < uint(MEDIA_WORDS); ++word) shadow_paths[at].media[word] = media_word(ray, word);
    shadow_paths[at].depth = load_ray(at).hit_t;
}
