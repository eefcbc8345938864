// scene: what a scene needs, and how it is lit. Constants of the pipeline: lavapipe runs both sides of an `if` for every ray,
// and so does a GPU where rays differ.
#ifndef SCENE_GLSL
#define SCENE_GLSL

layout(constant_id = 0) const uint SCENE = 0xffffffffu;
layout(constant_id = 1) const uint LIGHTING = 0xffffffffu;

bool scene_has(uint what) {
    return (SCENE & what) != 0u;
}

bool lighting_has(uint what) {
    return (LIGHTING & what) != 0u;
}
#endif
