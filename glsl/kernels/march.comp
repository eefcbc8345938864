// march: rays through volumes, sample after sample, as far as the surface that they met (section 6 of the
// paper).
//
// reads   the ray state, hits      where each ray begins and ends
//         objects          what the medium that a ray is in absorbs
//         volumes, their cells, points, lengths and stops
// writes  march            where each ray goes on in the next pass, and what channels of volumes show
//         blocks           of each volume, the scalars at a few places, or what they are made of so far; not with LIT
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
// a steep piece are divided into parts, once all volumes are known at both ends. Volumes add. Scalars are known a block of
// places at a time (block.glsl); with LIT, each place is weighed by itself (lit_sample.glsl). A pass can end after any few runs
// of points, and its sums go on in the next.
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
#ifndef LIT
layout(std430, binding = VOLUME_BLOCKS) buffer Blocks { VolumeBlock blocks[]; };
#endif
layout(push_constant) uniform Push { MarchParams params; };

#ifdef LIT
#define UNREACHED NO_HIT // the scalar where no point is in reach
#define LARGEST 1e38 // scalar
#endif
#define UNSEEN (-NO_HIT) // the scalar where nothing is seen from the cell, whatever it is
#define MOST_SAMPLES 16777215.0 // floats count little farther, and places have no more bits
#define PLACE_BITS 24 // of March::place
#define PART_BITS 7   // of the part, above them
#ifdef LIT
#define SEEN_OF(end) (end).x
#define PASS_OVER(passes) before.x = (passes) ? UNSEEN : before.x; ahead.x = (passes) ? UNSEEN : ahead.x;
#else
#define SEEN_OF(end) (end)
#define PASS_OVER(passes) before = (passes) ? UNSEEN : before; ahead = (passes) ? UNSEEN : ahead;
#endif

#include "sums.glsl"
#include "steps.glsl"
#ifdef LIT
#include "lit_sample.glsl"
#else
#include "known_block.glsl"
#endif

bool is_scalar(float end) {
    return abs(end) <= LARGEST;
}

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
    Stride stride = stride_of(march.state);
    march.state = bitfieldExtract(march.state, 0, STATE_BITS);
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
    Pivots pivots = pivots_of(volume);
    bool steep = scene_has(SCENE_STEEP);
    uint part = steep ? bitfieldExtract(march.place, PLACE_BITS, PART_BITS) : 0u; // 0: the whole step
    bool divided = steep && bitfieldExtract(march.place, 31, 1) != 0u;
    march.place = steep ? bitfieldExtract(march.place, 0, PLACE_BITS) : march.place;
    uint last_end = steep ? 1u : 0u;
    uint slots = last_end + (scene_has(SCENE_SIZES) ? 2u : 1u); // the last: whether this stretch of steps sees the volume
    uint end_at = (at * params.volume_count + march.volume) * slots;
#ifdef LIT
    vec4 before = ends[end_at]; // and the light there
    vec4 ahead = ends[end_at + last_end]; // at the end of the whole step
#else
    float before = ends[end_at];
    float ahead = ends[end_at + last_end];
#endif
    bool seen = scene_has(SCENE_SIZES) && SEEN_OF(ends[end_at + last_end + 1u]) > 0.0;
#ifdef LIT
    uint known = 0u, known_of = 0u;
#else
    uint block_at = at * params.volume_count + march.volume;
    uint known = blocks[block_at].known, known_of = blocks[block_at].of;
