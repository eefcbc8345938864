// isosurface: where rays first meet a surface on which the scalar of a volume is one number, before the
// surface of points that they met.
//
// reads   the ray state, volumes, their cells, points and lengths
//         paths            whether a ray is inside glass
// writes  searches         where each ray goes on in the next pass
//         hits, the ray state    of rays that met one: the hit, and the slot that stands for it
//         live             how many rays are not done
// runs    one invocation per ray of the wave; dispatched until none lives
// twin    crates/reference/src/isosurface.rs
//
// With SHADOWS, rays towards a light, which any isosurface blocks. With PASSING, rays towards a light that goes straight on
// through glass: instead of `hits`, the normal at the nearest isosurface is written, as the throughput of the shadow ray's
// path, which is 0 where there is none.
//
// The scalar is taken at the midpoints of steps and at the end of the way. Where it passes the number
// between two samples, a few turns of regula falsi (Illinois) close in on the place, and the scalar's
// gradient there is the normal. A pass can end after any row of cells or any 64 points of one.
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
#if defined(SHADOWS) || defined(PASSING)
layout(std430, binding = LIGHT_SUMS) readonly buffer LightSums { LightSum light_sums[]; };
#else
layout(std430, binding = HITS) buffer Hits { Hit hits[]; };
#endif
layout(push_constant) uniform Push { MarchParams params; };

#define AT_ONCE 64u // points of a row
#define MOST_SAMPLES 16777215.0 // floats count little farther
#define TURNS 8u
#define ON_IT -1e-20 // the value of a place on the surface: 0 is not known
#define SKIPPED 0u // looked
#define LOOKED 1u
#define TO_LOOK 2u
#define MOVED_LOW 3u // the end that was moved by the last turn
#define MOVED_HIGH 4u
#define UNKNOWN 0u // sides
#define BELOW 1u
#define ABOVE 2u
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

// The sample after one of a step of a level, at t; the one at the end of the way is the last.
uint sample_after(vec2 way, float t, uint place, uint level, uint samples) {
    if (!scene_has(SCENE_SIZES)) return place + 1u;
    return t >= way.y ? samples : place + (1u << level);
}

