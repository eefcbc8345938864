//! From a path on the command line to a checked scene and its points.

use crate::args::{Overrides, ViewArgs};
use crate::camera::CameraOptions;
use crate::errors::Failure;
use crate::point_file::{ColorBy, PointFile};
use crate::progress::Progress;
use crate::{memory, source};
use plan::{MapProjection, Plan, SceneImages, SensorView, Window};
use points::{Column, Columns, Dropped, PointSet, ReadOptions, Upwards, Wanted, Watch};
use scene::{Albedo, ImageFile, Object, Scene, Units, Up};
use serde_json::json;
use std::borrow::Cow;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

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

/// Options of the command line that stand for values of the scene, later ones over earlier ones.
#[derive(Debug, Default)]
pub struct SceneValues {
    /// `PATH=VALUE`, and the option as typed where it was not `--set`.
    entries: Vec<(String, Option<String>)>,
    /// Where the files of a scene are looked for first.
    root: Option<PathBuf>,
}

impl SceneValues {
    /// `--set` alone.
    pub fn set(set: &[String]) -> Self {
        Self { entries: set.iter().map(|entry| (entry.clone(), None)).collect(), root: None }
    }

    /// With `--root`.
    pub fn below(mut self, root: Option<&Path>) -> Self {
        self.root = root.map(Path::to_path_buf).or(self.root);
        self
    }

    /// With `--preset`, which is one more value of the scene.
    pub fn add_preset(&mut self, preset: Option<&str>) {
        if let Some(name) = preset {
            self.add("render.preset", &json!(name).to_string(), &format!("--preset {name}"));
        }
    }

    /// `--set`, `--size` and `--cells-per-pass`.
    pub fn new(overrides: &Overrides) -> Self {
        let mut values = Self::default();
        values.append(overrides);
        values
    }

    /// The same over what there is already.
    pub fn append(&mut self, overrides: &Overrides) {
        self.entries.extend(Self::set(&overrides.set).entries);
        self.add_preset(overrides.preset.as_deref());
        if let Some(root) = &overrides.root {
            self.root = Some(root.clone());
        }
        if let Some(size) = overrides.size {
            self.add(
                "image.size",
                &format!("[{}, {}]", size.0, size.1),
                &format!("--size {}x{}", size.0, size.1),
            );
        }
        if let Some(cells) = overrides.cells_per_pass {
            self.add(
                "render.cells_per_pass",
                &cells.to_string(),
                &format!("--cells-per-pass {cells}"),
            );
        }
    }

    /// `--columns`, which is for point files.
    pub fn add_columns(&mut self, path: &Path, columns: &Columns) -> Result<(), Failure> {
        if is_scene_file(path) {
            return Err(columns_of_scene(path));
        }
        let column = |of: &Column| match of {
            Column::Name(name) => json!(name).to_string(),
            Column::Number(number) => number.to_string(),
        };
        let named =
            columns.named.iter().map(|(name, of)| format!("{} = {}", json!(name), column(of)));
        let left_out = format!("_ = {:?}", columns.left_out);
        let all: Vec<String> = named.chain([left_out]).collect();
        self.add("objects.0.columns", &format!("{{ {} }}", all.join(", ")), "--columns");
        Ok(())
    }

    /// One option.
    pub fn add(&mut self, path: &str, value: &str, option: &str) {
        self.entries.push((format!("{path}={value}"), Some(option.to_owned())));
    }

    /// As the scene takes them.
    pub fn as_set(&self) -> Vec<String> {
        self.entries.iter().map(|entry| entry.0.clone()).collect()
    }

    /// The scene knows of `--set` alone; the user is told of what was typed.
    fn name_options(&self, mut failure: Failure) -> Failure {
        for (value, option) in &self.entries {
            let Some(option) = option else { continue };
            for line in &mut failure.lines {
                *line = line.replace(&format!("--set {value}"), option);
            }
        }
        failure
    }
}

