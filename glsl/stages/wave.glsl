// wave: the rays of one generation: what they have behind them, what they met, what lights it.
//
// Made from crates/kernels/src/layout/wave.rs by compile-kernels: change that.
#ifndef STAGE_WAVE_GLSL
#define STAGE_WAVE_GLSL
#include "stages/discs.glsl"
#include "stages/tree.glsl"

#define MEDIA_WORDS 8 // Words of a path's set of media: two media each
#define MATERIAL_LIT 256 // Bit of ObjectInfo.material: lights of the scene light the surface
#define MATERIAL_SENDS 512 // Bit: rays go on from it
#define MATERIAL_INSIDE 1024 // Bit: it encloses a medium, which rays are inside or outside
#define MATERIAL_DIFFUSE 256 // ObjectInfo.material of Lambert's law: the number of the kind, and its bits
#define MATERIAL_MIRROR 513 // ObjectInfo.material of a perfect mirror
#define MATERIAL_GLASS 1538 // ObjectInfo.material of smooth glass
#define MATERIAL_MATTE 771 // ObjectInfo.material of Lambert's law where light goes on from surface to surface
#define MATERIAL_CLOUD 772 // Of a volume that scatters light where it goes on
#define MOST_CROSSINGS 1024 // Surfaces that a path may pass through that do not change its medium
#define CHANNELS_ALL 7 // Path.channels of a ray that carries all three
#define PATH_REFLECTED 8 // Bit beside them: the path was reflected somewhere
#define PATH_ADDS 16 // Bit: surfaces on its way were lit, so that what it brings is added to what the pixel has
#define PATH_SCATTERED 32 // Bit: the last thing on its way scattered it to all sides, and has asked the lamps and, by its brightness, the background for light
#define PATH_INDIRECT 64 // Bit: something on its way before the last did
#define FIRST_CHANCE 2 // Paths may end by chance from this bounce on
#define TRANSPARENT_CAMERA 1 // WaveParams.transparent: camera rays leave the background out
#define TRANSPARENT_GLASS 2 // WaveParams.transparent: and so do rays that were only refracted
#define WAVE_FROM_CAMERA 1 // WaveParams.flags: rays come from the camera
#define WAVE_SHARES_PATH 2 // WaveParams.flags: all rays have the camera's path, but for the pixel
#define WAVE_VALUES 4 // WaveParams.flags: of paths that have shown no scalar of a volume yet, the next part of the way does
#define WAVE_LOSSES 8 // WaveParams.flags: of paths that have lost no light to volumes yet, the next part of the way says where it is
#define IMAGE_SRGB8 0 // An image of red, green, blue in sRGB, a byte each, from the lowest byte of a word on
#define IMAGE_LINEAR 1 // An image of red, green, blue as three floats, linear
#define LIGHT_DIRECTIONAL 0 // A light infinitely far away
#define LIGHT_POINT 1 // A light at a point
#define LIGHT_SKY 2 // The background, whose light surfaces look for by how they scatter it
#define LIGHT_ENVIRONMENT 3 // The same by how bright it is
#define LIGHT_SUN 4 // As directional, the sun in the background, which rays that are not scattered see there
#define IMAGES_OF_TURN 3 // Of the images after an environment: three rows of the matrix that turns it, and two of its sun: the direction towards it and the square of the sine of its radius; its radiance

// What rays that hit nothing see.
struct BackgroundInfo { // 16 bytes
    vec3 color;                      //   0 Linear RGB.
    uint environment;                //  12 An image instead, or NONE.
};

// A hit on a lit surface, where light is asked for.
struct LitHit { // 32 bytes
    vec3 position;                   //   0 Centred scene space.
    uint slot;                       //  12 The point hit.
    vec3 normal;                     //  16 Unit normal facing the ray's origin.
    uint view;                       //  28 The way that the ray came (packed_direction), where SCENE_GLOSSY.
};

#ifdef TEXELS
LitHit lit_hit_from(usamplerBuffer texels, int first) {
    uvec4 t0 = texelFetch(texels, first + 0);
    uvec4 t1 = texelFetch(texels, first + 1);
    return LitHit(uintBitsToFloat(t0.xyz), t0.w, uintBitsToFloat(t1.xyz), t1.w);
}
#endif

