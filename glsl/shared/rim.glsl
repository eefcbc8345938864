// rim: where the surface of an open set ends (method, section 2).
//
// twin  crates/reference/src/rim.rs
// After Adamson and Alexa, Approximating bounded, non-orientable surfaces from points, 2004: a
// place x belongs to the surface while it is near the weighted centroid of the points around it. Lengths
// are in units of the reach of the neighbours.
#ifndef RIM_GLSL
#define RIM_GLSL
#include "math.glsl"

#define RIM_STEPS 6u        // of Newton's method
#define RIM_LEAST 0.05      // the surface reaches at least so far beyond its point
#define RIM_FARTHEST 1.5
#define RIM_FLATTEST 0.2    // slope of the distance to the centroid that a step counts on
#define RIM_OPEN 0.8        // cells that reach farther may lie at a rim
#define RIM_SHORTEST 1e-6   // way to the centroid that has a direction

// Sums over the points around x = s e: weights, and places along e.
struct Centroid {
    float total;
    float first;
    float second;
};

// The point itself, at the origin.
Centroid centroid_at(float s) {
    return Centroid(exp_negative(-(s * s)), 0.0, 0.0);
}

void add_neighbor(inout Centroid c, vec3 y, vec3 e, float s) {
    vec3 d = y - s * e;
    float weight = exp_negative(-dot3(d, d));
    float along = dot3(y, e);
    float moment = weight * along;
    c.total += weight;
    c.first += moment;
    c.second += moment * along;
}

// One step towards the s where the distance to the centroid is the limit.
float step_to_rim(Centroid c, float s, float limit) {
    float mean = c.first / c.total;
    float variance = c.second / c.total - mean * mean;
    float slope = max(1.0 - 2.0 * variance, RIM_FLATTEST);
    return min(max(s - ((s - mean) - limit) / slope, -1.0), RIM_FARTHEST);
}
#endif
