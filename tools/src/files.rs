//! Files that are whole or absent.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A file that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {path}: {source}; check that the folder exists and has room")]
pub struct WriteError {
    path: PathBuf,
    source: io::Error,
}

/// Writes a file, aside first and then renamed, so that no half file is left.
///
/// # Errors
/// Whatever the file system says.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let mut aside = path.as_os_str().to_owned();
    aside.push(".part");
    let aside = PathBuf::from(aside);
    let written = fs::write(&aside, bytes).and_then(|()| fs::rename(&aside, path));
    written.map_err(|source| {
        // What is left of the file is of no use; that it cannot be removed is no second error.
        let _ = fs::remove_file(&aside);
        WriteError { path: path.to_owned(), source }
    })
}