// Push constants of the kernels that scatter and shade the rays of a wave.
struct WaveParams { // 96 bytes
    vec3 forward;                    //   0 Unit vector of the viewing axis.
    uint ray_count;                  //  12 Rays of the wave; for shadow_rays and shade, hits on lit surfaces.
    BackgroundInfo background;       //  16 What rays that hit nothing see.
    uvec2 tile_origin;               //  32 The tile's first pixel in the full image.
    uvec2 tile_size;                 //  40 Columns and rows of the tile.
    uint flags;                      //  48 WAVE_*.
    uint max_bounces;                //  52 Interactions after the primary hit.
    uint fresnel;                    //  56 1: glass reflects or refracts at random; 0: it refracts.
    uint seed;                       //  60 Of everything random.
    uint light;                      //  64 The light that shadow rays go to now.
    uint light_count;                //  68 Lights of the scene.
    uint sample_index;               //  72 Which sample of each pixel; NONE where there is only one, and lights have no extent.
    uint transparent;                //  76 What leaves the background out: one of TRANSPARENT_*, or 0 for nothing.
    float clamp;                     //  80 The most radiance of what has come over several surfaces.
    uint sample_bits;                //  84 The samples of a pixel are at most 2 to this power.
    uvec2 pad;                       //  88 Unused.
};

// Push constants of camera_trace.
struct CameraTraceParams { // 128 bytes
    vec3 eye;                        //   0 As in CameraParams, as are the next six.
    float scale;                     //  12 Half the view's height over half the rows.
    vec3 right;                      //  16 Unit vector.
    float half_width;                //  28 Of the full image, in pixels.
    vec3 up;                         //  32 Unit vector.
    float half_height;               //  44 Of the full image, in pixels.
    vec3 forward;                    //  48 Unit vector of the viewing axis.
    uint work;                       //  60 Loop iterations a ray may spend.
    uvec2 tile_origin;               //  64 The tile's first pixel in the full image.
    uvec2 tile_size;                 //  72 Columns and rows of the tile.
    BackgroundInfo background;       //  80 What rays that hit nothing see.
    DepthRanks ranks;                //  96 How pairs of a screen tile are ordered.
    uint transparent;                // 112 What leaves the background out: one of TRANSPARENT_*, or 0 for nothing.
    uint max_bounces;                // 116 Interactions after the primary hit.
    TreeInfo tree;                   // 120 The tree's, where rays go through it.
};

// An image whose texels lie in rows, the top row first. After that of an environment come three whose first three words are the bits of a row of the matrix that turns it.
struct ImageInfo { // 16 bytes
    uint first;                      //   0 Word of its first texel among all texels.
    uint width;                      //   4 Columns.
    uint height;                     //   8 Rows.
    uint format;                     //  12 One of IMAGE_*.
};

// What shading needs of an object.
struct ObjectInfo { // 112 bytes
    vec3 albedo;                     //   0 Linear RGB, where the points' colours do not count; what rays that go on keep of their light.
    uint first_color;                //  12 First float of what its points have: three floats of colour each, or, with a texture, their two places in it; NONE where they have neither.
    uint first_slot;                 //  16 First slot of the object.
    uint polynomial;                 //  20 FIT_FULL or FIT_INCOMPLETE: what refinement fits first.
    uint max_iterations;             //  24 Of the refinement; 0: hits are taken as they are.
    float tolerance;                 //  28 Of the refinement, over h.
    uint slot_count;                 //  32 Slots that carry the object's surface; its spheres and discs come after these.
    float weight_scale;              //  36 h over the width of the weights; of a cloud, the mean cosine of the angle that it scatters by.
    uint blends;                     //  40 1: normals are blended over the polynomials around a hit.
    uint texture;                    //  44 An image, or NONE.
    vec4 texture_u;                  //  48 Column over width at x is dot(xyz, x) + w, where points have no places in the texture.
    vec4 texture_v;                  //  64 Row over height.
    vec3 ior;                        //  80 Refractive index of glass, by channel.
    uint material;                   //  92 One of MATERIAL_*.
    vec3 absorption;                 //  96 Of glass: σ, per unit of length.
    int priority;                    // 108 Of glass: the highest counts where media overlap.
};

#ifdef TEXELS
ObjectInfo object_info_from(usamplerBuffer texels, int first) {
    uvec4 t0 = texelFetch(texels, first + 0);
    uvec4 t1 = texelFetch(texels, first + 1);
    uvec4 t2 = texelFetch(texels, first + 2);
    uvec4 t3 = texelFetch(texels, first + 3);
    uvec4 t4 = texelFetch(texels, first + 4);
    uvec4 t5 = texelFetch(texels, first + 5);
    uvec4 t6 = texelFetch(texels, first + 6);
    return ObjectInfo(uintBitsToFloat(t0.xyz), t0.w, t1.x, t1.y, t1.z, uintBitsToFloat(t1.w), t2.x, uintBitsToFloat(t2.y), t2.z, t2.w, uintBitsToFloat(t3), uintBitsToFloat(t4), uintBitsToFloat(t5.xyz), t5.w, uintBitsToFloat(t6.xyz), int(t6.w));
}
#endif

