// steps: where a ray goes through volumes, in steps, and what is to be done at their ends.
//
// twin    crates/reference/src/march.rs
// Whoever includes this has push constants `params` of a march, and buffers `paths` and, with LIT, the light of points.
#ifndef STEPS_GLSL
#define STEPS_GLSL
#include "strides.glsl"

bool is_inside(uint path, uint object) {
    bool found = false;
    for (uint i = 0u; i < paths[path].media_count; ++i) {
        found = found || member_in(paths[path].media[i / 2u], i) == object;
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

// An end of a step, and the step before it.
struct Sample {
    vec3 x;
    float length_of_step;
    float begin; // of the step, along the ray
    float whole; // where the whole step begins
    bool outside; // at the border of the volumes' boxes, where no point is in reach
};

Sample sample_of(Ray ray, vec2 way, float end, uint place, uint part, uint steps, Stride stride) {
    uint from = max(place, 1u) - 1u;
    float longest = params.step;
    if (scene_has(SCENE_SIZES)) {
        from = (from >> stride.before) << stride.before;
        longest = params.step * float(1u << stride.before);
    }
    float whole = float(from) * params.step, begin = whole;
    float length_of_step = place > 0u ? min(longest, (way.y - way.x) - whole) : 0.0;
    length_of_step *= part > 0u ? 1.0 / float(MARCH_PARTS) : 1.0;
    begin += part > 0u ? float(part - 1u) * length_of_step : 0.0;
    vec3 x = ray.origin + (way.x + (begin + length_of_step)) * ray.direction;
    bool outside = (place == 0u && way.x > 0.0) || (place == steps && part == 0u && way.y < end);
    return Sample(x, length_of_step, way.x + begin, way.x + whole, outside);
}

#define LOOK_NOWHERE 0u // nothing is seen from the cell
#define LOOK_OUTSIDE 1u // no point is in reach
#define LOOK_AROUND 2u

// What is to be done at a place, where volumes have one grid.
uint look_at(VolumeInfo volume, Sample at) {
    vec3 cells_off = (at.x - volume.grid.origin) * volume.grid.inverse_edge;
    bool inside = all(greaterThanEqual(cells_off, vec3(0.0))) && all(lessThan(cells_off, vec3(volume.grid.resolution)));
    bool seen = volume_cell_at(volume.first_cell + cell_id(volume.grid, cell_of(volume.grid, at.x))).counts != 0u;
    return !inside || at.outside ? LOOK_OUTSIDE : (seen ? LOOK_AROUND : LOOK_NOWHERE);
}

// Where a stretch of steps begins: their length, the longest that all volumes allow and of which a stretch may begin at that
// place, and whether this volume is seen from them. `which` it is among the volumes: the first sets the length.
void settle(VolumeInfo volume, uint which, Sample at, uint place, uint path, inout Stride stride, inout bool seen) {
    Look look = look_by_size(volume, at.x, stride.before);
    seen = look.kind != CELL_NOTHING;
    uint longest = scene_has(SCENE_MANY_VOLUMES) ? 31u : look.level;
    uint count = scene_has(SCENE_MANY_VOLUMES) && which == 0u ? params.volume_count : 0u;
    for (uint i = 0u; i < count; ++i) {
        VolumeInfo other = volumes[i];
        uint own = look_by_size(other, at.x, 0u).level;
        longest = min(longest, takes_part(other, path) ? own : longest);
    }
    stride.level = which == 0u ? min(longest, longest_at(place)) : stride.level;
}

#define OPAQUE NO_HIT // the optical depth from 69 on
#define DEEPEST 69.0775528 // optical depth through which nothing is seen, a transmittance of 1e-30

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
    Shown seen = mean_of(volume, pivots_of(volume), scalar, scalar);
    float depth = seen.scattering.w * thickness;
    vec3 color = (thickness * mean_transmittance(depth)) * (seen.scattering.xyz + seen.emission);
    march.depth = reached ? (depth > DEEPEST ? OPAQUE : depth) : 0.0;
    march.color = reached ? color : vec3(0.0);
    march.along = scalar;
    return march;
}
#endif
