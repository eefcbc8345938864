//! Models that suites fill, kept in a cache folder from run to run.
//!
//! A file's name has a hash of the model's bytes and of how it is filled, so that another model, or another version of
//! what fills, has a file of its own, and a hash of what is in it, so that a damaged one is known and made anew. Where the cache cannot be written to, a temporary folder holds them for one run.

use crate::commands::fill;
use crate::errors::{Exit, Failure};
use crate::progress::Progress;
use points::ReadOptions;
use sha2::{Digest, Sha256};
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// As `fill` has them without options.
const COUNT: u32 = 40_000;
const REACH: f64 = 0.06;
/// Raised when the same model gives other points.
const VERSION: u32 = 1;

/// Where filled models are kept.
#[derive(Default)]
pub struct Filled {
    /// Where the cache cannot be written to.
    temporary: Option<TempDir>,
}

impl Filled {
    /// The file of a filled model, made where it is not there.
    pub fn of(&mut self, model: &Path, progress: &Progress) -> Result<PathBuf, Failure> {
        let bytes = fs::read(model).map_err(|source| {
            Failure::usage(format!(
                "{}: cannot be read ({source}); check the file",
                model.display()
            ))
        })?;
        let stem = model.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let mut hash = Sha256::new();
        hash.update(format!("fill {VERSION} {COUNT} {REACH} {}\n", env!("CARGO_PKG_VERSION")));
        hash.update(bytes);
        let hash = hexadecimal(&hash.finalize());
        let prefix = format!("{stem}-filled-{hash}-");
        if let Some(cache) = folder()
            && let Some(path) = whole(&cache, &prefix, progress)
        {
            return Ok(path);
        }
        let set = crate::input::read_file(model, &ReadOptions::default(), progress)?;
        let points = fill::filled(model, &set.positions, COUNT, REACH, progress)?;
        let points = fill::encoded(&points);
        let name = format!("{prefix}{}.ply", short_hash(&points));
        if let Some(cache) = folder() {
            let path = cache.join(&name);
            let written = match fs::create_dir_all(&cache) {
                Ok(()) => fill::write(&path, &points),
                Err(error) => Err(Failure::usage(format!("{}: {error}", cache.display()))),
            };
            match written {
                Ok(()) => {
                    progress.note(&format!(
                        "{}: filled, and kept as {}; to empty the cache, remove the folder {}",
                        model.display(),
                        path.display(),
                        cache.display()
                    ));
                    return Ok(path);
                }
                Err(failure) if failure.exit == Exit::Interrupted => return Err(failure),
                Err(failure) => progress.warn(&format!(
                    "the cache folder cannot be written to, so that {} is filled for this run only: {}; set \
                     XDG_CACHE_HOME to a folder that can",
                    model.display(),
                    failure.lines.join("; ")
                )),
            }
        }
        self.in_temporary(&name, |path| fill::write(path, &points))
    }

    fn in_temporary(
        &mut self,
        name: &str,
        write: impl Fn(&Path) -> Result<(), Failure>,
    ) -> Result<PathBuf, Failure> {
        if self.temporary.is_none() {
            let folder = tempfile::Builder::new().prefix("pointillist-bench-").tempdir();
            let folder =
                folder.map_err(|error| Failure::exhausted(format!("temporary folder: {error}")))?;
            self.temporary = Some(folder);
        }
        let folder = self.temporary.as_ref().map(TempDir::path).unwrap_or(Path::new(""));
        let path = folder.join(name);
        write(&path)?;
        Ok(path)
    }
}

/// The file of the cache that begins so and holds what its name says. Others are removed.
fn whole(cache: &Path, prefix: &str, progress: &Progress) -> Option<PathBuf> {
    for entry in fs::read_dir(cache).ok()?.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let of_contents = name.strip_prefix(prefix).and_then(|rest| rest.strip_suffix(".ply"));
        let Some(of_contents) = of_contents else { continue };
        let path = entry.path();
        if fs::read(&path).is_ok_and(|bytes| short_hash(&bytes) == of_contents) {
            return Some(path);
        }
        progress.note(&format!(
            "{}: damaged, since its contents are not those of its name; it is made anew",
            path.display()
        ));
        // Where it cannot be removed, it is written over.
        let _ = fs::remove_file(&path);
    }
    None
}

fn short_hash(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

fn hexadecimal(hash: &[u8]) -> String {
    hash.iter().take(16).map(|byte| format!("{byte:02x}")).collect()
}

/// The cache folder: `pointillist` in what XDG_CACHE_HOME names, else in ~/.cache; on Windows in LOCALAPPDATA.
fn folder() -> Option<PathBuf> {
    let named = |variable: &str| {
        env::var_os(variable).map(PathBuf::from).filter(|folder| folder.is_absolute())
    };
    let caches = named("XDG_CACHE_HOME")
        .or_else(|| named("HOME").map(|home| home.join(".cache")))
        .or_else(|| named("LOCALAPPDATA"))?;
    Some(caches.join("pointillist"))
}
