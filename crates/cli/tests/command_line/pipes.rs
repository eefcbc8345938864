//! `-` for stdin and stdout. On the CPU, so that no device is needed.
#![cfg(unix)]

use crate::{Folder, pointillist, run_in, sphere};
use std::io::{Read, Write};
use std::process::{Command, Output, Stdio};

const SMALL: [&str; 4] = ["--device", "reference", "--size", "48x32"];

/// Runs it in a folder with these bytes on stdin, and a folder of its own for temporary files, which is empty at the end.
fn piped(folder: &Folder, arguments: &[&str], input: &[u8]) -> Output {
    let scratch = tempfile::tempdir().expect("a folder");
    let mut child = pointillist()
        .current_dir(folder.path())
        .env("TMPDIR", scratch.path())
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    let mut stdin = child.stdin.take().expect("a pipe");
    let input = input.to_vec();
    // It may end before it has read all.
    let writer = std::thread::spawn(move || drop(stdin.write_all(&input)));
    let output = child.wait_with_output().expect("it ends");
    writer.join().expect("it wrote");
    let left = std::fs::read_dir(scratch.path()).expect("the folder").count();
    assert_eq!(left, 0, "temporary files are left by {arguments:?}");
    output
}

#[track_caller]
fn succeeds(output: Output) -> (Vec<u8>, String) {
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(!stderr.contains("pointillist-stdin-"), "{stderr}");
    (output.stdout, stderr)
}

#[track_caller]
fn fails(output: &Output, words: &[&str]) {
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    for word in words {
        assert!(stderr.contains(word), "'{word}' is not in: {stderr}");
    }
    assert!(!stderr.contains("pointillist-stdin-"), "{stderr}");
    assert!(output.stdout.is_empty());
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(500));
    folder.write("s.toml", SCENE);
    folder
}

const SCENE: &str = "# a ball\n[image]\nsize = [48, 32]\n[[lights]]\nkind = \"directional\"\n\
                     direction = [0, -1, -1]\nirradiance = [3, 3, 3]\n[[objects]]\npoints = \"ball.ply\"\n";

fn rendered(folder: &Folder, arguments: &[&str], name: &str) -> Vec<u8> {
    run_in(folder.path(), &[arguments, &["-o", name]].concat()).succeeds();
    std::fs::read(folder.path().join(name)).expect("a picture")
}

#[test]
fn points_from_a_pipe_give_the_picture_of_the_file() {
    let folder = folder();
    let file = rendered(&folder, &[&["render", "ball.ply"][..], &SMALL].concat(), "a.png");
    let arguments = [&["render", "-", "-o", "b.png"][..], &SMALL].concat();
    let (_, stderr) = succeeds(piped(&folder, &arguments, sphere(500).as_bytes()));
    assert!(stderr.contains("stdin: 500 points"), "{stderr}");
    assert!(std::fs::read(folder.path().join("b.png")).expect("a picture") == file);
    // The header says nothing that changes from run to run.
    let exr = |name: &str| {
        let arguments = [&["render", "-", "-o", name][..], &SMALL].concat();
        succeeds(piped(&folder, &arguments, sphere(500).as_bytes()));
        std::fs::read(folder.path().join(name)).expect("a picture")
    };
    assert!(exr("a.exr") == exr("b.exr"));
}

