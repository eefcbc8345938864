// volume: volumes of points, and rays on their way through them.
//
// Made from crates/kernels/src/layout/volume.rs by compile-kernels: change that.
#ifndef STAGE_VOLUME_GLSL
#define STAGE_VOLUME_GLSL
#include "stages/grid.glsl"

#define VOLUME_SHEPARD 0 // VolumeInfo.kernel of the weighted mean, Eq. 3 of the paper
#define VOLUME_SUM 1 // VolumeInfo.kernel of the weighted sum
#define VOLUME_SPH 2 // VolumeInfo.kernel of particles with smoothing lengths of their own
#define VOLUME_EMISSION 0 // VolumeInfo.mode: emission and extinction along the way
#define VOLUME_MAXIMUM 1 // VolumeInfo.mode: the greatest scalar
#define VOLUME_AVERAGE 2 // VolumeInfo.mode: the mean scalar
#define VOLUME_ISOSURFACE 3 // VolumeInfo.mode: the surface where the scalar is one number
#define VOLUME_INTEGRAL 4 // What a ray shows: the integral of the scalar
#define VOLUME_EMITS 0 // VolumeInfo.shading: colours are emitted
#define VOLUME_GRADIENT 1 // VolumeInfo.shading: Lambert's law, with the scalar's gradient for a normal
#define VOLUME_SCATTERS 2 // VolumeInfo.shading: light is scattered evenly to all sides
#define VOLUME_LIGHTS 4 // Lights that a scene with lit volumes may have
#define CELL_NOTHING 0 // VolumeCell.counts: nothing can be seen from here
#define CELL_LOOK 1 // VolumeCell.counts: something may be seen
#define CELL_ABOVE 2 // VolumeCell.counts: where there is a scalar, it is above the isosurface
#define CELL_BELOW 3 // VolumeCell.counts: where there is one, it is below
#define CELL_KINDS 3 // VolumeCell.counts: the bits of these
#define CELL_FINER 4 // VolumeCell.counts, of a grid by size: finer points may be near
#define CELL_MARKS 7 // VolumeCell.counts: all bits that are none of a float's
#define STRIDE_STEPS 8 // Steps of one length that a ray takes at a time, a power of two
#define MARCH_PARTS 64 // Parts of a step that is divided
#define BLOCK_PLACES 8 // Places along a ray for which points are measured together, at most

// A field between points ([T] §6).
struct VolumeInfo { // 112 bytes
    GridInfo grid;                   //   0 Over the points' bounding box grown by the radius, and up to a cell more; that of the largest points where it has grids by size.
    uint first_cell;                 //  32 In the cells of all volumes.
    uint first_stop;                 //  36 In the stops of all volumes.
    uint stop_count;                 //  40 Stops of its transfer function.
    uint kernel;                     //  44 One of VOLUME_*.
    float square_radius;             //  48 Of a point's reach; where each has its own, of a mean one, and in a grid by size of the greatest there.
    float inverse_width;             //  52 1 / 2ρ; 0: each point has its own reach r, and ρ = (r/2)². Then 1/r is its inverse length.
    uint object;                     //  56 Index of the object in the scene.
    uint bounded;                    //  60 1: it counts only inside the object's surface.
    vec3 high;                       //  64 Highest corner of the box, whose lowest is the grid's.
    uint mode;                       //  76 What a ray shows: one of VOLUME_EMISSION and so on.
    float iso;                       //  80 Scalar on an isosurface; of other modes, the mean cosine of the angle that light is scattered by.
    uint slot;                       //  84 Of the polynomial that stands for an isosurface, behind those of all points; of other modes, 1 where anything has an emission.
    uint refracts;                   //  88 1: an isosurface of glass, which rays are inside or outside; of a volume that scatters rays, the slot of the polynomial that stands for it.
    uint shading;                    //  92 What light does in it: one of VOLUME_EMITS and so on.
    uint block;                      //  96 Places of a block, a power of two: so many that no weight is out of the range of floats.
    uint first_size;                 // 100 The first of its grids by size, coarsest first, in the list of volumes.
    uint size_count;                 // 104 How many of these there are; 0: it has one grid.
    uint level;                      // 108 log₂ of the length of steps, in shortest steps, where the points of this grid are the smallest around.
};

// A cell of a volume's grid.
struct VolumeCell { // 8 bytes
    uint first;                      //   0 Point in the points of all volumes; the next cell's is the end.
    uint counts;                     //   4 One of CELL_*; in the other bits, beside a steep transfer function, those of the float by which the scalar within a step may be off a straight line.
};

