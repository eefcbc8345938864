//! The plan of a render: plain data made before a device is touched.
//!
//! A checked scene and its point sets go in; centred points, kernel parameters, lights, colours and
//! the tiles of the picture come out. The GPU (`render`) and the CPU (`reference`) execute the same
//! plan, and hand back the same [`layout::FilmPixel`]s for [`Plan::picture`].
#![forbid(unsafe_code)]

mod answers;
mod bulk;
mod camera;
mod chord;
mod chosen;
mod clear;
mod colors;
mod crossings;
mod degrees;
mod denoise;
mod diagnostic;
mod discs;
mod environment;
mod error;
mod extra;
mod field;
mod filter;
mod first_view;
mod frame;
mod framing;
mod ground;
mod header_camera;
mod images;
mod inside;
mod isolated;
mod lighting;
mod lights;
pub mod materials;
mod missing;
mod needs;
mod neighborhoods;
mod nothing;
mod objects;
mod picture;
mod precision;
mod scales;
mod scene_bits;
mod shapes;
mod sky;
mod steep;
mod structure;
mod tiles;
mod transfer;
mod volumes;

pub use camera::View;
pub use chosen::{Choice, Chosen};
pub use degrees::{MapProjection, in_degrees};
pub use denoise::Denoising;
pub use diagnostic::Diagnostic;
pub use discs::{MAX_DISC_PAIRS, screen_tiles};
pub use environment::EnvironmentTable;
pub use error::PlanError;
pub use extra::Extra;
pub use first_view::{SensorView, sensor_view};
pub use header_camera::{HeaderCamera, camera_of_matrices};
pub use images::{Cleaned, SceneImages};
pub use missing::{Lacking, Missing};
pub use needs::{columns as point_columns, filter as point_filter, read_options};
pub use nothing::{Shown, blank, nothing_seen};
pub use picture::{Picture, Rays};
pub use scales::ColorScale;
pub use shapes::{ShapeKind, Shapes, scatter_kind};
pub use structure::{RaysFrom, StructureKind};
pub use tiles::{Window, camera_wave, checked_crop};
pub use volumes::Volumes;

use bulk::Bulk;
use chosen::Findings;
use denoise::denoise;
use frame::{Sight, file_origin};
use images::{ImageList, Use};
use kernels::layout::{
    self, BackgroundInfo, CameraParams, FitParams, ImageInfo, NONE, ObjectInfo, TRANSPARENT_CAMERA,
    TRANSPARENT_GLASS, WAVE_FROM_CAMERA, WaveParams,
};
use lighting::SkyLight;
use lights::local_light;
use objects::{add_image, color_isosurfaces, fit_params, object_infos};
use points::{Apart, Cloud, PointSet, SlotRange, Unwatched, Watch};
use scene::{Fresnel, Scene, Up};
pub use scene::{Integrator, Primary, RayLoop, Secondary, Shadows};
use std::sync::Arc;

