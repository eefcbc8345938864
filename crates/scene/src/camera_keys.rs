//! What a scene gives of its camera. Whatever is left out is chosen by the renderer, which knows the points.

use crate::document::{Node, Origin, Value};
use crate::error::Source;
use crate::keys::Absent::{self, Words};
use crate::keys::{
    DEFAULT_FOV, Fault, Kind, LARGE, LENGTH, POSITION, SHORT, Table, key, numbers, plain,
};
use crate::load::document_of;
use crate::read::{Reader, to_vector};
use crate::settings::quoted;
use crate::whole::{length, long_enough};
use crate::{Camera, Projection, SceneError};
use std::fmt::{self, Write};
use std::path::Path;

/// What is given of a camera: each key of `[camera]` may be left out.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CameraKeys {
    /// As [`Camera::eye`].
    pub eye: Option<[f64; 3]>,
    /// As [`Camera::target`].
    pub target: Option<[f64; 3]>,
    /// Where a framed camera looks from; only where eye or target is left out.
    pub view: Option<ViewFrom>,
    /// As [`Camera::up`].
    pub up: Option<[f64; 3]>,
    /// Whether rays are parallel.
    pub is_orthographic: bool,
    /// As [`Projection::Perspective`] has it.
    pub vertical_fov: Option<f64>,
    /// As [`Projection::Orthographic`] has it.
    pub height: Option<f64>,
    /// As [`Camera::aperture`].
    pub aperture: f64,
    /// As [`Camera::focus`].
    pub focus: Option<f64>,
}

/// Where a framed camera looks from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ViewFrom {
    /// The front: from +z where +y is up, from -y where +z is up.
    Front,
    /// The back.
    Back,
    /// The left side of whoever looks from the front.
    Left,
    /// The right side of whoever looks from the front.
    Right,
    /// Above.
    Top,
    /// Below.
    Bottom,
    /// The corner between front, right and top.
    Iso,
    /// The way that the camera looks, of any length from 1e-12.
    Along([f64; 3]),
}

impl ViewFrom {
    /// Those with names.
    pub const NAMED: [Self; 7] =
        [Self::Front, Self::Back, Self::Left, Self::Right, Self::Top, Self::Bottom, Self::Iso];
    /// Their names.
    pub const NAMES: [&str; 7] = ["front", "back", "left", "right", "top", "bottom", "iso"];

    /// The view of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMES.iter().position(|known| *known == name).map(|index| Self::NAMED[index])
    }

    /// As scene files write it.
    fn written(self) -> String {
        match (self, Self::NAMED.iter().position(|named| *named == self)) {
            (Self::Along(direction), _) => format!("{direction:?}"),
            (_, index) => format!("\"{}\"", Self::NAMES[index.unwrap_or(0)]),
        }
    }
}

impl CameraKeys {
    /// The camera, where nothing of it is left to choose.
    #[must_use]
    pub fn whole(&self) -> Option<Camera> {
        let (eye, target) = (self.eye?, self.target?);
        let projection = match (self.is_orthographic, self.height) {
            (true, None) => return None,
            (true, Some(height)) => Projection::Orthographic { height },
            (false, _) => {
                Projection::Perspective { vertical_fov: self.vertical_fov.unwrap_or(DEFAULT_FOV) }
            }
        };
        let up = self.up.unwrap_or([0.0, 1.0, 0.0]);
        Some(Camera { eye, target, up, projection, aperture: self.aperture, focus: self.focus })
    }

    /// What the `[camera]` of scene text says, such as that of a picture's header; `file` names the text in messages.
    ///
    /// # Errors
    /// Text that is no TOML, and keys that a camera does not have. Other tables are not looked at.
    pub fn from_toml(text: &str, file: &Path) -> Result<Self, SceneError> {
        let document = document_of(text, file)?;
        let Some(camera) = document.get("camera") else { return Ok(Self::default()) };
        let problems = crate::check::check_as(camera, &CAMERA);
        match problems.is_empty() {
            true => Ok(Self::read(&Reader::new(&CAMERA, Some(camera)))),
            false => Err(SceneError::problems(problems, &Source { file, text, overrides: &[] })),
        }
    }

    /// A checked table.
    pub(crate) fn read(table: &Reader<'_>) -> Self {
        let vector = |name: &str| table.written(name).map(|_| table.vector(name));
        let number = |name: &str| table.written(name).map(|_| table.number(name));
        Self {
            eye: vector("eye"),
            target: vector("target"),
            view: table.written("view").and_then(|node| match &node.value {
                Value::Text(name) => ViewFrom::named(name),
                direction => to_vector(direction).map(ViewFrom::Along),
            }),
            up: vector("up"),
            is_orthographic: table.text("projection") == "orthographic",
            vertical_fov: number("vertical_fov"),
            height: number("height"),
            aperture: table.number("aperture"),
            focus: number("focus"),
        }
    }

