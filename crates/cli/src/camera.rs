//! Options that say how a scene or a point file is looked at: `--up`, `--view`, `--ortho`, `--camera-from`.
//!
//! They stand for keys of `[camera]`, over what the scene and `--set` give, and the header of an EXR file has the camera
//! that they make.

use crate::args::{UpAxis, ViewArgs};
use crate::errors::Failure;
use crate::progress::Progress;
use crate::source::PIPE;
use scene::{CameraKeys, Scene, ViewFrom, camera_keys_set};
use std::path::{Path, PathBuf};

/// What the options make of a camera.
#[derive(Debug, Clone, Default)]
pub struct CameraOptions {
    /// `--up`.
    pub up: Option<UpAxis>,
    view: Option<ViewFrom>,
    ortho: bool,
    from: Option<Header>,
    /// With `--ortho`, the height that `--set` gives.
    height: Option<f64>,
    /// Keys of the camera that `--set` gives, with what was typed.
    set: Vec<(String, String)>,
}

/// How `--set` gives the height of an orthographic camera.
const HEIGHT: &str = "camera.height";

/// The camera of another picture.
#[derive(Debug, Clone)]
struct Header {
    file: PathBuf,
    keys: CameraKeys,
    aspect: Option<f64>,
    /// How degrees became metres where it was made.
    projection: Option<String>,
}

impl CameraOptions {
    /// Checks the options against `--set`, and reads the header that they name.
    pub fn new(args: &ViewArgs, set: &[String]) -> Result<Self, Failure> {
        let options = Self {
            up: args.up,
            view: args.view,
            ortho: args.ortho,
            from: None,
            height: None,
            set: camera_keys_set(set),
        };
        let from =
            args.camera_from.as_ref().map(|file| format!("--camera-from {}", file.display()));
        let conflicts: [(Option<String>, &[&str], &str); 4] = [
            (from, &[], "both give the camera"),
            (
                options.view.map(|_| "--view".to_owned()),
                &["eye", "view"],
                "both say where the camera looks from",
            ),
            (
                args.ortho.then(|| "--ortho".to_owned()),
                &["projection", "vertical_fov"],
                "contradict each other",
            ),
            (args.up.map(|_| "--up".to_owned()), &["up"], "both say which way is up"),
        ];
        for (option, keys, why) in conflicts {
            let Some(option) = option else { continue };
            let against = |(name, text): &&(String, String)| match name.as_str() {
                "projection" if text.contains("orthographic") => false,
                name => keys.is_empty() || keys.contains(&name),
            };
            if let Some((_, text)) = options.set.iter().find(against) {
                return Err(Failure::usage(format!(
                    "{option} and --set {text} {why}; leave one out"
                )));
            }
        }
        if args.camera_from.as_deref() == Some(Path::new(PIPE)) {
            return Err(Failure::usage(
                "--camera-from -: reads no picture from stdin, expected an EXR file; name one",
            ));
        }
        let from = args.camera_from.as_deref().map(Header::read).transpose()?;
        Ok(Self { from, ..options })
    }

    /// The overrides but for the height of a camera that only `--ortho` makes orthographic, which is kept for it.
    pub fn without_height(&mut self, set: Vec<String>) -> Result<Vec<String>, Failure> {
        if !self.ortho {
            return Ok(set);
        }
        let value_of = |text: &str| {
            let (path, value) = text.split_once('=')?;
            (path.trim() == HEIGHT).then(|| value.trim().to_owned())
        };
        for (text, value) in set.iter().filter_map(|text| Some((text, value_of(text)?))) {
            let camera = format!("[camera]\nprojection = \"orthographic\"\nheight = {value}\n");
            let keys = CameraKeys::from_toml(&camera, Path::new(&format!("--set {text}")))?;
            self.height = keys.height;
        }
        Ok(set.into_iter().filter(|text| value_of(text).is_none()).collect())
    }