// Between two places on either side: on the line between their values, or in the middle.
float between(IsoSearch search) {
    float span = search.value_low - search.value_high;
    bool apart = search.value_low * search.value_high < 0.0;
    float part = apart ? search.value_low / (apart ? span : 1.0) : 0.5;
    return search.low + part * (search.high - search.low);
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
            stride.before = skips ? stride.level : stride.before;
            search.place = skips ? sample_after(way, t, search.place, stride.level, samples) : search.place;
            work_left -= min(work_left, 1u);
        }
        bool stepping = search.state == STEPPING;
        bool sampling = !stepping || search.place < samples;
        bool turning = search.state == TURNING;
        float t = stepping ? sample_at(way, search.place, stride.level) : search.here;
        vec3 x = o + t * d;
        uint grids = sampling ? grids_of(volume, stepping ? stride.level : 0u) : 0u;
        bool particles = volume.kernel == VOLUME_SPH;
        uint size = search.row >> SIZE_BITS, row = bitfieldExtract(search.row, 0, SIZE_BITS);

        while (size < grids && work_left > 0u) {
            VolumeInfo grid = grid_of(volume, size);
            float reach = sqrt(grid.square_radius);
            uvec3 low, high;
            cells_around(grid.grid, x, reach, low, high);
            uint rows = (high.y - low.y + 1u) * (high.z - low.z + 1u);
            while (row < rows && work_left > 0u) {
                uvec2 range = row_points(grid, low, high, row, x, reach);
                uint first = range.x + search.cursor;
                uint count = min(range.y - first, AT_ONCE);
                uint end_of_turn = first + count;
                for (uint i = particles ? end_of_turn : first; i < end_of_turn; i += 4u) {
                    FourPoints four = four_points(i, end_of_turn, x);
                    vec4 weights = gaussians(volume, four, inverse_squares_of(volume, four));
                    search.numerator = add_up(search.numerator, weights * four.scalars);
                    search.denominator = add_up(search.denominator, weights);
                }
                for (uint i = particles ? first : end_of_turn; i < end_of_turn; i += 4u) {
                    FourPoints four = four_points(i, end_of_turn, x);
                    vec4 weights = splines(four, inverse_lengths_of(four));
                    search.numerator = add_up(search.numerator, weights * four.scalars);
                    search.denominator = add_up(search.denominator, weights);
                }
                uint pulls = turning ? count : 0u;
                for (uint i = 0u; i < pulls; ++i) {
                    VolumePoint point = volume_point_at(first + i);
                    vec3 y = point.position - x;
                    float square = dot3(y, y);
                    float inverse_length = particles || scene_has(SCENE_SIZES) ? inverse_length_at(first + i) : 0.0;
                    float limit = volume.square_radius, width = volume.inverse_width, share = 1.0;
                    if (has_own_reaches(volume)) {
                        share = inverse_length * inverse_length;
                        limit = 1.0 / share;
                        width = 2.0 * share;
                    }
                    float gaussian = square <= limit ? exp_negative(-square * width) * share : 0.0;
                    float pull = particles ? spline_pull(sqrt(square) * inverse_length, inverse_length) : gaussian;
                    search.pull += (pull * point.scalar) * y;
                    search.weights_pull += (particles ? 0.0 : pull) * y;
                }
                bool row_ends = first + count >= range.y;
                search.cursor = row_ends ? 0u : search.cursor + count;
                row += row_ends ? 1u : 0u;
                work_left -= min(work_left, count + 2u);
            }
            bool ends = row >= rows;
            size += ends ? 1u : 0u;
            row = ends ? 0u : row;
        }
        search.row = row | size << SIZE_BITS;
        work_left -= min(work_left, 4u);

        if (size >= grids) {
            bool reached = search.denominator > 0.0;
            bool mean = volume.kernel == VOLUME_SHEPARD;
            float scalar = mean && reached ? search.numerator / (reached ? search.denominator : 1.0) : search.numerator;
            float exact = scalar - volume.iso;
            float value = exact == 0.0 ? ON_IT : exact;
            uint side = mean && !reached ? UNKNOWN : (value > 0.0 ? ABOVE : BELOW);
            if (!sampling) {
                ++search.volume;
                search.state = NEW;
            } else if (stepping && search.looked == SKIPPED && side != UNKNOWN && search.side != UNKNOWN && side != search.side) {
                search.looked = TO_LOOK; // at the place before, first
                search.side = UNKNOWN;
                stride.level = stride.before;
                search.place -= 1u << stride.level;
            } else if (stepping) {
                bool crosses = side != UNKNOWN && search.side != UNKNOWN && side != search.side;
                search.looked = LOOKED;
                search.high = t;
                search.value_high = value;
                search.here = between(search);
                search.low = crosses ? search.low : t;
                search.value_low = crosses ? search.value_low : (side == UNKNOWN ? 0.0 : value);
                search.side = crosses ? search.side : side;
                uint next_place = sample_after(way, t, search.place, stride.level, samples);
                stride.before = stride.level;
                search.place = crosses ? 0u : next_place;
                search.state = crosses ? CLOSING_IN : STEPPING;
#ifdef SHADOWS
                blocked = blocked || crosses;
                search.volume = crosses ? params.volume_count : search.volume;
#endif
            } else if (!turning) {
                // Of an end that stays where it is for two turns, half the value counts (Illinois).
                bool before = side == UNKNOWN || side == search.side;
                bool again = search.looked == (before ? MOVED_LOW : MOVED_HIGH);
                float share = again ? 0.5 : 1.0;
                search.low = before ? t : search.low;
                search.high = before ? search.high : t;
                float kept_low = share * search.value_low, kept_high = share * search.value_high;
                search.looked = before ? MOVED_LOW : MOVED_HIGH;
                search.value_low = before ? (side == UNKNOWN ? 0.0 : value) : kept_low;
                search.value_high = before ? kept_high : value;
                ++search.place;
                search.here = between(search);
                search.state = search.place < TURNS ? CLOSING_IN : TURNING;
            } else {
#ifndef SHADOWS
                vec3 gradient = gradient_of(volume, scalar, search.pull, search.weights_pull);
                float square = dot3(gradient, gradient);
                bool steep = square > 0.0;
                vec3 normal = steep ? gradient / (steep ? sqrt(square) : 1.0) : d;
                normal = dot3(normal, d) > 0.0 ? -normal : normal;
#ifdef PASSING
                paths[at].throughput = normal;
#else
                hits[at] = Hit(x, t, normal, HIT_ACCEPTED);
#endif
                ray.hit_t = t;
                ray.hit_slot = volume.slot;
                end = t;
                store_ray(at, ray);
#endif
                ++search.volume;
                search.state = NEW;
            }
            search = without_sums(search);
        }
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
