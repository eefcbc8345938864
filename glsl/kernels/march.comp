// march: rays through volumes, sample after sample, as far as the surface that they met (section 6 of the
// paper).
//
// reads   the ray state, hits      where each ray begins and ends
//         objects          what the medium that a ray is in absorbs
//         volumes, their cells, points, lengths and stops
// writes  march            where each ray goes on in the next pass, and what channels of volumes show
//         ends             of each volume, what the last step ended with; where transfer functions are steep, the last part
//                          of one and the whole step
//         paths            what the volumes emit towards the camera, and their optical depth
//         live             how many rays are not done
// runs    one invocation per ray of the wave; dispatched until none lives
// twin    crates/reference/src/march.rs
//
// With SHADOWS, rays towards a light: what is left of its light goes to light_sums. With LIT, colours of
// some volumes are not emitted, but scatter the light that reaches their points:
// reads   lights
//         visible          of each point, how much of each light's reaches it
// writes  march_lights     beside march
//
// With SCATTERED, where light goes from surface to surface, volumes that are lit scatter rays: a ray ends where the optical
// depth of these is the one that is drawn for it, with the colour there for a normal, as a hit on what stands for the volume.
// What others emit before that and take is left in march.
// writes  hits, the ray state      of such rays
//         march_scatters   beside march
//
// Samples lie at the ends of steps that are counted from where the ray enters the first volume, or from its
// start where it is inside the surface of one; the last step ends where the ray does, and counts with its own
// length. Between the scalars at its ends, the transfer function is integrated. Where that is steep, steps that may pass
// a steep piece are divided into parts, once all volumes are known at both ends. Volumes add. A pass can end after any
// row of cells or any 64 points of one.
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#ifdef SCATTERED
#define STATE_WRITES
#endif
#include "stages/points.glsl"
#include "stages/scene.glsl"
#include "stages/rays.glsl"
#include "stages/wave.glsl"
#include "stages/volume.glsl"
#include "math.glsl"
#include "members.glsl"
#include "volume.glsl"
#include "state.glsl"
#include "index.glsl"
#include "scene.glsl"
#ifdef LIT
#include "light.glsl"
#include "phase.glsl"
#endif
#ifdef SCATTERED
#include "sampler.glsl"
#endif

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = LIVE) buffer Live { uint live; };
layout(std430, binding = PATHS) buffer Paths { Path paths[]; };
layout(std430, binding = MARCHES) buffer Marches { March marches[]; };
#ifdef LIT
layout(std430, binding = MARCH_ENDS) buffer Ends { vec4 ends[]; };
#else
layout(std430, binding = MARCH_ENDS) buffer Ends { float ends[]; };
#endif
#ifdef SHADOWS
layout(std430, binding = LIT_RAYS) readonly buffer LitRays { uint lit_rays[]; };
layout(std430, binding = LIGHT_SUMS) buffer LightSums { LightSum light_sums[]; };
#else
#ifdef SCATTERED
layout(std430, binding = HITS) buffer Hits { Hit hits[]; };
layout(std430, binding = MARCH_SCATTERS) buffer MarchScatters { MarchScatter march_scatters[]; };
#else
layout(std430, binding = HITS) readonly buffer Hits { Hit hits[]; };
#endif

uint media_word(uint ray, uint word) {
    return paths[ray].media[word];
}
#include "media.glsl"
#endif
#ifdef LIT
layout(std430, binding = LIGHTS) readonly buffer Lights { Light lights[]; };
layout(std430, binding = MARCH_LIGHTS) buffer MarchLights { MarchLight march_lights[]; };
#endif
layout(push_constant) uniform Push { MarchParams params; };

#define AT_ONCE 64u // points of a row
#define DEEPEST 69.0775528 // optical depth through which nothing is seen, a transmittance of 1e-30
#define OPAQUE NO_HIT // the optical depth from there on
#define UNREACHED NO_HIT // the scalar where no point is in reach
#define UNSEEN (-NO_HIT) // and where nothing is seen from the cell, whatever it is
#define LARGEST 1e38 // scalar
#define MOST_SAMPLES 16777215.0 // floats count little farther, and places have no more bits
#define PLACE_BITS 24 // of March::place
#define PART_BITS 7   // of the part, above them

#include "steps.glsl"

bool is_scalar(float end) {
    return abs(end) <= LARGEST;
}

// Kahan's summation: `lost` is what rounding added to the sum.
float add_to(float sum, float term, inout float lost) {
    float more = term - lost;
    float total = sum + more;
    float left = (total - sum) - more;
    lost = abs(total) < NO_HIT ? left : 0.0; // infinity loses nothing
    return total;
}

