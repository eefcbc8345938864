//! Where the input comes from: a file, or stdin, where `-` stands for it.
//!
//! A point file or picture from stdin is copied to a temporary file first, since readers go back in it; a scene is held,
//! and its relative paths start from the working folder. Which of them it is, its contents say, or `--input-format`.

use crate::errors::{Exit, Failure};
use crate::temporary::{self, Folder};
use std::fs::{File, OpenOptions};
use std::io::{self, Cursor, IsTerminal, Read};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// What stands for stdin, and for stdout.
pub const PIPE: &str = "-";
/// What a scene from stdin is called in messages.
const SCENE_NAME: &str = "stdin.toml";
/// Largest scene in bytes, as for files.
const MAX_SCENE: u64 = 16 << 20;
/// How much tells what comes.
const START: u64 = 4096;
/// Values of `--input-format`: a scene, or the extension that a file would have.
pub const FORMATS: [&str; 33] = [
    "scene", "ply", "las", "laz", "e57", "pcd", "npy", "npz", "vtk", "vtu", "vtp", "vts", "vtr",
    "vti", "off", "obj", "ptx", "pts", "xyz", "csv", "tsv", "txt", "asc", "dat", "ply.gz",
    "xyz.gz", "csv.gz", "pts.gz", "exr", "png", "jpg", "hdr", "toml",
];

/// The scene that came through stdin.
static SCENE: OnceLock<String> = OnceLock::new();
/// A file that is a scene whatever it is called.
static FORCED: OnceLock<PathBuf> = OnceLock::new();
/// What the temporary file's path begins with, which means nothing to a user.
static FOLDER: OnceLock<String> = OnceLock::new();

/// The path to go on with. `as_scene` is what `--scene` names in place of `path`.
pub fn resolve(
    path: &Path,
    as_scene: Option<&Path>,
    format: Option<&str>,
) -> Result<PathBuf, Failure> {
    let named = as_scene.unwrap_or(path);
    let is_pipe = named == Path::new(PIPE);
    if let (false, Some(format)) = (is_pipe, format) {
        return Err(Failure::usage(format!(
            "{}: --input-format {format} is for what comes through stdin; name - as the input, or leave it out",
            named.display()
        )));
    }
    let format = match (as_scene, format) {
        (Some(_), Some(format)) if format != "scene" && format != "toml" => {
            return Err(Failure::usage(format!(
                "--scene and --input-format {format} contradict each other; leave one of them out"
            )));
        }
        (Some(_), _) => Some("scene"),
        (None, format) => format,
    };
    if is_pipe {
        return from_stdin(format);
    }
    if as_scene.is_some() {
        let _ = FORCED.set(named.to_owned());
    }
    Ok(named.to_owned())
}

/// Whether a path is a scene's, whatever its extension.
pub fn is_scene(path: &Path) -> bool {
    FORCED.get().is_some_and(|forced| forced == path)
}

/// The scene that came through stdin, if it is what this path stands for.
pub fn scene_text(path: &Path) -> Option<&'static str> {
    SCENE.get().filter(|_| path == Path::new(SCENE_NAME)).map(String::as_str)
}

/// Whether anything came through stdin, which is read once.
pub fn is_stdin_read() -> bool {
    SCENE.get().is_some() || FOLDER.get().is_some()
}

/// A message without the folder of the temporary file.
pub fn without_folder(message: String) -> String {
    match FOLDER.get() {
        Some(folder) if message.contains(folder.as_str()) => message.replace(folder.as_str(), ""),
        _ => message,
    }
}

fn from_stdin(format: Option<&str>) -> Result<PathBuf, Failure> {
    let stdin = io::stdin();
    if stdin.is_terminal() {
        return Err(Failure::usage(
            "-: stdin is a terminal, expected a scene or a point file; pipe one into it (cat scan.ply | pointillist \
             render - -o a.png), or name a file",
        ));
    }
    let mut stdin = stdin.lock();
    let mut start = Vec::new();
    stdin.by_ref().take(START).read_to_end(&mut start).map_err(|error| unreadable(&error))?;
    if start.is_empty() {
        return Err(Failure::usage(
            "-: nothing came through stdin, expected a scene or a point file; see whether the program before the pipe \
             fails, or name a file",
        ));
    }
    let is_scene = match format {
        Some(format) => format == "scene" || format == "toml",
        None => looks_like_a_scene(&start),
    };
    let extension = format.or_else(|| picture_extension(&start));
    let mut all = Cursor::new(start).chain(stdin);
    if is_scene {
        return hold(&mut all);
    }
    let folder = Folder::new("pointillist-stdin-")?;
    let name =
        extension.map_or_else(|| "stdin".to_owned(), |extension| format!("stdin.{extension}"));
    let path = folder.path().join(name);
    let prefix = format!("{}/", folder.path().display());
    let _ = FOLDER.set(prefix);
    // It is removed when the process ends, however it does.
    folder.keep();
    let mut file = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(&path)
        .map_err(|error| temporary::cannot(&error))?;
    copy(&mut all, &mut file)?;
    Ok(path)
}

