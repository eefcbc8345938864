//! What a scene gives of its camera. Whatever is left out is chosen by the renderer, which knows the points.

use crate::document::{Node, Origin, Value};
use crate::error::Source;
use crate::keys::{CAMERA, DEFAULT_FOV};
use crate::load::document_of;
use crate::read::{Reader, to_vector};
use crate::settings::quoted;
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
