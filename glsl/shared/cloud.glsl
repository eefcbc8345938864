// cloud: distances, as every neighbour search of the project computes them.
#ifndef CLOUD_GLSL
#define CLOUD_GLSL

float square_of(vec3 way) {
    return (way.x * way.x + way.y * way.y) + way.z * way.z;
}
#endif