// One light.
struct Light { // 32 bytes
    vec3 vector;                     //   0 Unit vector towards a directional light; a point light's position, centred scene space.
    uint kind;                       //  12 One of LIGHT_*.
    vec3 strength;                   //  16 Irradiance on a surface facing it, or intensity.
    float extent;                    //  28 Sine of half the angle of a directional light; a point light's radius. 0: it is hard.
};

// What a ray has behind it.
struct Path { // 80 bytes
    vec3 throughput;                 //   0 What of the light it finds arrives at the pixel.
    uint pixel;                      //  12 Pixel of the tile, row by row; NONE: no ray at all.
    uint channels;                   //  16 Bits of CHANNELS_ALL: 1 red, 2 green, 4 blue; and PATH_*.
    uint bounces;                    //  20 Interactions with surfaces so far.
    uint crossings;                  //  24 Surfaces passed through so far that did not change its medium.
    uint media_count;                //  28 Objects that it is inside.
    uint media[8];                   //  32 Those, 16 bits each, in no order.
    vec3 emitted;                    //  64 What volumes on its way have sent to the pixel.
    float depth;                     //  76 Optical depth of the volumes on its way so far, which is no part of the throughput. Where light goes from surface to surface it is; then this is the share of the background that the path counts (LIGHTING_PATH).
};

#ifdef TEXELS
Path path_from(usamplerBuffer texels, int first) {
    uvec4 t0 = texelFetch(texels, first + 0);
    uvec4 t1 = texelFetch(texels, first + 1);
    uvec4 t2 = texelFetch(texels, first + 2);
    uvec4 t3 = texelFetch(texels, first + 3);
    uvec4 t4 = texelFetch(texels, first + 4);
    return Path(uintBitsToFloat(t0.xyz), t0.w, t1.x, t1.y, t1.z, t1.w, uint[](t2.x, t2.y, t2.z, t2.w, t3.x, t3.y, t3.z, t3.w), uintBitsToFloat(t4.xyz), uintBitsToFloat(t4.w));
}
#endif

// Light at a lit hit.
struct LightSum { // 32 bytes
    vec3 sum;                        //   0 Irradiance by the lights before the last, each by its cosine.
    uint pad;                        //  12 Unused.
    vec3 arriving;                   //  16 What the last would add, were nothing in the way.
    uint pad_end;                    //  28 Unused.
};

// Push constants of shadow_meet and shadow_go_on.
struct ShadowParams { // 52 bytes
    uint ray_count;                  //   0 Shadow rays.
    uint passed;                     //   4 Object whose surface is not there, or NONE.
    uint counts;                     //   8 1: the work of rays is counted in the film.
    uint lamp_count;                 //  12 Objects that the light may be inside; NONE: it is not known which.
    uint tints;                      //  16 1: the light goes straight on through glass; 0: only between media of one index.
    uint lamp_media[8];              //  20 What the light may be inside, 16 bits each.
};

#define CAMERA_PATH 62 // The path of every ray from the camera, but for its pixel

#define PATHS 63 // Of the rays of the wave, by ray
#ifdef TEXELS
layout(binding = PATHS) uniform usamplerBuffer path_texels;

Path path_at(uint at) {
    return path_from(path_texels, int(5u * at));
}

vec3 path_throughput_at(uint at) {
    return uintBitsToFloat(texelFetch(path_texels, int(5u * at)).xyz);
}

uint path_pixel_at(uint at) {
    return texelFetch(path_texels, int(5u * at)).w;
}

uint path_channels_at(uint at) {
    return texelFetch(path_texels, int(5u * at) + 1).x;
}

uint path_bounces_at(uint at) {
    return texelFetch(path_texels, int(5u * at) + 1).y;
}

uint path_crossings_at(uint at) {
    return texelFetch(path_texels, int(5u * at) + 1).z;
}

uint path_media_count_at(uint at) {
    return texelFetch(path_texels, int(5u * at) + 1).w;
}

uint path_media_at(uint at, uint i) {
    return texelFetch(path_texels, int(5u * at) + int((8u + i) / 4u))[(8u + i) & 3u];
}

vec3 path_emitted_at(uint at) {
    return uintBitsToFloat(texelFetch(path_texels, int(5u * at) + 4).xyz);
}

