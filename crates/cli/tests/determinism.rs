//! The same scene gives the same file: from run to run, over numbers of threads, by discs (the default
//! at this size) and through the grid with any number of cells a pass,
//! and on the CPU without Vulkan.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use std::io::Write;
use std::path::Path;
use std::process::Command;

/// A bumpy sphere as an ASCII PLY.
fn write_points(path: &Path) {
    let count = 4_000;
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n\
         property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
         end_header\n"
    );
    for i in 0..count {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let (sin, cos) = (2.399_963 * f64::from(i)).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        let bump = 1.0 + 0.05 * (9.0 * z).sin();
        let red = (127.0 + 127.0 * z) as u8;
        text +=
            &format!("{} {} {} {red} 90 200\n", bump * radius * cos, bump * radius * sin, bump * z);
    }
    std::fs::write(path, text).expect("a written file");
}

#[test]
fn every_way_to_render_gives_the_same_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let points = folder.path().join("bumpy.ply");
    write_points(&points);
    let render = |name: &str, threads: &str, extra: &[&str]| -> Vec<u8> {
        let out = folder.path().join(format!("{name}.exr"));
        let output = Command::new(env!("CARGO_BIN_EXE_pointillist"))
            .arg("render")
            .arg(&points)
            .arg("-o")
            .arg(&out)
            .args(["--size", "256x192"])
            .args(extra)
            .env("LP_NUM_THREADS", threads)
            .env("POINTILLIST_VALIDATION", "1")
            .output()
            .expect("runs");
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{name}: {errors}");
        std::fs::read(&out).expect("a picture")
    };
    let first = render("first", "2", &[]);
    assert!(first.len() > 10_000, "{} bytes are no picture", first.len());
    let again: [(&str, &str, &[&str]); 5] = [
        ("a second run", "2", &[]),
        ("one thread", "1", &[]),
        ("one cell a pass", "2", &["--cells-per-pass", "1"]),
        ("four cells a pass", "1", &["--cells-per-pass", "4"]),
        ("all cells in a pass", "2", &["--cells-per-pass", "1000000"]),
    ];
    for (name, threads, extra) in again {
        assert!(render(name, threads, extra) == first, "{name}: another file");
    }
    let device = film::read_exr(&folder.path().join("first.exr")).expect("an EXR").strings;
    let device = &device["pointillist/device"];
    // As in the tests' harness: measured.
    if !["llvmpipe", "SwiftShader Device (Subzero)"].iter().any(|exact| device.contains(exact)) {
        let line =
            format!("SKIPPED: equal bytes on the CPU reference: {device} may round otherwise\n");
        std::io::stderr().write_all(line.as_bytes()).expect("stderr");
        return;
    }
    // The header says which device it was; all else is equal.
    render("the CPU reference", "2", &["--device", "reference"]);
    let read = |name: &str| {
        let mut picture = film::read_exr(&folder.path().join(name)).expect("an EXR");
        for volatile in ["pointillist/device", "pointillist/driver"] {
            picture.strings.remove(volatile);
        }
        // Infinities and all, by their bits.
        let channels = std::mem::take(&mut picture.channels).into_iter();
        let bits: Vec<(String, Vec<u32>)> = channels
            .map(|(name, values)| (name, values.into_iter().map(f32::to_bits).collect()))
            .collect();
        (picture, bits)
    };
    assert!(read("first.exr") == read("the CPU reference.exr"), "the CPU reference: another file");
}