/// In place of a sample's number: the ray through a pixel's centre, where there are several samples beside it.
pub const CENTER: u32 = NONE;
/// Everything that a render needs, on any device.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The points of all objects.
    pub cloud: Cloud,
    /// One an object: parameters of `fit_polynomials` over its points that carry a surface, which may be none.
    pub fits: Vec<FitParams>,
    /// Points that are drawn as spheres or discs: the last slots of their objects.
    pub shapes: Vec<Shapes>,
    /// Cells along the grid's longest axis; 0: chosen from the points.
    pub grid_resolution: u32,
    /// Cells a ray may cross in one pass; 0: the device decides. Changes no pixel.
    pub cells_per_pass: u32,
    /// Where the ray state lives. Changes no pixel.
    pub ray_loop: RayLoop,
    /// How camera rays find their first hit. Changes no pixel.
    pub primary: Primary,
    /// How all other rays find theirs. Changes no pixel.
    pub secondary: Secondary,
    /// Rays a pixel; one alone goes through its centre.
    pub samples: u32,
    /// Where the reconstruction filter's integral takes equal steps, in pixels from a pixel's centre.
    pub filter: Vec<f32>,
    /// Parameters of `camera_rays`, but for tile and sample.
    pub camera: CameraParams,
    /// Points of all objects, whether they carry a surface, a volume, or both.
    pub point_count: u64,
    /// Volumes of the scene.
    pub volumes: Volumes,
    /// Objects of glass that rays from the camera start inside of.
    pub camera_media: Vec<u32>,
    /// Parameters of the kernels that scatter and shade, but for the tile and the wave.
    pub wave: WaveParams,
    /// What shading needs of each object.
    pub objects: Vec<ObjectInfo>,
    /// Three floats a point of each object that has colours, two where they are places in a texture,
    /// by slot.
    pub colors: Vec<f32>,
    /// Where the images of the scene lie among the texels.
    pub images: Vec<ImageInfo>,
    /// The linear value of each byte of sRGB; then the texels of all images.
    pub texels: Vec<u32>,
    /// Files of the images as the scene names them, for messages.
    pub image_files: Vec<String>,
    /// Images with pixels that no picture can show.
    pub cleaned: Vec<Cleaned>,
    /// All lights.
    pub lights: Vec<layout::Light>,
    /// Where light comes from.
    pub integrator: Integrator,
    /// The most radiance of what has come over several surfaces.
    pub clamp: Option<f32>,
    /// Where the environment is bright, as kernels take it, if directions are drawn by that; else empty.
    pub environment_table: Vec<f32>,
    sky_lights: bool,
    shows_sun: bool,
    /// What glass does with light on its way; [`Plan::tints`] says so of each light.
    pub shadows: Shadows,
    /// Whether their light passes surfaces, of which there are some: shadow rays go on there.
    pub light_passes: bool,
    /// Of each light the objects of glass that it is, or may be, inside of, where its light passes surfaces; `None` where
    /// that is not asked.
    pub lamp_media: Vec<Option<Vec<u32>>>,
    /// The full image: columns and rows.
    pub image_size: [u32; 2],
    /// What of it is rendered.
    pub window: Window,
    /// Names of the objects, for messages.
    pub names: Vec<String>,
    /// How the objects whose points are in degrees became metres; `None` where there is none.
    pub projection: Option<MapProjection>,
    /// Where steps of 32 bits are coarse beside the distances of points, one sentence an object and cause.
    pub coarse: Vec<String>,
    /// Objects of glass of which it is in doubt whether the eye is inside, one sentence each.
    pub doubts: Vec<String>,
    /// Where steps through volumes are too long for the data, one sentence an object.
    pub long_steps: Vec<String>,
    /// How many isolated points each object lost (`drop_isolated`).
    pub isolated: Vec<u64>,
    /// The strays of each object that has any, by its index.
    pub apart: Vec<(usize, Apart)>,
    /// What was done to objects whose points have noise.
    pub denoised: Vec<Denoising>,
    /// Points that lack what is shown of them.
    pub missing: Vec<Missing>,
    /// Numbers that were chosen where the scene leaves them to the program, object by object.
    pub chosen: Vec<Chosen>,
    /// What the colours of the objects mean that are coloured by a map or a transfer function, in their order.
    pub color_scales: Vec<ColorScale>,
    /// Diagnostics that the film is to have, each at most once. None at first.
    pub diagnostics: Vec<Diagnostic>,
    /// What else the film is to have, each at most once. None at first.
    pub extras: Vec<Extra>,
    /// Whether depth, position, normal, object and diagnostics of the film are wanted. Where a pixel has several samples
    /// they are those of a ray of its own, through the pixel's centre and the lens's. True at first; otherwise they are
    /// the first sample's, and that ray is saved.
    pub aovs: bool,
    transparent: bool,
    channel_alpha: bool,
    sight: Sight,
    provenance: film::Provenance,
}

impl Plan {
    /// Plans a render of `scene`, whose objects have the point sets `sets`, in order, and which names
    /// `images`. `crop` is what of the picture to render, all of it when `None`; `up` turns the view
    /// where the scene has no camera.
    ///
    /// # Panics
    /// Where the scene names an image that is not given.
    ///
    /// # Errors
    /// Points that f32 cannot bear, missing colours or attributes, a crop outside of the picture.
    pub fn new(
        scene: &Scene,
        sets: &[Arc<PointSet>],
        images: &SceneImages,
        crop: Option<Window>,
        up: Up,
    ) -> Result<Self, PlanError> {
        Self::watched(scene, sets, images, crop, up, &Unwatched)
    }

