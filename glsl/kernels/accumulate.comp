// accumulate: adds a sample of each pixel to the sum of those before it; after the last, the mean.
//
// reads   film             one sample of every pixel
//         sums             of the samples before it; not read at the first
// writes  sums             of all so far, but for the last
//         film             at the last sample: the mean of all
// runs    one invocation per pixel of the tile; dispatched once a sample
// twin    crates/reference/src/accumulate.rs
//
// Kahan's summation: over thousands of samples, a plain sum would lose as many roundings.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stages/points.glsl"
#include "stages/film.glsl"
#include "math.glsl"
#include "index.glsl"

layout(local_size_x = TILE_GROUP) in;
layout(std430, binding = FILM) buffer Film { FilmPixel film[]; };
layout(std430, binding = FILM_SUMS) buffer Sums { FilmSum sums[]; };
layout(push_constant) uniform Push { AccumulateParams params; };

uint saturating_sum(uint a, uint b) {
    return a + min(b, ~a);
}

void main() {
    uvec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, params.tile_size))) return;
    uint at = pixel.y * params.tile_size.x + pixel.x;
    FilmPixel next = film[at];
    FilmSum sum = FilmSum(next, vec4(0.0), vec3(0.0), 0u);
    if (params.sample_index > 0u) {
        sum = sums[at];
        vec4 term = next.color - sum.lost;
        vec4 total = sum.pixel.color + term;
        vec4 lost = (total - sum.pixel.color) - term;
        sum.lost = mix(vec4(0.0), lost, lessThan(abs(total), vec4(NO_HIT))); // infinity loses nothing
        sum.pixel.color = total;
        vec3 alpha_term = next.alpha - sum.lost_alpha;
        vec3 alpha_total = sum.pixel.alpha + alpha_term;
        sum.lost_alpha = (alpha_total - sum.pixel.alpha) - alpha_term;
        sum.pixel.alpha = alpha_total;
        sum.pixel.counts.x = saturating_sum(sum.pixel.counts.x, next.counts.x);
        sum.pixel.counts.y = saturating_sum(sum.pixel.counts.y, next.counts.y);
    }
    if (params.sample_index + 1u == params.samples) {
        sum.pixel.color = sum.pixel.color / float(params.samples);
        sum.pixel.alpha = sum.pixel.alpha / float(params.samples);
        film[at] = sum.pixel;
    } else {
        sums[at] = sum;
    }
}
