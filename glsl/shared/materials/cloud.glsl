// cloud: a volume that scatters light where it goes on, by the phase function of Henyey and Greenstein (Diffuse Radiation
// in the Galaxy, 1941). Its objects have the mean cosine g for `weight_scale`; its hits, the colour there for a normal.
//
// twin  crates/reference/src/material/cloud.rs

#include "phase.glsl"

#define NEARLY_EVEN 1e-2 // below, directions are drawn by a series in g, whose error is g cubed

float cloud_g(Place place) {
    return lighting_has(LIGHTING_ANISOTROPY) ? object_weight_scale_at(place.object) : 0.0;
}

float cloud_density(Place place, vec3 towards) {
    return phase(cloud_g(place), dot3(place.d, towards));
}

vec3 cloud_lobe(Place place, vec3 towards) {
    return vec3(cloud_density(place, towards));
}

vec3 cloud_direction(Place place, vec2 u) {
    float g = cloud_g(place);
    float s = 2.0 * u.x - 1.0;
    bool even = abs(g) < NEARLY_EVEN;
    float ratio = (1.0 - g * g) / (1.0 + g * s);
    float bent = ((1.0 + g * g) - ratio * ratio) / (even ? 1.0 : 2.0 * g);
    float level = s + (1.0 - s * s) * (1.5 * g - (2.0 * g * g) * s);
    float cosine = clamp(even ? level : bent, -1.0, 1.0);
    vec2 around = sqrt(max(1.0 - cosine * cosine, 0.0)) * on_circle(u.y);
    return about_axis(place.d, around, cosine);
}

Sent cloud_sends(Place place, Drawn drawn) {
    return Sent(cloud_direction(place, drawn.place), vec3(1.0), true);
}
