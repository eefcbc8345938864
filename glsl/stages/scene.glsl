// scene: what a scene needs: the bits of the specialization constants 0 and 1 (scene.glsl). Drivers leave out what it has not.
//
// Made from crates/kernels/src/layout/scene.rs by compile-kernels: change that.
#ifndef STAGE_SCENE_GLSL
#define STAGE_SCENE_GLSL

#define SCENE_ENVIRONMENT 1 // Of the constant that kernels are specialized by: rays that hit nothing see an image
#define SCENE_BLENDS 2 // Normals of an object are blended
#define SCENE_LIGHTS 4 // There is light, and shade writes the colours of lit hits
#define SCENE_ALPHA 8 // What each channel lets through is written
#define SCENE_DIAGNOSTICS 16 // Cells crossed, points hit and iterations are written
#define SCENE_VALUES 32 // Points of an object have colours, or places in a texture
#define SCENE_TEXTURES 64 // An object has a texture
#define SCENE_SAMPLES 128 // A pixel has several samples
#define SCENE_REFINES 256 // Hits of an object are refined
#define SCENE_LIT 512 // Lights light the surface of an object
#define SCENE_SCATTERS 1024 // Rays go on from one
#define SCENE_NESTED 2048 // Several objects are of glass, and rays may be inside more than one
#define SCENE_DISPERSES 4096 // Glass has indices by channel, and rays become three
#define SCENE_ABSORBS 8192 // Glass absorbs
#define SCENE_CHANCE 16384 // Whether glass reflects or refracts is drawn
#define SCENE_VOLUMES 32768 // Paths carry what volumes emit
#define SCENE_MANY_LIGHTS 65536 // More than one light
#define SCENE_SKIPS 131072 // Rays leave empty cells together
#define SCENE_LEVELS 262144 // Bit of the specialization constant SCENE: the scene has several grids
#define SCENE_SHAPES 524288 // Some points are drawn as spheres or discs
#define SCENE_SPHERES 1048576 // Some are drawn as spheres
#define SCENE_TURNED 2097152 // The environment is turned
#define SCENE_CLEAR 4194304 // Glass may meet a medium of its own index
#define SCENE_WEIGHTS 8388608 // Points of a volume have weights, Eq. 3 or their sum
#define SCENE_PARTICLES 16777216 // Or smoothing lengths
#define SCENE_MANY_VOLUMES 33554432 // More than one
#define SCENE_WHOLES 67108864 // One scalar stands for the whole way of a ray
#define SCENE_GLOWS 134217728 // A transfer function has an emission
#define SCENE_DEPTHS 0x10000000u // Where half of the light is lost is asked for
#define SCENE_GLOSSY 0x20000000u // Lights light a surface that scatters by another law than Lambert's, or from which rays go on
#define SCENE_STEEP 0x40000000u // A transfer function is steep, and steps may be divided
#define SCENE_SIZES 0x80000000u // A volume has grids by size
#define LIGHTING_TABLE 1 // Of the specialization constant 1: the background lights what rays hit, and how bright it is decides where rays look for its light
#define LIGHTING_PATH 2 // Light goes from surface to surface
#define LIGHTING_SKY 4 // The background lights what rays hit
#define LIGHTING_LAMPS 8 // Rays that surfaces send on may meet lamps with an extent
#define LIGHTING_SUN 16 // A sun stands in the background
#define LIGHTING_CLAMP 32 // What has come over several surfaces is limited
#define LIGHTING_SCATTERS 64 // Volumes scatter rays
#define LIGHTING_ANISOTROPY 128 // They do so to some sides more than to others
#endif
