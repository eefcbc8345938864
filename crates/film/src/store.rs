//! Files that are written whole or not at all.
//!
//! The bytes go to a temporary file in the output's folder, which then takes the output's name:
//! whoever reads the output sees the old file or the new one. A link is followed, so that the link
//! stays. What is neither file nor folder (a pipe, a device) cannot be renamed over and is written
//! directly.

use crate::error::FilmError;
use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// What is being written aside.
static ASIDE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// A chain of links longer than this is taken for a loop, as Linux does.
const MAX_LINKS: usize = 40;

/// Makes `path` a file of these bytes, whole or not at all. An existing file is replaced; through a
/// link, the file that the link names.
///
/// # Errors
/// A folder that is missing or cannot be written to, a full disk ([`FilmError::is_out_of_space`]).
/// Nothing is left behind then, and a file that was there before is as it was.
pub fn store(path: &Path, bytes: &[u8]) -> Result<(), FilmError> {
    let write_error = |source| FilmError::Write { path: path.into(), source };
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => Err(FilmError::IsFolder { path: path.into() }),
        // By the path as given: /dev/stdout leads to names such as 'pipe:[1]' that nobody can open.
        Ok(found) if !found.is_file() => OpenOptions::new()
            .write(true)
            .open(path)
            .and_then(|mut device| device.write_all(bytes))
            .map_err(write_error),
        Ok(found) if found.permissions().readonly() => {
            Err(FilmError::WriteProtected { path: path.into() })
        }
        // A file that is replaced keeps its permissions.
        Ok(found) => follow_links(path)
            .and_then(|target| replace(&target, bytes, Some(found.permissions())))
            .map_err(write_error),
        Err(_) => {
            let target = follow_links(path).map_err(write_error)?;
            let folder = folder_of(&target);
            if folder.is_dir() {
                replace(&target, bytes, None).map_err(write_error)
            } else {
                Err(FilmError::NoFolder { path: path.into(), folder: folder.into() })
            }
        }
    }
}

/// Removes what is being written aside: for a process that ends at once, in which no destructor runs.
pub fn remove_unfinished() {
    remove(&mut aside());
}

/// The same for a process that has no memory left or has crashed: where files are being written aside at this very
/// moment, it waits for nobody.
pub fn remove_unfinished_at_once() {
    if let Ok(mut paths) = ASIDE.try_lock() {
        remove(&mut paths);
    }
}

fn remove(paths: &mut Vec<PathBuf>) {
    for path in paths.drain(..) {
        // It may have its name by now, and then it is whole.
        let _ = fs::remove_file(path);
    }
}

fn aside() -> MutexGuard<'static, Vec<PathBuf>> {
    ASIDE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes aside, then renames. On failure the temporary file is removed by its destructor.
fn replace(target: &Path, bytes: &[u8], permissions: Option<fs::Permissions>) -> io::Result<()> {
    // Opened here rather than by `tempfile`, whose errors name the temporary file; `as_file_mut` for
    // the same reason. New files have the permissions that the user's umask leaves of any file's.
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    let file =
        tempfile::Builder::new().prefix(".pointillist-").make_in(folder_of(target), |path| {
            let mut aside = aside();
            let file = options.open(path)?;
            aside.push(path.to_owned());
            Ok(file)
        })?;
    let path = file.path().to_owned();
    let written = fill_and_rename(file, target, bytes, permissions);
    aside().retain(|other| *other != path);
    written
}

fn fill_and_rename(
    mut file: NamedTempFile,
    target: &Path,
    bytes: &[u8],
    permissions: Option<fs::Permissions>,
) -> io::Result<()> {
    file.as_file_mut().write_all(bytes)?;
    // Disks across a network say only here that they are full, and a machine that loses power must not
    // find the new name on an empty file.
    file.as_file().sync_data()?;
    if let Some(permissions) = permissions {
        file.as_file().set_permissions(permissions)?;
    }
    file.persist(target).map_err(|failed| failed.error)?;
    Ok(())
}

/// The folder that a file lies in.
fn folder_of(file: &Path) -> &Path {
    match file.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// What the last component of `path` leads to, whether that exists or not.
fn follow_links(path: &Path) -> io::Result<PathBuf> {
    let mut target = path.to_path_buf();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&target) {
            Ok(link) => target = folder_of(&target).join(link),
            Err(_) => return Ok(target), // not a link, or nothing there yet
        }
    }
    Err(io::Error::other("found more than 40 links that lead from one to the next"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Other tests write at the same time: this one looks at its own alone.
    #[test]
    fn what_is_aside_is_known_until_it_has_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("a");
        store(&target, b"whole").unwrap();
        let known = |path: &PathBuf| path.starts_with(folder.path());
        assert!(!aside().iter().any(known));
        store(&folder.path().join("no/b"), b"").unwrap_err();
        assert!(!aside().iter().any(known));
        let unfinished = folder.path().join(".pointillist-unfinished");
        fs::write(&unfinished, "half").unwrap();
        let mut paths = vec![unfinished.clone(), folder.path().join("renamed-by-now")];
        remove(&mut paths);
        assert!(paths.is_empty() && !unfinished.exists());
        assert_eq!(fs::read(&target).unwrap(), b"whole");
    }
}
