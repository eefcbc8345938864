//! What a plan chose where a scene leaves it to the program: lengths that are "auto", ranges that a colour map took.

use std::fmt;

/// One value that was chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// Index of the object in the scene.
    pub object: usize,
    /// The key that would say so, below the object: `volume.radius`.
    pub key: &'static str,
    /// What it would say.
    pub value: Choice,
}

/// What was chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Choice {
    /// A number, in the key's unit.
    Number(f64),
    /// The values at the lower and the upper end.
    Range([f64; 2]),
    /// A word.
    Word(&'static str),
}

/// `objects.0.volume.radius=0.05`, as `--set` takes it.
impl fmt::Display for Chosen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "objects.{}.{}={}", self.object, self.key, self.value)
    }
}

/// The shortest decimals that parse back to the same numbers.
impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number:?}"),
            Self::Range([low, high]) => write!(f, "[{low:?}, {high:?}]"),
            Self::Word(word) => write!(f, "\"{word}\""),
        }
    }
}

/// What an EXR's header says of it: a line for each, or nothing where nothing was chosen.
pub(crate) fn attribute(chosen: &[Chosen]) -> Option<(String, String)> {
    let lines: Vec<String> = chosen.iter().map(Chosen::to_string).collect();
    (!lines.is_empty()).then(|| ("chosen".to_owned(), lines.join("\n")))
}

/// What a plan finds on its way that its picture does not show.
#[derive(Debug, Default)]
pub(crate) struct Findings {
    /// Points that lack what is shown of them.
    pub missing: Vec<crate::Missing>,
    /// What was chosen.
    pub chosen: Vec<Chosen>,
    /// Steps through volumes that are too long for the data.
    pub long_steps: Vec<String>,
}

impl Findings {
    /// Notes a number that was chosen.
    pub(crate) fn number(&mut self, object: usize, key: &'static str, value: f64) {
        self.chosen.push(Chosen { object, key, value: Choice::Number(value) });
    }

    /// Notes a word that was chosen.
    pub(crate) fn word(&mut self, object: usize, key: &'static str, value: &'static str) {
        self.chosen.push(Chosen { object, key, value: Choice::Word(value) });
    }

    /// Notes a range that was chosen.
    pub(crate) fn range(&mut self, object: usize, key: &'static str, value: [f64; 2]) {
        self.chosen.push(Chosen { object, key, value: Choice::Range(value) });
    }
}
