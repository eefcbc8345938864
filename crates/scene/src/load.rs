//! From text to a checked scene.
use crate::background::BACKGROUND;
use crate::camera_keys::CAMERA;
use crate::document::{Node, Origin, SyntaxError, parse_file};
use crate::error::{Problem, Source};
use crate::image::IMAGE;
use crate::keys::SCENE;
use crate::light::LIGHTS;
use crate::models::{self, MODELS_VARIABLE};
use crate::object::OBJECTS;
use crate::read::Reader;
use crate::render_settings::RENDER;
use crate::root;
use crate::{
    Albedo, Background, CameraKeys, ImageSettings, Light, Object, RenderSettings, Scene, SceneError,
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
pub(crate) fn checked(
    document: &mut Node,
    folder: &Path,
    root: Option<&Path>,
    source: &Source<'_>,
) -> Result<(Scene, Vec<Problem>), SceneError> {
    let mut problems = Vec::new();
    for (index, text) in source.overrides.iter().enumerate() {
        problems.extend(crate::overrides::apply(document, index, text).err());
    }
    crate::ground::apply(document);
    crate::preset::apply(document);
    // What is wrong in a file of its own comes first: the scene is right if that is.
    let missing = crate::transfer_file::insert(document, folder, root)?;
    problems.extend(crate::check::check(document));
    if !problems.is_empty() {
        problems.extend(missing);
        return Err(SceneError::problems(problems, source));
    }
    let scene = scene(&Reader::new(&SCENE, Some(document)), folder);
    let problem = crate::inside::problem(document, &scene)
        .or_else(|| crate::ground::problem(document, &scene))
        .or_else(|| crate::background::problem(document, &scene));
    match problem {
        Some(problem) => Err(SceneError::problems(vec![problem], source)),
        None => Ok((scene, missing)),
    }
}

/// The folder that the environment names for models.
pub(crate) fn models_folder() -> Option<PathBuf> {
    env::var_os(MODELS_VARIABLE).filter(|folder| !folder.is_empty()).map(PathBuf::from)
}

/// Every file that the scene names is there: point files and images, beside those that are known to be missing.
pub(crate) fn files_exist(
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
        if !object.is_ground() {
            require(path, &object.points_as_written, "a point file", origin, key);
        }
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

fn scene(file: &Reader<'_>, folder: &Path) -> Scene {
    Scene {
        camera: CameraKeys::read(&file.table("camera", &CAMERA)),
        inside: file.table("camera", &CAMERA).written("inside").map(crate::inside::names),
        image: ImageSettings::read(&file.table("image", &IMAGE)),
        render: RenderSettings::read(&file.table("render", &RENDER)),
        background: Background::read(&file.table("background", &BACKGROUND), folder),
        lights: file.tables("lights", &LIGHTS).iter().map(Light::read).collect(),
        key_light: None,
        objects: (file.tables("objects", &OBJECTS).iter())
            .map(|object| Object::read(object, folder))
            .collect(),
    }
}
