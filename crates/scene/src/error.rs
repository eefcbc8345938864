//! What is wrong with a scene, as one message a line.

use crate::document::{Origin, cut};
use std::fmt;
use std::path::Path;

/// More lines than this are counted, not shown.
const MAX_LINES: usize = 20;

/// Everything wrong with a scene file, in the order of the file, then of the overrides.
///
/// Displays as one line a problem:
/// `a.toml:12:9: objects[0].surface.trust: found 1.7, expected a number from 0.5 to 1; lower it`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneError {
    lines: Vec<String>,
}

/// One thing that is wrong.
#[derive(Debug, Clone)]
pub(crate) struct Problem {
    pub(crate) origin: Origin,
    /// The key with its tables and indices; empty when it is no key's.
    pub(crate) path: String,
    pub(crate) message: String,
}

/// What origins refer to.
pub(crate) struct Source<'a> {
    pub(crate) file: &'a Path,
    pub(crate) text: &'a str,
    pub(crate) overrides: &'a [String],
}

impl SceneError {
    /// An error about a file as a whole.
    pub(crate) fn file(file: &Path, message: &str) -> Self {
        Self { lines: vec![format!("{}: {message}", file.display())] }
    }

    /// An error at a byte of a file.
    pub(crate) fn at(file: &Path, text: &[u8], offset: usize, message: &str) -> Self {
        let (line, column) = line_column(text, offset);
        Self { lines: vec![format!("{}:{line}:{column}: {message}", file.display())] }
    }

    /// Problems found by the checker, of which there is at least one.
    pub(crate) fn problems(mut problems: Vec<Problem>, source: &Source<'_>) -> Self {
        problems.sort_by_key(|problem| problem.origin);
        let count = problems.len();
        let mut lines: Vec<String> =
            problems.iter().take(MAX_LINES).map(|problem| problem.line(source)).collect();
        if count > MAX_LINES {
            lines.push(format!("{}: and {} more", source.file.display(), count - MAX_LINES));
        }
        Self { lines }
    }

    /// Whether all that is wrong is that models are missing which the repository does not have: see
    /// [`MODELS_VARIABLE`](crate::MODELS_VARIABLE).
    pub fn lacks_models_alone(&self) -> bool {
        self.lines.iter().all(|line| line.contains(crate::MODELS_VARIABLE))
    }

    /// The problems, one line each, at least one.
    pub fn lines(&self) -> &[String] {
        &self.lines
    }
}

impl Problem {
    fn line(&self, source: &Source<'_>) -> String {
        let file = source.file.display();
        let place = match self.origin {
            Origin::At(offset) => {
                let (line, column) = line_column(source.text.as_bytes(), offset);
                format!("{file}:{line}:{column}")
            }
            Origin::Set(index) => {
                let text = source.overrides.get(index).map_or("", String::as_str);
                format!("{file}: --set {}", cut(text))
            }
            Origin::Given => file.to_string(),
        };
        let Self { path, message, .. } = self;
        if path.is_empty() {
            format!("{place}: {message}")
        } else {
            format!("{place}: {path}: {message}")
        }
    }
}

/// Line and column, both from 1; columns count characters.
fn line_column(text: &[u8], offset: usize) -> (usize, usize) {
    let before = &text[..offset.min(text.len())];
    let line = before.iter().filter(|&&byte| byte == b'\n').count() + 1;
    let start = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |at| at + 1);
    (line, String::from_utf8_lossy(&before[start..]).chars().count() + 1)
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.lines.join("\n"))
    }
}

impl std::error::Error for SceneError {}
