// film: what pixels saw.
//
// Made from crates/kernels/src/layout/film.rs by compile-kernels: change that.
#ifndef STAGE_FILM_GLSL
#define STAGE_FILM_GLSL

// What one pixel saw.
struct FilmPixel { // 80 bytes
    vec4 color;                      //   0 Radiance, and coverage.
    vec4 position_depth;             //  16 First surface, centred scene space; distance along the viewing axis, or +inf.
    vec4 normal_object;              //  32 Unit normal facing the viewer; index of the object, or −1.
    uvec4 counts;                    //  48 Points tested, cells crossed, slot of the hit or NONE, iterations of its refinement.
    vec3 alpha;                      //  64 1 less what each channel lets through of the background, by nothing but glass and volumes.
    float along;                     //  76 Of volumes on the camera ray's way, as in March.
};

// A pixel's samples so far.
struct FilmSum { // 112 bytes
    FilmPixel pixel;                 //   0 Sums of colours, alphas and of the first two counts; all else is the first sample's.
    vec4 lost;                       //  80 What rounding added to the colours' sums.
    vec3 lost_alpha;                 //  96 What it added to the alphas'.
    uint pad;                        // 108 Unused.
};

// Push constants of accumulate.
struct AccumulateParams { // 16 bytes
    uvec2 tile_size;                 //   0 Columns and rows of the tile.
    uint sample_index;               //   8 Which sample the film holds.
    uint samples;                    //  12 In all.
};

#define FILM 93 // By pixel of the tile

#define FILM_SUMS 94 // Of all samples so far
#endif
