//! From a path on the command line to a checked scene and its points.

mod reading;
mod units;
mod values;

pub use reading::{note_points, read_file};
pub use units::looks_like_degrees;
pub use values::{SceneValues, check_preset};

use crate::args::ViewArgs;
use crate::camera::CameraOptions;
use crate::errors::Failure;
use crate::point_file::{ColorBy, PointFile};
use crate::progress::Progress;
use crate::{memory, source};
use plan::{Plan, SceneImages, SensorView, Window};
use points::{PointSet, Upwards, Watch};
use reading::same_file;
use scene::{Albedo, ImageFile, Object, Scene, Units, Up};
use std::borrow::Cow;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use units::note_projection;

/// A scene, from a scene file or around a point file.
#[derive(Debug, Clone)]
pub struct Input {
    /// As typed.
    pub path: PathBuf,
    /// What to render.
    pub scene: Scene,
    /// What turns the view where the scene's camera does not say what is up.
    up: Up,
    /// What else the command line says of the camera.
    options: CameraOptions,
    /// Of a point file without a scene.
    point_file: Option<PointFile>,
}

/// What is meant where a crop is of the file's coordinates.
pub const BOX_HINT: &str = "To render only the points in a box of the file's coordinates, use filter.box: \
    --set 'objects.0.filter.box={ min = [X, Y, Z], max = [X, Y, Z] }'";

/// Why `--columns` and this file do not go together.
pub fn columns_of_scene(path: &Path) -> Failure {
    Failure::usage(format!(
        "{}: --columns is for point files, but this is a scene; write [objects.columns] in it",
        path.display()
    ))
}

/// Whether a path is that of a scene, in a file of its own or in the header of a picture, rather than a point file's.
pub fn is_scene_file(path: &Path) -> bool {
    is_toml(path) || is_exr(path)
}

/// Whether a path is a scene file's.
pub fn is_toml(path: &Path) -> bool {
    let is_named_so = |extension: &std::ffi::OsStr| extension.eq_ignore_ascii_case("toml");
    path.extension().is_some_and(is_named_so) || source::is_scene(path)
}

/// Whether a path is that of an EXR, whose header has the scene that it was made from.
fn is_exr(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"))
}

/// The scene that an EXR holds in its header, as TOML, with what an earlier program took for granted.
pub fn scene_of_picture(path: &Path) -> Result<String, Failure> {
    let text = film::exr_text(path, "pointillist/scene")?.ok_or_else(|| {
        Failure::usage(format!(
            "{}: found no scene in its header, which pictures by pointillist have as pointillist/scene; name one of \
             these, a scene file or a point file",
            path.display()
        ))
    })?;
    Ok(scene::settings_of_header(&text).into_owned())
}

/// `--root` is for scenes, and a folder.
fn check_root(root: Option<&Path>, path: &Path) -> Result<(), Failure> {
    let Some(root) = root else { return Ok(()) };
    if !is_scene_file(path) {
        return Err(Failure::usage(format!(
            "{}: --root says where the files of a scene are, but this is a point file; leave it out",
            path.display()
        )));
    }
    if !root.is_dir() {
        return Err(Failure::usage(format!(
            "--root {}: found no such folder, expected the one that the scene's files are in; check the path",
            root.display()
        )));
    }
    Ok(())
}

impl Input {
    /// Loads and checks a scene file, or makes the scene that a point file means. Reads no points.
    pub fn load(path: &Path, values: &SceneValues, view: &ViewArgs) -> Result<Self, Failure> {
        let set = values.as_set();
        let mut options = CameraOptions::new(view, &set)?;
        let set = options.without_height(set)?;
        let turned = options.up.map_or(Up::Y, Up::from);
        let root = values.root.as_deref();
        check_root(root, path)?;
        let loaded = if is_exr(path) {
            Scene::of_picture(&scene_of_picture(path)?, path, &set, root)
        } else if is_scene_file(path) {
            match source::scene_text(path) {
                Some(text) => Scene::load_text(text, path, &set, root),
                None => Scene::load_below(path, &set, root),
            }
        } else {
            Scene::for_point_file(path, turned, values.quality, &set)
        };
        let mut scene = loaded.map_err(|error| values.name_options(error.into()))?;
        options.apply(&mut scene, path, is_scene_file(path))?;
        let point_file = (!is_scene_file(path)).then(|| {
            leave_out_folder(&mut scene, path);
            PointFile {
                values: set,
                quality: values.quality,
                up_is_open: options.up.is_none(),
                color: None,
            }
        });
        Ok(Self { path: path.into(), scene, up: turned, options, point_file })
    }

