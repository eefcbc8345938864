//! From text to a checked scene.

use crate::document::{Node, Origin, SyntaxError, Value, parse_file, parse_value};
use crate::error::{Problem, Source};
use crate::keys::{self, SCENE};
use crate::models::{self, MODELS_VARIABLE};
use crate::read::{Reader, to_number, to_vector};
use crate::root;
use crate::{
    Albedo, Background, Boundary, CameraKeys, ColorMap, ExtinctionFactor, FeatureSize, Filter,
    Fresnel, GridResolution, ImageFile, ImageSettings, Light, Material, MaterialKind, Neighbors,
    Normals, Object, PerParticle, PointFilter, Polynomial, Primary, RadiusOf, RayLoop, Refine,
    RenderSettings, Scale, Scatter, Scene, SceneError, Secondary, ShapeRadius, Stop, Surface,
    SurfaceKind, TextureAxis, Transfer, Transform, Units, Up, Volume, VolumeKernel, VolumeMode,
    VolumeShading, VoxelEdge,
};
use std::env;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Largest scene file in bytes; points belong in point files.
const MAX_BYTES: u64 = 16 << 20;

impl Scene {
    /// Reads and checks a scene file, and that the files it names exist: beside it or, where their
    /// path begins with `models/`, below the folder of [`MODELS_VARIABLE`]. `overrides` are `PATH=VALUE`
    /// (`objects.0.surface.trust=0.7`), applied in order before the checks; paths in them too
    /// start from the scene file's folder.
    pub fn load(path: &Path, overrides: &[String]) -> Result<Scene, SceneError> {
        Self::load_below(path, overrides, None)
    }

    /// The same where the files that the scene names are looked for below `root` first: there as they are written, or
    /// without their first folders, those with absolute paths too.
    ///
    /// # Errors
    /// As [`Scene::load`]; every file that is missing is named, with all places where it was looked for.
    pub fn load_below(
        path: &Path,
        overrides: &[String],
        root: Option<&Path>,
    ) -> Result<Scene, SceneError> {
        Self::load_text(&read_text(path)?, path, overrides, root)
    }

