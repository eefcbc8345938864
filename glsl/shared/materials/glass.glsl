// glass: smooth glass.
//
// twin  crates/reference/src/material/glass.rs
#include "optics.glsl"

// Straight on where the ray passes, or where its channels meet no other index; else refracted or reflected.
Sent glass_sends(Place place, Fate fate, uint channels, Drawn drawn) {
    vec3 n1 = ior_of(fate.crossing.before), n2 = ior_of(fate.crossing.after);
    bool red = (channels & 1u) != 0u, green = channels == 2u;
    float index = red ? n1.x : (green ? n1.y : n1.z), beyond = red ? n2.x : (green ? n2.y : n2.z);
    Refraction bent = refraction(place.d, place.normal, index, beyond);
    bool by_chance = scene_has(SCENE_CHANCE) && drawn.chance < bent.reflectance;
    bool straight = fate.passes || (scene_has(SCENE_CLEAR) && index == beyond);
    bool reflects = !straight && (bent.total || by_chance);
    vec3 direction = reflects ? reflected(place.d, place.normal) : (straight ? place.d : bent.direction);
    return Sent(direction, object_albedo_at(place.object), reflects);
}

// All where the media on both sides have one index. Else, where light goes straight on, what is not reflected of it; `cosine`
// is that of the angle on the side of the lower index, so that nothing is reflected totally.
vec3 glass_light_passed(Crossing crossing, float cosine, bool tints) {
    vec3 n1 = ior_of(crossing.before), n2 = ior_of(crossing.after);
    vec3 low = min(n1, n2), high = max(n1, n2);
    bvec3 alike = equal(n1, n2);
    vec3 reflected = vec3(1.0);
    if (tints) {
        reflected = vec3(reflectance_into(cosine, low.x, high.x), reflectance_into(cosine, low.y, high.y),
                         reflectance_into(cosine, low.z, high.z));
    }
    return mix(vec3(1.0) - reflected, vec3(1.0), alike);
}
