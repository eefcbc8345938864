//! What a scene needs: the bits of the specialization constants 0 and 1 (scene.glsl). Drivers leave out what it has not.

use super::stage;

stage! {
    #![doc = "What a scene needs: the bits of the specialization constants 0 and 1 (scene.glsl). Drivers leave out what it has not."]
    "scene" needs []
    constants {
        /// Of the constant that kernels are specialized by: rays that hit nothing see an image.
        SCENE_ENVIRONMENT = 1;
        /// Normals of an object are blended.
        SCENE_BLENDS = 2;
        /// There is light, and `shade` writes the colours of lit hits.
        SCENE_LIGHTS = 4;
        /// What each channel lets through is written.
        SCENE_ALPHA = 8;
        /// Cells crossed, points hit and iterations are written.
        SCENE_DIAGNOSTICS = 16;
        /// Points of an object have colours, or places in a texture.
        SCENE_VALUES = 32;
        /// An object has a texture.
        SCENE_TEXTURES = 64;
        /// A pixel has several samples.
        SCENE_SAMPLES = 128;
        /// Hits of an object are refined.
        SCENE_REFINES = 256;
        /// Lights light the surface of an object.
        SCENE_LIT = 512;
        /// Rays go on from one.
        SCENE_SCATTERS = 1024;
        /// Several objects are of glass, and rays may be inside more than one.
        SCENE_NESTED = 2048;
        /// Glass has indices by channel, and rays become three.
        SCENE_DISPERSES = 4096;
        /// Glass absorbs.
        SCENE_ABSORBS = 8192;
        /// Whether glass reflects or refracts is drawn.
        SCENE_CHANCE = 16384;
        /// Paths carry what volumes emit.
        SCENE_VOLUMES = 32768;
        /// More than one light.
        SCENE_MANY_LIGHTS = 65536;
        /// Rays leave empty cells together.
        SCENE_SKIPS = 131_072;
        /// Bit of the specialization constant `SCENE`: the scene has several grids.
        SCENE_LEVELS = 262_144;
        /// Some points are drawn as spheres or discs.
        SCENE_SHAPES = 524_288;
        /// Some are drawn as spheres.
        SCENE_SPHERES = 1_048_576;
        /// The environment is turned.
        SCENE_TURNED = 2_097_152;
        /// Glass may meet a medium of its own index.
        SCENE_CLEAR = 4_194_304;
        /// Points of a volume have weights, Eq. 3 or their sum.
        SCENE_WEIGHTS = 8_388_608;
        /// Or smoothing lengths.
        SCENE_PARTICLES = 16_777_216;
        /// More than one.
        SCENE_MANY_VOLUMES = 33_554_432;
        /// One scalar stands for the whole way of a ray.
        SCENE_WHOLES = 67_108_864;
        /// A transfer function has an emission.
        SCENE_GLOWS = 134_217_728;
        /// Where half of the light is lost is asked for.
        SCENE_DEPTHS = 268_435_456;
        /// Lights light a surface that scatters by another law than Lambert's, or from which rays go on.
        SCENE_GLOSSY = 536_870_912;
        /// A transfer function is steep, and steps may be divided.
        SCENE_STEEP = 1_073_741_824;
        /// A volume has grids by size.
        SCENE_SIZES = 2_147_483_648;
        /// Of the specialization constant 1: the background lights what rays hit, and how bright it is decides where rays look
        /// for its light.
        LIGHTING_TABLE = 1;
        /// Light goes from surface to surface.
        LIGHTING_PATH = 2;
        /// The background lights what rays hit.
        LIGHTING_SKY = 4;
        /// Rays that surfaces send on may meet lamps with an extent.
        LIGHTING_LAMPS = 8;
        /// A sun stands in the background.
        LIGHTING_SUN = 16;
        /// What has come over several surfaces is limited.
        LIGHTING_CLAMP = 32;
        /// Volumes scatter rays.
        LIGHTING_SCATTERS = 64;
        /// They do so to some sides more than to others.
        LIGHTING_ANISOTROPY = 128;
    }
    bindings after [film] {
    }
    structs {
    }
}