vec3 add_to(vec3 sum, vec3 terms, inout vec3 lost) {
    vec3 more = terms - lost;
    vec3 total = sum + more;
    vec3 left = (total - sum) - more;
    lost = mix(vec3(0.0), left, lessThan(abs(total), vec3(NO_HIT)));
    return total;
}

// Whether one scalar stands for the whole way of a ray.
bool is_whole(VolumeInfo volume) {
    return volume.mode == VOLUME_MAXIMUM || volume.mode == VOLUME_AVERAGE || volume.mode == VOLUME_INTEGRAL;
}

// What a ray shows of the scalar that stands for its whole way: a layer of one radius, all of it, or once.
March shown(VolumeInfo volume, March march) {
    float way = march.color.y;
    bool reached = way > 0.0;
    bool mean = volume.mode == VOLUME_AVERAGE;
    float scalar = reached ? march.color.x / (mean && reached ? way : 1.0) : 0.0;
    float thickness = mean ? way : (volume.mode == VOLUME_INTEGRAL ? 1.0 : sqrt(volume.square_radius));
    Shown seen = mean_of(volume, scalar, scalar);
    float depth = seen.scattering.w * thickness;
    vec3 color = (thickness * mean_transmittance(depth)) * (seen.scattering.xyz + seen.emission);
    march.depth = reached ? (depth > DEEPEST ? OPAQUE : depth) : 0.0;
    march.color = reached ? color : vec3(0.0);
    march.along = scalar;
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
        float even = INVERSE_FOUR_PI;
        if (lighting_has(LIGHTING_ANISOTROPY)) even = phase(volume.iso, dot3(d, light.towards));
        float share = steep ? max(dot3(normal, light.towards), 0.0) * INVERSE_PI : even;
        sum += ((sums.visible[i] / weights) * share) * light.arriving;
    }
    return sum;
}
#endif

