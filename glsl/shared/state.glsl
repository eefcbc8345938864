// state: what a ray carries from pass to pass, in four images read and four written; with QUEUE, in a
// buffer, in place, but for a kernel that moves rays from one to another.
//
// Stands in for the four render targets of the paper (section 5): position, direction, cell; what a
// ray has accumulated is in its Path. The nearest hit so far is packed among them. The rays of a wave
// lie one after another, STATE_ROW a row. All bits travel as unsigned integers, so that no driver
// flushes or quiets a value on its way.
#ifndef STATE_GLSL
#define STATE_GLSL
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/rays.glsl"
#include "math.glsl"
#include "scene.glsl"

struct Ray {
    vec3 origin;     // centred scene space
    float hit_t;     // nearest hit so far, or NO_HIT
    vec3 direction;  // unit length
    uint cells;      // cells crossed so far
    uint cell;       // where in its structure it is; RAY_STARTS: at its beginning; NONE: the ray is done
    uint cursor;     // how many of the points there it has tested
    uint tests;      // points tested so far
    uint hit_slot;   // the point hit, or NONE
    uint left;       // the point whose surface it starts on, or NONE
    float after;     // hits up to this distance do not count: they were refined away
    uint entry;      // the cell where it came into the grid that it is in, of several
};

// One that its structure has yet to begin with (structure.glsl).
Ray new_ray(vec3 origin, vec3 direction, uint left) {
    return Ray(origin, NO_HIT, direction, 0u, RAY_STARTS, 0u, 0u, NONE, left, 0.0, NONE);
}

Ray no_ray() {
    Ray ray = new_ray(vec3(0.0), vec3(0.0, 0.0, 1.0), NONE);
    ray.cell = NONE;
    return ray;
}

#ifdef STATE_READS
StateRay stored_state(uint ray);

Ray load_ray(uint at) {
    StateRay ray = stored_state(at);
    return Ray(uintBitsToFloat(ray.position.xyz), uintBitsToFloat(ray.position.w),
               uintBitsToFloat(ray.direction.xyz), ray.direction.w,
               ray.cell.x, ray.cell.y, ray.cell.z, ray.cell.w, ray.start.x, uintBitsToFloat(ray.start.y),
               ray.start.z);
}
#endif

#ifdef QUEUE
#ifdef STATE_READS
StateRay stored_state(uint ray) {
    return state_at(ray);
}

// What keep_words has kept.
uvec2 kept_words(uint ray) {
    return state_start_at(ray).zw;
}
#endif

#ifdef STATE_WRITES
layout(std430, binding = STATE_OUT) writeonly buffer StateOut { StateRay state_out[]; };

void store_ray(uint at, Ray ray) {
    state_out[at].position = uvec4(floatBitsToUint(ray.origin), floatBitsToUint(ray.hit_t));
    state_out[at].direction = uvec4(floatBitsToUint(ray.direction), ray.cells);
    state_out[at].cell = uvec4(ray.cell, ray.cursor, ray.tests, ray.hit_slot);
    state_out[at].start.xy = uvec2(ray.left, floatBitsToUint(ray.after));
    if (scene_has(SCENE_LEVELS)) state_out[at].start.z = ray.entry;
}

// Two words more that a structure keeps of a ray of a queue, in place of `entry`, which is the grids' own.
void keep_words(uint at, uvec2 words) {
    state_out[at].start.zw = words;
}

// A ray that has gone on: it starts where it did.
void store_progress(uint at, Ray ray) {
    state_out[at].position.w = floatBitsToUint(ray.hit_t);
    state_out[at].direction.w = ray.cells;
    state_out[at].cell = uvec4(ray.cell, ray.cursor, ray.tests, ray.hit_slot);
    if (scene_has(SCENE_LEVELS)) state_out[at].start.z = ray.entry;
}
#endif

#else
ivec2 texel_of(uint ray) {
    return ivec2(ray % uint(STATE_ROW), ray / uint(STATE_ROW));
}

#ifdef STATE_READS
layout(rgba32ui, binding = STATE_IN) uniform readonly uimage2D position_in;
layout(rgba32ui, binding = DIRECTION_IN) uniform readonly uimage2D direction_in;
layout(rgba32ui, binding = CELL_IN) uniform readonly uimage2D cell_in;
layout(rgba32ui, binding = START_IN) uniform readonly uimage2D start_in;

StateRay stored_state(uint ray) {
    ivec2 texel = texel_of(ray);
    return StateRay(imageLoad(position_in, texel), imageLoad(direction_in, texel), imageLoad(cell_in, texel),
                    imageLoad(start_in, texel));
}
#endif

#ifdef STATE_WRITES
layout(rgba32ui, binding = STATE_OUT) uniform writeonly uimage2D position_out;
layout(rgba32ui, binding = DIRECTION_OUT) uniform writeonly uimage2D direction_out;
layout(rgba32ui, binding = CELL_OUT) uniform writeonly uimage2D cell_out;
layout(rgba32ui, binding = START_OUT) uniform writeonly uimage2D start_out;

void store_ray(uint at, Ray ray) {
    ivec2 texel = texel_of(at);
    imageStore(position_out, texel, uvec4(floatBitsToUint(ray.origin), floatBitsToUint(ray.hit_t)));
    imageStore(direction_out, texel, uvec4(floatBitsToUint(ray.direction), ray.cells));
    imageStore(cell_out, texel, uvec4(ray.cell, ray.cursor, ray.tests, ray.hit_slot));
    imageStore(start_out, texel, uvec4(ray.left, floatBitsToUint(ray.after), ray.entry, 0u));
}

// The images swap after a pass, so all of a ray is written.
void store_progress(uint at, Ray ray) {
    store_ray(at, ray);
}
#endif
#endif
#endif
