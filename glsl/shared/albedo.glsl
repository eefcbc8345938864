// albedo: the share of light that the surface of an object scatters back at a hit.
//
// twin    crates/reference/src/albedo.rs
// reads   the object's own, its texture, or what its points have: colours, or places in the texture
#ifndef ALBEDO_GLSL
#define ALBEDO_GLSL
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/grid.glsl"
#include "stages/wave.glsl"
#include "blend.glsl"
#include "image.glsl"
#include "scene.glsl"
#include "objects.glsl"
#include "around.glsl"

layout(std430, binding = COLORS) readonly buffer Colors { float colors[]; };

// Points of a cell that are asked. Two loops over so many stay under what lavapipe allows a dispatch.
#define MOST_ASKED 2048u
#define ASKED_AT_ONCE 32u

// What a point of the object has: a colour, or with a texture its place in it. A colour whose red is
// negative is what a point without a value is drawn in.
vec3 value_of(ObjectInfo object, uint slot) {
    bool is_color = object.texture == NONE;
    uint at = object.first_color + (is_color ? 3u : 2u) * (slot - object.first_slot);
    return vec3(colors[at], colors[at + 1u], is_color ? colors[at + 2u] : 0.0);
}

// Whether a point of the object has no value, by what value_of gives.
bool has_none(ObjectInfo object, vec3 value) {
    return object.texture == NONE && value.x < 0.0;
}

// The mean over the points of the object around x that have a value, by the weights of normals that are blended; where
// none has a weight, it has no value, or is a sphere or disc, what the point at `slot` has. The object's points have
// values.
// First the trust balls that hold x, up to 32 into a bit mask, then their weights: few of a cell do.
vec3 blended_value(ObjectInfo object, uint slot, vec3 x) {
    vec3 own = value_of(object, slot);
    vec3 sum = 1e-6 * own;
    float weights = 1e-6;
    uvec2 slots = uvec2(object.first_slot, object.slot_count);
    Around around = Around(uvec2(0u), false);
    bool is_shape = scene_has(SCENE_SHAPES) && is_shape_of(object, slot);
    if (scene_has(SCENE_SHAPES)) { // for shapes alone nothing is listed
        if (!is_shape) around = points_around(x, slots);
    } else {
        around = points_around(x, slots);
    }
    uvec2 range = around.range;
    uint end = object.first_color != NONE && !around.several ? min(range.y, range.x + MOST_ASKED) : range.x;
    if (scene_has(SCENE_LEVELS)) {
        if (around.several) {
            Merge merge = merge_around(x, slots);
            uint near = next_around(merge, x, slots);
            while (near != NONE) {
                vec3 normal;
                float weight = weight_at(polynomial_at(near), x, normal);
                vec3 value = value_of(object, near);
                weight = has_none(object, value) ? 0.0 : weight;
                sum += weight * value;
                weights += weight;
                near = next_around(merge, x, slots);
            }
        }
    }
    for (uint first = range.x; first < end; first += ASKED_AT_ONCE) {
        uint count = min(end - first, ASKED_AT_ONCE);
        uint holding = 0u;
        for (uint i = 0u; i < count; ++i) {
            uint near = slot_at(first + i);
            vec4 ball = polynomial_center_trust_at(near);
            vec3 y = x - ball.xyz;
            bool is_near = near - object.first_slot < object.slot_count && dot3(y, y) < ball.w * ball.w;
            holding |= is_near ? 1u << i : 0u;
        }
        while (holding != 0u) {
            uint near = slot_at(first + uint(findLSB(holding)));
            holding &= holding - 1u;
            vec3 normal;
            float weight = weight_at(polynomial_at(near), x, normal);
            vec3 value = value_of(object, near);
            weight = has_none(object, value) ? 0.0 : weight;
            sum += weight * value;
            weights += weight;
        }
    }
    vec3 mean = is_shape ? own : sum / weights;
    return has_none(object, own) ? vec3(-own.x, own.yz) : mean;
}

// The albedo at x of the object at `index`, whose point at `slot` was hit.
vec3 albedo_at(uint index, uint slot, vec3 x) {
    ObjectInfo object = object_at(index);
    bool has_values = scene_has(SCENE_VALUES) && object.first_color != NONE;
    bool has_texture = scene_has(SCENE_TEXTURES) && object.texture != NONE;
    vec3 value = vec3(0.0);
    if (scene_has(SCENE_VALUES)) {
        if (has_values) value = blended_value(object, slot, x);
    }
    vec3 color = has_values && !has_texture ? value : object.albedo;
    if (scene_has(SCENE_TEXTURES)) {
        float u = dot3(object.texture_u.xyz, x) + object.texture_u.w;
        float v = dot3(object.texture_v.xyz, x) + object.texture_v.w;
        u = has_values ? value.x : u;
        v = has_values ? value.y : v;
        if (has_texture) color = image_at(images[object.texture], u, v, false);
    }
    return color;
}
#endif
