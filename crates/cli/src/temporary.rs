//! Folders of temporary files, which are removed however the process ends, but by SIGKILL.

use crate::errors::Failure;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Those that there are.
static ALL: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// A folder that is removed with this.
pub struct Folder(tempfile::TempDir);

impl Folder {
    /// A new one, whose name begins so.
    pub fn new(prefix: &str) -> Result<Self, Failure> {
        let mut all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
        let folder =
            tempfile::Builder::new().prefix(prefix).tempdir().map_err(|error| cannot(&error))?;
        all.push(folder.path().to_owned());
        Ok(Self(folder))
    }

    /// Lets it be there until the process ends.
    pub fn keep(self) {
        std::mem::forget(self);
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.0.path()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let mut all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
        all.retain(|other| other != self.0.path());
    }
}

/// Why a temporary file cannot be written.
pub fn cannot(error: &io::Error) -> Failure {
    let place = std::env::temp_dir();
    Failure::exhausted(format!(
        "cannot write to the folder of temporary files '{}': {error}; free some space, or name another folder by \
         TMPDIR",
        place.display()
    ))
}

/// Removes all: for a process that ends at once, in which no destructor runs.
pub fn remove_all() {
    remove(&mut ALL.lock().unwrap_or_else(PoisonError::into_inner));
}

/// The same for a process that has no memory left or has crashed: it waits for nobody.
pub fn remove_all_at_once() {
    if let Ok(mut all) = ALL.try_lock() {
        remove(&mut all);
    }
}

fn remove(all: &mut Vec<PathBuf>) {
    for folder in all.drain(..) {
        // Nobody is left to read it.
        let _ = std::fs::remove_dir_all(folder);
    }
}
