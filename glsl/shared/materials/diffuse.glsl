// diffuse: Lambert's law.
//
// twin  crates/reference/src/material/diffuse.rs

#define INVERSE_PI 0.318309886

vec3 diffuse_lobe(Place place, vec3 towards) {
    return vec3(max(dot3(place.normal, towards), 0.0));
}

vec3 diffuse_scattered(vec3 light, vec3 albedo) {
    return albedo * (light * INVERSE_PI);
}