    /// The same for text that is held already, as if it were read from `path`.
    ///
    /// # Errors
    /// As [`Scene::load_below`].
    pub fn load_text(
        text: &str,
        path: &Path,
        overrides: &[String],
        root: Option<&Path>,
    ) -> Result<Scene, SceneError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let source = Source { file: path, text, overrides };
        Self::with_files(&source, folder, root, false)
    }

    /// The scene that `picture` holds in its header as `text`, whose relative paths start from the picture's folder, or
    /// from `root` as in [`Scene::load_below`].
    ///
    /// # Errors
    /// As [`Scene::load_below`].
    pub fn of_picture(
        text: &str,
        picture: &Path,
        overrides: &[String],
        root: Option<&Path>,
    ) -> Result<Scene, SceneError> {
        let mut shown = picture.as_os_str().to_owned();
        shown.push("[pointillist/scene]");
        let folder = picture.parent().unwrap_or(Path::new(""));
        let source = Source { file: Path::new(&shown), text, overrides };
        Self::with_files(&source, folder, root, true)
    }

    fn with_files(
        source: &Source<'_>,
        folder: &Path,
        root: Option<&Path>,
        of_picture: bool,
    ) -> Result<Scene, SceneError> {
        let mut document = document_of(source.text, source.file)?;
        let (mut scene, missing) = checked(&mut document, folder, root, source)?;
        models::find(&mut scene, models_folder().as_deref());
        root::find(&mut scene, root);
        files_exist(&document, &scene, source, (root, of_picture), missing)?;
        Ok(scene)
    }

    /// Checks scene text as if it were read from `file`, which names it in messages and whose
    /// folder relative paths start from. Opens no file but those of transfer functions.
    pub fn from_toml(text: &str, file: &Path, overrides: &[String]) -> Result<Scene, SceneError> {
        let folder = file.parent().unwrap_or(Path::new(""));
        let mut document = document_of(text, file)?;
        let source = Source { file, text, overrides };
        match checked(&mut document, folder, None, &source)? {
            (scene, missing) if missing.is_empty() => Ok(scene),
            (_, missing) => Err(SceneError::problems(missing, &source)),
        }
    }

    /// The scene that a point file rendered directly means: one object with defaults, no camera
    /// (the renderer frames it), a key light, a dimmer one in the camera's eye, a grey background. `overrides`
    /// apply as in [`Scene::load`], with paths relative to the working directory.
    pub fn for_point_file(
        points: &Path,
        up: Up,
        overrides: &[String],
    ) -> Result<Scene, SceneError> {
        Self::around(points, light_over(up), overrides)
    }

    /// The same for a camera in the place of a sensor, whose right, up and ahead are these unit vectors. The key
    /// light comes from a little above and beside it, so that few of its shadows are seen. In a room, light from high
    /// above would end at the ceiling.
    ///
    /// # Errors
    /// As [`Scene::for_point_file`].
    pub fn for_sensor(
        points: &Path,
        [right, up, ahead]: [[f64; 3]; 3],
        overrides: &[String],
    ) -> Result<Scene, SceneError> {
        let key = [0, 1, 2].map(|i| -0.2 * right[i] - 0.25 * up[i] + ahead[i]);
        Self::around(points, key, overrides)
    }

    fn around(points: &Path, key: [f64; 3], overrides: &[String]) -> Result<Scene, SceneError> {
        let source = Source { file: points, text: "", overrides };
        let mut document = point_file_document(points, key);
        let (mut scene, missing) = checked(&mut document, Path::new(""), None, &source)?;
        models::find(&mut scene, models_folder().as_deref());
        let key_light = document.get("lights").and_then(|list| list.items().first());
        let direction = key_light.and_then(|light| light.get("direction"));
        scene.key_light = direction.filter(|node| node.origin == Origin::Given).map(|_| 0);
        let written = document.get("objects").and_then(|list| list.items().first()?.get("points"));
        // The document holds text; the path itself may hold bytes that are not UTF-8.
        if let (Some(Origin::Given), [object, ..]) =
            (written.map(|node| node.origin), scene.objects.as_mut_slice())
        {
            object.points = points.to_path_buf();
        }
        files_exist(&document, &scene, &source, (None, false), missing)?;
        Ok(scene)
    }
}

/// The text of a scene file.
pub(crate) fn read_text(path: &Path) -> Result<String, SceneError> {
    let bytes = read(path).map_err(|message| SceneError::file(path, &message))?;
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let bytes = error.as_bytes();
        let byte = bytes.get(at).copied().unwrap_or_default();
        let message = format!("found byte 0x{byte:02x}, expected UTF-8; save the file as UTF-8");
        SceneError::at(path, bytes, at, &message)
    })
}

/// The tree of a file.
pub(crate) fn document_of(text: &str, file: &Path) -> Result<Node, SceneError> {
    parse_file(text).map_err(|SyntaxError { at, message }| {
        let message = format!("not valid TOML: {message}");
        match at {
            Some(at) => SceneError::at(file, text.as_bytes(), at, &message),
            None => SceneError::file(file, &message),
        }
    })
}

/// The bytes of a scene file.
fn read(path: &Path) -> Result<Vec<u8>, String> {
    let reason = |error: io::Error| match error.kind() {
        io::ErrorKind::NotFound => "no such file; check the path".to_owned(),
        _ => format!("cannot be read ({error}); check the file and its permissions"),
    };
    let meta = fs::metadata(path).map_err(reason)?;
    if meta.is_dir() {
        return Err("found a folder, expected a scene file; name the file in it".into());
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(reason)?;
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(reason)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(format!(
            "found more than {MAX_BYTES} bytes, the limit of a scene file; keep points in point \
             files"
        ));
    }
    Ok(bytes)
}

