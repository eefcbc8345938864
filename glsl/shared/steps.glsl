// steps: where a ray goes through volumes, in steps, and what is to be done at their ends.
//
// twin    crates/reference/src/march.rs
// Whoever includes this has push constants `params` of a march, and buffers `paths` and, with LIT, the light of points.
#ifndef STEPS_GLSL
#define STEPS_GLSL

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

#ifdef LIT
// What reaches the points, by their weights.
vec4 visible_sum(vec4 sum, vec4 weights, FourPoints four) {
    return (((sum + weights.x * visible_at(four.at[0])) + weights.y * visible_at(four.at[1]))
        + weights.z * visible_at(four.at[2])) + weights.w * visible_at(four.at[3]);
}
#endif

// An end of a step, and the step before it.
struct Sample {
    vec3 x;
    float length_of_step;
    float begin; // of the step, along the ray
    bool outside; // at the border of the volumes' boxes, where no point is in reach
};

Sample sample_of(Ray ray, vec2 way, float end, uint place, uint part, uint steps) {
    float begin = float(max(place, 1u) - 1u) * params.step;
    float length_of_step = place > 0u ? min(params.step, (way.y - way.x) - begin) : 0.0;
    length_of_step *= part > 0u ? 1.0 / float(MARCH_PARTS) : 1.0;
    begin += part > 0u ? float(part - 1u) * length_of_step : 0.0;
    vec3 x = ray.origin + (way.x + (begin + length_of_step)) * ray.direction;
    bool outside = (place == 0u && way.x > 0.0) || (place == steps && part == 0u && way.y < end);
    return Sample(x, length_of_step, way.x + begin, outside);
}

#define LOOK_NOWHERE 0u // nothing is seen from the cell
#define LOOK_OUTSIDE 1u // no point is in reach
#define LOOK_AROUND 2u

// What is to be done at a place.
uint look_at(VolumeInfo volume, Sample at) {
    vec3 cells_off = (at.x - volume.grid.origin) * volume.grid.inverse_edge;
    bool inside = all(greaterThanEqual(cells_off, vec3(0.0))) && all(lessThan(cells_off, vec3(volume.grid.resolution)));
    bool seen = volume_cell_at(volume.first_cell + cell_id(volume.grid, cell_of(volume.grid, at.x))).counts != 0u;
    return !inside || at.outside ? LOOK_OUTSIDE : (seen ? LOOK_AROUND : LOOK_NOWHERE);
}
#endif
