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

/// A chain of links longer than this is taken for a loop, as Linux does.
const MAX_LINKS: usize = 40;

/// Makes `path` a file of these bytes.
pub(crate) fn store(path: &Path, bytes: &[u8]) -> Result<(), FilmError> {
    let write_error = |source| FilmError::Write { path: path.into(), source };
    let target = follow_links(path).map_err(write_error)?;
    match fs::metadata(&target) {
        Ok(found) if found.is_dir() => Err(FilmError::IsFolder { path: path.into() }),
        Ok(found) if !found.is_file() => OpenOptions::new()
            .write(true)
            .open(&target)
            .and_then(|mut device| device.write_all(bytes))
            .map_err(write_error),
        Ok(found) if found.permissions().readonly() => {
            Err(FilmError::WriteProtected { path: path.into() })
        }
        // A file that is replaced keeps its permissions.
        Ok(found) => replace(&target, bytes, Some(found.permissions())).map_err(write_error),
        Err(_) => {
            let folder = folder_of(&target);
            if folder.is_dir() {
                replace(&target, bytes, None).map_err(write_error)
            } else {
                Err(FilmError::NoFolder { path: path.into(), folder: folder.into() })
            }
        }
    }
}

/// Writes aside, then renames. On failure the temporary file is removed by its destructor.
fn replace(target: &Path, bytes: &[u8], permissions: Option<fs::Permissions>) -> io::Result<()> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".pointillist-");
    #[cfg(unix)]
    let allowed = {
        use std::os::unix::fs::PermissionsExt;
        // What any program asks for; the system takes away what the user's umask forbids.
        fs::Permissions::from_mode(0o666)
    };
    #[cfg(unix)]
    builder.permissions(allowed);
    let mut file = builder.tempfile_in(folder_of(target))?;
    file.write_all(bytes)?;
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
