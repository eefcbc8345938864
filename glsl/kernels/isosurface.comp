// isosurface: where rays first meet a surface on which the scalar of a volume is one number, before the
// surface of points that they met.
//
// reads   the ray state, volumes, their cells, points and lengths
//         paths            whether a ray is inside glass
// writes  searches         where each ray goes on in the next pass
//         blocks           by ray, the scalars at a few places, or what they are made of so far
//         hits, the ray state    of rays that met one: the hit, and the slot that stands for it
//         live             how many rays are not done
// runs    one invocation per ray of the wave; dispatched until none lives
// twin    crates/reference/src/isosurface.rs
//
// With SHADOWS, rays towards a light, which any isosurface blocks. With PASSING, rays towards a light that goes straight on
// through glass: instead of `hits`, the normal at the nearest isosurface is written, as the throughput of the shadow ray's
// path, which is 0 where there is none.
//
// The scalar is taken at the midpoints of steps and at the end of the way, a block of places at a time (block.glsl). Where it
// passes the number between two samples, a few turns close in on the place, each with a block of places between
// (iso_search.glsl), and the scalar's gradient there is the normal. A pass can end after any few runs of points.
#version 460
#extension GL_GOOGLE_include_directive : require
#define STATE_READS
#define STATE_WRITES
#include "stages/points.glsl"
#include "stages/rays.glsl"
#include "stages/wave.glsl"
#include "stages/volume.glsl"
#include "math.glsl"
#include "members.glsl"
#include "volume.glsl"
#include "strides.glsl"
#include "state.glsl"
#include "index.glsl"

layout(local_size_x = LINE_GROUP) in;
layout(std430, binding = LIVE) buffer Live { uint live; };
layout(std430, binding = PATHS) buffer Paths { Path paths[]; };
layout(std430, binding = ISO_SEARCHES) buffer Searches { IsoSearch searches[]; };
layout(std430, binding = VOLUME_BLOCKS) buffer Blocks { VolumeBlock blocks[]; };
#if defined(SHADOWS) || defined(PASSING)
layout(std430, binding = LIGHT_SUMS) readonly buffer LightSums { LightSum light_sums[]; };
#else
layout(std430, binding = HITS) buffer Hits { Hit hits[]; };
#endif
layout(push_constant) uniform Push { MarchParams params; };

#include "iso_search.glsl"

#define MOST_SAMPLES 16777215.0 // floats count little farther
#define NEW 0u // states
#define STEPPING 1u
#define CLOSING_IN 2u
#define TURNING 3u // towards the viewer, at the place
#define DONE 4u
#define SEARCH_BITS 3 // of states, in IsoSearch::state; above them the stride and what its cell says

bool is_inside(uint path, uint object) {
    bool found = false;
    for (uint i = 0u; i < paths[path].media_count; ++i) {
        found = found || member_in(paths[path].media[i / 2u], i) == object;
    }
    return found;
}

// What may be seen from x.
uint seen_from(VolumeInfo volume, vec3 x) {
    vec3 cells_off = (x - volume.grid.origin) * volume.grid.inverse_edge;
    bool inside = all(greaterThanEqual(cells_off, vec3(0.0))) && all(lessThan(cells_off, vec3(volume.grid.resolution)));
    return inside ? volume_cell_at(volume.first_cell + cell_id(volume.grid, cell_of(volume.grid, x))).counts : CELL_NOTHING;
}

// The side of a place that need not be looked at, unless it tells where the surface is: where there are no
// points a sum is 0, a mean is none.
uint side_of(VolumeInfo volume, uint seen) {
    uint nothing = volume.kernel == VOLUME_SHEPARD ? UNKNOWN : BELOW;
    return seen == CELL_ABOVE ? ABOVE : (seen == CELL_BELOW ? BELOW : nothing);
}

float sample_at(vec2 way, uint place, uint level) {
    float half_step = scene_has(SCENE_SIZES) ? 0.5 * float(1u << level) : 0.5;
    return min(way.x + (float(place) + half_step) * params.step, way.y);
}

// Whether a sample is that at the end of the way, the last.
bool is_last(vec2 way, uint place, uint level, uint samples) {
    return scene_has(SCENE_SIZES) ? sample_at(way, place, level) >= way.y : place + 1u >= samples;
}

IsoSearch without_sums(IsoSearch search) {
    search.pull = vec3(0.0);
    search.weights_pull = vec3(0.0);
    search.numerator = 0.0;
    search.denominator = 0.0;
    search.row = 0u;
    search.cursor = 0u;
    return search;
}

