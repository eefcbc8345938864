// rays: rays on their way, and where they met surfaces.
//
// Made from crates/kernels/src/layout/rays.rs by compile-kernels: change that.
#ifndef STAGE_RAYS_GLSL
#define STAGE_RAYS_GLSL

#define RAY_STARTS 0xfffffffeu // A ray's cell before its structure has begun with it (structure.glsl)
#define STATE_ROW 1024 // Texels a row of the ray state's images
#define PASSED_NEAR 0x80000000u // Beside an object in TraceParams.passed: its surface is left out only near the ray's start
#define HIT_NONE 0 // A pixel that hit nothing
#define HIT_ACCEPTED 1 // A hit that stands
#define HIT_PENDING 2 // A hit whose refinement is under way
#define HIT_REJECTED 3 // A hit whose refinement left the trust region
#define HIT_STATUS_BITS 8 // Low bits of Hit.status that say what has become of it; the next 8 bits count the iterations since the stored hit
#define HIT_TOTAL_SHIFT 16 // The bits of Hit.status from here on count all iterations of the ray
#define PERSPECTIVE 0 // Rays from one place, or through one place of the lens
#define ORTHOGRAPHIC 1 // Parallel rays
#define FILTER_INTERVALS 1024 // Intervals of the table that the reconstruction filter is sampled by
#define SAMPLE_FILM 0 // Numbers of the low-discrepancy sequence for the place on the film
#define SAMPLE_LENS 1 // For the place on the lens
#define SAMPLE_FRESNEL 2 // For what glass does with a ray: one a bounce from here on
#define SAMPLE_LIGHT 4096 // For the place on a light: one a light from here on
#define SAMPLE_SCATTER 8192 // For the direction that light is scattered in: one a bounce from here on
#define SAMPLE_SURVIVAL 12288 // For whether a path goes on: one a bounce from here on
#define SAMPLE_DISTANCE 0x80000000u // For how far a ray comes in volumes that scatter it: one a bounce from here on, so many for each surface that it has passed as if there were nothing
#define DISTANCES_A_CROSSING 2048 // See SAMPLE_DISTANCE
#define SAMPLES_A_BOUNCE 65536 // Numbers of a bounce, of paths that light takes from surface to surface

// Push constants of camera_rays.
struct CameraParams { // 96 bytes
    vec3 eye;                        //   0 Centred scene space.
    float scale;                     //  12 Size of a pixel: on the plane at distance 1, or, where rays are parallel, anywhere.
    vec3 right;                      //  16 Unit vector to the right.
    float half_width;                //  28 Half the full image's columns.
    vec3 up;                         //  32 Unit vector upwards.
    float half_height;               //  44 Half the full image's rows.
    vec3 forward;                    //  48 Unit vector of the viewing axis.
    uint sample_index;               //  60 Which sample of its pixel; NONE where there is only one, through the pixel's centre and the lens's.
    uvec2 tile_origin;               //  64 The tile's first pixel in the full image.
    uvec2 tile_size;                 //  72 Columns and rows of the tile.
    uint projection;                 //  80 PERSPECTIVE or ORTHOGRAPHIC.
    float lens_radius;               //  84 0: a pinhole.
    float focus;                     //  88 Distance along the viewing axis of the plane in focus, greater than 0.
    uint seed;                       //  92 Of all that is random.
};

// Push constants of the kernel of any structure that rays go through (structure.glsl).
struct TraceParams { // 24 bytes
    uint ray_count;                  //   0 Rays of the wave, or of those that are listed.
    uint cells;                      //   4 K: cells a ray may cross in this pass.
    uint work;                       //   8 Loop iterations a ray may spend in this pass.
    uint any_hit;                    //  12 1: any hit ends a ray.
    uint listed;                     //  16 1: rays are those of a list, and their state stays where it is.
    uint passed;                     //  20 Object whose surface is not there, or NONE.
};

// A ray as it travels in a queue; all bits as unsigned integers.
struct StateRay { // 64 bytes
    uvec4 position;                  //   0 Origin in centred scene space, and the nearest hit so far.
    uvec4 direction;                 //  16 Unit direction, and how many cells were crossed.
    uvec4 cell;                      //  32 Cell, RAY_STARTS or NONE, cursor in it, points tested, slot of the hit or NONE.
    uvec4 start;                     //  48 The point whose surface it starts on or NONE, up to where hits do not count, the cell where it came into the grid that it is in, of several; one unused.
};