    /// With `--color`, which is for point files.
    pub fn colored_by(mut self, color: Option<ColorBy>) -> Result<Self, Failure> {
        match (&mut self.point_file, color) {
            (_, None) => {}
            (Some(point_file), color) => point_file.color = color,
            (None, Some(_)) => {
                return Err(Failure::usage(format!(
                    "{}: --color is for point files, but this is a scene; set material.albedo in it",
                    self.path.display()
                )));
            }
        }
        Ok(self)
    }

    /// Whether it is a point file, rendered directly.
    pub fn is_point_file(&self) -> bool {
        self.point_file.is_some()
    }

    /// The exposure of 8-bit files that the header of a picture says, in stops.
    pub fn exposure_of_header(&self) -> Result<Option<f64>, Failure> {
        if !is_exr(&self.path) {
            return Ok(None);
        }
        let text = film::exr_text(&self.path, "pointillist/exposure")?;
        Ok(text.and_then(|text| text.parse().ok()).filter(|stops: &f64| stops.is_finite()))
    }

    /// Which way is up in these points, and why, if anything says so.
    fn found_up(&self, sets: &[Arc<PointSet>]) -> Option<(Upwards, &'static str)> {
        let in_degrees = (self.scene.objects.iter().zip(sets)).any(|(object, set)| {
            object.units == Units::Degrees || matches!(set.units, points::Units::Degrees(_))
        });
        let is_open = self.point_file.as_ref().is_some_and(|file| file.up_is_open)
            && self.scene.camera.up.is_none();
        match in_degrees {
            _ if !is_open => None,
            true => Some((Upwards::Z, "as on maps")),
            false => sets.first().and_then(|set| set.up),
        }
    }

    /// The same as a view is turned by it.
    fn up_of(&self, sets: &[Arc<PointSet>]) -> Up {
        match self.found_up(sets) {
            Some((Upwards::Y, _)) => Up::Y,
            Some((Upwards::Z, _)) => Up::Z,
            Some((Upwards::MinusY, _)) => Up::MinusY,
            None => match self.scene.camera.up {
                Some([x, y, z]) if z > x.abs().max(y.abs()) => Up::Z,
                Some([x, y, z]) if -y > x.abs().max(z.abs()) => Up::MinusY,
                _ => self.up,
            },
        }
    }

    /// The scene, and which way is up in it, now that the points are known.
    fn upright(
        &self,
        sets: &[Arc<PointSet>],
        progress: &Progress,
    ) -> Result<(Cow<'_, Scene>, Up), Failure> {
        let open = self.point_file.as_ref().filter(|point_file| point_file.up_is_open);
        if let (Some(point_file), Some(view)) = (open, plan::sensor_view(&self.scene, sets)) {
            self.note_sensor(&view, progress);
            let values = &point_file.values;
            let quality = point_file.quality;
            let lights = Scene::for_sensor(&self.path, view.axes, quality, values)?.lights;
            let camera = view.camera.into();
            let scene = Scene { lights, key_light: None, camera, ..self.scene.clone() };
            return Ok((Cow::Owned(scene), self.up));
        }
        let (Some(point_file), Some((up, why))) = (&self.point_file, self.found_up(sets)) else {
            return Ok((Cow::Borrowed(&self.scene), self.up));
        };
        let turned = self.up_of(sets);
        if self.scene.camera.whole().is_none() {
            let file = self.path.display();
            let others: Vec<String> = ([Upwards::Y, Upwards::Z, Upwards::MinusY].iter())
                .filter(|other| **other != up)
                .map(|other| format!("--up {}", other.name()))
                .collect();
            let [axis, others] = [up.name().to_owned(), others.join(" or ")];
            progress.note(&format!("{file}: {axis} is up, {why}; {others} says otherwise"));
        }
        let PointFile { values, quality, .. } = point_file;
        let lights = Scene::for_point_file(&self.path, turned, *quality, values)?.lights;
        Ok((Cow::Owned(Scene { lights, ..self.scene.clone() }), turned))
    }

    /// Says that the view is the sensor's, and how there is another.
    fn note_sensor(&self, view: &SensorView, progress: &Progress) {
        let [x, y, z] = view.camera.eye;
        let [across, above] = view.angles;
        progress.note(&format!(
            "{}: one depth image, seen from where its sensor stood, {x} {y} {z}, {across:.0} by {above:.0} degrees; \
             --up y, --up z or --up -y shows it from outside",
            self.path.display()
        ));
    }

    /// Every file that the picture is made from.
    pub fn files(&self) -> Vec<&Path> {
        let points = self.scene.objects.iter().filter(|object| !object.is_ground());
        let points = points.map(|object| object.points.as_path());
        let images = self.images().map(|image| image.path.as_path());
        std::iter::once(self.path.as_path()).chain(points).chain(images).collect()
    }

