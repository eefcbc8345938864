//! One word finds a kernel everywhere.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use kernels::source::glsl_folder;
use kernels::spirv::KERNELS;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// What a kernel's header says after `// twin`, its further lines included.
fn twin_of(kernel: &str) -> String {
    let path = glsl_folder().join(format!("kernels/{kernel}.comp"));
    let text = fs::read_to_string(path).expect("a kernel's source");
    let header = text.lines().map_while(|line| line.strip_prefix("//"));
    let mut rest = header.skip_while(|line| !line.starts_with(" twin "));
    let first = rest.next().unwrap_or_default().trim_start_matches(" twin ").trim().to_owned();
    rest.take_while(|line| line.starts_with("   ")).fold(first, |all, line| all + " " + line.trim())
}

/// The header names a file of the kernel's name, or a function of that name in another, or says why there is no twin.
#[test]
fn every_kernel_has_its_twin() {
    for kernel in KERNELS.iter().map(|kernel| kernel.name) {
        let twin = twin_of(kernel);
        if let Some(why) = twin.strip_prefix("none") {
            assert!(why.len() > 10, "{kernel}: why there is no twin");
            continue;
        }
        let (file, function) = twin.split_once(", ").unwrap_or((&twin, ""));
        let path = root().join(file);
        let text =
            fs::read_to_string(&path).unwrap_or_else(|_| panic!("{kernel}: no twin '{file}'"));
        let of_its_name = path.file_stem().is_some_and(|stem| stem == kernel);
        let has =
            text.contains(&format!("fn {kernel}(")) || text.contains(&format!("fn {kernel}<"));
        assert!(of_its_name || (function == kernel && has), "{kernel}: '{twin}' has another name");
    }
}

/// A kernel's pass asks for it by its name, which is its label and its row in the timings.
#[test]
fn every_kernel_is_dispatched_by_name() {
    let folders =
        ["crates/render/src", "crates/points/src/device"].map(|folder| root().join(folder));
    let mut pending = folders.to_vec();
    let mut sources = String::new();
    while let Some(folder) = pending.pop() {
        for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry")) {
            match entry.path() {
                path if path.is_dir() => pending.push(path),
                path if path.ends_with("ahead.rs") => {} // made, and not dispatched
                path => sources += &fs::read_to_string(path).expect("a source"),
            }
        }
    }
    for kernel in KERNELS.iter().map(|kernel| kernel.name) {
        assert!(sources.contains(&format!("spirv::{kernel}(")), "{kernel}: nothing asks for it");
    }
}
