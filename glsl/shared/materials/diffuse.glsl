// diffuse: Lambert's law.
//
// twin  crates/reference/src/material/diffuse.rs
#include "direction.glsl"

#define INVERSE_PI 0.318309886

vec3 diffuse_lobe(Place place, vec3 towards) {
    return vec3(max(dot3(place.normal, towards), 0.0));
}

vec3 diffuse_scattered(vec3 light, vec3 albedo) {
    return albedo * (light * INVERSE_PI);
}

// The direction that u in the unit square stands for, by the lobe's share of all that is scattered.
vec3 diffuse_direction(Place place, vec2 u) {
    vec2 s = concentric_disc(u);
    return about_axis(place.normal, s, sqrt(max(1.0 - (s.x * s.x + s.y * s.y), 0.0)));
}

// How densely that draws directions, per steradian.
float diffuse_density(Place place, vec3 towards) {
    return max(dot3(place.normal, towards), 0.0) * INVERSE_PI;
}

// A ray that carries on what light scatters from all sides. The albedo of the place is not in its weight.
Sent matte_sends(Place place, Drawn drawn) {
    return Sent(diffuse_direction(place, drawn.place), vec3(1.0), true);
}
