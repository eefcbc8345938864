// points: points, and the surfaces near them.
//
// Made from crates/kernels/src/layout/points.rs by compile-kernels: change that.
#ifndef STAGE_POINTS_GLSL
#define STAGE_POINTS_GLSL

#define NONE 0xffffffffu // No slot, no colour, no object; a ray's cell once the ray is done
#define LINE_GROUP 64 // Invocations a workgroup of kernels that run along a list
#define LINE_ROW 1048576 // Invocations a row of such a kernel, where one row is not enough
#define TILE_GROUP 64 // Invocations a workgroup of kernels that run over 8 × 8 pixels
#define FIT_NO_SURFACE 0 // A fit that found no surface
#define FIT_PLANE 1 // A fit that fell back to a plane
#define FIT_INCOMPLETE 2 // The paper's polynomial without linear terms
#define FIT_FULL 3 // The polynomial with linear terms
#define FIT_DISC 4 // No fit: the point is drawn as a disc
#define FIT_SPHERE 5 // No fit: the point is drawn as a sphere

// One point of the scene.
struct Point { // 16 bytes
    vec3 position;                   //   0 Centred scene space.
    uint index;                      //  12 Place in its file.
};

#ifdef TEXELS
Point point_from(usamplerBuffer texels, int first) {
    uvec4 t0 = texelFetch(texels, first + 0);
    return Point(uintBitsToFloat(t0.xyz), t0.w);
}
#endif

// The surface near one point, in world form: with y = x − center, gradient · y − offset − yᵀ M y = 0 where |y| ≤ trust ([T] §4; method, section 1).
struct Polynomial { // 64 bytes
    vec4 center_trust;               //   0 p, and the trust radius b; b = 0 where the point carries no surface. At a rim, centre and radius of a ball inside that one.
    vec4 gradient_offset;            //  16 m = n − E u − F v, and D.
    vec4 curvature;                  //  32 M: xx, yy, zz, xy.
    vec2 cross_terms;                //  48 M: xz, yz.
    uint object;                     //  56 Index of the object in the scene.
    uint index;                      //  60 Place in its file.
};

#ifdef TEXELS
Polynomial polynomial_from(usamplerBuffer texels, int first) {
    uvec4 t0 = texelFetch(texels, first + 0);
    uvec4 t1 = texelFetch(texels, first + 1);
    uvec4 t2 = texelFetch(texels, first + 2);
    uvec4 t3 = texelFetch(texels, first + 3);
    return Polynomial(uintBitsToFloat(t0), uintBitsToFloat(t1), uintBitsToFloat(t2), uintBitsToFloat(t3.xy), t3.z, t3.w);
}
#endif

// How one fit ended.
struct FitOutcome { // 12 bytes
    float trust;                     //   0 The trust radius b, or 0.
    uint kind;                       //   4 One of FIT_*.
    float feature_size;              //   8 h.
};

// What a point's neighbours say about a rim of the set.
struct Rim { // 20 bytes
    float outward[3];                //   0 Unit vector in the tangent plane; zero where the cell is not open.
    float reach;                     //  12 Along it: from the point to where the surface ends.
    float openness;                  //  16 Reach of the Voronoi cell over that of the neighbours.
};

// Parameters of smooth_sizes for one batch of points.
struct SmoothParams { // 16 bytes
    uint first_slot;                 //   0 Of the batch.
    uint point_count;                //   4 Points of the batch.
    uint stride;                     //   8 Entries of a point in the list of neighbours.
    uint round;                      //  12 0: reaches are written; 1: sizes.
};

// A trust ball that ends at a rim.
struct BallClip { // 20 bytes
    uint slot;                       //   0 Of the point.
    float trust;                     //   4 The ball's radius.
    float shift[3];                  //   8 From the point to the ball's centre.
};

// Push constants of clip_balls.
struct ClipParams { // 4 bytes
    uint count;                      //   0 Balls.
};

// Push constants of shape_spheres and shape_discs.
struct ShapeParams { // 20 bytes
    uint first_slot;                 //   0 First slot of this batch.
    uint count;                      //   4 Slots in this batch.
    uint object;                     //   8 Index of the object in the scene.
    uint bound_from;                 //  12 Slot that the buffers by slot are bound from.
    uint has_normals;                //  16 1: normals are given; 0: of discs, planes were fitted.
};