void finish(uint at, uint path, March march) {
#ifdef SHADOWS
    light_sums[at].arriving *= exp_negative(-march.depth);
#elif !defined(SCATTERED) // `classify` knows what to do with the rest
    float before = paths[path].depth;
    paths[path].emitted += (exp_negative(-before) * paths[path].throughput) * march.color;
    paths[path].depth = before + march.depth;
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
#ifdef SCATTERED
    MarchScatter scatter = march_scatters[at];
    uint pixel = paths[path].pixel;
    uint sample_index = params.sample_index == NONE ? 0u : params.sample_index;
    uint dimension = uint(SAMPLE_DISTANCE) + paths[path].bounces + uint(DISTANCES_A_CROSSING) * paths[path].crossings;
    uvec2 place_in_image = params.tile_origin + uvec2(pixel % params.tile_width, pixel / params.tile_width);
    float chosen_depth = depth_of_chance(sample_1d(place_in_image, sample_index, params.seed, dimension));
#endif
    march.state = max(march.state, 1u);
#ifndef SHADOWS
    uint medium = paths[at].media_count > 0u ? medium_without(Media(at, paths[at].media_count), NONE) : NONE;
#endif
    vec2 way = way_through(ray, path, end);
    float span = way.y - way.x;
    uint steps = uint(min(max(-floor(-(span / params.step)), 0.0), MOST_SAMPLES));
    uint places = steps > 0u ? steps + 1u : 0u;
    uint work_left = params.work;

    // Drivers without real branches run what is under an if for every ray: loops of one turn or none are passed over.
    bool alone = !scene_has(SCENE_MANY_VOLUMES);
    VolumeInfo volume = volumes[march.volume];
    bool steep = scene_has(SCENE_STEEP);
    uint part = steep ? bitfieldExtract(march.place, PLACE_BITS, PART_BITS) : 0u; // 0: the whole step
    bool divided = steep && bitfieldExtract(march.place, 31, 1) != 0u;
    march.place = steep ? bitfieldExtract(march.place, 0, PLACE_BITS) : march.place;
    uint slots = steep ? 2u : 1u;
    uint end_at = (at * params.volume_count + march.volume) * slots;
#ifdef LIT
    vec4 before = ends[end_at]; // and the light there
    vec4 ahead = ends[end_at + (slots - 1u)]; // at the end of the whole step
#else
    float before = ends[end_at];
    float ahead = ends[end_at + (slots - 1u)];
#endif
    while (march.place < places && work_left > 0u) {
        Sample at_place = sample_of(ray, way, end, march.place, part, steps);
        bool fresh = alone && part == 0u && march.row == 0u && march.cursor == 0u;
        while (fresh && march.place < places && work_left > 0u && look_at(volume, at_place) == LOOK_NOWHERE) {
            ++march.place;
            --work_left;
#ifdef LIT
            before.x = UNSEEN;
            ahead.x = UNSEEN;
#else
            before = UNSEEN;
            ahead = UNSEEN;
#endif
            at_place = sample_of(ray, way, end, march.place, part, steps);
        }
        bool counts = march.place < places && takes_part(volume, path);
        uint look = counts ? look_at(volume, at_place) : LOOK_NOWHERE;
        vec3 x = at_place.x;
        float reach = sqrt(volume.square_radius);
        uvec3 low, high;
        cells_around(volume.grid, x, reach, low, high);
        bool is_known = part == MARCH_PARTS; // by the whole step
        uint rows = look == LOOK_AROUND && !is_known ? (high.y - low.y + 1u) * (high.z - low.z + 1u) : 0u;
        bool particles = scene_has(SCENE_PARTICLES) && (!scene_has(SCENE_WEIGHTS) || volume.kernel == VOLUME_SPH);

        while (march.row < rows && work_left > 0u) {
            uvec2 range = row_points(volume, low, high, march.row, x, reach);
            uint first = range.x + march.cursor;
            uint count = min(range.y - first, AT_ONCE);
            uint end = first + count;
            if (scene_has(SCENE_WEIGHTS)) {
                for (uint i = particles ? end : first; i < end; i += 4u) {
                    FourPoints four = four_points(i, end, x);
                    vec4 weights = gaussians(volume, four);
                    vec4 weighted = weights * four.scalars;
                    march.numerator = add_up(march.numerator, weighted);
                    march.denominator = add_up(march.denominator, weights);
#ifdef LIT
                    sums.pull = add_up(sums.pull, weighted, four);
                    sums.weights_pull = add_up(sums.weights_pull, weights, four);
                    sums.visible = visible_sum(sums.visible, weights, four);
#endif
                }
            }
            if (scene_has(SCENE_PARTICLES)) {
                for (uint i = particles ? first : end; i < end; i += 4u) {
                    FourPoints four = four_points(i, end, x);
                    vec4 inverse_lengths = inverse_lengths_of(four);
                    vec4 weights = splines(four, inverse_lengths);
                    march.numerator = add_up(march.numerator, weights * four.scalars);
                    march.denominator = add_up(march.denominator, weights);
#ifdef LIT
                    vec4 pulls = spline_pulls(sqrt(four.squares) * inverse_lengths, inverse_lengths);
                    sums.pull = add_up(sums.pull, mix(vec4(0.0), pulls * four.scalars, four.are_there), four);
                    sums.visible = visible_sum(sums.visible, weights, four);
#endif
                }
            }
            bool row_ends = first + count >= range.y;
            march.cursor = row_ends ? 0u : march.cursor + count;
            march.row += row_ends ? 1u : 0u;
            work_left -= min(work_left, count + 2u);
        }
        work_left -= min(work_left, 2u);

        if (march.row >= rows && march.place < places) { // all but those whose work ran out
            bool reached = march.denominator > 0.0;
            float divisor = volume.kernel == VOLUME_SHEPARD && reached ? march.denominator : 1.0;
            float scalar = min(max(march.numerator / divisor, -LARGEST), LARGEST);
            float here = look == LOOK_NOWHERE ? UNSEEN : (reached ? scalar : UNREACHED);
#ifdef LIT
            here = is_known ? ahead.x : here;
            vec4 start = steep && part == 0u ? ahead : before;
            float there = march.place > 0u ? start.x : UNSEEN;
            vec3 light = is_known ? ahead.yzw : vec3(1.0);
            uint lit = reached && volume.shading != VOLUME_EMITS ? 1u : 0u;
            for (uint i = 0u; i < lit; ++i) {
                light = scattered(volume, march.numerator, march.denominator, sums, at_place.x, ray.direction);
            }
            sums = MarchLight(vec3(0.0), 0u, vec3(0.0), 0u, vec4(0.0));
            vec3 light_there = start.yzw;
            ahead = part == 0u ? vec4(here, light) : ahead;
            before = steep && part == 0u ? vec4(there, light_there) : vec4(here, light);
#else
            here = is_known ? ahead : here;
            float there = march.place > 0u ? (steep && part == 0u ? ahead : before) : UNSEEN;
            ahead = part == 0u ? here : ahead;
            before = steep && part == 0u ? there : here;
#endif
            // A step with one end in reach is so for half of its way. At the border of particles a sum is 0.
            bool is_here = is_scalar(here), is_there = is_scalar(there);
            bool both = is_here && is_there;
            bool shows = (is_here || is_there) && here != UNSEEN && there != UNSEEN;
            float share = both ? 1.0 : 0.5;
            float border = particles ? 0.0 : (is_here ? here : there);
            float from = is_there ? there : border, to = is_here ? here : border;

            bool emission = volume.mode == VOLUME_EMISSION;
            uint wholes = scene_has(SCENE_WHOLES) && is_whole(volume) ? 1u : 0u;
            while (wholes > 0u) {
                --wholes;
                float counted = shows ? share * at_place.length_of_step : 0.0;
                bool greater = is_here && (!(march.color.z > 0.0) || here > march.color.x);
                bool most = volume.mode == VOLUME_MAXIMUM;
                float greatest = greater ? here : march.color.x;
                float term = shows ? counted * (0.5 * (from + to)) : 0.0;
                float integral = add_to(march.color.x, most ? 0.0 : term, march.color_lost.x);
                march.color.x = most ? greatest : integral;
                march.color.z = is_here ? 1.0 : march.color.z;
                march.color.y = add_to(march.color.y, counted, march.color_lost.y);
            }
            bool counts_here = emission && shows;
            Shown seen = mean_of(volume, counts_here ? from : 0.0, counts_here ? to : 0.0);
            uint may_divide = steep && part == 0u && counts_here && !divided ? 1u : 0u;
            while (may_divide > 0u) {
                --may_divide;
                bool seen_at_border = !both && (seen.scattering.w > 0.0 || any(greaterThan(seen.emission, vec3(0.0))));
                divided = seen_at_border || is_divided(volume, from, to, at_place.x);
            }
#ifdef LIT
            vec3 mean_light = both ? 0.5 * (light_there + light) : (is_here ? light : light_there);
            seen.scattering.xyz *= mean_light;
#endif
#ifdef SCATTERED
            bool scatters = counts_here && volume.shading != VOLUME_EMITS;
            vec3 others_scattering = alone ? vec3(0.0) : scatter.step_color;
            float others_scatter = alone ? 0.0 : scatter.step_extinction;
            float own_scatter = share * seen.scattering.w;
            bool is_most = scatters && (alone || own_scatter > scatter.most);
            scatter.slot = is_most ? volume.refracts : scatter.slot;
            scatter.most = is_most ? own_scatter : scatter.most;
            scatter.step_color = scatters ? others_scattering + share * seen.scattering.xyz : others_scattering;
            scatter.step_extinction = scatters ? others_scatter + own_scatter : others_scatter;
            seen.scattering = scatters ? vec4(0.0) : seen.scattering;
#endif
            vec3 others_color = alone ? vec3(0.0) : march.step_color;
            float others_extinction = alone ? 0.0 : march.step_extinction;
            vec3 color_now = others_color + share * (seen.scattering.xyz + seen.emission);
            float extinction_now = others_extinction + share * seen.scattering.w;
            vec3 step_color = counts_here ? color_now : others_color;
            float step_extinction = counts_here ? extinction_now : others_extinction;
            march.numerator = 0.0;
            march.denominator = 0.0;
            march.row = 0u;
            bool last = alone || march.volume + 1u >= params.volume_count;
            bool closer = last && divided && part == 0u; // the step begins anew, in parts
            bool ends_step = last && !closer;
            float length_of_step = at_place.length_of_step;
            bool ends_here = false; // a volume scatters the ray within this step
#ifdef SCATTERED
            float scatter_depth = scatter.step_extinction * length_of_step;
            float short_of = chosen_depth - scatter.depth;
            ends_here = ends_step && scatter_depth > 0.0 && scatter_depth >= short_of;
            float reached_part = max(short_of, 0.0) / (scatter_depth > 0.0 ? scatter_depth : 1.0);
            length_of_step = ends_here ? length_of_step * reached_part : length_of_step;
            float scatter_lost = scatter.lost;
            float scatter_sum = add_to(scatter.depth, scatter_depth, scatter_lost);
            bool adds_scatter = ends_step && scatter_depth > 0.0;
            scatter.depth = adds_scatter ? scatter_sum : scatter.depth;
            scatter.lost = adds_scatter ? scatter_lost : scatter.lost;
            if (ends_here) {
                float t = at_place.begin + length_of_step;
                hits[at].t = t;
                hits[at].position = ray.origin + t * ray.direction;
                hits[at].normal = min(scatter.step_color / scatter.step_extinction, vec3(1.0));
                hits[at].status = 0u;
                ray.hit_slot = scatter.slot;
                ray.hit_t = t;
                store_ray(at, ray);
            }
            scatter.step_color = last ? vec3(0.0) : scatter.step_color;
            scatter.step_extinction = last ? 0.0 : scatter.step_extinction;
            scatter.most = last ? 0.0 : scatter.most;
#endif
            float step_depth = step_extinction * length_of_step;
            bool emits = ends_step && (step_depth > 0.0 || any(greaterThan(step_color, vec3(0.0))));
            float through = exp_negative(-march.depth);
            vec3 lengths = vec3(length_of_step * mean_transmittance(step_depth)); // that a step shows
#ifndef SHADOWS
            uint absorbs = scene_has(SCENE_ABSORBS) && emits && medium != NONE ? 1u : 0u;
            while (absorbs > 0u) {
                --absorbs;
                vec3 both_depths = vec3(step_depth) + object_at(medium).absorption * length_of_step;
                lengths.x = length_of_step * mean_transmittance(both_depths.x);
                lengths.y = length_of_step * mean_transmittance(both_depths.y);
                lengths.z = length_of_step * mean_transmittance(both_depths.z);
                lengths *= transmittance(medium, at_place.begin);
            }
            bool again = scene_has(SCENE_DEPTHS) && march.state == 3u;
            vec3 sent = through * (lengths * step_color);
            bool sends = emits && !again;
            vec3 color_lost = march.color_lost;
            vec3 color = add_to(march.color, sent, color_lost);
            march.color = sends ? color : march.color;
            march.color_lost = sends ? color_lost : march.color_lost;
            // Where the light is lost that is looked for: a place within this step.
            float missing = -march.along - march.depth;
            bool found = again && ends_step && step_depth > 0.0 && step_depth >= missing;
            float t = at_place.begin + at_place.length_of_step * (max(missing, 0.0) / (step_depth > 0.0 ? step_depth : 1.0));
            march.along = found ? t * dot3(ray.direction, params.forward) : march.along;
#else
            bool found = false;
#endif
            bool adds = ends_step && step_depth > 0.0;
            float depth_lost = march.depth_lost;
            float depth = add_to(march.depth, step_depth, depth_lost);
            march.depth = adds ? depth : march.depth;
            march.depth_lost = adds ? depth_lost : march.depth_lost;
            march.step_color = last ? vec3(0.0) : step_color;
            march.step_extinction = last ? 0.0 : step_extinction;
            march.volume = last ? 0u : march.volume + 1u;
            bool dark = march.depth > DEEPEST;
            march.depth = dark ? OPAQUE : march.depth;
            bool over = ends_step && (dark || found || ends_here);
            uint next_part = (closer || part > 0u) && !over && !is_known ? part + 1u : 0u;
            march.place = over ? places : (ends_step && next_part == 0u ? march.place + 1u : march.place);
            part = last ? next_part : part;
            divided = divided && !last;
        }
        uint other = alone ? 0u : 1u;
        while (other > 0u) {
            --other;
            uint next_at = (at * params.volume_count + march.volume) * slots;
            ends[end_at] = before;
            if (steep) ends[end_at + 1u] = ahead;
            end_at = next_at;
            before = ends[end_at];
            ahead = ends[end_at + (slots - 1u)];
            volume = volumes[march.volume];
        }
    }
    ends[end_at] = before;
    if (steep) ends[end_at + 1u] = ahead;
    bool done = march.place >= places;
    bool whole = is_whole(volumes[0]);
    bool again = march.state == 3u;
    if (done && !again) {
        march = whole ? shown(volumes[0], march) : march;
        finish(at, path, march);
#ifndef SHADOWS
        again = params.wants_depth != 0u && !whole;
        march.along = again ? -depth_of_absorptance(0.5 * absorptance(march.depth)) : march.along;
        again = again && march.along < 0.0;
        march.along = params.wants_depth != 0u && !whole && !again ? -1.0 : march.along;
        march.place = again ? 0u : march.place;
        march.depth = again ? 0.0 : march.depth;
        march.depth_lost = again ? 0.0 : march.depth_lost;
        done = !again;
#endif
    }
    march.state = done ? 2u : (again ? 3u : 1u);
    uint above = part | (divided ? 1u : 0u) << PART_BITS;
    march.place = steep ? bitfieldInsert(march.place, above, PLACE_BITS, PART_BITS + 1) : march.place;
    marches[at] = march;
#ifdef LIT
    march_lights[at] = sums;
#endif
#ifdef SCATTERED
    march_scatters[at] = scatter;
#endif
    if (!done) atomicAdd(live, 1u);
}
