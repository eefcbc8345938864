// march: rays through volumes, sample after sample, as far as the surface that they met (section 6 of the
// paper).
//
// reads   the ray state, hits      where each ray begins and ends
//         objects          what the medium that a ray is in absorbs
//         volumes, their cells, points, lengths and stops
// writes  march            where each ray goes on in the next pass
//         paths            what the volumes emit towards the camera, and what they leave of the throughput
//         live             how many rays are not done
// runs    one invocation per ray of the wave; dispatched until none lives
// twin    crates/reference/src/volume.rs
//
// With SHADOWS, rays towards a light: what is left of its light goes to light_sums. With LIT, colours of
// some volumes are not emitted, but scatter the light that reaches their points:
// reads   lights
//         visible          of each point, how much of each light's reaches it
// writes  march_lights     beside march
//
// Samples lie at the midpoints of steps that are counted from where the ray enters the first volume, or
// from its start where it is inside the surface of one; the last step ends where the ray does, and counts
// with its own length. Volumes add. A pass can end after any row of cells or any 64 points of one.
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#include "layout.glsl"
#include "math.glsl"
#include "volume.glsl"
#include "state.glsl"
#include "index.glsl"
#ifdef LIT
#include "light.glsl"
#endif

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = TRACE_LIVE) buffer Live { uint live; };
layout(std430, binding = WAVE_PATHS) buffer Paths { Path paths[]; };
layout(std430, binding = MARCH_STATE) buffer Marches { March marches[]; };
#ifdef SHADOWS
layout(std430, binding = WAVE_LIT_RAYS) readonly buffer LitRays { uint lit_rays[]; };
layout(std430, binding = WAVE_LIGHT_SUMS) buffer LightSums { LightSum light_sums[]; };
#else
layout(std430, binding = TRACE_HITS) readonly buffer Hits { Hit hits[]; };

uint media_word(uint ray, uint word) {
    return paths[ray].media[word];
}
#include "media.glsl"
#endif
#ifdef LIT
layout(std430, binding = SHADE_LIGHTS) readonly buffer Lights { Light lights[]; };
layout(std430, binding = MARCH_LIGHT) buffer MarchLights { MarchLight march_lights[]; };
#ifdef QUEUE
layout(binding = MARCH_VISIBLE) uniform usamplerBuffer visible_texels; // four each

vec4 visible_from(uint point) {
    return uintBitsToFloat(texelFetch(visible_texels, int(point)));
}
#else
layout(std430, binding = MARCH_VISIBLE) readonly buffer Visible { vec4 visible[]; };

vec4 visible_from(uint point) {
    return visible[point];
}
#endif
#endif
layout(push_constant) uniform Push { MarchParams params; };

#define AT_ONCE 64u // points of a row
#define FEWEST 1e-30 // transmittance that still counts
#define MOST_SAMPLES 16777216.0 // floats count no farther

bool is_inside(uint path, uint object) {
    bool found = false;
    for (uint i = 0u; i < paths[path].media_count; ++i) {
        found = found || bitfieldExtract(paths[path].media[i / 2u], 16 * int(i & 1u), 16) == object;
    }
    return found;
}

// Whether a volume counts on this ray at all.
bool takes_part(VolumeInfo volume, uint path) {
    return volume.mode != VOLUME_ISOSURFACE && (volume.bounded == 0u || is_inside(path, volume.object));
}

// From where to where the ray passes volumes.
vec2 way_through(Ray ray, uint path, float end) {
    vec2 way = vec2(NO_HIT, 0.0);
    for (uint i = 0u; i < params.volume_count; ++i) {
        bool bounded = volumes[i].bounded != 0u;
        vec2 box = within_box(volumes[i].grid.origin, volumes[i].high, ray.origin, ray.direction);
        bool counts = takes_part(volumes[i], path) && box.x <= box.y;
        way.x = counts ? min(way.x, bounded ? 0.0 : box.x) : way.x;
        way.y = counts ? max(way.y, box.y) : way.y;
    }
    way.y = min(way.y, end);
    return way;
}

#ifdef LIT
// What reaches the points, by their weights.
vec4 visible_at(vec4 sum, vec4 weights, FourPoints four) {
    return (((sum + weights.x * visible_from(four.at[0])) + weights.y * visible_from(four.at[1]))
        + weights.z * visible_from(four.at[2])) + weights.w * visible_from(four.at[3]);
}
#endif

struct Sample {
    vec3 x;
    float length_of_step;
    float t;
};

Sample sample_of(Ray ray, vec2 way, uint place) {
    float begin = float(place) * params.step;
    float length_of_step = min(params.step, (way.y - way.x) - begin);
    float t = way.x + (begin + 0.5 * length_of_step);
    return Sample(ray.origin + t * ray.direction, length_of_step, t);
}