/// Tells a fault of the pipe from one of the disk.
fn copy(from: &mut impl Read, to: &mut File) -> Result<(), Failure> {
    let mut block = vec![0; 1 << 18];
    loop {
        match from.read(&mut block) {
            Ok(0) => return Ok(()),
            Ok(count) => io::Write::write_all(to, &block[..count])
                .map_err(|error| temporary::cannot(&error))?,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(unreadable(&error)),
        }
    }
}

/// Holds a scene, which is called [`SCENE_NAME`] from now on.
fn hold(from: &mut impl Read) -> Result<PathBuf, Failure> {
    let mut bytes = Vec::new();
    from.take(MAX_SCENE + 1).read_to_end(&mut bytes).map_err(|error| unreadable(&error))?;
    if bytes.len() as u64 > MAX_SCENE {
        return Err(Failure::usage(format!(
            "{SCENE_NAME}: more than {MAX_SCENE} bytes came through stdin, expected a scene; keep points in point files"
        )));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..valid].iter().filter(|&&byte| byte == b'\n').count();
        Failure::usage(format!(
            "{SCENE_NAME}:{line}: found bytes that are no UTF-8, expected a scene; save it as UTF-8, or say what comes \
             by --input-format"
        ))
    })?;
    let _ = SCENE.set(text);
    Ok(SCENE_NAME.into())
}

fn unreadable(error: &io::Error) -> Failure {
    Failure {
        exit: Exit::Usage,
        lines: vec![format!("-: stdin cannot be read: {error}; name a file instead")],
    }
}

/// Whether text begins as scene files do: with a table or a key, after blank lines and comments. No point file does.
fn looks_like_a_scene(start: &[u8]) -> bool {
    // The last character may be cut off.
    let text = match std::str::from_utf8(start) {
        Ok(text) => text,
        Err(error) if error.error_len().is_none() => {
            std::str::from_utf8(&start[..error.valid_up_to()]).unwrap_or_default()
        }
        Err(_) => return false,
    };
    // A line of the user's own follows.
    if text.starts_with("# vtk DataFile") {
        return false;
    }
    let text = text.trim_start_matches('\u{feff}');
    let mut lines = text.lines().map(str::trim);
    let Some(first) = lines.find(|line| !line.is_empty() && !line.starts_with('#')) else {
        return false;
    };
    let is_key = |key: &str| {
        let key = key.trim();
        let part = |c: char| c.is_ascii_alphanumeric() || "_-.\"' ".contains(c);
        key.starts_with(|c: char| c.is_ascii_alphabetic() || c == '"') && key.chars().all(part)
    };
    first.starts_with('[') || first.split_once('=').is_some_and(|(key, _)| is_key(key))
}

/// The extension by which `info` knows pictures.
fn picture_extension(start: &[u8]) -> Option<&'static str> {
    let known: [(&[u8], &str); 4] = [
        (b"\x89PNG", "png"),
        (b"\xff\xd8\xff", "jpg"),
        (b"#?", "hdr"),
        (b"\x76\x2f\x31\x01", "exr"),
    ];
    known.into_iter().find(|(magic, _)| start.starts_with(magic)).map(|(_, extension)| extension)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_told_from_point_files() {
        for scene in [
            "[camera]\neye = [0, 0, 1]\n",
            "# a scene\n\n[[objects]]\n",
            "\u{feff}image.size = [4, 4]\n",
            "image = { size = [4, 4] }\n[[objects",
        ] {
            assert!(looks_like_a_scene(scene.as_bytes()), "{scene}");
        }
        for points in [
            "ply\nformat ascii 1.0\n",
            "# .PCD v0.7\nVERSION 0.7\n",
            "x,y,z\n0,0,0\n",
            "0 0 0\n1 1 1\n",
            "# x y z\n0 0 0\n",
            "OFF\n3 1 0\n",
            "v 0 0 0\n",
            "ncols 4\nnrows 3\n",
            "<VTKFile type=\"PolyData\">\n",
            "<?xml version=\"1.0\"?>\n",
            "# vtk DataFile Version 3.0\nheight = 3\nASCII\n",
            "\x01\u{0}[",
            "",
        ] {
            assert!(!looks_like_a_scene(points.as_bytes()), "{points}");
        }
        assert!(!looks_like_a_scene(b"LASF\xff\xfe"));
    }
}
