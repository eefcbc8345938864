// disc: which pixels a point's trust ball can cover: the paper's viewport-aligned disc, as a rectangle.
//
// twin  crates/reference/src/disc.rs
// Never too small: a ray that `near_trust_ball` lets pass at this ball belongs to a pixel of the
// rectangle, rounding included. Its test errs by a few roundings of the distance to the eye, the
// projection here by as many; DISTANCE_ERROR is 64 of them, as much as all of both together.
#ifndef DISC_GLSL
#define DISC_GLSL
#include "stages/points.glsl"
#include "stages/search.glsl"
#include "stages/discs.glsl"
#include "stages/rays.glsl"
#include "math.glsl"

#define DISC_GROWTH 1.0001     // of the trust radius
#define DISTANCE_ERROR 4e-6    // of the distance from the eye
#define PIXEL_MARGIN 0.03125   // a pixel's place is rounded by less than a hundredth of a pixel
#define STEEPEST 1e6           // a tangent closer to the eye's plane than that bounds nothing
#define UNBOUNDED 1e20

// Screen tiles as a rectangle.
struct TileSpan {
    uvec2 low;    // first screen tile along x and y
    uvec2 extent; // tiles along x and y; 0: the disc covers no pixel
};

uvec2 screen_tiles(uvec2 tile_size) {
    return (tile_size + uint(DISC_TILE - 1)) / uint(DISC_TILE);
}

// The trust ball, grown by what rounding may do on the way to the pixels.
float disc_radius(vec3 from_eye, float trust) {
    return trust * DISC_GROWTH + sqrt(dot3(from_eye, from_eye)) * DISTANCE_ERROR;
}

// x / z over the points with z > 0 of the disc of radius r about (x, z), seen from the origin, for
// z >= -r. By its two tangents: (x, z) turned by +-asin(r / |(x, z)|).
vec2 tangents(float x, float z, float r) {
    float squared = (x * x + z * z) - r * r;
    bool outside = squared > 0.0;
    float c = sqrt(outside ? squared : 0.0);
    vec2 across = vec2(x * c - z * r, x * c + z * r);
    vec2 along = vec2(z * c + x * r, z * c - x * r);
    bool low = outside && along.x * STEEPEST > abs(across.x);
    bool high = outside && along.y * STEEPEST > abs(across.y);
    return vec2(low ? across.x / (low ? along.x : 1.0) : -UNBOUNDED,
                high ? across.y / (high ? along.y : 1.0) : UNBOUNDED);
}

// First and last screen tile among `size` pixels whose centres lie in the range, first > last: none.
ivec2 tiles_of(vec2 range, float origin, float size) {
    float first = -floor(-((range.x - PIXEL_MARGIN - 0.5) - origin));
    float last = floor((range.y + PIXEL_MARGIN - 0.5) - origin);
    first = max(first, 0.0);
    last = min(last, size - 1.0);
    bool none = first > last;
    return none ? ivec2(1, 0) : ivec2(first, last) / DISC_TILE;
}

// The screen tiles that the disc of a trust ball covers.
TileSpan disc_tiles(CameraParams camera, vec3 from_eye, float trust) {
    float r = disc_radius(from_eye, trust);
    float z = dot3(camera.forward, from_eye);
    vec2 x = tangents(dot3(camera.right, from_eye), z, r) / camera.scale + camera.half_width;
    vec2 y = tangents(dot3(camera.up, from_eye), z, r) / camera.scale;
    vec2 rows = vec2(camera.half_height - y.y, camera.half_height - y.x);
    ivec2 along_x = tiles_of(x, float(camera.tile_origin.x), float(camera.tile_size.x));
    ivec2 along_y = tiles_of(rows, float(camera.tile_origin.y), float(camera.tile_size.y));
    bool none = trust <= 0.0 || z < -r || along_x.x > along_x.y || along_y.x > along_y.y;
    return TileSpan(uvec2(along_x.x, along_y.x),
                    none ? uvec2(0u) : uvec2(along_x.y - along_x.x, along_y.y - along_y.x) + 1u);
}

// The discs of a leaf's points.
struct LeafDiscs {
    TileSpan spans[LEAF_POINTS];
    TileSpan around; // all of them
    float nearest;   // distance from the eye to any of the trust balls, a lower bound
};

LeafDiscs discs_of_leaf(DiscParams params, uint leaf) {
    LeafDiscs discs;
    uvec2 low = uvec2(NONE), end = uvec2(0u);
    float nearest = NO_HIT;
    for (uint i = 0u; i < LEAF_POINTS; ++i) {
        uint slot = leaf * LEAF_POINTS + i;
        vec4 ball = polynomial_center_trust_at(slot);
        vec3 from_eye = ball.xyz - params.camera.eye;
        TileSpan span = disc_tiles(params.camera, from_eye, slot < params.point_count ? ball.w : 0.0);
        float distance = sqrt(dot3(from_eye, from_eye)) - disc_radius(from_eye, ball.w);
        bool covers = span.extent.x > 0u;
        low = covers ? min(low, span.low) : low;
        end = covers ? max(end, span.low + span.extent) : end;
        nearest = covers && distance < nearest ? distance : nearest;
        discs.spans[i] = span;
    }
    discs.around = TileSpan(low, end.x > 0u ? end - low : uvec2(0u));
    discs.nearest = nearest;
    return discs;
}

// Which of a leaf's points cover a screen tile, a bit each.
uint covering(LeafDiscs discs, uvec2 tile) {
    uint points = 0u;
    for (uint i = 0u; i < LEAF_POINTS; ++i) {
        uvec2 at = tile - discs.spans[i].low; // before it: past it
        points |= at.x < discs.spans[i].extent.x && at.y < discs.spans[i].extent.y ? 1u << i : 0u;
    }
    return points;
}

// The screen tile after another, row after row.
uvec2 tile_after(uvec2 tile, TileSpan span) {
    return tile.x + 1u == span.low.x + span.extent.x ? uvec2(span.low.x, tile.y + 1u) : uvec2(tile.x + 1u, tile.y);
}

// Ranks distances along a ray: a lesser one never has a greater rank. The float's own bits, so that
// near and far are resolved alike.
uint depth_rank(DepthRanks ranks, float t) {
    float clamped = min(max(t, ranks.nearest), ranks.farthest);
    return (floatBitsToUint(clamped) - floatBitsToUint(ranks.nearest)) >> ranks.shift;
}
#endif
