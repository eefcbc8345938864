//! The binary from outside: what it prints, writes and exits with. `drivers`, `faults`, `signals` and `twins` need a
//! Vulkan device, the others none.
#![forbid(unsafe_code)]
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod bench;
mod bench_preset;
mod broken;
mod camera;
mod columns;
mod compare;
mod compare_flip;
mod degrees;
mod disk;
mod drivers;
mod faults;
mod fill;
mod filters;
mod first_picture;
mod forecasts;
mod headers;
mod inputs;
mod inspect;
mod kept_rows;
mod legend;
mod log;
mod meant;
mod memory;
mod nothing;
mod optics;
mod pipes;
mod points;
mod render;
mod root;
mod signals;
mod threads;
mod twins;
mod typed;
mod usage;
mod volumes;

use std::ffi::OsStr;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The binary, without whatever the caller's environment asks of it.
fn pointillist() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pointillist"));
    command.env_remove("POINTILLIST_VALIDATION");
    command
}

/// Runs it in a folder.
fn run_in(folder: &Path, arguments: &[&str]) -> Ran {
    let mut command = pointillist();
    Ran::of(command.current_dir(folder).args(arguments))
}

/// How a run ended.
#[derive(Debug)]
struct Ran {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

impl Ran {
    fn of(command: &mut Command) -> Self {
        let Output { status, stdout, stderr } = command.output().expect("the binary starts");
        Self {
            code: status.code(),
            stdout: String::from_utf8(stdout).expect("UTF-8 on stdout"),
            stderr: String::from_utf8(stderr).expect("UTF-8 on stderr"),
        }
    }

    /// Asserts the exit code, and that stderr says all of `words`.
    #[track_caller]
    fn fails_with(self, code: i32, words: &[&str]) -> Self {
        assert_eq!(self.code, Some(code), "{self:?}");
        for word in words {
            assert!(self.stderr.contains(word), "'{word}' is not in: {}", self.stderr);
        }
        assert!(!self.stderr.contains("panicked") && !self.stderr.contains("bug"), "{self:?}");
        assert_eq!(self.stdout, "");
        self
    }

    #[track_caller]
    fn succeeds(self) -> Self {
        assert_eq!(self.code, Some(0), "{self:?}");
        self
    }
}

/// A line that is seen although the test passes: the test runner swallows what eprintln! prints.
fn said(line: &str) {
    let line = format!("{line}\n");
    std::io::Write::write_all(&mut std::io::stderr(), line.as_bytes()).expect("stderr");
}

/// A folder of one test's own, removed with it.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn write(&self, name: impl AsRef<OsStr>, text: &str) -> PathBuf {
        let path = self.path().join(name.as_ref());
        std::fs::write(&path, text).expect("the folder can be written to");
        path
    }

    /// Names of what is in it, sorted.
    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.path()).expect("the folder can be read");
        let name = |entry: std::io::Result<std::fs::DirEntry>| {
            entry.expect("an entry").file_name().to_string_lossy().into_owned()
        };
        let mut names: Vec<String> = entries.map(name).collect();
        names.sort();
        names
    }
}

/// A PLY of `count` even points on the unit sphere, with colours.
fn sphere(count: u32) -> String {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n\
         property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
         end_header\n"
    );
    for i in 0..count {
        let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let angle = f64::from(i) * 2.399_963_229_728_653;
        let radius = (1.0 - y * y).sqrt();
        let (x, z) = (radius * angle.cos(), radius * angle.sin());
        writeln!(text, "{x} {y} {z} 200 100 50").expect("a string takes all");
    }
    text
}

/// A PLY of these positions, as text.
fn ply(positions: &[&str]) -> String {
    let count = positions.len();
    format!(
        "ply\nformat ascii 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n\
         property float z\nend_header\n{}\n",
        positions.join("\n")
    )
}