#ifdef TEXELS
VolumeCell volume_cell_from(usamplerBuffer texels, int first) {
    uvec4 t0 = texelFetch(texels, first + 0);
    return VolumeCell(t0.x, t0.y);
}
#endif

// A point of a volume.
struct VolumePoint { // 16 bytes
    vec3 position;                   //   0 Centred scene space.
    float scalar;                    //  12 What it carries; a particle, A (m/ρ) / (π h³).
};

#ifdef TEXELS
VolumePoint volume_point_from(usamplerBuffer texels, int first) {
    uvec4 t0 = texelFetch(texels, first + 0);
    return VolumePoint(uintBitsToFloat(t0.xyz), uintBitsToFloat(t0.w));
}
#endif

// A stop of a transfer function, ascending in value. Integrals are those from the first stop to this one, each of them the sum of two numbers.
struct VolumeStop { // 96 bytes
    vec3 color;                      //   0 Linear RGB.
    float extinction;                //  12 σ, per unit of length.
    float value;                     //  16 The scalar at this stop.
    float emission[3];               //  20 Radiance per unit of length.
    vec4 scattering_integral;        //  32 Of the colour times the extinction, and of the extinction.
    vec4 scattering_rest;            //  48 The second numbers of these.
    vec4 emission_integral;          //  64 Of the emission; the fourth is how many stops up to this one bound a steep piece.
    vec4 emission_rest;              //  80 The second numbers of these.
};

#ifdef TEXELS
VolumeStop volume_stop_from(usamplerBuffer texels, int first) {
    uvec4 t0 = texelFetch(texels, first + 0);
    uvec4 t1 = texelFetch(texels, first + 1);
    uvec4 t2 = texelFetch(texels, first + 2);
    uvec4 t3 = texelFetch(texels, first + 3);
    uvec4 t4 = texelFetch(texels, first + 4);
    uvec4 t5 = texelFetch(texels, first + 5);
    return VolumeStop(uintBitsToFloat(t0.xyz), uintBitsToFloat(t0.w), uintBitsToFloat(t1.x), float[](uintBitsToFloat(t1.y), uintBitsToFloat(t1.z), uintBitsToFloat(t1.w)), uintBitsToFloat(t2), uintBitsToFloat(t3), uintBitsToFloat(t4), uintBitsToFloat(t5));
}
#endif

// How far a ray has marched through volumes. Sums over its way are of two numbers: what rounding added is taken from the next term.
struct March { // 80 bytes
    vec3 color;                      //   0 Emitted towards its start so far; of other modes than emission, the greatest scalar or the integral of all, and the length in reach.
    float depth;                     //  12 Optical depth.
    vec3 color_lost;                 //  16 What rounding added to the colour.
    float depth_lost;                //  28 What rounding added to the depth.
    vec3 step_color;                 //  32 What this step sends per length, of the volumes so far.
    float step_extinction;           //  44 Of this step.
    float numerator;                 //  48 Where volumes are lit, numerator of this volume's scalar at this place, so far.
    float denominator;               //  52 Its denominator.
    uint state;                      //  56 0: not begun, 1: on its way, 2: done, 3: once more, for along. From bit 2 on, in five bits each: log₂ of the length of steps from the place on, and of the step before it, in shortest steps.
    uint place;                      //  60 End of a step; from bit 24 on, its part, where 0 is the whole step; in bit 31, whether a volume so far divides it.
    uint volume;                     //  64 Volume.
    uint row;                        //  68 Of cells around the places that are asked for; from bit 24 on, which grid by size they are of.
    uint cursor;                     //  72 Points of the row that are done.
    float along;                     //  76 For the channels of volumes: the depth along the viewing axis where half of what is lost is lost, or below 0; of other modes than emission, the scalar that is shown.
};

// Scalars of a volume at even places along a ray.
struct VolumeBlock { // 80 bytes
    float scalars[8];                //   0 Numerators so far; once all points are weighed, the scalars.
    float weights[8];                //  32 Denominators so far.
    uint known;                      //  64 The place after the last whose scalar is known.
    uint of;                         //  68 0: places are ends of steps; else they are ends of parts of the step before this place.
    uvec2 pad;                       //  72 Unused.
};

