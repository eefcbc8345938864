// path: what a ray has behind it. Rays from the camera share one path, but for the pixel, as long as nothing
// on their way changes it (WAVE_SHARES_PATH).
//
// Whoever includes this has push constants `params` of a wave.
#ifndef PATH_GLSL
#define PATH_GLSL
#include "index.glsl"
#include "layout.glsl"
#include "math.glsl"
#include "scene.glsl"

#ifdef QUEUE
layout(binding = WAVE_PATHS) uniform usamplerBuffer path_texels; // five a path

uint stored_media(uint at, uint word) {
    return texelFetch(path_texels, int(5u * at + 2u + word / 4u))[word & 3u];
}

Path stored_path(uint at) {
    int first = int(5u * at);
    uvec4 start = texelFetch(path_texels, first), counts = texelFetch(path_texels, first + 1);
    uvec4 low = texelFetch(path_texels, first + 2), high = texelFetch(path_texels, first + 3);
    vec4 volumes = uintBitsToFloat(texelFetch(path_texels, first + 4));
    uint media[MEDIA_WORDS] = uint[](low.x, low.y, low.z, low.w, high.x, high.y, high.z, high.w);
    return Path(uintBitsToFloat(start.xyz), start.w, counts.x, counts.y, counts.z, counts.w, media, volumes.xyz, volumes.w);
}
#else
layout(std430, binding = WAVE_PATHS) readonly buffer Paths { Path paths[]; };

uint stored_media(uint at, uint word) {
    return paths[at].media[word];
}

Path stored_path(uint at) {
    return paths[at];
}
#endif

bool shares_path() {
    return (params.flags & uint(WAVE_SHARES_PATH)) != 0u;
}

// Two of the path's media, 16 bits each.
uint media_word(uint ray, uint word) {
    return stored_media(shares_path() ? 0u : ray, word);
}

// All but the media.
Path path_of(uint ray) {
    Path path = stored_path(shares_path() ? 0u : ray);
    uvec2 pixel = pixel_of_ray(ray, params.tile_size);
    path.pixel = shares_path() ? pixel.y * params.tile_size.x + pixel.x : path.pixel;
    // Without volumes nobody stores these.
    path.emitted = scene_has(SCENE_VOLUMES) ? path.emitted : vec3(0.0);
    path.depth = scene_has(SCENE_VOLUMES) ? path.depth : 0.0;
    return path;
}

// What of a light comes through the volumes on the path.
vec3 through_volumes(Path path, vec3 light) {
    return scene_has(SCENE_VOLUMES) ? exp_negative(-path.depth) * light : light;
}

// 1 less the throughput of surfaces and volumes.
vec3 alpha_of(Path path, vec3 throughput) {
    vec3 alpha = vec3(1.0) - throughput;
    return scene_has(SCENE_VOLUMES) ? alpha + throughput * absorptance(path.depth) : alpha;
}
#endif
