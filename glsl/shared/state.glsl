// state: what a ray carries from pass to pass, in four images read and four written.
//
// Stands in for the four render targets of the paper (section 5): position, direction, cell,
// accumulated colour. The nearest hit so far is packed among them. All bits travel as unsigned
// integers, so that no driver flushes or quiets a value on its way.
#ifndef STATE_GLSL
#define STATE_GLSL
#include "layout.glsl"

struct Ray {
    vec3 origin;     // centred scene space
    float hit_t;     // nearest hit so far, or NO_HIT
    vec3 direction;  // unit length
    uint cells;      // cells crossed so far
    uint cell;       // the one it is in; NONE: the ray is done
    uint cursor;     // how many of that cell's points it has tested
    uint tests;      // points tested so far
    uint hit_slot;   // the point hit, or NONE
    vec3 color;      // accumulated
    float after;     // hits up to this distance do not count: they were refined away
};

#ifdef STATE_READS
layout(rgba32ui, binding = STATE_IN + 0) uniform readonly uimage2D position_in;
layout(rgba32ui, binding = STATE_IN + 1) uniform readonly uimage2D direction_in;
layout(rgba32ui, binding = STATE_IN + 2) uniform readonly uimage2D cell_in;
layout(rgba32ui, binding = STATE_IN + 3) uniform readonly uimage2D color_in;

Ray load_ray(ivec2 pixel) {
    uvec4 position = imageLoad(position_in, pixel);
    uvec4 direction = imageLoad(direction_in, pixel);
    uvec4 cell = imageLoad(cell_in, pixel);
    uvec4 color = imageLoad(color_in, pixel);
    return Ray(uintBitsToFloat(position.xyz), uintBitsToFloat(position.w),
               uintBitsToFloat(direction.xyz), direction.w,
               cell.x, cell.y, cell.z, cell.w, uintBitsToFloat(color.xyz), uintBitsToFloat(color.w));
}
#endif

#ifdef STATE_WRITES
layout(rgba32ui, binding = STATE_OUT + 0) uniform writeonly uimage2D position_out;
layout(rgba32ui, binding = STATE_OUT + 1) uniform writeonly uimage2D direction_out;
layout(rgba32ui, binding = STATE_OUT + 2) uniform writeonly uimage2D cell_out;
layout(rgba32ui, binding = STATE_OUT + 3) uniform writeonly uimage2D color_out;

void store_ray(ivec2 pixel, Ray ray) {
    imageStore(position_out, pixel, uvec4(floatBitsToUint(ray.origin), floatBitsToUint(ray.hit_t)));
    imageStore(direction_out, pixel, uvec4(floatBitsToUint(ray.direction), ray.cells));
    imageStore(cell_out, pixel, uvec4(ray.cell, ray.cursor, ray.tests, ray.hit_slot));
    imageStore(color_out, pixel, uvec4(floatBitsToUint(ray.color), floatBitsToUint(ray.after)));
}
#endif
#endif