#ifdef TEXELS
StateRay state_ray_from(usamplerBuffer texels, int first) {
    uvec4 t0 = texelFetch(texels, first + 0);
    uvec4 t1 = texelFetch(texels, first + 1);
    uvec4 t2 = texelFetch(texels, first + 2);
    uvec4 t3 = texelFetch(texels, first + 3);
    return StateRay(t0, t1, t2, t3);
}
#endif

// Where a pixel's ray met a surface.
struct Hit { // 32 bytes
    vec3 position;                   //   0 Centred scene space.
    float t;                         //  12 Distance along the ray.
    vec3 normal;                     //  16 Unit normal facing the ray's origin.
    uint status;                     //  28 One of HIT_*, and counts of iterations.
};

#ifdef TEXELS
Hit hit_from(usamplerBuffer texels, int first) {
    uvec4 t0 = texelFetch(texels, first + 0);
    uvec4 t1 = texelFetch(texels, first + 1);
    return Hit(uintBitsToFloat(t0.xyz), uintBitsToFloat(t0.w), uintBitsToFloat(t1.xyz), t1.w);
}
#endif

// Push constants of count_marked and list_marked.
struct MarkParams { // 12 bytes
    uint words;                      //   0 Words of 32 marks each.
    uint pairs;                      //   4 1: a word is followed by one whose marks count twice.
    uint listed;                     //   8 1: marks are of the rays of a list.
};

#define STATE_IN 47 // The ray state read: a queue, or the first of four images
#ifdef TEXELS
layout(binding = STATE_IN) uniform usamplerBuffer state_texels;

StateRay state_at(uint at) {
    return state_ray_from(state_texels, int(4u * at));
}

uvec4 state_position_at(uint at) {
    return texelFetch(state_texels, int(4u * at));
}

uvec4 state_direction_at(uint at) {
    return texelFetch(state_texels, int(4u * at) + 1);
}

uvec4 state_cell_at(uint at) {
    return texelFetch(state_texels, int(4u * at) + 2);
}

uvec4 state_start_at(uint at) {
    return texelFetch(state_texels, int(4u * at) + 3);
}
#else
layout(std430, binding = STATE_IN) readonly buffer StateList { StateRay state_list[]; };

StateRay state_at(uint at) {
    return state_list[at];
}

uvec4 state_position_at(uint at) {
    return state_list[at].position;
}

uvec4 state_direction_at(uint at) {
    return state_list[at].direction;
}

uvec4 state_cell_at(uint at) {
    return state_list[at].cell;
}

uvec4 state_start_at(uint at) {
    return state_list[at].start;
}
#endif

#define DIRECTION_IN 48 // The second

#define CELL_IN 49 // The third

#define START_IN 50 // The fourth

#define STATE_OUT 51 // The ray state written: a queue, or the first of four images

#define DIRECTION_OUT 52 // The second

#define CELL_OUT 53 // The third

#define START_OUT 54 // The fourth

#define LIVE 55 // How many rays are not done, and one more count

#define HITS 56 // Where rays met surfaces, by ray
#ifdef TEXELS
layout(binding = HITS) uniform usamplerBuffer hit_texels;

Hit hit_at(uint at) {
    return hit_from(hit_texels, int(2u * at));
}

vec3 hit_position_at(uint at) {
    return uintBitsToFloat(texelFetch(hit_texels, int(2u * at)).xyz);
}

float hit_t_at(uint at) {
    return uintBitsToFloat(texelFetch(hit_texels, int(2u * at)).w);
}

vec3 hit_normal_at(uint at) {
    return uintBitsToFloat(texelFetch(hit_texels, int(2u * at) + 1).xyz);
}

uint hit_status_at(uint at) {
    return texelFetch(hit_texels, int(2u * at) + 1).w;
}
#else
layout(std430, binding = HITS) readonly buffer HitList { Hit hit_list[]; };

Hit hit_at(uint at) {
    return hit_list[at];
}

vec3 hit_position_at(uint at) {
    return hit_list[at].position;
}

float hit_t_at(uint at) {
    return hit_list[at].t;
}

vec3 hit_normal_at(uint at) {
    return hit_list[at].normal;
}

uint hit_status_at(uint at) {
    return hit_list[at].status;
}
#endif

#define MARKS 57 // A bit a ray

#define MARK_OFFSETS 58 // How many marks each word has, then how many come before

#define LIVE_RAYS 59 // The rays that are marked, in order

#define LIST_IN 60 // The rays whose marks these are, where they are listed

#define CAMERA_FILTER 61 // Where the reconstruction filter's integral takes equal steps
#endif
