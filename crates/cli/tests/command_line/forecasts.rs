//! Large jobs say what they will take. On the CPU, so that no device is needed.
#![cfg(unix)]

use crate::{Folder, pointillist, sphere};
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

/// The first line of stderr that is a forecast of this; the render is then interrupted.
fn forecast(arguments: &[&str], of: &str) -> String {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(500));
    let mut child = pointillist()
        .current_dir(folder.path())
        .args(["render", "ball.ply", "--device", "reference"])
        .args(arguments)
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    let lines = BufReader::new(child.stderr.take().expect("a pipe")).lines();
    let mut lines = lines.map(|line| line.expect("UTF-8"));
    let found = lines.find(|line| line.contains("forecast: ") && line.contains(of));
    // Nobody may be stopped by a pipe that is full.
    let rest = std::thread::spawn(move || lines.count());
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.expect("kill runs").success());
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    rest.join().expect("it read");
    assert_eq!(folder.names(), ["ball.ply"]);
    found.unwrap_or_else(|| panic!("no forecast of {of}"))
}

/// Neither on a terminal nor with `--progress always`: whoever starts a job of days should hear of it.
#[test]
fn a_render_of_days_says_so() {
    let line = forecast(&["-o", "a.png", "--size", "4096x4096", "--samples", "65536"], "tracing");
    assert!(line.starts_with("forecast: tracing takes about "), "{line}");
    assert!(line.contains("days") || line.contains(" h") || line.contains("years"), "{line}");
    let log = ["-o", "a.png", "--size", "4096x4096", "--samples", "65536", "--log", "json"];
    let line = forecast(&log, "tracing");
    let object: serde_json::Value = serde_json::from_str(&line).expect("an object");
    assert_eq!((&object["event"], &object["stage"]), (&"forecast".into(), &"tracing".into()));
    assert!(object["seconds_left"].as_f64() > Some(60.0), "{line}");
    assert_eq!(object["total"], 4096_u64 * 4096 * 65536);
}

/// 48 bytes a pixel; 96 where an EXR is made.
#[test]
fn a_large_picture_says_what_memory_it_takes() {
    let line = forecast(&["-o", "a.png", "--size", "5000x5000", "--samples", "64"], "memory");
    let expected = "forecast: at least 1.2 GB of memory for a picture of 5000x5000 pixels; ";
    assert!(line.starts_with(expected) && line.ends_with(" are free"), "{line}");
}