float path_depth_at(uint at) {
    return uintBitsToFloat(texelFetch(path_texels, int(5u * at) + 4).w);
}
#else
layout(std430, binding = PATHS) readonly buffer PathList { Path path_list[]; };

Path path_at(uint at) {
    return path_list[at];
}

vec3 path_throughput_at(uint at) {
    return path_list[at].throughput;
}

uint path_pixel_at(uint at) {
    return path_list[at].pixel;
}

uint path_channels_at(uint at) {
    return path_list[at].channels;
}

uint path_bounces_at(uint at) {
    return path_list[at].bounces;
}

uint path_crossings_at(uint at) {
    return path_list[at].crossings;
}

uint path_media_count_at(uint at) {
    return path_list[at].media_count;
}

uint path_media_at(uint at, uint i) {
    return path_list[at].media[i];
}

vec3 path_emitted_at(uint at) {
    return path_list[at].emitted;
}

float path_depth_at(uint at) {
    return path_list[at].depth;
}
#endif

#define NEXT_PATHS 64 // Of the rays of the next wave

#define SHADOW_PATHS 65 // Of shadow rays, where light may pass surfaces

#define LIT_MARKS 66 // Marks of the rays that hit a surface that lamps light

#define LIT_RAYS 67 // Those rays
#ifdef TEXELS
layout(binding = LIT_RAYS) uniform usamplerBuffer lit_ray_texels;

uint lit_ray_at(uint at) {
    return texelFetch(lit_ray_texels, int(at)).x;
}
#else
layout(std430, binding = LIT_RAYS) readonly buffer LitRayList { uint lit_ray_list[]; };

uint lit_ray_at(uint at) {
    return lit_ray_list[at];
}
#endif

#define LIT_HITS 68 // Where each did, by ray
#ifdef TEXELS
layout(binding = LIT_HITS) uniform usamplerBuffer lit_hit_texels;

LitHit lit_hit_at(uint at) {
    return lit_hit_from(lit_hit_texels, int(2u * at));
}

vec3 lit_hit_position_at(uint at) {
    return uintBitsToFloat(texelFetch(lit_hit_texels, int(2u * at)).xyz);
}

uint lit_hit_slot_at(uint at) {
    return texelFetch(lit_hit_texels, int(2u * at)).w;
}

vec3 lit_hit_normal_at(uint at) {
    return uintBitsToFloat(texelFetch(lit_hit_texels, int(2u * at) + 1).xyz);
}

uint lit_hit_view_at(uint at) {
    return texelFetch(lit_hit_texels, int(2u * at) + 1).w;
}
#else
layout(std430, binding = LIT_HITS) readonly buffer LitHitList { LitHit lit_hit_list[]; };

LitHit lit_hit_at(uint at) {
    return lit_hit_list[at];
}

vec3 lit_hit_position_at(uint at) {
    return lit_hit_list[at].position;
}

uint lit_hit_slot_at(uint at) {
    return lit_hit_list[at].slot;
}

vec3 lit_hit_normal_at(uint at) {
    return lit_hit_list[at].normal;
}

uint lit_hit_view_at(uint at) {
    return lit_hit_list[at].view;
}
#endif

#define LIGHT_SUMS 69 // What the lights send to those hits, and what the light of now would

#define SCATTERING_MARKS 70 // Marks of the rays that hit a surface that sends rays on

#define SCATTERING_RAYS 71 // Those rays
#ifdef TEXELS
layout(binding = SCATTERING_RAYS) uniform usamplerBuffer scattering_ray_texels;

uint scattering_ray_at(uint at) {
    return texelFetch(scattering_ray_texels, int(at)).x;
}
#else
layout(std430, binding = SCATTERING_RAYS) readonly buffer ScatteringRayList { uint scattering_ray_list[]; };

uint scattering_ray_at(uint at) {
    return scattering_ray_list[at];
}
#endif

#define NEXT_MARKS 72 // Two marks a ray, for the rays of the next wave that it makes
#ifdef TEXELS
layout(binding = NEXT_MARKS) uniform usamplerBuffer next_mark_texels;

uvec2 next_mark_at(uint at) {
    return texelFetch(next_mark_texels, int(at)).xy;
}
#else
layout(std430, binding = NEXT_MARKS) readonly buffer NextMarkList { uvec2 next_mark_list[]; };

uvec2 next_mark_at(uint at) {
    return next_mark_list[at];
}
#endif

