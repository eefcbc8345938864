// optics: directions of reflected and refracted rays (method, section 4).
//
// twin  crates/reference/src/optics.rs
// Directions and normals have unit length; the normal faces the side that the ray comes from.
#ifndef OPTICS_GLSL
#define OPTICS_GLSL
#include "math.glsl"

vec3 reflected(vec3 d, vec3 n) {
    return normalize3(d - (2.0 * dot3(n, d)) * n);
}

// Snell's law for a ray from index n1 to n2.
struct Refraction {
    vec3 direction;   // refracted, or reflected where nothing is refracted
    bool total;       // total internal reflection
    float reflectance; // of unpolarised light, by Fresnel's equations; 1 where total
};

// The mean of the two polarisations' reflectances, from the cosines on either side.
float fresnel_reflectance(float n1, float incident, float n2, float transmitted) {
    float across = (n1 * incident - n2 * transmitted) / (n1 * incident + n2 * transmitted);
    float along = (n2 * incident - n1 * transmitted) / (n2 * incident + n1 * transmitted);
    return 0.5 * (across * across + along * along);
}

Refraction refraction(vec3 d, vec3 n, float n1, float n2) {
    float eta = n1 / n2;
    float incident = min(max(-dot3(n, d), 0.0), 1.0); // cosines of the angles to the normal
    float square = 1.0 - (eta * eta) * (1.0 - incident * incident);
    bool total = square <= 0.0;
    float transmitted = sqrt(total ? 0.0 : square);
    float partial = fresnel_reflectance(n1, incident, n2, transmitted);
    vec3 bent = eta * d + (eta * incident - transmitted) * n;
    return Refraction(total ? reflected(d, n) : normalize3(total ? n : bent), total, total ? 1.0 : partial);
}

// The same of light from index n1 to a higher n2, which is never reflected totally.
float reflectance_into(float incident, float n1, float n2) {
    float eta = n1 / n2;
    float transmitted = sqrt(1.0 - (eta * eta) * (1.0 - incident * incident));
    return fresnel_reflectance(n1, incident, n2, transmitted);
}
#endif
