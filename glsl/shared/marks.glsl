// marks: what becomes of each ray of a wave, a bit each; lists are made of them (list_marked.comp).
//
// Whoever includes this reads `params` of a wave.
#ifndef MARKS_GLSL
#define MARKS_GLSL
#include "stages/scene.glsl"
#include "stages/wave.glsl"

layout(std430, binding = LIT_MARKS) buffer Lit { uint lit[]; };
layout(std430, binding = SCATTERING_MARKS) buffer Scattering { uint scattering[]; };
layout(std430, binding = NEXT_MARKS) buffer NextMarks { uvec2 next_marks[]; };

// A hit on a lit surface.
void mark_lit(uint ray) {
    atomicOr(lit[ray / 32u], 1u << (ray & 31u));
}

// One on a surface that sends rays on, and how many rays of the next wave it makes: none, one or three.
void mark_scattering(uint ray, uint count) {
    uint bit = 1u << (ray & 31u);
    atomicOr(scattering[ray / 32u], bit);
    if (count > 0u) atomicOr(next_marks[ray / 32u].x, bit);
    if (scene_has(SCENE_DISPERSES)) {
        if (count > 1u) atomicOr(next_marks[ray / 32u].y, bit);
    }
}
#endif
