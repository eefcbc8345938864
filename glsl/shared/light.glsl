// light: a place on a light, and what arrives from there (method, section 6).
//
// twin  crates/reference/src/light.rs
// A directional light is a disc on the sky, a point light a sphere. Places are even in projected
// solid angle about the direction to the centre, so that a surface that faces the light gets exactly
// what it would from a hard one, whichever place is drawn.
#ifndef LIGHT_GLSL
#define LIGHT_GLSL
#include "stages/wave.glsl"
#include "direction.glsl"
#include "math.glsl"
#include "sampler.glsl"

#define LEAST_COSINE 1e-3 // between a place and the centre, as weights see it: the widest lights alone
#define PI 3.14159265
#define MOST_LIGHT 1e30 // so that nothing overflows next to a light

struct LightSample {
    vec3 towards;   // unit
    float distance; // to the light's surface along it; NO_HIT: infinite
    vec3 arriving;  // irradiance, to be multiplied by max(0, n . towards)
};

// What arrives at x from the place on the light that u in the unit square stands for; (1/2, 1/2) is
// the centre. Inside a sphere the light is as strong as on its surface, and comes from half of all
// directions; a point without extent does not light itself.
LightSample sample_light(Light light, vec3 x, vec2 u) {
    bool is_point = light.kind == LIGHT_POINT;
    vec3 away = light.vector - x;
    float square = dot3(away, away);
    float center_distance = sqrt(square);
    bool apart = square > 0.0;
    vec3 to_center = apart ? away / (apart ? center_distance : 1.0) : vec3(0.0, 0.0, 1.0);
    vec3 axis = is_point ? to_center : light.vector;
    float least = light.extent * light.extent;
    bool within = square <= least;
    float seen = within ? 1.0 : light.extent / (within ? 1.0 : center_distance);
    float sine = is_point ? seen : light.extent;

    vec2 s = sine * concentric_disc(u);
    float sines = s.x * s.x + s.y * s.y;
    float cosine = sqrt(max(1.0 - sines, 0.0));
    vec3 towards = sines > 0.0 ? about_axis(axis, s, cosine) : axis;

    // The foot of the sphere's centre on the ray lies half a chord behind the entry.
    float foot = center_distance * cosine;
    float half_chord = sqrt(max(least - square * sines, 0.0));
    float entry = max(within ? foot + half_chord : foot - half_chord, 0.0);

    float divisor = is_point ? max(square, least) : 1.0;
    bool dark = divisor <= 0.0;
    vec3 arriving = (light.strength / (dark ? 1.0 : divisor)) / max(cosine, LEAST_COSINE);
    return LightSample(towards, is_point ? entry : NO_HIT, dark ? vec3(0.0) : min(arriving, vec3(MOST_LIGHT)));
}

#define LEAST_EXTENT 1e-12 // squared, of what rays may meet

// The radiance of a light with an extent, where a ray meets it before `end`; 0 where it does not, and of all other lights.
// Places of it are as bright from any side that sees them, as the mean of `sample_light` has it.
vec3 met_of(Light light, vec3 origin, vec3 direction, float end) {
    bool is_point = light.kind == LIGHT_POINT;
    float square_extent = light.extent * light.extent;
    bool has_extent = square_extent > LEAST_EXTENT && (is_point || light.kind == LIGHT_DIRECTIONAL);
    vec3 axis = is_point ? light.vector - origin : light.vector;
    float square = dot3(axis, axis);
    float along = dot3(axis, direction);
    vec3 off = cross3(axis, direction);
    float square_off = dot3(off, off);
    bool within = square <= square_extent;
    float half_chord = sqrt(max(square_extent - square_off, 0.0));
    float entry = is_point ? (within ? along + half_chord : along - half_chord) : NO_HIT;
    bool meets = has_extent && square_off <= square_extent && (along > 0.0 || (is_point && within));
    bool before = is_point ? entry < end : end >= NO_HIT;
    float area = PI * (has_extent ? square_extent : 1.0);
    return meets && before ? light.strength / area : vec3(0.0);
}
#endif