// Whether x is in the volume's grid, and anything may be seen from its cell.
bool may_be_seen(VolumeInfo volume, vec3 x) {
    vec3 cells_off = (x - volume.grid.origin) * volume.grid.inverse_edge;
    bool inside = all(greaterThanEqual(cells_off, vec3(0.0))) && all(lessThan(cells_off, vec3(volume.grid.resolution)));
    return inside && volume_cell(volume.first_cell + cell_id(volume.grid, cell_of(volume.grid, x))).counts != 0u;
}

// What a ray shows of the scalar that stands for its whole way: a layer of one radius, or all of it.
March shown(VolumeInfo volume, March march) {
    float scalar = march.color.x;
    float way = march.color.y;
    bool reached = way > 0.0;
    bool mean = volume.mode == VOLUME_AVERAGE;
    vec4 seen = transfer(volume, mean ? scalar / (reached ? way : 1.0) : scalar);
    float through = exp_negative(-(seen.w * (mean ? way : sqrt(volume.square_radius))));
    through = through < FEWEST ? 0.0 : through;
    march.transmittance = reached ? through : 1.0;
    march.color = reached ? (1.0 - through) * seen.xyz : vec3(0.0);
    return march;
}

#ifdef LIT
#define INVERSE_PI 0.318309886
#define INVERSE_FOUR_PI 0.0795774715
#define FLATTEST 1e-5 // a gradient over a point's reach, by the scalar: less is rounding

// What of the light at x goes towards the viewer, by the colour there. By Lambert's law for a surface across
// the gradient, or evenly to all sides, as is the mean of that over all surfaces.
vec3 scattered(VolumeInfo volume, float numerator, float weights, MarchLight sums, vec3 x, vec3 d) {
    float scalar = volume.kernel == VOLUME_SHEPARD ? numerator / weights : numerator;
    vec3 gradient = gradient_of(volume, scalar, sums.pull, sums.weights_pull);
    float square = dot3(gradient, gradient);
    float reach = volume.square_radius;
    float most = (numerator * numerator) * (volume.kernel == VOLUME_SPH ? 1.0 / reach : reach);
    bool steep = volume.shading == VOLUME_GRADIENT && square > (FLATTEST * FLATTEST) * most;
    vec3 normal = steep ? gradient / (steep ? sqrt(square) : 1.0) : vec3(0.0);
    normal = dot3(normal, d) > 0.0 ? -normal : normal;
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < params.light_count; ++i) {
        LightSample light = sample_light(lights[i], x, vec2(0.5));
        float share = steep ? max(dot3(normal, light.towards), 0.0) * INVERSE_PI : INVERSE_FOUR_PI;
        sum += ((sums.visible[i] / weights) * share) * light.arriving;
    }
    return sum;
}
#endif

void finish(uint at, uint path, March march) {
#ifdef SHADOWS
    light_sums[at].arriving *= march.transmittance;
#else
    paths[path].emitted += paths[path].throughput * march.color;
    paths[path].throughput *= march.transmittance;
    paths[path].coverage = 1.0 - march.transmittance;
#endif
}

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    March march = marches[at];
#ifdef SHADOWS
    uint path = lit_rays[at];
    Ray ray = load_ray(at);
    // Blocked, or never sent: the light brings nothing, however far it would come.
    bool begins = ray.hit_slot == NONE && any(greaterThan(light_sums[at].arriving, vec3(0.0)));
    float end = ray.hit_t;
#else
    uint path = at;
    bool begins = paths[at].pixel != NONE;
    Ray ray = load_ray(at);
    float end = ray.hit_slot != NONE ? hits[at].t : NO_HIT;
#endif
    if (march.state == 2u || !begins) return;
#ifdef LIT
    MarchLight sums = march_lights[at];
#endif
    if (march.state == 0u) {
        march.transmittance = 1.0;
        march.state = 1u;
    }
#ifndef SHADOWS
    uint medium = paths[at].media_count > 0u ? medium_without(Media(at, paths[at].media_count), NONE) : NONE;
