//! From a word on the command line to a suite, a scene file or a point file.
//!
//! The suites of the repository are part of the binary, with their scenes and the points these need, so
//! that they run from anywhere. Within a checkout its own files are taken instead: so what was edited
//! counts, and models that `tools/fetch-models` fetched are found.

use crate::errors::{Exit, Failure};
use crate::input::is_toml;
use scene::Suite;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Where a checkout has its suites.
const FOLDER: &str = "scenes/bench";

macro_rules! embedded {
    ($($path:literal),* $(,)?) => {
        &[$(($path, include_bytes!(concat!("../../../../scenes/", $path)))),*]
    };
}

/// Suites and all that they need but models, by path below `scenes/`.
const EMBEDDED: &[(&str, &[u8])] = embedded![
    "bench/paper.toml",
    "bench/scaling.toml",
    "bench/scans.toml",
    "bench/cells-per-pass.toml",
    "bench/landscape.toml",
    "bench/light.toml",
    "bench/ruler.toml",
    "bench/smoke.toml",
    "bench/volume.toml",
    "bench/scenes/armadillo.toml",
    "bench/scenes/ball.toml",
    "bench/scenes/bunny.toml",
    "bench/scenes/bunny-filled.toml",
    "bench/scenes/bunny-on-hills.toml",
    "bench/scenes/bunny-under-sky.toml",
    "bench/scenes/cloud.toml",
    "bench/scenes/cube.toml",
    "bench/scenes/horse.toml",
    "bench/scenes/horse-filled.toml",
    "bench/scenes/room.toml",
    "bench/scenes/torus.toml",
    "combustor.toml",
    "ironprot.toml",
    "lox-post.toml",
    "nested-glass.toml",
    "smoke.toml",
    "stream.toml",
    "images/sky.hdr",
    "images/tiles.png",
    "points/floor.ply",
    "points/slab.ply",
    "points/smoke.ply",
    "points/sphere.ply",
    "points/stream.ply",
];

/// What the command line asks to be timed.
pub enum Asked {
    /// A suite by its name.
    Suite(String, Suite),
    /// A scene file or point file.
    Scene(PathBuf),
}

/// Finds suites, and holds the files of those that are part of the binary.
#[derive(Default)]
pub struct Suites {
    unpacked: Option<TempDir>,
}

impl Suites {
    /// What a word of the command line means: the name of a suite, or a file.
    pub fn find(&mut self, asked: &Path) -> Result<Asked, Failure> {
        if let Some(name) = plain_name(asked)
            && !asked.is_file()
        {
            let file = self.file_of(name)?.ok_or_else(|| unknown(name))?;
            let suite = Suite::load(&file).map_err(|error| self.failure(error.into()))?;
            return Ok(Asked::Suite(name.to_owned(), suite));
        }
        if is_toml(asked) && Suite::is_one(asked)? {
            let name = asked.file_stem().unwrap_or(asked.as_os_str()).to_string_lossy();
            return Ok(Asked::Suite(name.into_owned(), Suite::load(asked)?));
        }
        Ok(Asked::Scene(asked.to_path_buf()))
    }

    /// The file of a suite: the checkout's, else one that is unpacked from the binary.
    fn file_of(&mut self, name: &str) -> Result<Option<PathBuf>, Failure> {
        if let Some(file) = in_checkout(name) {
            return Ok(Some(file));
        }
        let path = format!("bench/{name}.toml");
        if !EMBEDDED.iter().any(|file| file.0 == path) {
            return Ok(None);
        }
        if self.unpacked.is_none() {
            self.unpacked = Some(unpack()?);
        }
        Ok(self.unpacked.as_ref().map(|folder| folder.path().join(path)))
    }

    /// A failure in the words of the repository, where it speaks of a file of the binary.
    pub fn failure(&self, mut failure: Failure) -> Failure {
        for line in &mut failure.lines {
            *line = self.as_written(line);
        }
        failure
    }

    /// The same for one line.
    pub fn as_written(&self, line: &str) -> String {
        match &self.unpacked {
            Some(folder) => line.replace(&folder.path().display().to_string(), "scenes"),
            None => line.to_owned(),
        }
    }
}

/// Names of all suites with what they measure.
pub fn known() -> Vec<(String, String)> {
    let of_binary = EMBEDDED.iter().filter_map(|(path, _)| suite_name(path));
    let mut names: Vec<String> = of_binary.map(str::to_owned).collect();
    if let Some(folder) = checkout()
        && let Ok(entries) = fs::read_dir(folder)
    {
        let files = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
        names.extend(files.filter_map(|file| Some(file.strip_suffix(".toml")?.to_owned())));
    }
    names.sort();
    names.dedup();
    names.into_iter().map(|name| (about(&name), name)).map(|(about, name)| (name, about)).collect()
}

/// What a suite says it measures; nothing where its file is at fault.
fn about(name: &str) -> String {
    let of_binary = || {
        let path = format!("bench/{name}.toml");
        let file = EMBEDDED.iter().find(|file| file.0 == path)?;
        Suite::from_toml(std::str::from_utf8(file.1).ok()?, Path::new(file.0)).ok()
    };
    let suite = match in_checkout(name) {
        Some(file) => Suite::load(&file).ok(),
        None => of_binary(),
    };
    suite.map_or_else(String::new, |suite| suite.about)
}

