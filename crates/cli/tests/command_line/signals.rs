//! Interruptions end a render soon, with 130, and leave nothing behind.
#![cfg(unix)]

use crate::{Folder, pointillist, sphere};
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

fn interrupted_by(signal: &str) {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(2000));
    let mut child = pointillist()
        .current_dir(folder.path())
        .args(["render", "ball.ply", "-o", "a.exr", "-o", "a.png", "--stats", "a.json"])
        .args(["--device", "reference", "--size", "8000x8000", "--progress", "always"])
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    let mut lines = BufReader::new(child.stderr.take().expect("a pipe")).lines();
    // 64 million pixels take many seconds; the first line comes after one.
    let first = lines.next().expect("a line").expect("UTF-8");
    assert!(first.starts_with("tracing: "), "{first}");
    let sent = Instant::now();
    let kill = Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(kill.expect("kill runs").success());
    let status = child.wait().expect("it ends");
    assert_eq!(status.code(), Some(130));
    assert!(sent.elapsed() < Duration::from_secs(10), "{:?}", sent.elapsed());
    let last = lines.last().expect("a line").expect("UTF-8");
    assert_eq!(last, "error: interrupted");
    assert_eq!(folder.names(), ["ball.ply"]);
}

#[test]
fn sigint_is_130_and_leaves_nothing() {
    interrupted_by("-INT");
}

#[test]
fn sigterm_is_130_and_leaves_nothing() {
    interrupted_by("-TERM");
}
