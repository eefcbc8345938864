//! From text to a checked scene.

use crate::{Scene, SceneError, Up};
use std::path::Path;

fn unfinished(file: &Path) -> SceneError {
    SceneError::one(format!("{}: scene files are not built yet", file.display()))
}

impl Scene {
    /// Reads and checks a scene file. `overrides` are `PATH=VALUE`, applied in order before the
    /// checks.
    pub fn load(path: &Path, overrides: &[String]) -> Result<Scene, SceneError> {
        let _ = overrides;
        Err(unfinished(path))
    }

    /// Checks scene text as if it were read from `file`, which names it in messages and whose
    /// folder relative paths start from. Opens nothing.
    pub fn from_toml(text: &str, file: &Path, overrides: &[String]) -> Result<Scene, SceneError> {
        let _ = (text, overrides);
        Err(unfinished(file))
    }

    /// The scene that a point file rendered directly means: one object with defaults, no camera,
    /// a key light and a dim fill light, a neutral background.
    pub fn for_point_file(
        points: &Path,
        up: Up,
        overrides: &[String],
    ) -> Result<Scene, SceneError> {
        let _ = (up, overrides);
        Err(unfinished(points))
    }

    /// Canonical TOML of everything that changes a picture: neither `cells_per_pass` nor `loop`.
    pub fn settings_toml(&self) -> String {
        String::new()
    }
}

/// The JSON Schema of scene files.
pub fn json_schema() -> serde_json::Value {
    serde_json::Value::Null
}