    /// Every image that the scene names.
    fn images(&self) -> impl Iterator<Item = &ImageFile> {
        let textures = self.scene.objects.iter().filter_map(texture_of);
        self.scene.background.environment.iter().chain(textures)
    }

    /// Reads the images, each file once.
    fn read_images(&self, progress: &Progress) -> Result<SceneImages, Failure> {
        let mut read: HashMap<PathBuf, Arc<film::Image>> = HashMap::new();
        let bytes = |path: &Path| fs::metadata(path).map_or(0, |file| file.len());
        progress.stage("reading images", self.images().map(|image| bytes(&image.path)).sum());
        let mut done = 0;
        for image in self.images() {
            let file = same_file(&image.path);
            if let Entry::Vacant(place) = read.entry(file) {
                place.insert(Arc::new(film::read_image(&image.path)?));
            }
            done += bytes(&image.path);
            progress.done(done);
        }
        progress.clear();
        let image_of = |image: &ImageFile| read.get(&same_file(&image.path)).map(Arc::clone);
        Ok(SceneImages {
            environment: self.scene.background.environment.as_ref().and_then(image_of),
            textures: (self.scene.objects.iter())
                .map(|object| texture_of(object).and_then(image_of))
                .collect(),
        })
    }

    /// Name in tables and statistics.
    pub fn name(&self) -> String {
        self.path.file_stem().unwrap_or(self.path.as_os_str()).to_string_lossy().into_owned()
    }

    /// What of the picture is rendered. Fails where a crop does not lie inside the picture: before
    /// points are read.
    pub fn window(&self, crop: Option<Window>) -> Result<Window, Failure> {
        let size = self.scene.image.size;
        plan::checked_crop(crop, size).map_err(|error| {
            let mut failure = Failure::from(error);
            let lies_outside =
                |crop: Window| crop.origin[0] >= size[0] || crop.origin[1] >= size[1];
            // As whole coordinates of a file do.
            if let (true, Some(line)) = (crop.is_some_and(lies_outside), failure.lines.last_mut()) {
                *line = format!("{line}. {BOX_HINT}");
            }
            failure
        })
    }

    /// Reads the images and plans the render. This checks whatever of the scene depends on its points and
    /// images.
    pub fn plan(
        &self,
        sets: &[Arc<PointSet>],
        crop: Option<Window>,
        progress: &Progress,
    ) -> Result<Plan, Failure> {
        memory::require_points(sets.iter().map(|set| set.len() as u64).sum(), progress)?;
        let images = self.read_images(progress)?;
        self.note_units(sets, progress);
        let (scene, up) = self.upright(sets, progress)?;
        let plan = Plan::watched(&scene, sets, &images, crop, up, progress);
        progress.clear();
        let plan = plan?;
        if let Some(projection) = &plan.projection {
            note_projection(projection, progress);
        }
        let metres = plan.projection.map(|projection| projection.to_string());
        self.options.note(plan.image_size, metres.as_deref(), progress);
        for warning in plan.coarse.iter().chain(&plan.long_steps) {
            progress.warn(&warning.to_string());
        }
        for doubt in &plan.doubts {
            progress.warn(doubt);
        }
        for (object, apart) in &plan.apart {
            let file = self.scene.objects[*object].points.display();
            progress.warn(&format!("{file}: {apart}"));
        }
        for denoising in &plan.denoised {
            let file = self.scene.objects[denoising.object].points.display();
            progress.note(&format!("{file}: {denoising}"));
        }
        for chosen in &plan.chosen {
            let (name, value) = (&plan.names[chosen.object], chosen.value);
            progress.detail(&format!("object '{name}': {} = {value}", chosen.key));
        }
        for missing in &plan.missing {
            progress.warn(&format!("{missing}"));
        }
        for image in &plan.cleaned {
            progress.warn(&format!(
                "{}: {} pixels were changed: {}",
                image.file, image.pixels, image.rule
            ));
        }
        Ok(plan)
    }
}

/// A header must not tell in which folder of which machine a picture was made.
fn leave_out_folder(scene: &mut Scene, path: &Path) {
    let mut objects: Vec<&mut Object> =
        scene.objects.iter_mut().filter(|object| !object.is_ground()).collect();
    if let [object] = objects.as_mut_slice() {
        object.points_as_written =
            path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    }
}

fn texture_of(object: &Object) -> Option<&ImageFile> {
    match &object.material.albedo {
        Albedo::Texture { file, .. } => Some(file),
        _ => None,
    }
}
