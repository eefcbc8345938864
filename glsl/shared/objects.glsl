// objects: what the points of an object are.
#ifndef OBJECTS_GLSL
#define OBJECTS_GLSL
#include "stages/wave.glsl"

// Whether a point of the object is a sphere or disc: nothing of it is blended, and its hits are not refined.
bool is_shape_of(ObjectInfo object, uint slot) {
    return slot - object.first_slot >= object.slot_count;
}
#endif