#define NEXT_OFFSETS 73 // Where the rays that those of each word of marks make begin in the next wave
#ifdef TEXELS
layout(binding = NEXT_OFFSETS) uniform usamplerBuffer next_offset_texels;

uint next_offset_at(uint at) {
    return texelFetch(next_offset_texels, int(at)).x;
}
#else
layout(std430, binding = NEXT_OFFSETS) readonly buffer NextOffsetList { uint next_offset_list[]; };

uint next_offset_at(uint at) {
    return next_offset_list[at];
}
#endif

#define TALLY 74 // Counts of rays

#define OBJECTS 75 // By object
#ifdef TEXELS
layout(binding = OBJECTS) uniform usamplerBuffer object_texels;

ObjectInfo object_at(uint at) {
    return object_info_from(object_texels, int(7u * at));
}

vec3 object_albedo_at(uint at) {
    return uintBitsToFloat(texelFetch(object_texels, int(7u * at)).xyz);
}

uint object_first_color_at(uint at) {
    return texelFetch(object_texels, int(7u * at)).w;
}

uint object_first_slot_at(uint at) {
    return texelFetch(object_texels, int(7u * at) + 1).x;
}

uint object_polynomial_at(uint at) {
    return texelFetch(object_texels, int(7u * at) + 1).y;
}

uint object_max_iterations_at(uint at) {
    return texelFetch(object_texels, int(7u * at) + 1).z;
}

float object_tolerance_at(uint at) {
    return uintBitsToFloat(texelFetch(object_texels, int(7u * at) + 1).w);
}

uint object_slot_count_at(uint at) {
    return texelFetch(object_texels, int(7u * at) + 2).x;
}

float object_weight_scale_at(uint at) {
    return uintBitsToFloat(texelFetch(object_texels, int(7u * at) + 2).y);
}

uint object_blends_at(uint at) {
    return texelFetch(object_texels, int(7u * at) + 2).z;
}

uint object_texture_at(uint at) {
    return texelFetch(object_texels, int(7u * at) + 2).w;
}

vec4 object_texture_u_at(uint at) {
    return uintBitsToFloat(texelFetch(object_texels, int(7u * at) + 3));
}

vec4 object_texture_v_at(uint at) {
    return uintBitsToFloat(texelFetch(object_texels, int(7u * at) + 4));
}

vec3 object_ior_at(uint at) {
    return uintBitsToFloat(texelFetch(object_texels, int(7u * at) + 5).xyz);
}

uint object_material_at(uint at) {
    return texelFetch(object_texels, int(7u * at) + 5).w;
}

vec3 object_absorption_at(uint at) {
    return uintBitsToFloat(texelFetch(object_texels, int(7u * at) + 6).xyz);
}

int object_priority_at(uint at) {
    return int(texelFetch(object_texels, int(7u * at) + 6).w);
}
#else
layout(std430, binding = OBJECTS) readonly buffer ObjectList { ObjectInfo object_list[]; };

ObjectInfo object_at(uint at) {
    return object_list[at];
}

vec3 object_albedo_at(uint at) {
    return object_list[at].albedo;
}

uint object_first_color_at(uint at) {
    return object_list[at].first_color;
}

uint object_first_slot_at(uint at) {
    return object_list[at].first_slot;
}

uint object_polynomial_at(uint at) {
    return object_list[at].polynomial;
}

uint object_max_iterations_at(uint at) {
    return object_list[at].max_iterations;
}

float object_tolerance_at(uint at) {
    return object_list[at].tolerance;
}

uint object_slot_count_at(uint at) {
    return object_list[at].slot_count;
}

float object_weight_scale_at(uint at) {
    return object_list[at].weight_scale;
}

uint object_blends_at(uint at) {
    return object_list[at].blends;
}

uint object_texture_at(uint at) {
    return object_list[at].texture;
}

vec4 object_texture_u_at(uint at) {
    return object_list[at].texture_u;
}

vec4 object_texture_v_at(uint at) {
    return object_list[at].texture_v;
}

vec3 object_ior_at(uint at) {
    return object_list[at].ior;
}

uint object_material_at(uint at) {
    return object_list[at].material;
}

vec3 object_absorption_at(uint at) {
    return object_list[at].absorption;
}

int object_priority_at(uint at) {
    return object_list[at].priority;
}
#endif

#define COLORS 76 // Three floats a point, or two: a place in a texture

#define LIGHTS 77 // The lamps of the scene

#define IMAGES 78 // Textures and the environment

#define TEXELS_OF_IMAGES 79 // A table of sRGB, and the texels of all images

#define ENVIRONMENT_TABLE 80 // Where the environment is bright
#endif
