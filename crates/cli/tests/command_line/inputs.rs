//! What scenes may name, and what of it is opened.
#![cfg(unix)]

use crate::{Folder, Ran, pointillist, run_in, sphere};
use std::io::Write;
use std::os::unix::fs::symlink;
use std::process::{Command, Stdio};

const SMALL: [&str; 4] = ["--device", "reference", "--size", "16x12"];

fn make_pipe(folder: &Folder, name: &str) {
    let status = Command::new("mkfifo").arg(folder.path().join(name)).status();
    assert!(status.expect("mkfifo runs").success());
}

/// They may never end, or wait for a writer that never comes: neither is opened.
#[test]
fn pipes_and_devices_in_a_scene_are_2_and_named() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(100));
    make_pipe(&folder, "pipe");
    symlink("/dev/zero", folder.path().join("link")).expect("a link");
    let plain = "[[objects]]\npoints = 'ball.ply'\n";
    for (key, text) in [
        ("objects[0].points", "[[objects]]\npoints = 'FILE'\n".to_owned()),
        ("objects[0].material.texture", format!("{plain}material = {{ texture = 'FILE' }}\n")),
        ("background.environment", format!("[background]\nenvironment = 'FILE'\n{plain}")),
        (
            "objects[0].volume.transfer",
            format!("{plain}volume = {{ scalar = 'x', transfer = 'FILE' }}\n"),
        ),
    ] {
        for file in ["/dev/zero", "/dev/stdin", "pipe", "link"] {
            folder.write("s.toml", &text.replace("FILE", file));
            let words = ["s.toml:", key, "a pipe or a device", file];
            for command in [
                &["check", "s.toml"][..],
                &["info", "s.toml"],
                &["render", "s.toml", "-o", "a.png"],
            ] {
                let mut child = pointillist();
                child.current_dir(folder.path()).args(command);
                // A terminal would wait as well.
                Ran::of(child.stdin(Stdio::piped())).fails_with(2, &words);
            }
        }
    }
}

/// What the user names may be a pipe: it is read once.
#[test]
fn points_may_come_through_a_pipe() {
    let folder = Folder::new();
    for arguments in [
        &["info", "/dev/stdin"][..],
        &["check", "/dev/stdin"],
        &["render", "/dev/stdin", "-o", "a.png", "--device", "reference", "--size", "8x8"],
    ] {
        let mut child = pointillist()
            .current_dir(folder.path())
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()
            .expect("the binary starts");
        let mut pipe = child.stdin.take().expect("a pipe");
        pipe.write_all(sphere(100).as_bytes()).expect("it reads");
        drop(pipe);
        assert!(child.wait().expect("it ends").success(), "{arguments:?}");
    }
    for arguments in [&["info", "/dev/zero"][..], &["render", "/dev/zero", "-o", "b.png"]] {
        run_in(folder.path(), arguments).fails_with(2, &["/dev/zero", "expected a point file"]);
    }
    folder.write("b.png", "");
    run_in(folder.path(), &["compare", "/dev/zero", "b.png"])
        .fails_with(2, &["/dev/zero", "a pipe"]);
}

/// A link and a path through `..` lead where they say; a model only to what is below the folder of models.
#[test]
fn paths_lead_where_they_say() {
    let folder = Folder::new();
    for inner in ["scene", "models/deep"] {
        std::fs::create_dir_all(folder.path().join(inner)).expect("a folder");
    }
    folder.write("ball.ply", &sphere(100));
    folder.write("models/deep/inside.ply", &sphere(100));
    symlink("../ball.ply", folder.path().join("scene/link.ply")).expect("a link");
    symlink("circle.ply", folder.path().join("scene/circle.ply")).expect("a link");
    let check = |points: &str| {
        folder.write("scene/s.toml", &format!("[[objects]]\npoints = '{points}'\n"));
        let mut command = pointillist();
        command.env("POINTILLIST_MODELS", "models").env("HOME", folder.path());
        Ran::of(command.current_dir(folder.path()).args(["check", "scene/s.toml"]))
    };
    for found in ["../ball.ply", "link.ply", "models/inside.ply", "../models/deep/inside.ply"] {
        check(found).succeeds();
    }
    for missing in [
        "models/../../ball.ply",
        "models//ball.ply",
        "~/ball.ply",
        "$HOME/ball.ply",
        "*.ply",
        "circle.ply",
        "",
    ] {
        check(missing).fails_with(2, &["s.toml:2:10"]);
    }
}

/// A scene has a say in where its points come from, and in nothing else: what is written is what `-o` names.
#[test]
fn a_scene_names_no_output() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(100));
    folder.write("s.toml", "[[objects]]\nname = '../../evil.png'\npoints = 'ball.ply'\n");
    let schema = run_in(folder.path(), &["schema"]).succeeds().stdout;
    for word in ["output", "write", "save", "file", "path", "include", "command"] {
        assert!(!schema.contains(&format!("\"{word}\":")), "a key {word}");
    }
    std::fs::create_dir(folder.path().join("out")).expect("a folder");
    std::fs::create_dir(folder.path().join("tmp")).expect("a folder");
    let mut command = pointillist();
    command.env("TMPDIR", folder.path().join("tmp")).current_dir(folder.path());
    Ran::of(command.args(["render", "s.toml", "-o", "out/a.png"]).args(SMALL)).succeeds();
    assert_eq!(folder.names(), ["ball.ply", "out", "s.toml", "tmp"]);
    for (inner, count) in [("out", 1), ("tmp", 0)] {
        let entries = std::fs::read_dir(folder.path().join(inner)).expect("a folder");
        assert_eq!(entries.count(), count, "{inner}");
    }
}

/// Names in files may hold what terminals obey: it is written out.
#[test]
fn a_terminal_is_not_told_to_obey_names() {
    let folder = Folder::new();
    let header = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n";
    folder.write("a.ply", &format!("{header}property float \x1b[2Jz\nend_header\n0 0 0\n"));
    folder.write(
        "b.ply",
        &format!("{header}property float z\nproperty float \x1b[2Jq\nend_header\n0 0 0 5\n"),
    );
    folder.write("s.toml", "[[objects]]\nname = \"\\u001b[2J\"\npoints = 'b.ply'\n");
    let runs = [
        &["info", "a.ply"][..],
        &["info", "b.ply"],
        &["info", "s.toml"],
        &["check", "s.toml", "--set", "objects.0.material.kind=\x1b[2J"],
        &["render", "b.ply", "-o", "\x1b[2J.png", "--device", "reference", "--size", "8x8"],
    ];
    for arguments in runs {
        let ran = run_in(folder.path(), arguments);
        assert!(
            !format!("{}{}", ran.stdout, ran.stderr).contains('\x1b'),
            "{arguments:?}: {ran:?}"
        );
        assert!(format!("{}{}", ran.stdout, ran.stderr).contains("[2J"), "{arguments:?}: {ran:?}");
    }
}