    /// Puts the camera that the options mean into a scene, and fails where `--up` meets a camera that says what is up.
    pub fn apply(&self, scene: &mut Scene, path: &Path, is_scene: bool) -> Result<(), Failure> {
        let is_set = |name: &str| self.set.iter().any(|(known, _)| known == name);
        let keys = &mut scene.camera;
        if let Some(header) = &self.from {
            *keys = header.keys;
            return Ok(());
        }
        if self.ortho && !keys.is_orthographic {
            if let (Some(eye), Some(target), false) = (keys.eye, keys.target, is_set("eye")) {
                let ahead = [0, 1, 2].map(|axis| target[axis] - eye[axis]);
                (keys.eye, keys.view) = (None, Some(ViewFrom::Along(ahead)));
                if !is_set("target") {
                    keys.target = None;
                }
                if !is_set("focus") {
                    keys.focus = None;
                }
            }
            (keys.is_orthographic, keys.vertical_fov) = (true, None);
        }
        keys.height = self.height.or(keys.height);
        if let Some(view) = self.view {
            (keys.view, keys.eye) = (Some(view), None);
            // What belongs to where the scene's camera was.
            for (name, key) in [("height", &mut keys.height), ("focus", &mut keys.focus)] {
                if !is_set(name) {
                    *key = None;
                }
            }
            if !is_set("target") {
                keys.target = None;
            }
        }
        let says_up = keys.up.is_some() || (keys.eye.is_some() && keys.target.is_some());
        if is_scene && self.up.is_some() && says_up {
            return Err(Failure::usage(format!(
                "{}: --up is for point files and for scenes whose [camera] leaves up and either eye or target out, but \
                 this one says what is up; set camera.up there, or leave --up out",
                path.display()
            )));
        }
        Ok(())
    }

    /// Reports where the picture that the camera is taken from differs from this one in what it shows.
    pub fn note(&self, size: [u32; 2], projection: Option<&str>, progress: &Progress) {
        let Some(header) = &self.from else { return };
        let file = header.file.display();
        let aspect = f64::from(size[0]) / f64::from(size[1]);
        let [width, height] = size;
        if let Some(other) = header.aspect.filter(|other| (other / aspect - 1.0).abs() > 1e-3) {
            let sides = if aspect > other { "more" } else { "less" };
            progress.note(&format!(
                "{file}: its picture is {other:.4} times as wide as high, but this one, {width}x{height}, is {aspect:.4} times: \
                 it shows the same from top to bottom, and {sides} at the sides"
            ));
        }
        if header.projection.as_deref() != projection {
            let of = |projection: Option<&str>| projection.unwrap_or("none").to_owned();
            progress.warn(&format!(
                "{file}: its camera is in other coordinates than this scene, whose degrees became metres by another \
                 projection ({} there, {} here); take a camera from a picture of the same objects",
                of(header.projection.as_deref()),
                of(projection)
            ));
        }
        if header.keys.eye.is_some()
            && !header.keys.is_orthographic
            && header.keys.vertical_fov.is_none()
        {
            progress.note(&format!(
                "{file}: has no worldToNDC, which would say how wide its camera sees; the angle is chosen so that the \
                 objects are in the picture"
            ));
        }
    }
}

impl Header {
    fn read(file: &Path) -> Result<Self, Failure> {
        let headers = film::read_exr_headers(file)?;
        let fault = |what: &str| {
            Failure::usage(format!(
                "--camera-from {}: {what}; expected an EXR file with pointillist/scene, or with worldToCamera and \
                 worldToNDC",
                file.display()
            ))
        };
        let has_camera = |header: &&film::ExrHeader| {
            ["pointillist/scene", "worldToCamera", "worldToNDC"]
                .iter()
                .any(|name| header.get(name).is_some())
        };
        let header = headers
            .iter()
            .find(has_camera)
            .ok_or_else(|| fault("found no camera in its header"))?;
        let projection = header.text("pointillist/projection");
        let shown = header.window("displayWindow").map(|[left, top, right, bottom]| {
            (right - left + 1) as f64 / (bottom - top + 1).max(1) as f64
        });
        let read = |keys, aspect: Option<f64>| Self {
            file: file.into(),
            keys,
            aspect: aspect.filter(|aspect| aspect.is_finite() && *aspect > 0.0),
            projection,
        };
        if let Some(text) = header.text("pointillist/scene")
            && let Ok(keys) = CameraKeys::from_toml(&text, file)
            && keys.whole().is_some()
        {
            return Ok(read(keys, shown));
        }
        let origin = header.text("pointillist/origin").map_or(Ok([0.0; 3]), |text| {
            let numbers: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
            numbers.ok().and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| {
                fault(&format!("found pointillist/origin '{text}', expected three numbers"))
            })
        })?;
        let matrices = ["worldToCamera", "worldToNDC"].map(|name| header.matrix(name));
        let camera = plan::camera_of_matrices(matrices[0], matrices[1], origin)
            .map_err(|what| fault(&what))?;
        Ok(read(camera.keys, camera.aspect.or(shown)))
    }
}