void main() {
    uint at = list_index();
    if (at >= params.ray_count) return;
    IsoSearch search = searches[at];
    Stride stride = Stride(bitfieldExtract(search.state, SEARCH_BITS, LEVEL_BITS),
                           bitfieldExtract(search.state, SEARCH_BITS + LEVEL_BITS, LEVEL_BITS));
    uint kind = bitfieldExtract(search.state, SEARCH_BITS + 2 * LEVEL_BITS, 2); // of a stretch of steps
    search.state = bitfieldExtract(search.state, 0, SEARCH_BITS);
    if (search.state == DONE) return;
    Ray ray = load_ray(at);
#ifdef SHADOWS
    bool begins = ray.hit_slot == NONE && any(greaterThan(light_sums[at].arriving, vec3(0.0)));
#elif defined(PASSING)
    bool begins = paths[at].bounces == 0u && any(greaterThan(light_sums[at].arriving, vec3(0.0)));
#else
    bool begins = paths[at].pixel != NONE;
#endif
    if (!begins) return;
    vec3 o = ray.origin, d = ray.direction;
#if defined(SHADOWS) || defined(PASSING)
    float end = ray.hit_t;
#else
    float end = ray.hit_slot != NONE ? hits[at].t : NO_HIT;
#endif
    bool blocked = false;
    uint work_left = params.work;

    while (search.volume < params.volume_count && work_left > 0u) {
        VolumeInfo volume = volumes[search.volume];
        vec2 way = within_box(volume.grid.origin, volume.high, o, d);
        way.y = min(way.y, end);
        bool counts = volume.mode == VOLUME_ISOSURFACE && way.x < way.y;
        float steps = max(-floor(0.5 - (way.y - way.x) / params.step), 0.0);
        uint samples = counts ? uint(min(steps, MOST_SAMPLES)) + 1u : 0u;
        if (search.state == NEW) {
            bool inside = volume.refracts != 0u && is_inside(at, volume.object);
#ifdef SHADOWS
            search.side = UNKNOWN;
#else
            search.side = volume.refracts != 0u ? (inside ? ABOVE : BELOW) : UNKNOWN;
#endif
            search.low = way.x;
            search.value_low = 0.0;
            search.place = 0u;
            search.looked = LOOKED;
            search.state = STEPPING;
            stride = Stride(0u, 0u);
        }
        // Samples whose side is known, and is that of the one before or none, cost a look.
        bool skips = search.state == STEPPING && search.row == 0u && search.cursor == 0u && search.looked != TO_LOOK;
        while (skips && search.place < samples && work_left > 0u) {
            if (scene_has(SCENE_SIZES)) {
                uint settles = begins_stretch(stride, search.place) ? 1u : 0u;
                while (settles > 0u) {
                    --settles;
                    vec3 begin = o + (way.x + float(search.place) * params.step) * d;
                    Look look = look_by_size(volume, begin, 0u);
                    kind = look.kind;
                    stride.level = min(look.level, longest_at(search.place));
                    work_left -= min(work_left, grids_of(volume));
                }
            }
            float t = sample_at(way, search.place, stride.level);
            uint seen = scene_has(SCENE_SIZES) ? kind : seen_from(volume, o + t * d);
            uint side = side_of(volume, seen);
            bool same = side == search.side || side == UNKNOWN || search.side == UNKNOWN;
            skips = seen != CELL_LOOK && same;
            search.side = skips ? side : search.side;
            search.low = skips ? t : search.low;
            search.looked = skips ? SKIPPED : search.looked;
            bool ends = is_last(way, search.place, stride.level, samples);
            stride.before = skips ? stride.level : stride.before;
            search.place = skips ? (ends ? samples : search.place + (1u << stride.level)) : search.place;
            work_left -= min(work_left, 1u);
        }
        bool stepping = search.state == STEPPING;
        bool sampling = !stepping || search.place < samples;
        bool turning = search.state == TURNING;
        // The end of the way is a block by itself.
        uint level = stepping ? stride.level : 0u;
        bool single = stepping && is_last(way, search.place, level, samples);
        uint first = single ? search.place : (stepping ? (search.place >> level & ~(volume.block - 1u)) << level : 0u);
        uint from = stepping ? (search.place - first) >> level : 0u;
        // The sample before is in the block, and not looked at: it is, since the surface may be after it.
        bool goes_back = stepping && sampling && !skips && search.looked == SKIPPED && from > 0u;
        from -= goes_back ? 1u : 0u;
        search.looked = goes_back ? TO_LOOK : search.looked;
        search.side = goes_back ? UNKNOWN : search.side;
        // Of the block, the samples up to the first that may be passed over are asked for.
        uint last = single ? 0u : volume.block - 1u;
        bool shortens = stepping && sampling && !skips;
        while (shortens && last > from) {
            shortens = is_last(way, first + (last << level), level, samples);
            last -= shortens ? 1u : 0u;
        }
        uint until = stepping ? from + 1u : last;
        bool more = stepping && sampling && !skips;
        while (more && until < last) {
            vec3 x = o + sample_at(way, first + (until << level), level) * d;
            more = scene_has(SCENE_SIZES) || seen_from(volume, x) == CELL_LOOK;
            until += more ? 1u : 0u;
        }
        last = min(until, last);
        float apart = scene_has(SCENE_SIZES) ? params.step * float(1u << level) : params.step;
        vec2 places = stepping ? vec2(sample_at(way, first, level), apart) : places_of_turn(search, volume.block);
        Block block = Block(o + places.x * d, d, places.y, float(from) * places.y, float(last) * places.y, level);
        bool weighed = weigh_block(volume, block, at, sampling && !turning && !skips, search, work_left);
        bool turned = weigh_pulls(volume, o + search.here * d, turning, search, work_left);
        work_left -= min(work_left, 24u); // turns of loops

        uint walks = weighed ? 1u : 0u;
        while (walks > 0u) {
            --walks;
            bool crosses = false;
            uint place = from;
            while (place <= last && !crosses) {
                float t = stepping ? sample_at(way, first + (place << level), level) : places.x + float(place) * places.y;
                float value = blocks[at].scalars[place];
                uint side = side_of_value(value);
                crosses = side != UNKNOWN && search.side != UNKNOWN && side != search.side;
                search.high = crosses ? t : search.high;
                search.value_high = crosses ? value : search.value_high;
                search.low = crosses ? search.low : t;
                search.value_low = crosses ? search.value_low : value;
                search.side = crosses || (side == UNKNOWN && !stepping) ? search.side : side;
                place += crosses ? 0u : 1u;
            }
            bool returns = stepping && crosses && place == from && search.looked == SKIPPED;
            bool found = stepping && crosses && !returns;
            bool narrow = search.looked == NARROW;
            uint turns = search.place + 1u;
            bool ends = !stepping && (turns >= (volume.block < BLOCK_PLACES ? TURNS_OF_FEW : TURNS) || (narrow && crosses && place > 0u));
            bool known = search.value_low * search.value_high < 0.0;
            search.looked = stepping ? (returns ? TO_LOOK : (found ? WIDE : LOOKED)) : (narrow || !known ? WIDE : NARROW);
            search.side = returns ? UNKNOWN : search.side;
            uint back = first + (from << level) - (1u << stride.before);
            uint next_place = single ? samples : first + (place << level);
            search.place = stepping ? (returns ? back : (found ? 0u : next_place)) : turns;
            stride.level = returns ? stride.before : stride.level;
            stride.before = stepping && !returns ? stride.level : stride.before;
            search.state = found ? CLOSING_IN : (ends ? TURNING : search.state);
            search.here = between(search);
#ifdef SHADOWS
            blocked = blocked || found;
            search.volume = found ? params.volume_count : search.volume;
#endif
        }
        uint turns = turned ? 1u : 0u;
        while (turns > 0u) {
            --turns;
#ifndef SHADOWS
            float t = search.here;
            bool mean = volume.kernel == VOLUME_SHEPARD && search.denominator > 0.0;
            float scalar = search.numerator / (mean ? search.denominator : 1.0);
            vec3 gradient = gradient_of(volume, scalar, search.pull, search.weights_pull);
            float square = dot3(gradient, gradient);
            bool steep = square > 0.0;
            vec3 normal = steep ? gradient / (steep ? sqrt(square) : 1.0) : d;
            normal = dot3(normal, d) > 0.0 ? -normal : normal;
#ifdef PASSING
            paths[at].throughput = normal;
#else
            hits[at] = Hit(o + t * d, t, normal, HIT_ACCEPTED);
#endif
            ray.hit_t = t;
            ray.hit_slot = volume.slot;
            end = t;
            store_ray(at, ray);
#endif
            search = without_sums(search);
        }
        bool over = turned || !sampling;
        search.volume += over ? 1u : 0u;
        search.state = over ? NEW : search.state;
    }
#ifdef SHADOWS
    if (blocked) {
        ray.hit_slot = volumes[0].slot; // any will do
        store_ray(at, ray);
    }
#endif
    bool done = search.volume >= params.volume_count;
    search.state = done ? DONE : search.state;
    search.state |= stride.level << SEARCH_BITS | stride.before << (SEARCH_BITS + LEVEL_BITS) |
                    kind << (SEARCH_BITS + 2 * LEVEL_BITS);
    searches[at] = search;
    if (!done) atomicAdd(live, 1u);
}
