//! Files that are asked for on the command line: checked before work begins, written aside and
//! renamed when it is done.

use crate::errors::{Exit, Failure};
use crate::interrupt;
use crate::source::PIPE;
use serde::Serialize;
use std::fs;
use std::io::{self, ErrorKind, IsTerminal, Read};
use std::path::{Path, PathBuf};

/// Fails where `path` cannot become a file: a missing folder, one that may not be written to, a
/// folder of that name. Leaves no trace.
pub fn check_output(path: &Path) -> Result<(), Failure> {
    if path == Path::new(PIPE) {
        return match io::stdout().is_terminal() {
            false => Ok(()),
            true => Err(Failure::usage(
                "-: stdout is a terminal, which shows no picture; lead it into a file or a program \
                 (pointillist render scan.ply -o - --format png | viewer), or name a file",
            )),
        };
    }
    let shown = path.display();
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => {
            return Err(Failure::usage(format!(
                "{shown}: found a folder, expected a file; add a file name"
            )));
        }
        // A pipe or a device: it is written directly.
        Ok(found) if !found.is_file() => return Ok(()),
        Ok(found) if found.permissions().readonly() => {
            return Err(film::FilmError::WriteProtected { path: path.into() }.into());
        }
        _ => {}
    }
    // Where a link leads to, if that exists.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let folder = folder_of(&target);
    let folder_shown = folder.display();
    if !folder.is_dir() {
        return Err(Failure::usage(format!(
            "{shown}: the folder '{folder_shown}' does not exist; create it or choose another"
        )));
    }
    // Some file systems have no files without a name: that is not to be left behind.
    interrupt::writing(|| match tempfile::tempfile_in(folder) {
        Ok(_) => Ok(()),
        Err(error) => {
            let what = format!("cannot write to the folder '{folder_shown}'; choose another");
            Err(write_failure(path, &error, &what))
        }
    })
}

/// Fails where two of `outputs` are one file, or one of them is an input.
pub fn check_distinct(outputs: &[&Path], inputs: &[&Path]) -> Result<(), Failure> {
    let inputs: Vec<PathBuf> = inputs.iter().map(|path| identity(path)).collect();
    let identities: Vec<PathBuf> = outputs.iter().map(|path| identity(path)).collect();
    for (index, (path, id)) in outputs.iter().zip(&identities).enumerate() {
        let shown = path.display();
        if identities[..index].contains(id) {
            return Err(Failure::usage(format!(
                "{shown}: named twice as an output; give each its own name"
            )));
        }
        if inputs.contains(id) {
            return Err(Failure::usage(format!(
                "{shown}: is also an input, which would be overwritten; choose another name"
            )));
        }
    }
    Ok(())
}

/// Whether two files have the same bytes. What cannot be read is left to whoever reads it next.
pub fn same_bytes(a: &Path, b: &Path) -> bool {
    const PART: u64 = 1 << 20;
    let same = || -> io::Result<bool> {
        let lengths =
            [fs::metadata(a)?, fs::metadata(b)?].map(|found| (found.is_file(), found.len()));
        if lengths[0] != lengths[1] || !lengths[0].0 {
            return Ok(false);
        }
        let mut files = [fs::File::open(a)?, fs::File::open(b)?];
        let mut parts = [Vec::new(), Vec::new()];
        loop {
            for (file, part) in files.iter_mut().zip(&mut parts) {
                part.clear();
                file.take(PART).read_to_end(part)?;
            }
            if parts[0] != parts[1] || parts[0].is_empty() {
                return Ok(parts[0] == parts[1]);
            }
        }
    };
    same().unwrap_or(false)
}

/// Makes `path` a file of this text, whole or not at all.
pub fn write(path: &Path, text: &str) -> Result<(), Failure> {
    interrupt::writing(|| Ok(film::store(path, text.as_bytes())?))
}

/// Makes `path` a file of one JSON value.
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), Failure> {
    write(path, &json(path, value)?)
}

/// The text of a JSON file.
pub fn json(path: &Path, value: &impl Serialize) -> Result<String, Failure> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::exhausted(format!("{}: {error}", path.display())))?;
    Ok(format!("{text}\n"))
}

/// As [`write`], also where an end was asked for: what was measured is kept.
pub fn keep(path: &Path, text: &str) -> Result<(), Failure> {
    interrupt::keeping(|| Ok(film::store(path, text.as_bytes())?))
}

fn write_failure(path: &Path, error: &io::Error, what: &str) -> Failure {
    let exit = match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => Exit::Exhausted,
        _ => Exit::Usage,
    };
    Failure { exit, lines: vec![format!("{}: {what}: {error}", path.display())] }
}

/// The folder that a file lies in.
fn folder_of(file: &Path) -> &Path {
    match file.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// One path a file, however it is written.
fn identity(path: &Path) -> PathBuf {
    if let Ok(real) = fs::canonicalize(path) {
        return real;
    }
    match (fs::canonicalize(folder_of(path)), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path.to_path_buf(),
    }
}