// Push constants of fit_polynomials.
struct FitParams { // 48 bytes
    uint first_slot;                 //   0 First slot of this batch.
    uint point_count;                //   4 Points in this batch.
    uint neighbors;                  //   8 Entries a point in the list of neighbours, a multiple of four; of a plan: k.
    uint polynomial;                 //  12 FIT_FULL, FIT_INCOMPLETE or FIT_PLANE: the first kind tried.
    float feature_size;              //  16 h for all points; 0: the distance to the last neighbour; −1: given for each.
    float trust;                     //  20 b / h.
    uint object;                     //  24 Index of the object in the scene.
    uint first_listed;               //  28 Slot whose neighbours come first in the list.
    float weight_scale;              //  32 h over the width of the weights.
    uint close_gaps;                 //  36 1: b grows, at most to h, where neighbours leave a gap.
    float rim_limit;                 //  40 Of the distance to the centroid, over the reach of the neighbours; 0: no rims.
    uint bound_from;                 //  44 Slot that the buffers by slot are bound from; points are bound as a whole.
};

#define POINTS 0 // Every point, by slot
#ifdef TEXELS
layout(binding = POINTS) uniform usamplerBuffer point_texels;

Point point_at(uint at) {
    return point_from(point_texels, int(at));
}

vec3 point_position_at(uint at) {
    return uintBitsToFloat(texelFetch(point_texels, int(at)).xyz);
}

uint point_index_at(uint at) {
    return texelFetch(point_texels, int(at)).w;
}
#else
layout(std430, binding = POINTS) readonly buffer PointList { Point point_list[]; };

Point point_at(uint at) {
    return point_list[at];
}

vec3 point_position_at(uint at) {
    return point_list[at].position;
}

uint point_index_at(uint at) {
    return point_list[at].index;
}
#endif

#define NEIGHBORS 1 // Neighbours of the batch's points, by slot
#ifdef TEXELS
layout(binding = NEIGHBORS) uniform usamplerBuffer neighbor_texels;

uint neighbor_at(uint at) {
    return texelFetch(neighbor_texels, int(at / 4u))[at & 3u];
}

// The four of which that is one, from a multiple of four on.
uvec4 neighbor_four_at(uint at) {
    return texelFetch(neighbor_texels, int(at / 4u));
}
#else
layout(std430, binding = NEIGHBORS) readonly buffer NeighborList { uint neighbor_list[]; };

uint neighbor_at(uint at) {
    return neighbor_list[at];
}

uvec4 neighbor_four_at(uint at) {
    uint first = at & ~3u;
    return uvec4(neighbor_list[first], neighbor_list[first + 1u], neighbor_list[first + 2u], neighbor_list[first + 3u]);
}
#endif

#define POLYNOMIALS 2 // The surfaces of points, by slot
#ifdef TEXELS
layout(binding = POLYNOMIALS) uniform usamplerBuffer polynomial_texels;

Polynomial polynomial_at(uint at) {
    return polynomial_from(polynomial_texels, int(4u * at));
}

vec4 polynomial_center_trust_at(uint at) {
    return uintBitsToFloat(texelFetch(polynomial_texels, int(4u * at)));
}

vec4 polynomial_gradient_offset_at(uint at) {
    return uintBitsToFloat(texelFetch(polynomial_texels, int(4u * at) + 1));
}

vec4 polynomial_curvature_at(uint at) {
    return uintBitsToFloat(texelFetch(polynomial_texels, int(4u * at) + 2));
}

vec2 polynomial_cross_terms_at(uint at) {
    return uintBitsToFloat(texelFetch(polynomial_texels, int(4u * at) + 3).xy);
}

uint polynomial_object_at(uint at) {
    return texelFetch(polynomial_texels, int(4u * at) + 3).z;
}

uint polynomial_index_at(uint at) {
    return texelFetch(polynomial_texels, int(4u * at) + 3).w;
}
#else
layout(std430, binding = POLYNOMIALS) readonly buffer PolynomialList { Polynomial polynomial_list[]; };

Polynomial polynomial_at(uint at) {
    return polynomial_list[at];
}

vec4 polynomial_center_trust_at(uint at) {
    return polynomial_list[at].center_trust;
}

vec4 polynomial_gradient_offset_at(uint at) {
    return polynomial_list[at].gradient_offset;
}

vec4 polynomial_curvature_at(uint at) {
    return polynomial_list[at].curvature;
}

vec2 polynomial_cross_terms_at(uint at) {
    return polynomial_list[at].cross_terms;
}

uint polynomial_object_at(uint at) {
    return polynomial_list[at].object;
}

uint polynomial_index_at(uint at) {
    return polynomial_list[at].index;
}
#endif

#define OUTCOMES 3 // How each fit ended

#define SIZES 4 // h by slot, where it is smoothed

#define RIMS 5 // Of the points of the batch

#define REACHES 6 // Distance of each point to its last neighbour, by slot

#define CLIPS 7 // Trust balls that end at a rim

#define RADII 8 // Of each sphere or disc of the batch

#define NORMALS 9 // Three floats for each disc of the batch, where normals are given
#endif