/// Columns of numbers do not say what they are called.
#[test]
fn what_comes_is_told_by_its_contents_or_by_an_option() {
    let folder = folder();
    let info = |options: &[&str], input: &[u8]| {
        let output = piped(&folder, &[&["info", "-", "--json"][..], options].concat(), input);
        let (stdout, _) = succeeds(output);
        let json: serde_json::Value = serde_json::from_slice(&stdout).expect("JSON");
        json
    };
    let text: String = (0..50).map(|i| format!("{} {} {}\n", i % 7, i / 7, i % 3)).collect();
    assert_eq!(info(&[], sphere(500).as_bytes())["points"], 500);
    assert_eq!(info(&[], text.as_bytes())["points"], 50);
    assert_eq!(info(&["--input-format", "xyz"], text.as_bytes())["points"], 50);
    assert_eq!(info(&[], SCENE.as_bytes())["format"], "scene file");
    assert_eq!(info(&["--input-format", "scene"], SCENE.as_bytes())["format"], "scene file");
    let picture = rendered(&folder, &[&["render", "ball.ply"][..], &SMALL].concat(), "a.png");
    assert_eq!(info(&[], &picture)["format"], "raster");
    fails(&piped(&folder, &["info", "-", "--input-format", "docx"], b"x"), &["--input-format"]);
    let named = ["info", "ball.ply", "--input-format", "ply"];
    run_in(folder.path(), &named).fails_with(2, &["ball.ply", "stdin"]);
}

#[test]
fn a_scene_from_a_pipe_finds_its_files_from_the_working_folder() {
    let folder = folder();
    let reference = ["--device", "reference"];
    let file = rendered(&folder, &[&["render", "s.toml"][..], &reference].concat(), "a.png");
    for source in [&["-"][..], &["--scene", "-"], &["-", "--input-format", "scene"]] {
        let arguments = [&["render"][..], source, &["-o", "b.png"], &reference].concat();
        succeeds(piped(&folder, &arguments, SCENE.as_bytes()));
        let path = folder.path().join("b.png");
        assert!(std::fs::read(&path).expect("a picture") == file, "{source:?}");
        std::fs::remove_file(path).expect("a picture");
        if !source.contains(&"--input-format") {
            let arguments = [&["check"][..], source].concat();
            let (stdout, _) = succeeds(piped(&folder, &arguments, SCENE.as_bytes()));
            assert_eq!(String::from_utf8_lossy(&stdout), "stdin.toml: ok, 1 object\n");
        }
    }
    // Faults have their line.
    let wrong = SCENE.replace("kind =", "kin =");
    fails(&piped(&folder, &["check", "-"], wrong.as_bytes()), &["stdin.toml:5:", "kin"]);
    let gone = SCENE.replace("ball.ply", "gone.ply");
    fails(&piped(&folder, &["check", "--scene", "-"], gone.as_bytes()), &["gone.ply"]);
}

/// A scene that is called as its author likes.
#[test]
fn scene_names_a_scene_of_any_name() {
    let folder = folder();
    folder.write("ball.scene", SCENE);
    let reference = ["--device", "reference"];
    let file = rendered(&folder, &[&["render", "s.toml"][..], &reference].concat(), "a.png");
    let named = rendered(
        &folder,
        &[&["render", "--scene", "ball.scene"][..], &reference].concat(),
        "b.png",
    );
    assert!(file == named);
    run_in(folder.path(), &["check", "--scene", "ball.scene"]).succeeds();
    for arguments in [
        &["render", "-o", "c.png"][..],
        &["render", "ball.ply", "--scene", "s.toml", "-o", "c.png"],
        &["check", "--scene", "-", "--input-format", "ply"],
    ] {
        run_in(folder.path(), arguments).fails_with(2, &["--"]);
    }
}

#[test]
fn a_picture_on_stdout_is_alone_there() {
    let folder = folder();
    for (format, name) in [("png", "a.png"), ("exr", "a.exr"), ("jpg", "a.jpg")] {
        let file = rendered(&folder, &[&["render", "ball.ply"][..], &SMALL].concat(), name);
        let options = ["--format", format, "--progress", "always"];
        let arguments = [&["render", "ball.ply", "-o", "-"][..], &options, &SMALL].concat();
        let (stdout, _) = succeeds(piped(&folder, &arguments, b""));
        assert!(stdout == file, "{format}");
        // Beside a file, from a pipe to a pipe.
        let arguments = [&["render", "-", "-o", "-", "-o", "b.png"][..], &options, &SMALL].concat();
        let (stdout, _) = succeeds(piped(&folder, &arguments, sphere(500).as_bytes()));
        assert!(format == "exr" || stdout == file, "{format}");
    }
    for (options, words) in [
        (&["-o", "-"][..], &["--format"][..]),
        (&["-o", "a.png", "--format", "png"], &["--format", "-o -"]),
        (&["-o", "-", "-o", "-", "--format", "png"], &["twice"]),
        (&["-o", "-", "--format", "bmp"], &["--format"]),
    ] {
        let arguments = [&["render", "ball.ply"][..], options, &SMALL].concat();
        fails(&piped(&folder, &arguments, b""), words);
    }
}