/// Overrides, then checks, then the scene, with which of the files of transfer functions are missing.
fn checked(
    document: &mut Node,
    folder: &Path,
    root: Option<&Path>,
    source: &Source<'_>,
) -> Result<(Scene, Vec<Problem>), SceneError> {
    let mut problems = Vec::new();
    for (index, text) in source.overrides.iter().enumerate() {
        problems.extend(crate::overrides::apply(document, index, text).err());
    }
    crate::preset::apply(document);
    // What is wrong in a file of its own comes first: the scene is right if that is.
    let missing = crate::transfer_file::insert(document, folder, root)?;
    problems.extend(crate::check::check(document));
    if !problems.is_empty() {
        problems.extend(missing);
        return Err(SceneError::problems(problems, source));
    }
    let scene = scene(&Reader::new(&SCENE, Some(document)), folder);
    match crate::inside::problem(document, &scene) {
        Some(problem) => Err(SceneError::problems(vec![problem], source)),
        None => Ok((scene, missing)),
    }
}

/// The folder that the environment names for models.
fn models_folder() -> Option<PathBuf> {
    env::var_os(MODELS_VARIABLE).filter(|folder| !folder.is_empty()).map(PathBuf::from)
}

/// Every file that the scene names is there: point files and images, beside those that are known to be missing.
fn files_exist(
    document: &Node,
    scene: &Scene,
    source: &Source<'_>,
    (root, of_picture): (Option<&Path>, bool),
    mut problems: Vec<Problem>,
) -> Result<(), SceneError> {
    let nodes = document.get("objects").map_or(&[][..], Node::items);
    let models = models_folder();
    let mut require = |file: &Path, written: &str, what: &str, origin: Origin, path: String| {
        // A point file rendered directly is looked for where it says, and named by the message already.
        let given = origin == Origin::Given;
        let advice = match (given, root) {
            (true, _) => None,
            (false, None) => models::advice(written, models.as_deref())
                .or_else(|| root::advice(None, written, of_picture)),
            (false, _) => root::advice(root, written, of_picture),
        };
        // What the user names may be a pipe; what a scene names is read more than once.
        let is_pipe = || file.metadata().is_ok_and(|found| !found.is_file() && !found.is_dir());
        let Some(message) = what_is_missing(file, what, advice).filter(|_| !given || !is_pipe())
        else {
            return;
        };
        let path = if given { String::new() } else { path };
        problems.push(Problem { origin, path, message });
    };
    if let Some(image) = &scene.background.environment {
        let origin = document
            .get("background")
            .and_then(|table| table.get("environment"))
            .map_or(document.origin, |node| node.origin);
        let (path, key) = (&image.path, "background.environment".into());
        require(path, &image.as_written, "an image", origin, key);
    }
    for (index, (object, node)) in scene.objects.iter().zip(nodes).enumerate() {
        let origin = node.get("points").map_or(node.origin, |points| points.origin);
        let (path, key) = (&object.points, format!("objects[{index}].points"));
        require(path, &object.points_as_written, "a point file", origin, key);
        if let Albedo::Texture { file, .. } = &object.material.albedo {
            let origin = node
                .get("material")
                .and_then(|table| table.get("texture"))
                .map_or(node.origin, |texture| texture.origin);
            let key = format!("objects[{index}].material.texture");
            require(&file.path, &file.as_written, "an image", origin, key);
        }
    }
    if problems.is_empty() { Ok(()) } else { Err(SceneError::problems(problems, source)) }
}

/// Why a path is no file, if it is none. `advice` is for a model that is missing.
pub(crate) fn what_is_missing(
    file: &Path,
    expected: &str,
    advice: Option<String>,
) -> Option<String> {
    let path = file.display();
    match fs::metadata(file) {
        Ok(meta) if meta.is_dir() => {
            Some(format!("found a folder at '{path}', expected {expected}; name the file"))
        }
        // It may never end, or wait for a writer that never comes.
        Ok(meta) if !meta.is_file() => Some(format!(
            "found a pipe or a device at '{path}', expected {expected}; save it to a file first"
        )),
        Ok(_) => None,
        Err(error) if error.kind() == io::ErrorKind::NotFound => Some(match advice {
            Some(advice) => format!("found no file at '{path}', {advice}"),
            None => format!(
                "found no file at '{path}'; check the path, which starts from the scene file's \
                 folder"
            ),
        }),
        Err(error) => {
            Some(format!("'{path}' cannot be read ({error}); check the file and its permissions"))
        }
    }
}

