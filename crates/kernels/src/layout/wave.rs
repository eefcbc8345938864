//! The rays of one generation: what they have behind them, what they met, what lights it.

use super::discs::DepthRanks;
use super::stage;
use super::tree::TreeInfo;

stage! {
    #![doc = "The rays of one generation: what they have behind them, what they met, what lights it."]
    "wave" needs ["discs", "tree"]
    constants {
        /// Words of a path's set of media: two media each.
        MEDIA_WORDS = 8;
        /// Bit of [`ObjectInfo::material`]: lights of the scene light the surface.
        MATERIAL_LIT = 256;
        /// Bit: rays go on from it.
        MATERIAL_SENDS = 512;
        /// Bit: it encloses a medium, which rays are inside or outside.
        MATERIAL_INSIDE = 1024;
        /// [`ObjectInfo::material`] of Lambert's law: the number of the kind, and its bits.
        MATERIAL_DIFFUSE = MATERIAL_LIT;
        /// [`ObjectInfo::material`] of a perfect mirror.
        MATERIAL_MIRROR = 1 | MATERIAL_SENDS;
        /// [`ObjectInfo::material`] of smooth glass.
        MATERIAL_GLASS = 2 | MATERIAL_SENDS | MATERIAL_INSIDE;
        /// [`ObjectInfo::material`] of Lambert's law where light goes on from surface to surface.
        MATERIAL_MATTE = 3 | MATERIAL_LIT | MATERIAL_SENDS;
        /// Of a volume that scatters light where it goes on.
        MATERIAL_CLOUD = 4 | MATERIAL_LIT | MATERIAL_SENDS;
        /// Surfaces that a path may pass through that do not change its medium.
        MOST_CROSSINGS = 1024;
        /// [`Path::channels`] of a ray that carries all three.
        CHANNELS_ALL = 7;
        /// Bit beside them: the path was reflected somewhere.
        PATH_REFLECTED = 8;
        /// Bit: surfaces on its way were lit, so that what it brings is added to what the pixel has.
        PATH_ADDS = 16;
        /// Bit: the last thing on its way scattered it to all sides, and has asked the lamps and, by its brightness, the
        /// background for light.
        PATH_SCATTERED = 32;
        /// Bit: something on its way before the last did.
        PATH_INDIRECT = 64;
        /// Paths may end by chance from this bounce on.
        FIRST_CHANCE = 2;
        /// [`WaveParams::transparent`]: camera rays leave the background out.
        TRANSPARENT_CAMERA = 1;
        /// [`WaveParams::transparent`]: and so do rays that were only refracted.
        TRANSPARENT_GLASS = 2;
        /// [`WaveParams::flags`]: rays come from the camera.
        WAVE_FROM_CAMERA = 1;
        /// [`WaveParams::flags`]: all rays have the camera's path, but for the pixel.
        WAVE_SHARES_PATH = 2;
        /// [`WaveParams::flags`]: of paths that have shown no scalar of a volume yet, the next part of the way does.
        WAVE_VALUES = 4;
        /// [`WaveParams::flags`]: of paths that have lost no light to volumes yet, the next part of the way says where it is.
        WAVE_LOSSES = 8;
        /// An image of red, green, blue in sRGB, a byte each, from the lowest byte of a word on.
        IMAGE_SRGB8 = 0;
        /// An image of red, green, blue as three floats, linear.
        IMAGE_LINEAR = 1;
        /// A light infinitely far away.
        LIGHT_DIRECTIONAL = 0;
        /// A light at a point.
        LIGHT_POINT = 1;
        /// The background, whose light surfaces look for by how they scatter it.
        LIGHT_SKY = 2;
        /// The same by how bright it is.
        LIGHT_ENVIRONMENT = 3;
        /// As directional, the sun in the background, which rays that are not scattered see there.
        LIGHT_SUN = 4;
        /// Of the images after an environment: three rows of the matrix that turns it, and two of its sun: the
        /// direction towards it and the square of the sine of its radius; its radiance.
        IMAGES_OF_TURN = 3;
    }
    bindings after [rays] {
        /// The path of every ray from the camera, but for its pixel.
        CAMERA_PATH: Path;
        /// Of the rays of the wave, by ray.
        PATHS: Path as path;
        /// Of the rays of the next wave.
        NEXT_PATHS: Path;
        /// Of shadow rays, where light may pass surfaces.
        SHADOW_PATHS: Path;
        /// Marks of the rays that hit a surface that lamps light.
        LIT_MARKS: u32;
        /// Those rays.
        LIT_RAYS: u32 as lit_ray;
        /// Where each did, by ray.
        LIT_HITS: LitHit as lit_hit;
        /// What the lights send to those hits, and what the light of now would.
        LIGHT_SUMS: LightSum;
        /// Marks of the rays that hit a surface that sends rays on.
        SCATTERING_MARKS: u32;
        /// Those rays.
        SCATTERING_RAYS: u32 as scattering_ray;
        /// Two marks a ray, for the rays of the next wave that it makes.
        NEXT_MARKS: [u32; 2] as next_mark;
        /// Where the rays that those of each word of marks make begin in the next wave.
        NEXT_OFFSETS: u32 as next_offset;
        /// Counts of rays.
        TALLY: u32;
        /// By object.
        OBJECTS: ObjectInfo as object;
        /// Three floats a point, or two: a place in a texture.
        COLORS: f32;
        /// The lamps of the scene.
        LIGHTS: Light;
        /// Textures and the environment.
        IMAGES: ImageInfo;
        /// A table of sRGB, and the texels of all images.
        TEXELS_OF_IMAGES: u32;
        /// Where the environment is bright.
        ENVIRONMENT_TABLE: f32;
    }
    structs {
        /// What rays that hit nothing see.
        BackgroundInfo {
            /// Linear RGB.
            color: [f32; 3],
            /// An image instead, or `NONE`.
            environment: u32,
        }
        /// A hit on a lit surface, where light is asked for.
        LitHit {
            /// Centred scene space.
            position: [f32; 3],
            /// The point hit.
            slot: u32,
            /// Unit normal facing the ray's origin.
            normal: [f32; 3],
            /// The way that the ray came (`packed_direction`), where `SCENE_GLOSSY`.
            view: u32,
        }
        /// Push constants of the kernels that scatter and shade the rays of a wave.
        WaveParams {
            /// Unit vector of the viewing axis.
            forward: [f32; 3],
            /// Rays of the wave; for `shadow_rays` and `shade`, hits on lit surfaces.
            ray_count: u32,
            /// What rays that hit nothing see.
            background: BackgroundInfo,
            /// The tile's first pixel in the full image.
            tile_origin: [u32; 2],
            /// Columns and rows of the tile.
            tile_size: [u32; 2],
            /// `WAVE_*`.
            flags: u32,
            /// Interactions after the primary hit.
            max_bounces: u32,
            /// 1: glass reflects or refracts at random; 0: it refracts.
            fresnel: u32,
            /// Of everything random.
            seed: u32,
            /// The light that shadow rays go to now.
            light: u32,
            /// Lights of the scene.
            light_count: u32,
            /// Which sample of each pixel; `NONE` where there is only one, and lights have no extent.
            sample_index: u32,
            /// What leaves the background out: one of `TRANSPARENT_*`, or 0 for nothing.
            transparent: u32,
            /// The most radiance of what has come over several surfaces.
            clamp: f32,
            /// The samples of a pixel are at most 2 to this power.
            sample_bits: u32,
            /// Unused.
            pad: [u32; 2],
        }
        /// Push constants of `camera_trace`.
        CameraTraceParams {
            /// As in [`CameraParams`], as are the next six.
            eye: [f32; 3],
            /// Half the view's height over half the rows.
            scale: f32,
            /// Unit vector.
            right: [f32; 3],
            /// Of the full image, in pixels.
            half_width: f32,
            /// Unit vector.
            up: [f32; 3],
            /// Of the full image, in pixels.
            half_height: f32,
            /// Unit vector of the viewing axis.
            forward: [f32; 3],
            /// Loop iterations a ray may spend.
            work: u32,
            /// The tile's first pixel in the full image.
            tile_origin: [u32; 2],
            /// Columns and rows of the tile.
            tile_size: [u32; 2],
            /// What rays that hit nothing see.
            background: BackgroundInfo,
            /// How pairs of a screen tile are ordered.
            ranks: DepthRanks,
            /// What leaves the background out: one of `TRANSPARENT_*`, or 0 for nothing.
            transparent: u32,
            /// Interactions after the primary hit.
            max_bounces: u32,
            /// The tree's, where rays go through it.
            tree: TreeInfo,
        }
        /// An image whose texels lie in rows, the top row first. After that of an environment come three whose first three
        /// words are the bits of a row of the matrix that turns it.
        ImageInfo {
            /// Word of its first texel among all texels.
            first: u32,
            /// Columns.
            width: u32,
            /// Rows.
            height: u32,
            /// One of `IMAGE_*`.
            format: u32,
        }
        /// What shading needs of an object.
        ObjectInfo {
            /// Linear RGB, where the points' colours do not count; what rays that go on keep of their light.
            albedo: [f32; 3],
            /// First float of what its points have: three floats of colour each, or, with a texture, their two
            /// places in it; `NONE` where they have neither.
            first_color: u32,
            /// First slot of the object.
            first_slot: u32,
            /// `FIT_FULL` or `FIT_INCOMPLETE`: what refinement fits first.
            polynomial: u32,
            /// Of the refinement; 0: hits are taken as they are.
            max_iterations: u32,
            /// Of the refinement, over h.
            tolerance: f32,
            /// Slots that carry the object's surface; its spheres and discs come after these.
            slot_count: u32,
            /// h over the width of the weights; of a cloud, the mean cosine of the angle that it scatters by.
            weight_scale: f32,
            /// 1: normals are blended over the polynomials around a hit.
            blends: u32,
            /// An image, or `NONE`.
            texture: u32,
            /// Column over width at x is dot(xyz, x) + w, where points have no places in the texture.
            texture_u: [f32; 4],
            /// Row over height.
            texture_v: [f32; 4],
            /// Refractive index of glass, by channel.
            ior: [f32; 3],
            /// One of `MATERIAL_*`.
            material: u32,
            /// Of glass: σ, per unit of length.
            absorption: [f32; 3],
            /// Of glass: the highest counts where media overlap.
            priority: i32,
        }
        /// One light.
        Light {
            /// Unit vector towards a directional light; a point light's position, centred scene space.
            vector: [f32; 3],
            /// One of `LIGHT_*`.
            kind: u32,
            /// Irradiance on a surface facing it, or intensity.
            strength: [f32; 3],
            /// Sine of half the angle of a directional light; a point light's radius. 0: it is hard.
            extent: f32,
        }
        /// What a ray has behind it.
        Path {
            /// What of the light it finds arrives at the pixel.
            throughput: [f32; 3],
            /// Pixel of the tile, row by row; `NONE`: no ray at all.
            pixel: u32,
            /// Bits of `CHANNELS_ALL`: 1 red, 2 green, 4 blue; and `PATH_*`.
            channels: u32,
            /// Interactions with surfaces so far.
            bounces: u32,
            /// Surfaces passed through so far that did not change its medium.
            crossings: u32,
            /// Objects that it is inside.
            media_count: u32,
            /// Those, 16 bits each, in no order.
            media: [u32; MEDIA_WORDS as usize],
            /// What volumes on its way have sent to the pixel.
            emitted: [f32; 3],
            /// Optical depth of the volumes on its way so far, which is no part of the throughput. Where light goes from surface
            /// to surface it is; then this is the share of the background that the path counts (`LIGHTING_PATH`).
            depth: f32,
        }
        /// Light at a lit hit.
        LightSum {
            /// Irradiance by the lights before the last, each by its cosine.
            sum: [f32; 3],
            /// Unused.
            pad: u32,
            /// What the last would add, were nothing in the way.
            arriving: [f32; 3],
            /// Unused.
            pad_end: u32,
        }
        /// Push constants of `shadow_meet` and `shadow_go_on`.
        ShadowParams {
            /// Shadow rays.
            ray_count: u32,
            /// Object whose surface is not there, or `NONE`.
            passed: u32,
            /// 1: the work of rays is counted in the film.
            counts: u32,
            /// Objects that the light may be inside; `NONE`: it is not known which.
            lamp_count: u32,
            /// 1: the light goes straight on through glass; 0: only between media of one index.
            tints: u32,
            /// What the light may be inside, 16 bits each.
            lamp_media: [u32; MEDIA_WORDS as usize],
        }
    }
}
