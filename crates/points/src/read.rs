//! Point files, told apart by their contents.

use crate::ply;
use crate::set::PointSet;
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// How the files begin that are recognised but not read, and what they are.
const KNOWN: [(&[u8], &str); 5] = [
    (b"LASF", "LAS"),
    (b"ASTM-E57", "E57"),
    (b"# .PCD", "PCD"),
    (b"\x93NUMPY", "NumPy"),
    (b"# vtk", "VTK"),
];

/// Reads the points of a file. Today that is PLY, in all three encodings.
///
/// `progress` is told from time to time how many bytes were read, and how many the file has: 0 if
/// the system does not know, as for a pipe. Points with a coordinate that is infinite or not a
/// number are dropped and counted.
///
/// # Errors
/// [`PointsError`] if the file cannot be read, is of another kind, is damaged, or has no usable
/// point.
pub fn read(path: &Path, progress: &mut dyn FnMut(u64, u64)) -> Result<PointSet, PointsError> {
    let io_error = |source| PointsError::Io { path: path.into(), source };
    let mut file = File::open(path).map_err(io_error)?;
    let metadata = file.metadata().map_err(io_error)?;
    if metadata.is_dir() {
        return Err(PointsError::IsFolder { path: path.into() });
    }
    let length = metadata.is_file().then_some(metadata.len());

    let mut start = Vec::new();
    file.by_ref().take(16).read_to_end(&mut start).map_err(io_error)?;
    if start.is_empty() {
        return Err(PointsError::Empty { path: path.into() });
    }
    if !ply::is_ply(&start) {
        let found = match KNOWN.iter().find(|(magic, _)| start.starts_with(magic)) {
            Some((_, name)) => format!("a {name} file"),
            None => format!("a file that begins with {}", Quoted(&start)),
        };
        return Err(PointsError::UnknownKind { path: path.into(), found });
    }
    ply::read(io::Cursor::new(start).chain(file), length, path, progress)
}

/// Why a point file gave no points.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PointsError {
    /// The file could not be opened or read.
    #[error("{}: cannot read the file; check its name and permissions", path.display())]
    Io {
        /// The file as given.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The path is a folder's.
    #[error("{}: found a folder, expected a point file; name a file in it", path.display())]
    IsFolder {
        /// The path as given.
        path: PathBuf,
    },
    /// The file has no bytes.
    #[error("{}: the file is empty, expected a PLY file; export it again", path.display())]
    Empty {
        /// The file as given.
        path: PathBuf,
    },
    /// The contents are of a kind that is not read.
    #[error("{}: found {found}, expected a PLY file (.ply); convert it to PLY", path.display())]
    UnknownKind {
        /// The file as given.
        path: PathBuf,
        /// What the contents look like.
        found: String,
    },
    /// A line of a header, or of a text file, is not as it should be.
    #[error("{}:{line}: found {found}, expected {expected}; {help}", path.display())]
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
    /// The header declares no such element or property.
    #[error("{}: found no {missing}, expected it {place}; {help}", path.display())]
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
    /// The file ends before the data that the header declares.
    #[error(
        "{}: the header declares {declared} of element '{element}'{}, but the file ends after \
         {found}{}; the file is cut off or its header wrong: copy or export it again",
        path.display(), in_bytes("needing", *bytes_declared), in_bytes("in", *bytes_found)
    )]
    CutOff {
        /// The file as given.
        path: PathBuf,
        /// The element that is cut off.
        element: String,
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
        path.display()
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
        path.display(), u32::MAX
    )]
    TooMany {
        /// The file as given.
        path: PathBuf,
        /// How many there are.
        found: u64,
    },
    /// No point has a usable position.
    #[error(
        "{}: found no usable point: {in_file} in the file, {non_finite} of them dropped for a \
         coordinate that is infinite or not a number; export points with finite positions",
        path.display()
    )]
    NoPoints {
        /// The file as given.
        path: PathBuf,
        /// Points in the file.
        in_file: u64,
        /// Points dropped for their position.
        non_finite: u64,
    },
    /// The machine has too little memory.
    #[error("{}: not enough memory for {points} points; thin them out", path.display())]
    OutOfMemory {
        /// The file as given.
        path: PathBuf,
        /// How many points memory was asked for.
        points: u64,
    },
}

impl PointsError {
    /// Whether the machine, not the file, is at fault.
    pub fn is_out_of_memory(&self) -> bool {
        match self {
            Self::OutOfMemory { .. } => true,
            Self::Io { source, .. } => source.kind() == io::ErrorKind::OutOfMemory,
            _ => false,
        }
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