/// Direction of the key light over points whose up is this.
fn light_over(up: Up) -> [f64; 3] {
    // Turned from y up by a quarter turn about x, (x, y, z) to (x, -z, y), or by half a turn, to
    // (x, -y, -z).
    match up {
        Up::Y => [-0.5, -1.0, -0.6],
        Up::Z => [-0.5, 0.6, -1.0],
        Up::MinusY => [-0.5, 1.0, 0.6],
    }
}

/// As TOML, so that overrides and checks work on it as on any scene. With the direction of the key light: the dimmer
/// one is in the eye, where no shadow of its own is seen, so that none is black.
fn point_file_document(points: &Path, key: [f64; 3]) -> Node {
    let text = format!(
        "{{ background = {{ color = [0.18, 0.18, 0.18] }}, lights = [\
         {{ kind = \"directional\", direction = {key:?}, irradiance = [2.5, 2.5, 2.5] }},\
         {{ kind = \"headlight\", at_target = [0.6, 0.6, 0.6] }}\
         ], objects = [{{ points = {} }}] }}",
        crate::settings::quoted(&points.to_string_lossy())
    );
    parse_value(&text, Origin::Given).unwrap_or_else(|| unreachable!("not TOML: {text}"))
}

fn scene(file: &Reader<'_>, folder: &Path) -> Scene {
    Scene {
        camera: CameraKeys::read(&file.table("camera", &keys::CAMERA)),
        inside: file.table("camera", &keys::CAMERA).written("inside").map(crate::inside::names),
        image: ImageSettings::read(&file.table("image", &keys::IMAGE)),
        render: RenderSettings::read(&file.table("render", &keys::RENDER)),
        background: Background::read(&file.table("background", &keys::BACKGROUND), folder),
        lights: file.tables("lights", &keys::LIGHTS).iter().map(Light::read).collect(),
        key_light: None,
        objects: (file.tables("objects", &keys::OBJECTS).iter())
            .map(|object| Object::read(object, folder))
            .collect(),
    }
}

impl ImageSettings {
    fn read(table: &Reader<'_>) -> Self {
        Self {
            size: table.counts("size"),
            samples: table.count("samples"),
            filter: match table.text("filter").as_str() {
                "triangle" => Filter::Triangle,
                "box" => Filter::Box,
                _ => Filter::Gaussian,
            },
            filter_width: table.written("filter_width").map(|_| table.number("filter_width")),
            transparent: table.flag("transparent"),
        }
    }
}

impl RenderSettings {
    fn read(table: &Reader<'_>) -> Self {
        Self {
            max_bounces: table.count("max_bounces"),
            fresnel: match table.text("fresnel").as_str() {
                "sample" => Fresnel::Sample,
                _ => Fresnel::Transmit,
            },
            cells_per_pass: table.count("cells_per_pass"),
            ray_loop: match table.text("loop").as_str() {
                "images" => RayLoop::Images,
                "queue" => RayLoop::Queue,
                _ => RayLoop::Auto,
            },
            seed: table.count("seed"),
            grid_resolution: match to_number(&table.value("grid_resolution")) {
                Some(_) => GridResolution::Cells(table.count("grid_resolution")),
                None => GridResolution::Paper,
            },
            primary: match table.text("primary").as_str() {
                "grid" => Primary::Grid,
                "discs" => Primary::Discs,
                "tree" => Primary::Tree,
                _ => Primary::Auto,
            },
            secondary: match table.text("secondary").as_str() {
                "grid" => Secondary::Grid,
                "tree" => Secondary::Tree,
                _ => Secondary::Auto,
            },
        }
    }
}

impl Background {
    fn read(table: &Reader<'_>, folder: &Path) -> Self {
        Self {
            color: table.vector("color"),
            environment: ImageFile::read(table, "environment", folder),
            rotate: table.vector("rotate"),
        }
    }
}

impl ImageFile {
    /// The image that a key names, if it is written.
    fn read(table: &Reader<'_>, name: &str, folder: &Path) -> Option<Self> {
        table.written(name)?;
        let as_written = table.text(name);
        Some(Self { path: folder.join(&as_written), as_written })
    }
}

