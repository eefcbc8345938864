// path: what a ray has behind it. Rays from the camera share one path, but for the pixel, as long as nothing
// on their way changes it (WAVE_SHARES_PATH).
//
// Whoever includes this has push constants `params` of a wave.
#ifndef PATH_GLSL
#define PATH_GLSL
#include "index.glsl"
#include "stages/scene.glsl"
#include "stages/wave.glsl"
#include "math.glsl"
#include "scene.glsl"

bool shares_path() {
    return (params.flags & uint(WAVE_SHARES_PATH)) != 0u;
}

// Two of the path's media, 16 bits each.
uint media_word(uint ray, uint word) {
    return path_media_at(shares_path() ? 0u : ray, word);
}

// All but the media.
Path path_of(uint ray) {
    Path path = path_at(shares_path() ? 0u : ray);
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
