//! What can go wrong between a film and its file.

use std::io;
use std::path::PathBuf;

/// A picture could not be written or read. The file in question is named in each message.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FilmError {
    /// The extension names no format.
    #[error(
        "{}: found the extension '{found}', expected '.exr', '.png' or '.jpg'; rename the output",
        path.display()
    )]
    UnknownFormat {
        /// The output as given.
        path: PathBuf,
        /// Its extension without the dot, empty if there is none.
        found: String,
    },
    /// The program's own font cannot be read.
    #[error("the font that is part of the program is damaged; install the program again")]
    Font,
    /// The file to write or to read is a folder.
    #[error("{}: found a folder, expected a file; add a file name", path.display())]
    IsFolder {
        /// The path as given.
        path: PathBuf,
    },
    /// The file to read is neither a file nor a folder.
    #[error("{}: found a pipe or a device, expected a file; save it to a file first", path.display())]
    NotFile {
        /// The path as given.
        path: PathBuf,
    },
    /// What should be the output's folder is none.
    #[error(
        "{}: there is no folder '{}'; create it or choose another",
        path.display(),
        folder.display()
    )]
    NoFolder {
        /// The output as given.
        path: PathBuf,
        /// The folder it would lie in.
        folder: PathBuf,
    },
    /// The output exists and may not be written to.
    #[error(
        "{}: the file exists and is write-protected; allow writing or choose another name",
        path.display()
    )]
    WriteProtected {
        /// The output as given.
        path: PathBuf,
    },
    /// The file could not be created or written.
    #[error("{}: cannot write the file; {}", path.display(), next_step(source))]
    Write {
        /// The output as given.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The format cannot hold this picture.
    #[error("{}: cannot encode {width} x {height} pixels: {reason}; choose '.exr'", path.display())]
    Encode {
        /// The output as given.
        path: PathBuf,
        /// Columns of the picture.
        width: u32,
        /// Rows of the picture.
        height: u32,
        /// What the encoder said.
        reason: String,
    },
    /// The header cannot be written as given.
    #[error("{}: cannot write the header: {reason}; shorten or rename the setting", path.display())]
    Header {
        /// The output as given.
        path: PathBuf,
        /// What is wrong with which attribute.
        reason: String,
    },
    /// The file could not be opened or read.
    #[error("{}: cannot read the file; check its name and permissions", path.display())]
    Read {
        /// The input as given.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file is no image that a scene can use.
    #[error(
        "{}: expected an image in PNG, JPEG, OpenEXR or Radiance HDR: {reason}; export it again",
        path.display()
    )]
    NotImage {
        /// The input as given.
        path: PathBuf,
        /// What was found.
        reason: String,
    },
    /// The file is not a picture that can be read here.
    #[error("{}: expected an OpenEXR picture: {reason}; export it again", path.display())]
    NotExr {
        /// The input as given.
        path: PathBuf,
        /// What was found.
        reason: String,
    },
}

impl FilmError {
    /// Whether the disk, or the user's share of it, is full, or files may not grow that long.
    pub fn is_out_of_space(&self) -> bool {
        matches!(self, Self::Write { source, .. } if is_full(source))
    }
}

fn is_full(error: &io::Error) -> bool {
    use io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull};
    matches!(error.kind(), StorageFull | QuotaExceeded | FileTooLarge)
}

/// What to do about an error of writing.
fn next_step(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::FileTooLarge => {
            "raise the limit on the size of files, as 'ulimit -f' shows it"
        }
        _ if is_full(error) => "free some space or choose another disk",
        io::ErrorKind::PermissionDenied => "allow writing to its folder or choose another",
        io::ErrorKind::ReadOnlyFilesystem => "choose a folder on another disk",
        io::ErrorKind::InvalidFilename => "choose a shorter name",
        _ => "check the disk or choose another folder",
    }
}