#[test]
fn nothing_from_a_pipe_is_2_and_says_so() {
    let folder = folder();
    for arguments in [
        &["check", "-"][..],
        &["info", "-"],
        &["check", "--scene", "-"],
        &["render", "-", "-o", "b.png"],
    ] {
        fails(&piped(&folder, arguments, b""), &["stdin", "name a file"]);
    }
    // What is no point file is named as such.
    fails(&piped(&folder, &["check", "-"], b"\x00\x01\x02\x03"), &["stdin: found"]);
    fails(&piped(&folder, &["check", "--scene", "-"], b"a = '\xff'"), &["stdin.toml:1:", "UTF-8"]);
}

/// `script` runs the binary on a terminal of its own.
#[test]
fn terminals_are_refused() {
    let folder = folder();
    for arguments in [
        "check -",
        "render - -o b.png --device reference",
        "render ball.ply -o - --format png --device reference",
    ] {
        let line = format!("{} {arguments}", env!("CARGO_BIN_EXE_pointillist"));
        let mut command = Command::new("script");
        command.args(["-qec", &line, "/dev/null"]).current_dir(folder.path());
        let Ok(output) = command.stdin(Stdio::null()).output() else {
            return crate::said("SKIPPED: terminals_are_refused: no script(1) here");
        };
        let shown = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {shown}");
        assert!(shown.contains("is a terminal"), "{arguments}: {shown}");
    }
}

/// As `| head -c 10` does. The other picture is whole.
#[test]
fn a_reader_that_stops_is_no_error() {
    let folder = folder();
    let mut child = pointillist()
        .current_dir(folder.path())
        .args(["render", "ball.ply", "-o", "-", "-o", "b.png", "--format", "exr"])
        .args(["--device", "reference", "--size", "800x600"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    let mut stdout = child.stdout.take().expect("a pipe");
    stdout.read_exact(&mut [0; 10]).expect("a beginning");
    drop(stdout);
    let output = child.wait_with_output().expect("it ends");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(!stderr.contains("error") && folder.path().join("b.png").exists(), "{stderr}");
}

/// While it waits for a pipe that nobody fills, and while it copies.
#[test]
fn an_interruption_while_it_reads_leaves_nothing() {
    let folder = folder();
    let scratch = tempfile::tempdir().expect("a folder");
    for begun in [false, true] {
        let mut child = pointillist()
            .current_dir(folder.path())
            .env("TMPDIR", scratch.path())
            .args(["check", "-"])
            .stdin(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary starts");
        let mut stdin = child.stdin.take().expect("a pipe");
        if begun {
            let points = sphere(20_000);
            stdin.write_all(&points.as_bytes()[..200_000]).expect("it reads");
        }
        // Until it has taken over the signals: before, the system ends it, as shells do.
        let status = format!("/proc/{}/status", child.id());
        let catches = || {
            let status = std::fs::read_to_string(&status).unwrap_or_default();
            let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
            let mask = u64::from_str_radix(mask.unwrap_or("0").trim(), 16).unwrap_or(0);
            mask & 2 != 0
        };
        while cfg!(target_os = "linux") && !catches() {
            assert!(child.try_wait().expect("it can be asked").is_none(), "it ended");
            std::thread::yield_now();
        }
        let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        assert!(kill.expect("kill runs").success());
        assert_eq!(child.wait().expect("it ends").code(), Some(130));
        assert_eq!(std::fs::read_dir(scratch.path()).expect("the folder").count(), 0);
    }
}