    /// As canonical TOML, with the names of what the eye is inside; nothing where nothing is given.
    pub(crate) fn write(&self, inside: Option<&[String]>, out: &mut String) -> fmt::Result {
        if *self == Self::default() && inside.is_none() {
            return Ok(());
        }
        writeln!(out, "[camera]")?;
        if let Some(eye) = self.eye {
            writeln!(out, "eye = {eye:?}")?;
        }
        if let Some(target) = self.target {
            writeln!(out, "target = {target:?}")?;
        }
        if let Some(view) = self.view {
            writeln!(out, "view = {}", view.written())?;
        }
        let whole = self.whole();
        if let Some(up) = self.up.or(whole.map(|camera| camera.up)) {
            writeln!(out, "up = {up:?}")?;
        }
        let fov = self.vertical_fov.or(whole.and(Some(DEFAULT_FOV)));
        if self.is_orthographic {
            writeln!(out, "projection = \"orthographic\"")?;
        } else {
            writeln!(out, "projection = \"perspective\"")?;
        }
        if let Some(fov) = fov.filter(|_| !self.is_orthographic) {
            writeln!(out, "vertical_fov = {fov:?}")?;
        }
        if let Some(height) = self.height {
            writeln!(out, "height = {height:?}")?;
        }
        writeln!(out, "aperture = {:?}", self.aperture)?;
        if let Some(focus) = self.focus {
            writeln!(out, "focus = {focus:?}")?;
        }
        if let Some(inside) = inside {
            let names: Vec<String> = inside.iter().map(|name| quoted(name)).collect();
            writeln!(out, "inside = [{}]", names.join(", "))?;
        }
        writeln!(out)
    }
}

impl From<Camera> for CameraKeys {
    fn from(camera: Camera) -> Self {
        let Camera { eye, target, up, projection, aperture, focus } = camera;
        let (is_orthographic, vertical_fov, height) = match projection {
            Projection::Perspective { vertical_fov } => (false, Some(vertical_fov), None),
            Projection::Orthographic { height } => (true, None, Some(height)),
        };
        Self {
            eye: Some(eye),
            target: Some(target),
            view: None,
            up: Some(up),
            is_orthographic,
            vertical_fov,
            height,
            aperture,
            focus,
        }
    }
}

/// Which keys of the camera `PATH=VALUE` overrides give, each with the first override that does. What is wrong with
/// them is found when a scene is loaded.
#[must_use]
pub fn camera_keys_set(overrides: &[String]) -> Vec<(String, String)> {
    let mut found: Vec<(String, String)> = Vec::new();
    for (index, text) in overrides.iter().enumerate() {
        let mut document = Node::empty_table(Origin::Given);
        if crate::overrides::apply(&mut document, index, text).is_err() {
            continue;
        }
        let Some(Value::Table(entries)) = document.get("camera").map(|node| &node.value) else {
            continue;
        };
        for entry in entries {
            if found.iter().all(|(name, _)| *name != entry.name) {
                found.push((entry.name.clone(), text.clone()));
            }
        }
    }
    found
}

