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

// Whether paths carry what volumes have sent and taken; where light goes from surface to surface, the pixel has the one,
// and the throughput lacks the other.
bool keeps_depths() {
    return scene_has(SCENE_VOLUMES) && !lighting_has(LIGHTING_PATH);
}

// Of light that has come over several surfaces, no more than is wanted.
vec3 limited(uint channels, vec3 radiance) {
    float red = (channels & 1u) != 0u ? radiance.x : 0.0;
    float green = (channels & 2u) != 0u ? radiance.y : 0.0;
    float blue = (channels & 4u) != 0u ? radiance.z : 0.0;
    float most = max(max(red, green), blue);
    bool over = most > params.clamp;
    return over ? radiance * (params.clamp / (over ? most : 1.0)) : radiance;
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
    // Otherwise nobody stores these.
    path.emitted = keeps_depths() ? path.emitted : vec3(0.0);
    path.depth = keeps_depths() || lighting_has(LIGHTING_PATH) ? path.depth : 0.0;
    return path;
}

// What of a light comes through the volumes on the path.
vec3 through_volumes(Path path, vec3 light) {
    return keeps_depths() ? exp_negative(-path.depth) * light : light;
}

// 1 less the throughput of surfaces and volumes.
vec3 alpha_of(Path path, vec3 throughput) {
    vec3 alpha = vec3(1.0) - throughput;
    return keeps_depths() ? alpha + throughput * absorptance(path.depth) : alpha;
}
#endif