#endif
    vec2 way = way_through(ray, path, end);
    float span = way.y - way.x;
    uint samples = uint(min(max(-floor(-(span / params.step)), 0.0), MOST_SAMPLES));
    uint work_left = params.work;

    // Drivers without real branches run what is under an if for every ray: loops of one turn or none are passed over.
    bool alone = params.volume_count == 1u;
    VolumeInfo volume = volumes[march.volume];
    while (march.place < samples && work_left > 0u) {
        Sample at_place = sample_of(ray, way, march.place);
        bool fresh = alone && march.row == 0u && march.cursor == 0u;
        while (fresh && march.place < samples && work_left > 0u && !may_be_seen(volume, at_place.x)) {
            ++march.place;
            --work_left;
            at_place = sample_of(ray, way, march.place);
        }
        bool counts = march.place < samples && takes_part(volume, path) && may_be_seen(volume, at_place.x);
        vec3 x = at_place.x;
        float reach = sqrt(volume.square_radius);
        uvec3 low, high;
        cells_around(volume.grid, x, reach, low, high);
        uint rows = counts ? (high.y - low.y + 1u) * (high.z - low.z + 1u) : 0u;
        bool particles = volume.kernel == VOLUME_SPH;

        while (march.row < rows && work_left > 0u) {
            uvec2 range = row_points(volume, low, high, march.row, x, reach);
            uint first = range.x + march.cursor;
            uint count = min(range.y - first, AT_ONCE);
            uint end = first + count;
            for (uint i = particles ? end : first; i < end; i += 4u) {
                FourPoints four = four_points(i, end, x);
                vec4 weights = gaussians(volume, four);
                vec4 weighted = weights * four.scalars;
                march.numerator = add_up(march.numerator, weighted);
                march.denominator = add_up(march.denominator, weights);
#ifdef LIT
                sums.pull = add_up(sums.pull, weighted, four);
                sums.weights_pull = add_up(sums.weights_pull, weights, four);
                sums.visible = visible_at(sums.visible, weights, four);
#endif
            }
            for (uint i = particles ? first : end; i < end; i += 4u) {
                FourPoints four = four_points(i, end, x);
                vec4 inverse_lengths = inverse_lengths_of(four);
                vec4 weights = splines(four, inverse_lengths);
                march.numerator = add_up(march.numerator, weights * four.scalars);
                march.denominator = add_up(march.denominator, weights);
#ifdef LIT
                vec4 pulls = spline_pulls(sqrt(four.squares) * inverse_lengths, inverse_lengths);
                sums.pull = add_up(sums.pull, mix(vec4(0.0), pulls * four.scalars, four.are_there), four);
                sums.visible = visible_at(sums.visible, weights, four);
#endif
            }
            bool row_ends = first + count >= range.y;
            march.cursor = row_ends ? 0u : march.cursor + count;
            march.row += row_ends ? 1u : 0u;
            work_left -= min(work_left, count + 2u);
        }
        work_left -= min(work_left, 2u);

        uint ends = march.row >= rows && march.place < samples ? 1u : 0u;
        while (ends > 0u) {
            --ends;
            bool reached = march.denominator > 0.0;
            float divisor = volume.kernel == VOLUME_SHEPARD && reached ? march.denominator : 1.0;
            float scalar = march.numerator / divisor;
            bool emission = volume.mode == VOLUME_EMISSION;
            bool greater = !(march.color.y > 0.0) || scalar > march.color.x;
            float greatest = greater ? scalar : march.color.x;
            float integral = march.color.x + at_place.length_of_step * scalar;
            vec2 whole =
                vec2(volume.mode == VOLUME_MAXIMUM ? greatest : integral, march.color.y + at_place.length_of_step);
            march.color.xy = reached && !emission ? whole : march.color.xy;
            vec4 seen = transfer(volume, scalar);
            float extinction = reached && emission ? seen.w : 0.0;
            vec3 color = seen.xyz;
#ifdef LIT
            uint lit = extinction > 0.0 && volume.shading != VOLUME_EMITS ? 1u : 0u;
            for (uint i = 0u; i < lit; ++i) {
                color *= scattered(volume, march.numerator, march.denominator, sums, at_place.x, ray.direction);
            }
            sums = MarchLight(vec3(0.0), 0u, vec3(0.0), 0u, vec4(0.0));
#endif
            march.sample_color += extinction * color;
            march.sample_extinction += extinction;
            march.numerator = 0.0;
            march.denominator = 0.0;
            march.row = 0u;
            ++march.volume;
            bool last = march.volume >= params.volume_count;
            bool emits = last && march.sample_extinction > 0.0;
            float through = exp_negative(-(march.sample_extinction * at_place.length_of_step));
            vec3 mean = march.sample_color / (emits ? march.sample_extinction : 1.0);
#ifndef SHADOWS
            uint absorbs = emits && medium != NONE ? 1u : 0u;
            for (uint i = 0u; i < absorbs; ++i) mean *= transmittance(medium, at_place.t);
#endif
            march.color += emits ? (march.transmittance * (1.0 - through)) * mean : vec3(0.0);
            march.transmittance *= emits ? through : 1.0;
            march.sample_color = last ? vec3(0.0) : march.sample_color;
            march.sample_extinction = last ? 0.0 : march.sample_extinction;
            march.volume = last ? 0u : march.volume;
            bool dark = march.transmittance < FEWEST;
            march.transmittance = dark ? 0.0 : march.transmittance;
            march.place = last ? (dark ? samples : march.place + 1u) : march.place;
        }
        uint other = alone ? 0u : 1u;
        while (other > 0u) {
            --other;
            volume = volumes[march.volume];
        }
    }
    bool done = march.place >= samples;
    march.state = done ? 2u : 1u;
    marches[at] = march;
#ifdef LIT
    march_lights[at] = sums;
#endif
    uint mode = volumes[0].mode;
    bool whole = mode == VOLUME_MAXIMUM || mode == VOLUME_AVERAGE;
    if (done) finish(at, path, whole ? shown(volumes[0], march) : march);
    else atomicAdd(live, 1u);
}