    /// The same for a watcher, who sees how far each stage is and may ask for an end.
    ///
    /// # Panics
    /// As [`Plan::new`].
    ///
    /// # Errors
    /// As [`Plan::new`], and [`PlanError::Interrupted`].
    pub fn watched(
        scene: &Scene,
        sets: &[Arc<PointSet>],
        images: &SceneImages,
        crop: Option<Window>,
        up: Up,
        watch: &dyn Watch,
    ) -> Result<Self, PlanError> {
        assert_eq!(scene.objects.len(), sets.len(), "one point set an object");
        let (metric, projection) = degrees::projected(scene, sets, watch)?;
        let image_size = scene.image.size;
        let window = checked_crop(crop, image_size)?;
        let upwards = framing::upwards(&scene.camera, up).into();
        let mut bulk = Bulk::of(scene, &metric, (sets, upwards), watch)?;
        let mut surface_sets: Vec<Arc<PointSet>> = (0..scene.objects.len())
            .map(|index| {
                volumes::surface_points(&scene.objects[index], bulk.drawn(scene, index), watch)
            })
            .collect::<Result<_, _>>()?;
        watch.stage("sorting points", surface_sets.iter().map(|set| set.len() as u64).sum());
        let mut cloud = bulk.cloud(scene, &surface_sets, watch)?;
        let smoothed = denoise(scene, &bulk, &mut surface_sets, &mut cloud, watch)?;
        for (index, apart) in &mut bulk.apart {
            let own = smoothed.found.iter().find(|denoising| denoising.object == *index);
            apart.is_drawn = own.is_some_and(|denoising| denoising.has_strays);
        }
        let coarse = precision::warnings(scene, sets, &metric, cloud.origin);
        let mut found = Findings::default();
        for (index, edge) in voxel_edges(scene, sets, &smoothed.found) {
            found.number(index, "filter.voxel", edge);
        }
        let volumes = volumes::plan_volumes(scene, &bulk, &cloud, (watch, &mut found))?;
        let mut shapes = shapes::whole_objects(scene, &surface_sets, &cloud, (watch, &mut found))?;
        shapes.extend(smoothed.shapes);
        let surfaces: Vec<SlotRange> = (0..scene.objects.len())
            .map(|index| shapes::surface_slots(&cloud, &shapes, index))
            .collect();
        let fits = (scene.objects.iter().zip(&surfaces).zip(0..))
            .map(|((object, slots), index)| fit_params(object, index, *slots))
            .collect();
        let mut list = ImageList::new();
        let (mut objects, colors) = object_infos(
            scene,
            &surface_sets,
            (&cloud, &surfaces),
            images,
            (&mut list, &mut found),
        )?;
        color_isosurfaces(scene, &volumes, &mut objects);
        objects.extend(volumes.cloud_objects());
        let channel_alpha = objects.iter().any(materials::tells_channels_apart);
        let camera = match scene.camera.whole() {
            Some(camera) => camera,
            None => {
                let subject = bulk.without_grounds(scene);
                let (sets, bounds) = &shapes::with_extents((scene, &shapes), &cloud, &subject);
                framing::complete(
                    &scene.camera,
                    &framing::Subject { sets, bounds: *bounds, image_size, up },
                )?
            }
        };
        let environment = match &scene.background.environment {
            Some(file) => {
                add_image(&mut list, images.environment.as_ref(), file, Use::Environment)?
            }
            None => match environment::made_image(&scene.background, camera.up)? {
                Some((image, name)) => (list.add(&image, name, Use::Environment))
                    .ok_or_else(|| PlanError::TooManyTexels(name.to_owned()))?,
                None => NONE,
            },
        };
        if environment != NONE {
            let turn = environment::turn(camera.up, scene.background.rotate);
            list.infos.extend(environment::rows_of(&turn));
        }
        let known = inside::Known {
            sets: &bulk.sets,
            world: &bulk.world,
            cloud: &cloud,
            shapes: &shapes,
            volumes: &volumes,
        };
        let (camera_media, doubts) = inside::media_of_eye(scene, &known, camera.eye);
        let view = View::new(&camera, image_size, cloud.origin);
        let sight = Sight::new(&camera, image_size);
        let origin = file_origin(cloud.bounds);
        let [world_to_camera, world_to_ndc] = sight.matrices(origin);
        found.chosen.sort_by_key(|chosen| chosen.object);
        let chosen_text = chosen::attribute(&found.chosen);
        let color_scales = scales::of_scene(scene, &volumes, &found.chosen);
        let scene_lights = framing::lights_for(&scene.lights, scene.key_light, &camera);
        let lights = scene_lights.iter().map(|light| local_light(light, &camera, cloud.origin));
        let mut lights: Vec<layout::Light> = lights.collect();
        let sun = environment::sun_of(&scene.background, camera.up)
            .map(|sun| lighting::sun_light(local_light(&sun, &camera, cloud.origin)));
        if let Some(sun) = &sun {
            list.infos.extend(lighting::sun_rows(sun));
        }
        // The sun of a sky is a light where the background lights; headers have it in the background.
        lights.extend(sun.iter().filter(|_| scene.background_lights()));
        let table = (environment != NONE)
            .then(|| EnvironmentTable::of(&list.infos[environment as usize], &list.texels));
        let sky = SkyLight::of(scene, table);
        lights.extend(sky.lights(scene.render.integrator));
        let integrator = scene.render.integrator;
        let may_tint = lights.iter().any(|light| clear::shines_through(light, integrator));
        let shadows = if may_tint { scene.render.shadows } else { Shadows::Opaque };
        let light_passes =
            !lights.is_empty() && clear::lets_light_pass(shadows, &objects, &cloud, &shapes);
        let lamp_media = match light_passes {
            true => inside::media_of_lamps(scene, &known, &lights, (camera.eye, &camera_media)),
            false => vec![None; lights.len()],
        };
        let framed = Scene {
            camera: camera.into(),
            lights: scene_lights,
            key_light: None,
            objects: scene.objects.iter().map(|object| object.with_ground_up(upwards)).collect(),
            ..scene.clone()
        };
        Ok(Self {
            fits,
            shapes,
            grid_resolution: scene.render.grid_resolution.cells(bulk.point_count),
            cells_per_pass: scene.render.cells_per_pass,
            ray_loop: scene.render.ray_loop,
            primary: scene.render.primary,
            secondary: scene.render.secondary,
            point_count: bulk.point_count,
            volumes,
            camera_media,
            samples: scene.image.samples,
            filter: filter::steps(scene.image.filter, scene.image.filter_width),
            camera: CameraParams { seed: scene.render.seed, ..view.params },
            wave: WaveParams {
                forward: view.params.forward,
                ray_count: 0,
                background: BackgroundInfo {
                    color: scene.background.color.map(|c| c as f32),
                    environment,
                },
                transparent: match (scene.image.transparent, channel_alpha) {
                    (false, _) => 0,
                    (true, false) => TRANSPARENT_CAMERA,
                    (true, true) => TRANSPARENT_GLASS,
                },
                tile_origin: [0, 0],
                tile_size: [0, 0],
                flags: WAVE_FROM_CAMERA,
                max_bounces: scene.render.max_bounces,
                fresnel: u32::from(scene.render.fresnel == Fresnel::Sample),
                seed: scene.render.seed,
                light: 0,
                light_count: lights.len() as u32,
                sample_index: NONE,
                clamp: scene.render.clamp.map_or(f32::MAX, |clamp| clamp as f32),
                sample_bits: 0,
                pad: [0; 2],
            },
            objects,
            colors,
            images: list.infos,
            texels: list.texels,
            image_files: list.files,
            cleaned: list.cleaned,
            lights,
            shadows,
            integrator: scene.render.integrator,
            clamp: scene.render.clamp.map(|clamp| clamp as f32),
            environment_table: sky.table,
            sky_lights: sky.lights,
            shows_sun: sun.is_some_and(|sun| sun.extent > 0.0),
            light_passes,
            lamp_media,
            image_size,
            window,
            names: scene.objects.iter().map(|object| object.name.clone()).collect(),
            isolated: bulk.isolated,
            apart: bulk.apart,
            denoised: smoothed.found,
            projection,
            coarse,
            doubts,
            missing: found.missing,
            color_scales,
            chosen: found.chosen,
            long_steps: found.long_steps,
            diagnostics: Vec::new(),
            extras: Vec::new(),
            aovs: true,
            transparent: scene.image.transparent,
            channel_alpha,
            sight,
            provenance: film::Provenance {
                world_to_camera,
                world_to_ndc,
                origin,
                settings: std::iter::once(("scene".to_owned(), framed.settings_toml()))
                    .chain(projection.map(|p| ("projection".to_owned(), p.to_string())))
                    .chain(chosen_text)
                    .collect(),
            },
            cloud,
        })
    }
}

/// The edges of the cubes over which means of an object's points were taken, where nobody gave them: by
/// `filter.voxel`, or of depths in steps.
fn voxel_edges(scene: &Scene, sets: &[Arc<PointSet>], denoised: &[Denoising]) -> Vec<(usize, f64)> {
    let automatic = sets.iter().enumerate().filter_map(|(index, set)| Some((index, set.voxel?)));
    let of_depths = denoised.iter().filter_map(|denoising| match denoising.noise {
        points::Noise::Quantised { edge } => {
            let scale = scene.objects[denoising.object].transform.scale;
            Some((denoising.object, f64::from(edge) / scale))
        }
        _ => None,
    });
    automatic.chain(of_depths).collect()
}
