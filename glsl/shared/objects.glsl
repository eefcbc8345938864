// objects: how kernels read what shading needs of an object; with QUEUE as in records.glsl.
#ifndef OBJECTS_GLSL
#define OBJECTS_GLSL
#include "layout.glsl"

#ifdef QUEUE
layout(binding = SHADE_OBJECTS) uniform usamplerBuffer object_texels; // seven an object

ObjectInfo object_at(uint object) {
    int first = int(7u * object);
    uvec4 albedo = texelFetch(object_texels, first), slots = texelFetch(object_texels, first + 1);
    uvec4 blending = texelFetch(object_texels, first + 2);
    uvec4 u = texelFetch(object_texels, first + 3), v = texelFetch(object_texels, first + 4);
    uvec4 ior = texelFetch(object_texels, first + 5), absorption = texelFetch(object_texels, first + 6);
    return ObjectInfo(uintBitsToFloat(albedo.xyz), albedo.w, slots.x, slots.y, slots.z, uintBitsToFloat(slots.w), blending.x,
                      uintBitsToFloat(blending.y), blending.z, blending.w, uintBitsToFloat(u), uintBitsToFloat(v),
                      uintBitsToFloat(ior.xyz), ior.w, uintBitsToFloat(absorption.xyz), int(absorption.w));
}
#else
layout(std430, binding = SHADE_OBJECTS) readonly buffer Objects { ObjectInfo objects[]; };

ObjectInfo object_at(uint object) {
    return objects[object];
}
#endif

// Whether a point of the object is a sphere or disc: nothing of it is blended, and its hits are not refined.
bool is_shape_of(ObjectInfo object, uint slot) {
    return slot - object.first_slot >= object.slot_count;
}
#endif
