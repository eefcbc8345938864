// gather: what a light brings, once the shadow rays towards it have ended.
//
// twin  crates/reference/src/wave/shade.rs
// Whoever includes this has buffers `light_sums` and `film`, and reads the shadow rays' state.
#ifndef GATHER_GLSL
#define GATHER_GLSL
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "scene.glsl"
#include "state.glsl"

// The lights' sum at a lit hit with the last light that was asked.
vec3 gathered(uint at, uint pixel) {
    Ray shadow = load_ray(at);
    count_work(pixel, shadow.tests, shadow.cells);
    bool blocked = shadow.hit_slot != NONE;
    vec3 sum = vec3(0.0); // of one light alone nobody stores it
    if (scene_has(SCENE_MANY_LIGHTS)) sum = light_sums[at].sum;
    return sum + (blocked ? vec3(0.0) : light_sums[at].arriving);
}
#endif
