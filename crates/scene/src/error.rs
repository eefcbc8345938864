//! What is wrong with a scene, as one message a line.

use std::fmt;

/// Everything wrong with a scene file, in the order of the file. Displays as one line a problem:
/// `a.toml:12:9: objects[0].surface.trust: found 1.7, expected a number from 0.5 to 1; lower it …`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneError {
    lines: Vec<String>,
}

impl SceneError {
    /// An error of one line.
    pub(crate) fn one(line: String) -> Self {
        Self { lines: vec![line] }
    }

    /// The problems, one line each, at least one.
    pub fn lines(&self) -> &[String] {
        &self.lines
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.lines.join("\n"))
    }
}

impl std::error::Error for SceneError {}