pub(crate) static CAMERA: Table = Table {
    header: "[camera]",
    doc: "A camera with square pixels, row 0 at the top. Whatever is left out is chosen so that the objects are in the \
          picture: see [below](#the-automatic-camera).",
    whole: Some(camera_has_a_view),
    keys: &[
        key(
            "eye",
            POSITION,
            Words("as far away as the objects need", "[0.0, 0.4, 3.0]"),
            "Where the camera is, in the world.",
        ),
        key(
            "target",
            POSITION,
            Words("in the middle of the objects", "[0.0, 0.0, 0.0]"),
            "The point in the picture's middle.",
        ),
        key(
            "view",
            Kind::Either(&[Kind::Choice(&ViewFrom::NAMES), Kind::Direction]),
            Words("from the front, a little from the right and from above", "\"front\""),
            "Where the camera looks from, or the way that it looks, as three numbers; only where eye or target is left out.",
        ),
        key(
            "up",
            Kind::Direction,
            Absent::Value("[0.0, 1.0, 0.0]"),
            "The direction that is upwards in the picture; not parallel to the line of sight. `--up` goes before the \
             default.",
        ),
        key(
            "vertical_fov",
            Kind::Number(numbers(0.001, 179.0, "degrees")),
            Words(
                "35; 40 where eye is left out; what holds the objects, at most 90, where only target is",
                "35.0",
            ),
            "Perspective only: angle between the lower and the upper edge of the picture.",
        ),
        key(
            "projection",
            Kind::Choice(&["perspective", "orthographic"]),
            Absent::Value("\"perspective\""),
            "Rays from the eye, or parallel ones from the plane through the eye across the line of \
             sight.",
        ),
        key(
            "height",
            LENGTH,
            Words("what holds the objects", "2.0"),
            "Orthographic only: height of what the picture shows.",
        ),
        key(
            "aperture",
            Kind::Number(numbers(0.0, LARGE, "scene units")),
            Absent::Value("0.0"),
            "Diameter of the lens; what is out of focus is blurred, with `image.samples` over 1. 0 is a \
             pinhole: everything is sharp. At most 1000 times the distance in focus.",
        ),
        key(
            "focus",
            LENGTH,
            Words("the distance from eye to target", "3.0"),
            "Distance of the plane in focus from the eye, along the line of sight.",
        ),
        key(
            "inside",
            Kind::Names("an object of glass"),
            Words("found by normals, else by counting surfaces around the eye", "\"bottle\""),
            "The glass that the eye is inside: an object's name, a list of names, or [] for none. Spheres \
             count where they hold the eye.",
        ),
    ],
};

/// The sine of the smallest angle between `up` and the line of sight.
const MIN_SINE: f64 = 1e-6;

/// A camera looks along a line, and `up` is not along it: as far as both are given.
fn camera_has_a_view(camera: &Reader<'_>) -> Result<(), Fault> {
    let given = |name: &str| camera.written(name).is_some();
    let up = camera.vector("up");
    long_enough("up", up)?;
    let focus = match (given("eye"), given("target")) {
        (true, true) => {
            let [eye, target] = ["eye", "target"].map(|name| camera.vector(name));
            let view = [target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]];
            let distance = length(view);
            if distance < SHORT {
                let message = format!(
                    "found {} scene units from camera.eye, expected at least {}; move it apart",
                    plain(distance),
                    plain(SHORT)
                );
                return Err(("target", message));
            }
            if given("view") {
                let message = "belongs to a camera without eye or target, but both are given; remove one of the three";
                return Err(("view", message.into()));
            }
            lies_across(view, up, "from camera.eye to camera.target")?;
            Some(distance)
        }
        _ => None,
    };
    if let Some(view) = camera.written("view").and_then(|node| to_vector(&node.value)) {
        long_enough("view", view)?;
        if given("up") {
            lies_across(view, up, "along camera.view")?;
        }
    }
    projection_has_its_keys(camera)?;
    let focus = camera.written("focus").map(|_| camera.number("focus")).or(focus);
    focus.map_or(Ok(()), |focus| lens_is_no_wider_than_rays_can_bear(camera, focus))
}

/// `up` is not parallel to the line of sight.
fn lies_across(view: [f64; 3], up: [f64; 3], line: &str) -> Result<(), Fault> {
    let (v, u) = (view.map(|x| x / length(view)), up.map(|x| x / length(up)));
    let cross = [v[1] * u[2] - v[2] * u[1], v[2] * u[0] - v[0] * u[2], v[0] * u[1] - v[1] * u[0]];
    if length(cross) < MIN_SINE {
        let message = format!(
            "found a direction parallel to the line of sight {line}, expected one across it; turn it"
        );
        return Err(("up", message));
    }
    Ok(())
}

/// Each projection has one key that says how much it shows.
fn projection_has_its_keys(camera: &Reader<'_>) -> Result<(), Fault> {
    let projection = camera.text("projection");
    let foreign = if projection == "orthographic" { "vertical_fov" } else { "height" };
    if camera.written(foreign).is_some() {
        let owner = if foreign == "height" { "orthographic" } else { "perspective" };
        let message = format!(
            "belongs to projection \"{owner}\", but projection is \"{projection}\"; remove one"
        );
        return Err((foreign, message));
    }
    Ok(())
}

/// Widest lens over the distance in focus.
const MAX_APERTURE: f64 = 1000.0;

/// Rays from its rim still go forward.
fn lens_is_no_wider_than_rays_can_bear(camera: &Reader<'_>, focus: f64) -> Result<(), Fault> {
    let aperture = camera.number("aperture");
    if aperture > MAX_APERTURE * focus {
        let message = format!(
            "found {} scene units with a focus at {}, expected at most {MAX_APERTURE} times as much; \
             lower it",
            plain(aperture),
            plain(focus)
        );
        return Err(("aperture", message));
    }
    Ok(())
}
