//! Why a point file gave no points.

use crate::format;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Why a point file gave no points.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PointsError {
    /// The file could not be opened or read.
    #[error("{}: cannot read the file; check its name and permissions", Shown(path))]
    Io {
        /// The file as given.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The path is a folder's.
    #[error("{}: found a folder, expected a point file; name a file in it", Shown(path))]
    IsFolder {
        /// The path as given.
        path: PathBuf,
    },
    /// The file has no bytes.
    #[error("{}: the file is empty, expected a point file; export it again", Shown(path))]
    Empty {
        /// The file as given.
        path: PathBuf,
    },
    /// The contents are of a kind that is not read.
    #[error("{}: found {found}, expected a point file ({}); {help}", Shown(path), format::names())]
    UnknownKind {
        /// The file as given.
        path: PathBuf,
        /// What the contents look like.
        found: String,
        /// What to do.
        help: String,
    },
    /// The file holds no points, but names others that do.
    #[error(
        "{}: found a list of {count} files ({kind}), expected points; {}",
        Shown(path), to_open(pieces, *count)
    )]
    Pieces {
        /// The file as given.
        path: PathBuf,
        /// What the list is called.
        kind: String,
        /// The first of the files, where the list is given.
        pieces: Vec<PathBuf>,
        /// How many files there are.
        count: usize,
    },
    /// A line of a header, or of a text file, is not as it should be.
    #[error("{}:{line}: found {found}, expected {expected}; {help}", Shown(path))]
    Line {
        /// The file as given.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// What stands there.
        found: String,
        /// What should stand there.
        expected: String,
        /// What to do.
        help: &'static str,
    },
    /// The file has no such part.
    #[error("{}: found no {missing}, expected it {place}; {help}", Shown(path))]
    Missing {
        /// The file as given.
        path: PathBuf,
        /// What is missing.
        missing: String,
        /// Where it was looked for, and what is there.
        place: String,
        /// What to do.
        help: &'static str,
    },
    /// A number or name in the file is not as it should be, or is not read.
    #[error("{}: found {found} as {place}, expected {expected}; {help}", Shown(path))]
    Wrong {
        /// The file as given.
        path: PathBuf,
        /// What it says: `the point record length in the header`.
        place: Box<str>,
        /// What stands there.
        found: Box<str>,
        /// What should stand there.
        expected: String,
        /// What to do.
        help: &'static str,
    },
    /// The file ends before the data that the header declares.
    #[error(
        "{}: the header declares {declared} {what}{}, but the file ends after {found}{}; the file \
         is cut off or its header wrong: copy or export it again",
        Shown(path), in_bytes("needing", *bytes_declared), in_bytes("in", *bytes_found)
    )]
    CutOff {
        /// The file as given.
        path: PathBuf,
        /// What is cut off: `points`, `of element 'vertex'`.
        what: String,
        /// How many of it the header declares.
        declared: u64,
        /// How many of it are there entirely.
        found: u64,
        /// How many bytes the element needs, where that is known.
        bytes_declared: Option<u128>,
        /// How many bytes are left for it in the file, where that is known.
        bytes_found: Option<u64>,
    },
    /// A list in a binary file has a negative length.
    #[error(
        "{}: found a list of length {length} in property '{property}' of {element} {index} (from \
         0), expected 0 or more; the file is damaged: copy or export it again",
        Shown(path)
    )]
    ListLength {
        /// The file as given.
        path: PathBuf,
        /// The element with the list.
        element: String,
        /// Which of them, from 0.
        index: u64,
        /// The list's name.
        property: String,
        /// The length found.
        length: f64,
    },
    /// The file has more points than indices of 32 bits can tell apart.
    #[error(
        "{}: found {found} points, at most {} are possible; thin them out",
        Shown(path),
        u32::MAX
    )]
    TooMany {
        /// The file as given.
        path: PathBuf,
        /// How many there are.
        found: u64,
    },
    /// A file that is read twice was not the same again.
    #[error("{}: the file changed while it was read; try again when it is complete", Shown(path))]
    Changed {
        /// The file as given.
        path: PathBuf,
    },
    /// The file has no points.
    #[error(
        "{}: the file holds no points, not even unusable ones; export it again with points",
        Shown(path)
    )]
    WithoutPoints {
        /// The file as given.
        path: PathBuf,
    },
    /// No point has a usable position.
    #[error(
        "{}: found no usable point: {in_file} in the file, {non_finite} of them dropped for a \
         coordinate that is infinite or not a number{}; export points with finite positions",
        Shown(path), if *invalid > 0 { format!(", {invalid} marked invalid") } else { String::new() }
    )]
    NoPoints {
        /// The file as given.
        path: PathBuf,
        /// Points in the file.
        in_file: u64,
        /// Points dropped for their position.
        non_finite: u64,
        /// Points that the file itself calls invalid.
        invalid: u64,
    },
    /// The filter keeps no point.
    #[error("{}: the filter ({filter}) keeps none of {usable} points; widen it", Shown(path))]
    FilteredOut {
        /// The file as given.
        path: PathBuf,
        /// Points with a usable position.
        usable: u64,
        /// The filter as a scene file says it.
        filter: String,
    },
    /// The machine has too little memory.
    #[error("{}: not enough memory for {points} points; thin them out", Shown(path))]
    OutOfMemory {
        /// The file as given.
        path: PathBuf,
        /// How many points memory was asked for.
        points: u64,
    },
}

impl PointsError {
    /// What a number or name in the file says, and what it should say.
    pub(crate) fn wrong(
        path: &Path,
        place: &str,
        found: impl fmt::Display,
        expected: &str,
        help: &'static str,
    ) -> Self {
        Self::Wrong {
            path: path.into(),
            place: place.into(),
            found: found.to_string().into(),
            expected: expected.to_owned(),
            help,
        }
    }

    /// Whether the machine, not the file, is at fault.
    pub fn is_out_of_memory(&self) -> bool {
        match self {
            Self::OutOfMemory { .. } => true,
            Self::Io { source, .. } => source.kind() == io::ErrorKind::OutOfMemory,
            _ => false,
        }
    }
}

/// The name of a file in a message: on one line, whatever it is.
struct Shown<'a>(&'a Path);

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = self.0.display().to_string();
        for sign in shown.chars() {
            match sign.is_control() {
                true => write!(f, "{}", sign.escape_debug())?,
                false => write!(f, "{sign}")?,
            }
        }
        Ok(())
    }
}

/// What to do with a list of files.
fn to_open(pieces: &[PathBuf], count: usize) -> String {
    let shown: Vec<String> = pieces.iter().map(|piece| Shown(piece).to_string()).collect();
    match count - shown.len().min(count) {
        _ if shown.is_empty() => "save the data as VTU or VTP".to_owned(),
        0 if count == 1 => format!("open that file: {}", shown.join(", ")),
        0 => format!("open one of them: {}", shown.join(", ")),
        more => format!("open one of them: {} and {more} more", shown.join(", ")),
    }
}

fn in_bytes(word: &str, bytes: Option<impl fmt::Display>) -> String {
    bytes.map_or_else(String::new, |bytes| format!(" {word} {bytes} bytes"))
}

/// Bytes of a file in a message: short, on one line, whatever they are.
pub(crate) struct Quoted<'a>(pub(crate) &'a [u8]);

impl fmt::Display for Quoted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const MAX: usize = 40;
        let shown = &self.0[..self.0.len().min(MAX)];
        let more = if self.0.len() > MAX { "…" } else { "" };
        write!(f, "'{}{more}'", String::from_utf8_lossy(shown).escape_debug())
    }
}
