// way: whether a ray goes into an object, out of it, or whichever it may.
//
// twin  crates/reference/src/shape.rs
#ifndef WAY_GLSL
#define WAY_GLSL
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "media.glsl"
#include "scene.glsl"
#include "shape.glsl"

// The way through the surface of the point at `slot`: each sphere is entered and left for itself.
uint way_through_point(uint slot, vec3 o, vec3 d, float t) {
    if (!scene_has(SCENE_SPHERES)) return WAY_EITHER;
    bool enters = t < -dot3(o - polynomial_center_trust_at(slot).xyz, d);
    return is_sphere(polynomial_gradient_offset_at(slot).xyz) ? (enters ? WAY_IN : WAY_OUT) : WAY_EITHER;
}
#endif
