// cloud: how the build reads points, and what it keeps about them.
//
// Through uniform texel buffers where the device allows ones long enough (records.glsl says why), else
// through storage buffers. Both give the same bits.
#ifndef CLOUD_GLSL
#define CLOUD_GLSL

// d2 as every neighbour search of the project computes it.
float square_of(vec3 way) {
    return (way.x * way.x + way.y * way.y) + way.z * way.z;
}
#endif
