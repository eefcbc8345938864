// phase: how much of light a volume scatters by an angle (Henyey and Greenstein, Diffuse Radiation in the Galaxy, 1941).
//
// twin  crates/reference/src/material/cloud.rs
#ifndef PHASE_GLSL
#define PHASE_GLSL

#define INVERSE_SPHERE 0.0795774715 // 1 / 4 pi

// The share of light that is scattered by an angle of this cosine, per steradian.
float phase(float g, float cosine) {
    float square = max((1.0 + g * g) - (2.0 * g) * cosine, 1e-6);
    return ((1.0 - g * g) / (square * sqrt(square))) * INVERSE_SPHERE;
}
#endif
