// gap: how far a point's polynomial must reach to meet its neighbours'.
//
// twin  crates/reference/src/gap.rs
// Points cover a surface where each one's disc holds its Voronoi cell. In direction e of the tangent
// plane the cell ends at the nearest bisector, |q|2 / 2 q.e over the neighbours q; its extent is
// sampled in 24 directions. A cell that is open, or reaches beyond h, in any of them lies at a rim, which
// is no gap.
#ifndef GAP_GLSL
#define GAP_GLSL

#define GAP_GROUPS 3     // of four directions, and the opposite of each
#define UNBOUNDED 1e6    // farther than any bisector that matters, in units of h
#define GAP_MARGIN 1.15  // for what lies between two sampled directions

const vec4 GAP_COSINES[GAP_GROUPS] = vec4[GAP_GROUPS](
    vec4(1.000000000, 0.965925826, 0.866025404, 0.707106781),
    vec4(0.500000000, 0.258819045, 0.0, -0.258819045),
    vec4(-0.500000000, -0.707106781, -0.866025404, -0.965925826));
const vec4 GAP_SINES[GAP_GROUPS] = vec4[GAP_GROUPS](
    vec4(0.0, 0.258819045, 0.500000000, 0.707106781),
    vec4(0.866025404, 0.965925826, 1.000000000, 0.965925826),
    vec4(0.866025404, 0.707106781, 0.500000000, 0.258819045));

// How far the cell reaches in the directions of a group, and in the opposite ones.
struct Extents {
    vec4 ahead, behind;
};

Extents no_bisectors() {
    return Extents(vec4(UNBOUNDED), vec4(UNBOUNDED));
}

// Narrows them by the bisector with the neighbour at q, |q| > 0: it is ahead or behind.
void narrow(inout Extents extents, vec4 cosines, vec4 sines, vec2 q, float half_square) {
    vec4 along = q.x * cosines + q.y * sines;
    vec4 bisector = half_square / larger(abs(along), vec4(1e-6));
    extents.ahead = mix(extents.ahead, smaller(extents.ahead, bisector), greaterThan(along, vec4(1e-6)));
    extents.behind = mix(extents.behind, smaller(extents.behind, bisector), lessThan(along, vec4(-1e-6)));
}

// Squared distance to the farthest point of the surface g = A x2 + B y2 + C xy + E x + F y + D over the
// cell, among four directions; in units of h.
float extent_of_cell(vec4 extent, vec4 cosines, vec4 sines, float c[6]) {
    vec4 x = extent * cosines, y = extent * sines;
    vec4 g = c[0] * x * x + c[1] * y * y + c[2] * x * y + c[3] * x + c[4] * y + c[5];
    vec4 square = extent * extent + g * g;
    return larger(larger(square.x, square.y), larger(square.z, square.w));
}

float farthest_of(vec4 extent) {
    return larger(larger(extent.x, extent.y), larger(extent.z, extent.w));
}

// The greatest of both so far, and of these: the squared distance to the surface, and the cell's extent.
void add_extents(Extents extents, vec4 cosines, vec4 sines, float c[6], inout float square, inout float extent) {
    square = larger(square, larger(extent_of_cell(extents.ahead, cosines, sines, c),
                                   extent_of_cell(extents.behind, -cosines, -sines, c)));
    extent = larger(extent, larger(farthest_of(extents.ahead), farthest_of(extents.behind)));
}
#endif