#endif
    while (march.place < places && work_left > 0u) {
        bool goes_on = true; // to the next place, as long as scalars are known
        Sample at_place;
        uint look, number; // of the place among those that blocks count
        while (goes_on && march.place < places && work_left > 0u) {
            at_place = sample_of(ray, way, end, march.place, part, steps, stride);
            number = part > 0u ? part - 1u : march.place;
            uint numbers_of = part > 0u ? march.place + 1u : 0u; // what they count
            bool in_known = number < known && numbers_of == known_of;
            bool fresh = part == 0u && march.row == 0u && march.cursor == 0u;
            if (scene_has(SCENE_SIZES)) {
                uint settles = fresh && !in_known && begins_stretch(stride, march.place) ? 1u : 0u;
                while (settles > 0u) {
                    settle(volume, march.volume, at_place, march.place, path, stride, seen);
                    work_left -= min(work_left, grids_of(volume) + params.volume_count);
                    // All of a stretch from which nothing is seen is passed over at once.
                    bool passes = alone && !seen && march.place < steps;
                    uint next_place = (march.place | ((uint(STRIDE_STEPS) << stride.level) - 1u)) + 1u;
                    march.place = passes ? min(next_place, steps) : march.place;
                    stride.before = passes ? stride.level : stride.before;
                    PASS_OVER(passes)
                    at_place = sample_of(ray, way, end, march.place, part, steps, stride);
                    settles = passes && work_left > 0u && begins_stretch(stride, march.place) ? 1u : 0u;
                }
                number = part > 0u ? number : march.place;
                look = at_place.outside ? LOOK_OUTSIDE : (seen ? LOOK_AROUND : LOOK_NOWHERE);
            } else {
                look = look_at(volume, at_place);
                while (alone && fresh && look == LOOK_NOWHERE && march.place < places && work_left > 0u) {
                    ++march.place;
                    --work_left;
                    PASS_OVER(true)
                    at_place = sample_of(ray, way, end, march.place, part, steps, stride);
                    look = look_at(volume, at_place);
                }
                number = part > 0u ? number : march.place;
            }
            in_known = number < known && numbers_of == known_of;
            look = march.place < places && takes_part(volume, path) ? look : LOOK_NOWHERE;
            bool is_known = part == MARCH_PARTS; // by the whole step
            bool particles = scene_has(SCENE_PARTICLES) && (!scene_has(SCENE_WEIGHTS) || volume.kernel == VOLUME_SPH);
            goes_on = look != LOOK_AROUND || is_known || in_known;
            work_left -= min(work_left, 16u); // turns of loops
            uint composes = goes_on && march.place < places ? 1u : 0u;
            while (composes > 0u) {
                --composes;
                float sampled = UNREACHED;
                uint reads = look == LOOK_AROUND && !is_known ? 1u : 0u;
                while (reads > 0u) {
                    --reads;
#ifdef LIT
                    bool mean = volume.kernel == VOLUME_SHEPARD && march.denominator > 0.0;
                    float scalar = march.numerator / (mean ? march.denominator : 1.0);
                    sampled = march.denominator > 0.0 ? min(max(scalar, -LARGEST), LARGEST) : UNREACHED;
#else
                    bool single = part == 0u && march.place == steps;
                    uint in_block = (part > 0u ? number : number >> stride.level) & (volume.block - 1u);
                    sampled = blocks[block_at].scalars[single ? 0u : in_block];
#endif
                }
                float here = look == LOOK_NOWHERE ? UNSEEN : (look == LOOK_AROUND && !is_known ? sampled : UNREACHED);
#ifdef LIT
                here = is_known ? ahead.x : here;
                vec4 start = steep && part == 0u ? ahead : before;
                float there = march.place > 0u ? start.x : UNSEEN;
                vec3 light = is_known ? ahead.yzw : vec3(1.0);
                uint lit = is_scalar(here) && !is_known && volume.shading != VOLUME_EMITS ? 1u : 0u;
                for (uint i = 0u; i < lit; ++i) {
                    light = scattered(volume, march.numerator, march.denominator, sums, at_place.x, ray.direction);
                }
                sums = MarchLight(vec3(0.0), 0u, vec3(0.0), 0u, vec4(0.0));
                march.numerator = 0.0;
                march.denominator = 0.0;
                march.row = 0u;
                known = 0u;
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
                Shown seen = mean_of(volume, pivots, counts_here ? from : 0.0, counts_here ? to : 0.0);
                uint may_divide = steep && part == 0u && counts_here && !divided ? 1u : 0u;
                while (may_divide > 0u) {
                    --may_divide;
                    bool seen_at_border = !both && (seen.scattering.w > 0.0 || any(greaterThan(seen.emission, vec3(0.0))));
                    divided = seen_at_border || is_divided(volume, pivots, from, to, at_place.x);
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
                bool goes_to_next = ends_step && next_part == 0u;
                uint next_place = place_after(march.place, stride, steps);
                march.place = over ? places : (goes_to_next ? next_place : march.place);
                stride.before = goes_to_next ? stride.level : stride.before;
                part = last ? next_part : part;
                divided = divided && !last;
            }
            uint other = alone ? 0u : 1u;
            while (other > 0u) {
                --other;
                uint next_at = (at * params.volume_count + march.volume) * slots;
                ends[end_at] = before;
                if (steep) ends[end_at + 1u] = ahead;
                if (scene_has(SCENE_SIZES)) SEEN_OF(ends[end_at + last_end + 1u]) = seen ? 1.0 : 0.0;
                end_at = next_at;
                before = ends[end_at];
                ahead = ends[end_at + last_end];
                if (scene_has(SCENE_SIZES)) seen = SEEN_OF(ends[end_at + last_end + 1u]) > 0.0;
                volume = volumes[march.volume];
                pivots = pivots_of(volume);
#ifndef LIT
                blocks[block_at].known = known;
                blocks[block_at].of = known_of;
                block_at = at * params.volume_count + march.volume;
                known = blocks[block_at].known;
                known_of = blocks[block_at].of;
#endif
            }
        }
        uint weighs = goes_on ? 0u : 1u;
        while (weighs > 0u) {
            --weighs;
            uint level_of_step = part > 0u ? stride.before : stride.level;
#ifdef LIT
            bool weighed = weigh_lit(volume, at_place.x, level_of_step, march, sums, work_left);
            uint last = number;
#else
            // The last step is of a length of its own, and a block by itself.
            bool single = part == 0u && march.place == steps;
            uint level = part > 0u ? 0u : stride.level; // parts and places count in numbers of their own
            uint first = single ? number : (number >> level & ~(volume.block - 1u)) << level;
            uint until = part > 0u ? uint(MARCH_PARTS) - 1u : steps;
            uint last = single ? number : min(first + (volume.block << level), until) - 1u;
            float count_by = part > 0u ? at_place.length_of_step : params.step;
            float length_of_step = count_by * float(1u << level);
            float begin = part > 0u ? at_place.whole + float(first + 1u) * length_of_step : way.x + float(first) * count_by;
            begin = single ? at_place.begin + at_place.length_of_step : begin;
            Block block = Block(ray.origin + begin * ray.direction, ray.direction, length_of_step,
                                float(number - first) * count_by, float(last - first) * count_by, level_of_step);
            bool weighed = block_of(volume, block, block_at, march, work_left);
            march.row = weighed ? 0u : march.row;
#endif
            known = weighed ? last + 1u : 0u;
            known_of = part > 0u ? march.place + 1u : 0u;
        }
    }
#ifndef LIT
    blocks[block_at].known = known;
    blocks[block_at].of = known_of;
#endif
    ends[end_at] = before;
    if (steep) ends[end_at + 1u] = ahead;
    if (scene_has(SCENE_SIZES)) SEEN_OF(ends[end_at + last_end + 1u]) = seen ? 1.0 : 0.0;
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
        stride = again ? Stride(0u, 0u) : stride;
#ifndef LIT
        for (uint i = 0u; again && i < params.volume_count; ++i) blocks[at * params.volume_count + i].known = 0u;
#endif
        march.depth = again ? 0.0 : march.depth;
        march.depth_lost = again ? 0.0 : march.depth_lost;
        done = !again;
#endif
    }
    march.state = with_stride(done ? 2u : (again ? 3u : 1u), stride);
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
