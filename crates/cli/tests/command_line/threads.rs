//! `--threads`: how many threads compute, and that pictures do not depend on it.
#![cfg(target_os = "linux")]

use crate::{Folder, Ran, pointillist, run_in, sphere};
use std::process::Stdio;

/// The most threads at once, of those whose name begins so, while a render runs.
fn most(folder: &Folder, arguments: &[&str], name: &str) -> usize {
    let mut child = pointillist()
        .current_dir(folder.path())
        .args(["render", "ball.ply", "--quiet"])
        .args(arguments)
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    let tasks = format!("/proc/{}/task", child.id());
    let mut most = 0;
    while child.try_wait().expect("it can be asked").is_none() {
        let tasks = std::fs::read_dir(&tasks).into_iter().flatten().flatten();
        let names = tasks.filter_map(|task| std::fs::read_to_string(task.path().join("comm")).ok());
        most = most.max(names.filter(|task| task.starts_with(name)).count());
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    assert!(child.wait().expect("it ended").success());
    most
}

#[test]
fn as_many_threads_compute_as_asked_for_and_the_picture_is_the_same() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(20_000));
    let picture = |name: &str| std::fs::read(folder.path().join(name)).expect("a picture");
    let size = ["--size", "640x480"];
    for threads in ["1", "3", "5"] {
        let count: usize = threads.parse().expect("a number");
        let name = format!("{threads}.exr");
        let arguments = [&["-o", &name, "--device", "reference", "--threads", threads][..], &size];
        assert_eq!(most(&folder, &arguments.concat(), "worker-"), count);
        assert!(picture(&name) == picture("1.exr"), "{threads} threads");
    }
}

/// The driver's threads, too, where it is lavapipe.
#[test]
fn software_drivers_start_as_many_threads() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(20_000));
    let devices = run_in(folder.path(), &["devices"]).succeeds().stdout;
    let is_default = |line: &&str| line.starts_with("0          llvmpipe");
    if devices.lines().find(is_default).is_none() {
        return crate::said("SKIPPED: software_drivers_start_as_many_threads: no lavapipe here");
    }
    let picture = |name: &str| std::fs::read(folder.path().join(name)).expect("a picture");
    for threads in ["1", "3"] {
        let name = format!("{threads}.exr");
        let arguments = ["-o", &name, "--device", "llvmpipe", "--threads", threads];
        let count: usize = threads.parse().expect("a number");
        assert_eq!(most(&folder, &arguments, "llvmpipe-"), count);
        assert!(picture(&name) == picture("1.exr"), "{threads} threads");
    }
}

#[test]
fn a_number_of_threads_that_makes_no_sense_is_2() {
    let folder = Folder::new();
    for threads in ["0", "-1", "1025", "many", "1.5"] {
        let ran = run_in(folder.path(), &["devices", &format!("--threads={threads}")]);
        ran.fails_with(2, &["--threads"]);
    }
    Ran::of(pointillist().args(["--threads", "2", "schema"])).succeeds();
}
