//! Drivers that crash while they are loaded, limits that leave no room beside a driver, interruptions while nothing is
//! held, and outputs that lead nowhere.
#![cfg(unix)]

use crate::{Folder, Ran, pointillist, run_in, sphere};
use std::io::{Read, Write};
use std::process::{Command, Stdio};
use std::time::Duration;

/// A library that ends by this signal when it is loaded, and the file that names it as a driver. `None` where there is no C
/// compiler.
fn crashing(folder: &Folder, body: &str) -> Option<String> {
    folder.write("driver.c", &format!("#include <stdlib.h>\n{body}\n"));
    let built = Command::new("cc")
        .args(["-shared", "-fPIC", "-o", "driver.so", "driver.c"])
        .current_dir(folder.path())
        .status();
    if !built.is_ok_and(|status| status.success()) {
        crate::said("skipped: a driver that crashes needs a C compiler (cc)");
        return None;
    }
    let library = folder.path().join("driver.so").display().to_string();
    folder.write(
        "driver.json",
        &format!(
            "{{ \"file_format_version\": \"1.0.0\", \"ICD\": {{ \"library_path\": \"{library}\", \"api_version\": \
             \"1.3.0\" }} }}"
        ),
    );
    Some(folder.path().join("driver.json").display().to_string())
}

/// By default the CPU renders and says why, once; a device that is asked for crashes the process, which says so.
#[test]
fn a_driver_that_crashes_while_it_is_loaded_is_passed_over() {
    for body in [
        "__attribute__((constructor)) static void f(void) { *(volatile int *)0 = 1; }",
        "__attribute__((constructor)) static void f(void) { abort(); }",
    ] {
        let folder = Folder::new();
        folder.write("ball.ply", &sphere(100));
        let Some(driver) = crashing(&folder, body) else { return };
        let run = |arguments: &[&str]| {
            let mut command = pointillist();
            command.envs([("VK_DRIVER_FILES", &driver), ("VK_ICD_FILENAMES", &driver)]);
            Ran::of(command.current_dir(folder.path()).args(arguments))
        };
        let render = ["render", "ball.ply", "-o", "a.png", "--size", "8x8"];
        let ran = run(&render).succeeds();
        assert!(ran.stderr.contains("crashed while it was opened"), "{}", ran.stderr);
        assert_eq!(ran.stderr.lines().count(), 2, "{}", ran.stderr);
        assert!(folder.path().join("a.png").is_file());
        let ran = run(&["devices"]).succeeds();
        assert!(ran.stdout.contains("default    reference: the Vulkan driver crashed"), "{ran:?}");
        let asked = run(&[&render[..], &["--device", "vulkan"]].concat());
        assert_eq!(asked.code, Some(4), "{asked:?}");
        assert!(asked.stderr.contains("the process crashed"), "{asked:?}");
        // What another process left in the environment is nothing to this one.
        let mut command = pointillist();
        command.env("POINTILLIST_DRIVER_CRASHED", "1").args(["devices"]);
        assert!(!Ran::of(&mut command).succeeds().stdout.contains("crashed"));
    }
}

/// Room for a driver, or for the points, but not for both: the CPU does it, as it does with less.
#[test]
fn a_driver_is_not_opened_in_the_room_that_the_points_need() {
    let folder = Folder::new();
    // 4 MiB of text, which is about 64 MiB of points.
    folder.write("ball.ply", &sphere(80_000));
    let script = "ulimit -v 500000 && exec \"$@\"";
    let mut command = Command::new("sh");
    command.args(["-c", script, "sh", env!("CARGO_BIN_EXE_pointillist"), "render", "ball.ply"]);
    command.args(["-o", "a.png", "--size", "16x16", "--threads", "2"]);
    command.args(["--set", "objects.0.surface.neighbors=16"]).current_dir(folder.path());
    let ran = Ran::of(&mut command).succeeds();
    let line = ran.stderr.lines().next().unwrap_or_default();
    assert!(line.contains("with the points and the picture needs about"), "{line}");
    assert_eq!(line.matches("--device reference").count(), 1, "{line}");
}

/// Work that looks for no interruption ends at once, and says so all the same.
#[test]
fn an_interruption_is_said_while_a_pipe_is_waited_for() {
    for log in ["text", "json"] {
        let folder = Folder::new();
        let mut child = pointillist()
            .args(["render", "-", "-o", "a.png", "--log", log])
            .current_dir(folder.path())
            .stdin(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary starts");
        let mut stdin = child.stdin.take().expect("a pipe");
        stdin.write_all(b"ply\n").expect("the pipe takes a line");
        std::thread::sleep(Duration::from_millis(500));
        let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        assert!(kill.expect("kill runs").success());
        assert_eq!(child.wait().expect("it ends").code(), Some(130));
        drop(stdin);
        let mut text = String::new();
        child.stderr.take().expect("a pipe").read_to_string(&mut text).expect("UTF-8");
        assert_eq!(text.lines().count(), 1, "{text}");
        if log == "text" {
            assert_eq!(text, "error: interrupted\n");
        } else {
            let line: serde_json::Value = serde_json::from_str(&text).expect("one object");
            assert_eq!((&line["event"], &line["exit"]), (&"error".into(), &130.into()));
        }
    }
}

#[test]
fn what_stdin_and_stdout_are_not_for_is_said() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(2000));
    for (arguments, words) in [
        (&["fill", "ball.ply", "-o", "-"][..], &["fill writes a file", ".ply"][..]),
        (&["bench", "-"], &["-: bench reads nothing from stdin"]),
        (&["render", "ball.ply", "-o", "a.png", "--camera-from", "-"], &["--camera-from -", "EXR"]),
    ] {
        run_in(folder.path(), arguments).fails_with(2, words);
    }
    let file = std::fs::File::open(folder.path().join("ball.ply")).expect("a file");
    let mut command = pointillist();
    command.args(["fill", "-", "-o", "filled.ply", "--count", "500"]).stdin(file);
    let ran = Ran::of(command.current_dir(folder.path())).succeeds();
    assert!(ran.stderr.contains("2000 points, and 500 inside -> filled.ply"), "{}", ran.stderr);
}