// What a ray needs beside its march where volumes scatter it.
struct MarchScatter { // 32 bytes
    vec3 step_color;                 //   0 Colour by extinction, of the scattering volumes of this step so far.
    float step_extinction;           //  12 Their extinction.
    float most;                      //  16 Most of one of them.
    uint slot;                       //  20 The slot that stands for that one.
    float depth;                     //  24 Their optical depth so far.
    float lost;                      //  28 What rounding added to it.
};

// What a sample of a lit volume needs beside its scalar.
struct MarchLight { // 48 bytes
    vec3 pull;                       //   0 Sum of the weights' gradients, by the scalars.
    uint pad;                        //  12 Unused.
    vec3 weights_pull;               //  16 Sum of the weights' gradients.
    uint pad_end;                    //  28 Unused.
    vec4 visible;                    //  32 Of each light, by the weights.
};

// How far a ray has looked for isosurfaces.
struct IsoSearch { // 80 bytes
    vec3 pull;                       //   0 As in MarchLight, at this place.
    float numerator;                 //  12 Numerator of the scalar at this place, so far.
    vec3 weights_pull;               //  16 As in MarchLight, at this place.
    float denominator;               //  28 Its denominator.
    float low;                       //  32 Along the ray: the last place on the side that it comes from.
    float high;                      //  36 The first known beyond the surface.
    float value_low;                 //  40 Scalar less iso there; 0: not known.
    float value_high;                //  44 The same at the other end.
    float here;                      //  48 The next place between them.
    uint state;                      //  52 New, stepping, closing in, turning to the viewer, done.
    uint place;                      //  56 Sample, or turn.
    uint volume;                     //  60 Volume.
    uint row;                        //  64 Of cells around the place.
    uint cursor;                     //  68 Points of the row that are done.
    uint side;                       //  72 Of low: 0 not known, 1 below, 2 above.
    uint looked;                     //  76 Whether it was looked at, or is known from its cell; then which end moved.
};

// Push constants of march.
struct MarchParams { // 64 bytes
    vec3 forward;                    //   0 Viewing axis.
    uint ray_count;                  //  12 Rays.
    uint volume_count;               //  16 Volumes of the scene.
    float step;                      //  20 Distance of the samples.
    uint work;                       //  24 Loop iterations a ray may spend in this pass.
    uint light_count;                //  28 Lights, where volumes are lit.
    uint wants_depth;                //  32 1: along is asked for.
    uint sample_index;               //  36 Where volumes scatter rays: which sample of each pixel, or NONE.
    uint seed;                       //  40 Of all that is random.
    uint tile_width;                 //  44 Columns of the tile.
    uvec2 tile_origin;               //  48 The tile's first pixel in the full image.
    uvec2 pad;                       //  56 Unused.
};

// Push constants of point_rays and point_lights.
struct PointLightParams { // 16 bytes
    uint first;                      //   0 Point in the points of all volumes.
    uint count;                      //   4 Points of this batch.
    uint light;                      //   8 Which light the rays go to.
    uint volume;                     //  12 Whose points they are.
};

#define VOLUMES 81 // The volumes of the scene

#define VOLUME_CELLS 82 // Of all volumes
#ifdef TEXELS
layout(binding = VOLUME_CELLS) uniform usamplerBuffer volume_cell_texels;

VolumeCell volume_cell_at(uint at) {
    return volume_cell_from(volume_cell_texels, int(at));
}

uint volume_cell_first_at(uint at) {
    return texelFetch(volume_cell_texels, int(at)).x;
}

uint volume_cell_counts_at(uint at) {
    return texelFetch(volume_cell_texels, int(at)).y;
}
#else
layout(std430, binding = VOLUME_CELLS) readonly buffer VolumeCellList { VolumeCell volume_cell_list[]; };

VolumeCell volume_cell_at(uint at) {
    return volume_cell_list[at];
}

uint volume_cell_first_at(uint at) {
    return volume_cell_list[at].first;
}

uint volume_cell_counts_at(uint at) {
    return volume_cell_list[at].counts;
}
#endif

#define VOLUME_POINTS 83 // Of all volumes
#ifdef TEXELS
layout(binding = VOLUME_POINTS) uniform usamplerBuffer volume_point_texels;

VolumePoint volume_point_at(uint at) {
    return volume_point_from(volume_point_texels, int(at));
}

vec3 volume_point_position_at(uint at) {
    return uintBitsToFloat(texelFetch(volume_point_texels, int(at)).xyz);
}