/// Fails where `--preset` and `--set` give different presets: neither is to be passed over without a word.
pub fn check_preset(preset: Option<&str>, set: &[String]) -> Result<(), Failure> {
    let Some(preset) = preset else { return Ok(()) };
    for text in set {
        let Some((path, value)) = text.split_once('=') else { continue };
        let value = value.trim().trim_matches(['"', '\'']);
        if path.trim() == "render.preset" && value != preset {
            return Err(Failure::usage(format!(
                "--preset {preset} and --set {text} give different presets; leave one out"
            )));
        }
    }
    Ok(())
}

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

/// The scene that an EXR holds in its header, as TOML.
pub fn scene_of_picture(path: &Path) -> Result<String, Failure> {
    film::exr_text(path, "pointillist/scene")?.ok_or_else(|| {
        Failure::usage(format!(
            "{}: found no scene in its header, which pictures by pointillist have as pointillist/scene; name one of \
             these, a scene file or a point file",
            path.display()
        ))
    })
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
            Scene::for_point_file(path, turned, &set)
        };
        let mut scene = loaded.map_err(|error| values.name_options(error.into()))?;
        options.apply(&mut scene, path, is_scene_file(path))?;
        let point_file = (!is_scene_file(path)).then(|| {
            leave_out_folder(&mut scene, path);
            PointFile { values: set, up_is_open: options.up.is_none(), color: None }
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
            let lights = Scene::for_sensor(&self.path, view.axes, values)?.lights;
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
        let lights = Scene::for_point_file(&self.path, turned, &point_file.values)?.lights;
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
        let points = self.scene.objects.iter().map(|object| object.points.as_path());
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

    /// Reads of every object's points what a render needs, and reports those that are of no use or left out. How a
    /// point file is shown is decided by its points.
    pub fn read_points(&mut self, progress: &Progress) -> Result<Vec<Arc<PointSet>>, Failure> {
        let Some(point_file) = &self.point_file else {
            return self.read_as(plan::read_options, progress);
        };
        let mut sets = self.read_as(|object| point_file.options(object), progress)?;
        let up = self.up_of(&sets);
        let read_all = || {
            let object = &self.scene.objects[0];
            let options = ReadOptions { wanted: Wanted::All, ..plan::read_options(object) };
            progress.stage(
                "reading attributes",
                fs::metadata(&object.points).map_or(0, |file| file.len()),
            );
            let set =
                points::read_with(&object.points, &options, &mut |done, _| progress.done(done));
            progress.clear();
            Ok(set?)
        };
        let Some(first) = sets.first_mut() else { return Ok(sets) };
        let mut values = point_file.choose(&self.scene, first, up, read_all, progress)?;
        if !values.is_empty() {
            values.extend(point_file.values.iter().cloned());
            self.scene = Scene::for_point_file(&self.path, self.up, &values)?;
            self.options.apply(&mut self.scene, &self.path, false)?;
            leave_out_folder(&mut self.scene, &self.path);
        }
        Ok(sets)
    }

    /// The same with everything that the files have.
    pub fn read_all(&self, progress: &Progress) -> Result<Vec<Arc<PointSet>>, Failure> {
        let all = |object: &Object| ReadOptions {
            wanted: Wanted::All,
            filter: plan::point_filter(&object.filter),
            columns: plan::point_columns(&object.columns),
            ..ReadOptions::default()
        };
        self.read_as(all, progress)
    }

    /// Reads each file once for all objects with the same filter and columns.
    fn read_as(
        &self,
        options: impl Fn(&Object) -> ReadOptions,
        progress: &Progress,
    ) -> Result<Vec<Arc<PointSet>>, Failure> {
        let mut jobs: Vec<(PathBuf, &Path, ReadOptions)> = Vec::new();
        let mut job_of = Vec::new();
        for object in &self.scene.objects {
            let (file, options) = (same_file(&object.points), options(object));
            let known = jobs.iter().position(|job| {
                let known = (&job.2.filter, &job.2.columns);
                job.0 == file && known == (&options.filter, &options.columns)
            });
            if let Some(job) = known {
                jobs[job].2.wanted = jobs[job].2.wanted.or(&options.wanted);
            } else {
                jobs.push((file, &object.points, options));
            }
            job_of.push(known.unwrap_or(jobs.len() - 1));
        }
        let sets = jobs
            .iter()
            .map(|(_, path, options)| Ok(Arc::new(read_file(path, options, progress)?)))
            .collect::<Result<Vec<_>, Failure>>()?;
        Ok(job_of.into_iter().map(|job| Arc::clone(&sets[job])).collect())
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

impl Input {
    /// Says which points are taken for degrees, and which only look like it.
    fn note_units(&self, sets: &[Arc<PointSet>], progress: &Progress) {
        for (index, (object, set)) in self.scene.objects.iter().zip(sets).enumerate() {
            let known = sets[..index].iter().any(|earlier| Arc::ptr_eq(earlier, set));
            if known || object.units != Units::Auto {
                continue;
            }
            let file = object.points.display();
            if let points::Units::Degrees(reason) = &set.units {
                progress.note(&format!(
                    "{file}: x and y are taken as longitude and latitude in degrees, since {reason}, and \
                     projected to metres; --set objects.{index}.units=scene leaves them as they are"
                ));
            }
            if let Some(note) = looks_like_degrees(&set.units, index) {
                progress.warn(&format!("{file}: {note}"));
            }
        }
    }
}

/// The doubt about numbers that look like degrees, of an object of this index.
pub fn looks_like_degrees(units: &points::Units, index: usize) -> Option<String> {
    (*units == points::Units::LikeDegrees).then(|| {
        format!(
            "x and y look like longitude and latitude in degrees beside heights in metres, but nothing in the \
             file says so, and they are left as they are; --set objects.{index}.units=degrees projects them to \
             metres"
        )
    })
}

fn note_projection(projection: &MapProjection, progress: &Progress) {
    let [longitude, latitude] = projection.center;
    progress.note(&format!(
        "degrees become metres east (x) and north (y) of longitude {longitude}, latitude {latitude} \
         ({projection}); camera, lights and transforms are in these"
    ));
    if projection.stretch > 0.01 {
        progress.warn(&format!(
            "the points in degrees reach so far that lengths are up to {:.0} % too long away from the \
             centre; choose a smaller part by objects.filter for true proportions",
            100.0 * projection.stretch
        ));
    }
}

/// A header must not tell in which folder of which machine a picture was made.
fn leave_out_folder(scene: &mut Scene, path: &Path) {
    if let [object] = scene.objects.as_mut_slice() {
        object.points_as_written =
            path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    }
}

/// One name for all names of a file.
fn same_file(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf())
}

fn texture_of(object: &Object) -> Option<&ImageFile> {
    match &object.material.albedo {
        Albedo::Texture { file, .. } => Some(file),
        _ => None,
    }
}

/// Reads one point file, and tells of points that are of no use or left out.
pub fn read_file(
    path: &Path,
    options: &ReadOptions,
    progress: &Progress,
) -> Result<PointSet, Failure> {
    progress.stage("reading points", fs::metadata(path).map_or(0, |file| file.len()));
    let set = points::read_with(path, options, &mut |done, _| progress.done(done))?;
    progress.clear();
    let dropped = Dropped { non_finite: set.non_finite, invalid: set.invalid };
    note_points(path, &set.notes, dropped, set.len() as u64 + set.filtered_out, progress);
    if !options.filter.keeps_all() {
        let (kept, all) = (set.len(), set.len() as u64 + set.filtered_out);
        let file = path.display();
        progress.note(&format!("{file}: kept {kept} of {all} points ({})", options.filter));
    }
    Ok(set)
}

/// Says what a reader assumed, and how many points are of no use besides so many that are.
pub fn note_points(
    path: &Path,
    notes: &[String],
    dropped: Dropped,
    usable: u64,
    progress: &Progress,
) {
    let file = path.display();
    for note in notes {
        progress.note(&format!("{file}: {note}"));
    }
    for (count, why) in [
        (dropped.non_finite, "whose position is infinite or not a number"),
        (dropped.invalid, "which the file marks as invalid"),
    ] {
        if count > 0 {
            let all = usable + dropped.count();
            progress.warn(&format!("{file}: dropped {count} of {all} points, {why}"));
        }
    }
}