impl Light {
    fn read(table: &Reader<'_>) -> Self {
        match table.text("kind").as_str() {
            "point" => Self::Point {
                position: table.vector("position"),
                intensity: table.vector("intensity"),
                radius: table.number("radius"),
            },
            "headlight" => Self::Headlight { at_target: table.vector("at_target") },
            _ => Self::Directional {
                direction: table.vector("direction"),
                irradiance: table.vector("irradiance"),
                angle: table.number("angle"),
            },
        }
    }
}

impl Object {
    fn read(table: &Reader<'_>, folder: &Path) -> Self {
        let written = table.text("points");
        let points: PathBuf = folder.join(&written);
        let name = match table.written("name") {
            Some(_) => table.text("name"),
            None => points.file_stem().map_or(written.clone(), |s| s.to_string_lossy().into()),
        };
        Self {
            name,
            points,
            points_as_written: written,
            filter: PointFilter::read(&table.table("filter", &keys::FILTER)),
            columns: table.written_columns("columns"),
            units: match table.text("units").as_str() {
                "degrees" => Units::Degrees,
                "scene" => Units::Scene,
                _ => Units::Auto,
            },
            transform: Transform::read(&table.table("transform", &keys::TRANSFORM)),
            surface: Surface::read(&table.table("surface", &keys::SURFACE)),
            material: Material::read(&table.table("material", &keys::MATERIAL), folder),
            volume: (table.written("volume"))
                .map(|_| Volume::read(&table.table("volume", &keys::VOLUME))),
        }
    }
}

impl PointFilter {
    fn read(table: &Reader<'_>) -> Self {
        Self {
            every: table.count("every"),
            bounds: table.written("box").map(|_| {
                let corners = table.table("box", &keys::FILTER_BOX);
                ["min", "max"].map(|corner| corners.vector(corner))
            }),
            ranges: table.written_ranges("range"),
            classes: table.written_counts("classification"),
            voxel: (table.written("voxel")).map(|_| {
                to_number(&table.value("voxel")).map_or(VoxelEdge::Auto, VoxelEdge::Length)
            }),
        }
    }
}

/// An optical depth through which nothing is seen.
const OPAQUE: f64 = 1e3;

impl Volume {
    fn read(table: &Reader<'_>) -> Self {
        let length = |name: &str| to_number(&table.value(name));
        let stops = table.tables("transfer", &keys::TRANSFER);
        let per_particle = |name: &str| match table.value(name) {
            Value::Text(text) if text == "auto" => None,
            Value::Text(text) => Some(PerParticle::Attribute(text)),
            number => to_number(&number).map(PerParticle::Number),
        };
        Self {
            scalar: table.text("scalar"),
            kernel: match table.text("kernel").as_str() {
                "sum" => VolumeKernel::Sum,
                "sph" => VolumeKernel::Sph {
                    smoothing_length: per_particle("smoothing_length")
                        .unwrap_or_else(|| PerParticle::Attribute("auto".into())),
                    mass: per_particle("mass"),
                    density: table.written("density").map(|_| table.text("density")),
                },
                _ => VolumeKernel::Shepard,
            },
            radius: length("radius"),
            smoothing: length("smoothing"),
            step: length("step"),
            boundary: match table.text("boundary").as_str() {
                "none" => Boundary::None,
                "all" => Boundary::All,
                "auto" => Boundary::Auto,
                name => Boundary::Attribute(name.to_owned()),
            },
            mode: match table.text("mode").as_str() {
                "maximum" => VolumeMode::Maximum,
                "average" => VolumeMode::Average,
                "integral" => VolumeMode::Integral,
                "isosurface" => VolumeMode::Isosurface(table.number("iso")),
                _ => VolumeMode::Emission,
            },
            transfer: match table.written("color_map") {
                Some(_) => Some(Transfer::Map {
                    color_map: ColorMap::read(&table.text("color_map")),
                    range: match table.written("value_range").map(|node| &node.value) {
                        Some(Value::Text(_)) | None => None,
                        Some(_) => table.written_range("value_range"),
                    },
                    // None is asked for, and none is needed, by an isosurface; an integral is opaque.
                    extinction: match table.written("extinction").map(|node| &node.value) {
                        Some(Value::Text(_)) => [1.0; 2],
                        Some(_) => table.pair("extinction"),
                        None if table.text("mode") == "integral" => [OPAQUE; 2],
                        None => [0.0; 2],
                    },
                }),
                None if stops.is_empty() => None,
                None => Some(Transfer::Stops(stops.iter().map(Stop::read).collect())),
            },
            scale: Scale::read(&table.text("scale")),
            extinction: match table.written("extinction").map(|node| &node.value) {
                Some(Value::Text(_)) => ExtinctionFactor::Auto,
                Some(number) if !stops.is_empty() => {
                    ExtinctionFactor::Given(to_number(number).unwrap_or(1.0))
                }
                _ => ExtinctionFactor::Given(1.0),
            },
            shading: match table.text("shading").as_str() {
                "gradient" => VolumeShading::Gradient,
                "scatter" => VolumeShading::Scatter,
                _ => VolumeShading::None,
            },
        }
    }
}