fn unknown(name: &str) -> Failure {
    let names: Vec<String> = known().into_iter().map(|suite| suite.0).collect();
    let near = names.iter().min_by_key(|known| strsim::damerau_levenshtein(name, known));
    let meant = near
        .filter(|known| strsim::damerau_levenshtein(name, known) <= (name.len() / 3).max(1))
        .map_or_else(String::new, |known| format!("did you mean '{known}'? "));
    Failure::usage(format!(
        "bench: found no suite and no file '{name}'; {meant}The suites are {}; or name a scene file, a \
         point file or a suite's file",
        names.join(", ")
    ))
}

/// The word, if it has neither folder nor extension.
fn plain_name(asked: &Path) -> Option<&str> {
    let name = asked.to_str()?;
    (!name.contains(['/', '\\', '.']) && !name.is_empty()).then_some(name)
}

/// `paper` of `bench/paper.toml`.
fn suite_name(path: &str) -> Option<&str> {
    let name = path.strip_prefix("bench/")?.strip_suffix(".toml")?;
    (!name.contains('/')).then_some(name)
}

/// The folder of suites of the checkout that the working folder lies in.
fn checkout() -> Option<PathBuf> {
    let here = env::current_dir().ok()?;
    here.ancestors().map(|folder| folder.join(FOLDER)).find(|folder| folder.is_dir())
}

fn in_checkout(name: &str) -> Option<PathBuf> {
    checkout().map(|folder| folder.join(format!("{name}.toml"))).filter(|file| file.is_file())
}

fn unpack() -> Result<TempDir, Failure> {
    let write = || {
        let folder = tempfile::Builder::new().prefix("pointillist-bench-").tempdir()?;
        for (path, bytes) in EMBEDDED {
            let file = folder.path().join(path);
            file.parent().map_or(Ok(()), fs::create_dir_all)?;
            fs::write(file, bytes)?;
        }
        Ok(folder)
    };
    write().map_err(|error: std::io::Error| Failure {
        exit: Exit::Exhausted,
        lines: vec![format!(
            "{}: cannot unpack the suites ({error}); make room, or set TMPDIR to a folder that has it",
            env::temp_dir().display()
        )],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{MODELS_VARIABLE, Scene};

    /// Whatever is below scenes/bench/ is part of the binary, and with it what its scenes name.
    #[test]
    fn every_suite_with_its_scenes_is_embedded() {
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        for folder in ["bench", "bench/scenes"] {
            for entry in fs::read_dir(scenes.join(folder)).unwrap() {
                let path = entry.unwrap().path();
                let name = format!("{folder}/{}", path.file_name().unwrap().to_string_lossy());
                let known = path.is_dir() || EMBEDDED.iter().any(|file| file.0 == name);
                assert!(known, "{name} is not embedded");
            }
        }
        let unpacked = unpack().unwrap();
        let mut loaded = 0;
        for (path, _) in EMBEDDED.iter().filter(|file| suite_name(file.0).is_some()) {
            let suite = Suite::load(&unpacked.path().join(path)).unwrap();
            for row in suite.rows {
                match Scene::load(&row.scene, &row.set) {
                    Ok(_) => loaded += 1,
                    Err(error) => {
                        assert!(error.lacks_models_alone(), "{path}: {}: {error}", row.name);
                        assert!(row.if_missing.is_some(), "{path}: {}: if_missing", row.name);
                        assert!(error.to_string().contains(MODELS_VARIABLE));
                    }
                }
            }
        }
        assert!(loaded > 8, "{loaded} rows need no model");
    }

    #[test]
    fn names_are_words_and_files_have_folders_or_extensions() {
        assert_eq!(plain_name(Path::new("cells-per-pass")), Some("cells-per-pass"));
        for file in ["a.toml", "./paper", "scenes/bench", ""] {
            assert_eq!(plain_name(Path::new(file)), None, "{file}");
        }
        assert_eq!(suite_name("bench/paper.toml"), Some("paper"));
        assert_eq!(suite_name("bench/scenes/ball.toml"), None);
    }

    #[test]
    fn known_suites_say_what_they_measure() {
        let suites = known();
        for name in [
            "cells-per-pass",
            "landscape",
            "light",
            "paper",
            "ruler",
            "scaling",
            "scans",
            "smoke",
            "volume",
        ] {
            let about = suites.iter().find(|suite| suite.0 == name).map(|suite| suite.1.as_str());
            assert!(about.is_some_and(|about| !about.is_empty()), "{name}: {suites:?}");
        }
        let failure = unknown("papr");
        assert!(failure.lines[0].contains("did you mean 'paper'?"), "{failure:?}");
        assert!(
            failure.lines[0].contains(
                "cells-per-pass, landscape, light, paper, ruler, scaling, scans, smoke, volume"
            ),
            "{failure:?}"
        );
    }
}