float volume_point_scalar_at(uint at) {
    return uintBitsToFloat(texelFetch(volume_point_texels, int(at)).w);
}
#else
layout(std430, binding = VOLUME_POINTS) readonly buffer VolumePointList { VolumePoint volume_point_list[]; };

VolumePoint volume_point_at(uint at) {
    return volume_point_list[at];
}

vec3 volume_point_position_at(uint at) {
    return volume_point_list[at].position;
}

float volume_point_scalar_at(uint at) {
    return volume_point_list[at].scalar;
}
#endif

#define VOLUME_LENGTHS 84 // 1/h by point, or one by its reach, if any volume has particles or points with a reach of their own
#ifdef TEXELS
layout(binding = VOLUME_LENGTHS) uniform usamplerBuffer inverse_length_texels;

float inverse_length_at(uint at) {
    return uintBitsToFloat(texelFetch(inverse_length_texels, int(at)).x);
}
#else
layout(std430, binding = VOLUME_LENGTHS) readonly buffer InverseLengthList { float inverse_length_list[]; };

float inverse_length_at(uint at) {
    return inverse_length_list[at];
}
#endif

#define VOLUME_STOPS 85 // Of all transfer functions
#ifdef TEXELS
layout(binding = VOLUME_STOPS) uniform usamplerBuffer stop_texels;

VolumeStop stop_at(uint at) {
    return volume_stop_from(stop_texels, int(6u * at));
}

vec3 stop_color_at(uint at) {
    return uintBitsToFloat(texelFetch(stop_texels, int(6u * at)).xyz);
}

float stop_extinction_at(uint at) {
    return uintBitsToFloat(texelFetch(stop_texels, int(6u * at)).w);
}

float stop_value_at(uint at) {
    return uintBitsToFloat(texelFetch(stop_texels, int(6u * at) + 1).x);
}

float stop_emission_at(uint at, uint i) {
    return uintBitsToFloat(texelFetch(stop_texels, int(6u * at) + int((5u + i) / 4u))[(5u + i) & 3u]);
}

vec4 stop_scattering_integral_at(uint at) {
    return uintBitsToFloat(texelFetch(stop_texels, int(6u * at) + 2));
}

vec4 stop_scattering_rest_at(uint at) {
    return uintBitsToFloat(texelFetch(stop_texels, int(6u * at) + 3));
}

vec4 stop_emission_integral_at(uint at) {
    return uintBitsToFloat(texelFetch(stop_texels, int(6u * at) + 4));
}

vec4 stop_emission_rest_at(uint at) {
    return uintBitsToFloat(texelFetch(stop_texels, int(6u * at) + 5));
}
#else
layout(std430, binding = VOLUME_STOPS) readonly buffer StopList { VolumeStop stop_list[]; };

VolumeStop stop_at(uint at) {
    return stop_list[at];
}

vec3 stop_color_at(uint at) {
    return stop_list[at].color;
}

float stop_extinction_at(uint at) {
    return stop_list[at].extinction;
}

float stop_value_at(uint at) {
    return stop_list[at].value;
}

float stop_emission_at(uint at, uint i) {
    return stop_list[at].emission[i];
}

vec4 stop_scattering_integral_at(uint at) {
    return stop_list[at].scattering_integral;
}

vec4 stop_scattering_rest_at(uint at) {
    return stop_list[at].scattering_rest;
}

vec4 stop_emission_integral_at(uint at) {
    return stop_list[at].emission_integral;
}

vec4 stop_emission_rest_at(uint at) {
    return stop_list[at].emission_rest;
}
#endif

#define MARCHES 86 // By ray

#define MARCH_ENDS 87 // The ends of steps by ray and volume, two each where steps may be divided; of lit ones four floats. With grids by size, after them whether the volume is seen from the stretch of steps

#define MARCH_LIGHTS 88 // By ray, where volumes are lit

#define MARCH_SCATTERS 89 // By ray, where volumes scatter rays

#define VISIBLE 90 // What of each light's reaches each point of a volume
#ifdef TEXELS
layout(binding = VISIBLE) uniform usamplerBuffer visible_texels;

vec4 visible_at(uint at) {
    return uintBitsToFloat(texelFetch(visible_texels, int(at)).xyzw);
}
#else
layout(std430, binding = VISIBLE) readonly buffer VisibleList { vec4 visible_list[]; };

vec4 visible_at(uint at) {
    return visible_list[at];
}
#endif

#define ISO_SEARCHES 91 // By ray

#define VOLUME_BLOCKS 92 // By ray and volume
#endif