impl Stop {
    fn read(table: &Reader<'_>) -> Self {
        Self {
            value: table.number("value"),
            color: table.written("color").map_or([0.0; 3], |_| table.vector("color")),
            extinction: table.written("extinction").map_or(0.0, |_| table.number("extinction")),
            emission: table.vector("emission"),
        }
    }
}

impl Transform {
    fn read(table: &Reader<'_>) -> Self {
        Self {
            scale: table.number("scale"),
            rotate: table.vector("rotate"),
            translate: table.vector("translate"),
        }
    }
}

/// The key, if any, by which a surface says that it is fitted to the points where they lie.
pub(crate) fn key_of_points_as_they_are(surface: &Reader<'_>) -> Option<&'static str> {
    let number = to_number(&surface.value("neighbors")).map(|_| "neighbors");
    let given = |name: &&str| surface.written(name).is_some();
    number.or_else(|| ["feature_size", "weight_width", "refine"].into_iter().find(given))
}

impl Surface {
    fn read(table: &Reader<'_>) -> Self {
        let radius = || ShapeRadius {
            of: match table.value("radius") {
                Value::Text(text) => match text.strip_prefix("attribute:") {
                    Some(name) => RadiusOf::Attribute(name.trim().to_owned()),
                    None if text == "local" => RadiusOf::LocalSpacing,
                    None => RadiusOf::Spacing,
                },
                number => to_number(&number).map_or(RadiusOf::Spacing, RadiusOf::Length),
            },
            scale: table.number("radius_scale"),
        };
        Self {
            kind: match table.text("kind").as_str() {
                "spheres" => SurfaceKind::Spheres(radius()),
                "discs" => SurfaceKind::Discs(radius()),
                _ => SurfaceKind::Points,
            },
            scatter: match table.text("scatter").as_str() {
                "spheres" => Scatter::Spheres,
                "drop" => Scatter::Drop,
                _ => Scatter::Discs,
            },
            neighbors: match to_number(&table.value("neighbors")) {
                Some(_) => Neighbors::Count(table.count("neighbors")),
                None if key_of_points_as_they_are(table).is_some() => {
                    Neighbors::Count(Neighbors::FEW)
                }
                None => Neighbors::Auto { accuracy: table.number("accuracy") },
            },
            polynomial: match table.text("polynomial").as_str() {
                "incomplete" => Polynomial::Incomplete,
                _ => Polynomial::Full,
            },
            feature_size: match to_number(&table.value("feature_size")) {
                Some(length) => FeatureSize::Constant(length),
                None if table.text("feature_size") == "smoothed" => FeatureSize::Smoothed,
                None => FeatureSize::Adaptive,
            },
            trust: table.number("trust"),
            drop_isolated: table.number("drop_isolated"),
            weight_width: table.number("weight_width"),
            close_gaps: table.flag("close_gaps"),
            boundary_clip: table.flag("boundary_clip"),
            normals: match table.text("normals").as_str() {
                "blended" => Normals::Blended,
                _ => Normals::Polynomial,
            },
            refine: match table.text("refine").as_str() {
                "project" => Refine::Project {
                    tolerance: table.number("tolerance"),
                    max_iterations: table.count("max_iterations"),
                },
                _ => Refine::None,
            },
        }
    }
}

impl Material {
    fn read(table: &Reader<'_>, folder: &Path) -> Self {
        let kind = match table.text("kind").as_str() {
            "mirror" => MaterialKind::Mirror { reflectance: table.vector("reflectance") },
            "glass" => MaterialKind::Glass {
                ior: ior_of_channels(table),
                // Within the range of the key, which is far inside i32.
                priority: to_number(&table.value("priority")).map_or(0, |priority| priority as i32),
                absorption: table.vector("absorption"),
            },
            _ => MaterialKind::Diffuse,
        };
        Self { kind, albedo: Albedo::read(table, folder) }
    }
}

impl Albedo {
    fn read(table: &Reader<'_>, folder: &Path) -> Self {
        if let Some(file) = ImageFile::read(table, "texture", folder) {
            let axis =
                table.written("texture_axis").map(|_| match table.text("texture_axis").as_str() {
                    "x" => TextureAxis::X,
                    "z" => TextureAxis::Z,
                    "uv" => TextureAxis::Uv,
                    _ => TextureAxis::Y,
                });
            return Self::Texture { file, axis };
        }
        match table.written("albedo").map(|node| &node.value) {
            None => Self::Default,
            Some(Value::Text(text)) => match text.strip_prefix("attribute:") {
                Some(name) => Self::Attribute {
                    name: name.trim().to_owned(),
                    color_map: ColorMap::read(&table.text("color_map")),
                    range: table.written_range("value_range"),
                    scale: Scale::read(&table.text("scale")),
                },
                None => Self::Points,
            },
            Some(value) => to_vector(value)
                .map_or_else(|| table.unlike("an albedo", "albedo", value), Self::Color),
        }
    }
}

/// Squares of reciprocal wavelengths in µm⁻²: of the dominant wavelengths of Rec. 709's primaries, and of the
/// spectral lines d, F and C that Abbe numbers are defined by.
const CHANNELS: [f64; 3] =
    [1.0 / (0.6114 * 0.6114), 1.0 / (0.5491 * 0.5491), 1.0 / (0.4642 * 0.4642)];
const LINE_D: f64 = 1.0 / (0.587_56 * 0.587_56);
const LINE_F: f64 = 1.0 / (0.486_13 * 0.486_13);
const LINE_C: f64 = 1.0 / (0.656_27 * 0.656_27);

/// The refractive index of each channel; from n_d and an Abbe number V by Cauchy's formula n = A + B/λ²,
/// where V = (n_d − 1) / (n_F − n_C).
fn ior_of_channels(table: &Reader<'_>) -> [f64; 3] {
    let ior = table.value("ior");
    let Some(index) = to_number(&ior) else { return table.vector("ior") };
    let Some(abbe) = table.written("abbe").and_then(|node| to_number(&node.value)) else {
        return [index; 3];
    };
    let b = (index - 1.0) / (abbe * (LINE_F - LINE_C));
    CHANNELS.map(|channel| index + b * (channel - LINE_D))
}

impl ColorMap {
    fn read(name: &str) -> Self {
        Self::ALL.into_iter().find(|map| map.name() == name).unwrap_or(Self::Viridis)
    }
}

impl Scale {
    fn read(name: &str) -> Self {
        if name == Self::Log.name() { Self::Log } else { Self::Linear }
    }
}

impl Default for ImageSettings {
    fn default() -> Self {
        Self::read(&Reader::defaults(&keys::IMAGE))
    }
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self::read(&Reader::defaults(&keys::RENDER))
    }
}

impl Default for Background {
    fn default() -> Self {
        Self::read(&Reader::defaults(&keys::BACKGROUND), Path::new(""))
    }
}

impl Default for Transform {
    fn default() -> Self {
        Self::read(&Reader::defaults(&keys::TRANSFORM))
    }
}

impl Default for Surface {
    fn default() -> Self {
        Self::read(&Reader::defaults(&keys::SURFACE))
    }
}

impl Default for Material {
    fn default() -> Self {
        Self::read(&Reader::defaults(&keys::MATERIAL), Path::new(""))
    }
}
