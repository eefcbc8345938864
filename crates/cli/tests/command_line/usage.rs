//! Mistakes: found before work, named, exit code 2, nothing written.

use crate::{Folder, Ran, pointillist, run_in, sphere};

#[test]
fn a_command_line_that_makes_no_sense_is_2() {
    let folder = Folder::new();
    for arguments in [
        &[][..],
        &["paint"],
        &["render"],
        &["render", "a.ply"],
        &["render", "a.ply", "-o", "a.png", "--size", "640"],
        &["render", "a.ply", "-o", "a.png", "--crop", "1,2,3"],
        &["render", "a.ply", "-o", "a.png", "--up", "x"],
        &["render", "a.ply", "-o", "a.png", "--samples", "-1"],
        &["render", "a.ply", "-o", "a.png", "--cells-per-pass", "many"],
        &["bench", "a.ply", "--runs", "0"],
    ] {
        run_in(folder.path(), arguments).fails_with(2, &[]);
    }
    assert!(folder.names().is_empty());
}

#[test]
fn help_and_version_are_no_errors() {
    let folder = Folder::new();
    for arguments in [&["--help"][..], &["--version"], &["render", "--help"]] {
        let ran = run_in(folder.path(), arguments).succeeds();
        assert!(ran.stdout.contains("pointillist"), "{ran:?}");
    }
}

/// The scene does not exist, so whoever complains about the output has not looked at it.
#[test]
fn outputs_are_checked_before_any_work() {
    let folder = Folder::new();
    folder.write("folder.png", "");
    std::fs::create_dir(folder.path().join("a.exr")).expect("a folder");
    for (output, words) in [
        ("a.bmp", &["a.bmp", ".exr", ".png", ".jpg"][..]),
        ("a", &["a:", ".exr"]),
        ("nowhere/a.png", &["nowhere/a.png", "does not exist"]),
        ("folder.png/a.png", &["folder.png/a.png"]),
        ("a.exr", &["a.exr", "folder"]),
    ] {
        run_in(folder.path(), &["render", "none.ply", "-o", "b.png", "-o", output])
            .fails_with(2, words);
    }
    run_in(folder.path(), &["render", "none.ply", "-o", "b.png", "--stats", "nowhere/s.json"])
        .fails_with(2, &["nowhere/s.json"]);
    assert_eq!(folder.names(), ["a.exr", "folder.png"]);
}

#[test]
fn outputs_differ_from_each_other_and_from_inputs() {
    let folder = Folder::new();
    let points = sphere(10);
    folder.write("points.png", &points);
    let render = |outputs: &[&str]| {
        let mut arguments = vec!["render", "points.png", "--device", "reference"];
        arguments.extend(outputs);
        run_in(folder.path(), &arguments)
    };
    render(&["-o", "a.png", "-o", "./a.png"]).fails_with(2, &["a.png", "twice"]);
    render(&["-o", "a.png", "--stats", "a.png"]).fails_with(2, &["a.png", "twice"]);
    render(&["-o", "points.png"]).fails_with(2, &["points.png", "input"]);
    assert_eq!(folder.names(), ["points.png"]);
    let kept = std::fs::read_to_string(folder.path().join("points.png")).expect("still there");
    assert_eq!(kept, points);
}

#[test]
fn options_that_set_scene_values_are_named_as_typed() {
    let folder = Folder::new();
    folder.write("a.ply", &sphere(10));
    let render = |option: &[&str]| {
        let mut arguments = vec!["render", "a.ply", "-o", "a.png", "--device", "reference"];
        arguments.extend(option);
        run_in(folder.path(), &arguments)
    };
    render(&["--size", "0x480"]).fails_with(2, &["--size 0x480", "image.size"]);
    render(&["--size", "20000x1"]).fails_with(2, &["--size 20000x1", "16384"]);
    render(&["--samples", "0"]).fails_with(2, &["--samples <N>", "'0'", "at least 1"]);
    render(&["--set", "image.sice=3"]).fails_with(2, &["--set image.sice=3", "size"]);
    render(&["--crop", "600,0,100,10"]).fails_with(2, &["--crop 600,0,100,10", "640x480"]);
    render(&["--crop", "0,0,0,10"]).fails_with(2, &["--crop 0,0,0,10"]);
    assert_eq!(folder.names(), ["a.ply"]);
}

#[test]
fn channels_are_named_in_the_help_and_where_one_is_unknown() {
    const NAMES: [&str; 7] = ["point", "tests", "cells", "iterations", "trust", "fit", "world"];
    let folder = Folder::new();
    folder.write("a.ply", &sphere(10));
    let render =
        |list: &str| run_in(folder.path(), &["render", "a.ply", "-o", "a.exr", "--channels", list]);
    render("list").fails_with(2, &NAMES);
    render("point,tets").fails_with(2, &["'tets'", "similar", "'tests'"]);
    for wrong in ["", "point,", "object", "Z", "POINT"] {
        render(wrong).fails_with(2, &["--channels <LIST>"]).fails_with(2, &NAMES);
    }
    assert_eq!(folder.names(), ["a.ply"]);
    let help = run_in(folder.path(), &["render", "--help"]).succeeds().stdout;
    for name in NAMES {
        assert!(help.contains(&format!("- {name}")), "'{name}' is not in: {help}");
    }
}

#[test]
fn inputs_at_fault_are_2_and_named() {
    let folder = Folder::new();
    folder.write("empty.ply", "");
    folder.write("noise.ply", "no point file\n");
    folder.write("broken.toml", "[image]\nsice = [1, 2]\n");
    folder.write("lonely.toml", "[[objects]]\npoints = \"none.ply\"\n");
    for (file, words) in [
        ("none.ply", &["none.ply"][..]),
        ("none.toml", &["none.toml"]),
        ("empty.ply", &["empty.ply"]),
        ("noise.ply", &["noise.ply"]),
        ("broken.toml", &["broken.toml:2:1", "sice", "size"]),
        ("lonely.toml", &["lonely.toml:2", "none.ply"]),
        (".", &["folder"]),
    ] {
        run_in(folder.path(), &["render", file, "-o", "a.png", "--device", "reference"])
            .fails_with(2, words);
        run_in(folder.path(), &["check", file]).fails_with(2, words);
        run_in(folder.path(), &["info", file]).fails_with(2, words);
    }
    assert!(!folder.names().contains(&"a.png".to_owned()));
}

#[test]
fn up_is_for_views_that_are_chosen() {
    let folder = Folder::new();
    folder.write("a.ply", &sphere(200));
    let objects = "[[objects]]\npoints = \"a.ply\"\n";
    let camera = "[camera]\neye = [0, 0, 4]\ntarget = [0, 0, 0]\n";
    folder.write("framed.toml", objects);
    folder.write("camera.toml", &format!("{camera}{objects}"));
    let render = |scene: &str| {
        let options = ["--up", "z", "--size", "32x24", "--device", "reference"];
        let mut arguments = vec!["render", scene, "-o", "a.png"];
        arguments.extend(options);
        run_in(folder.path(), &arguments)
    };
    render("a.ply").succeeds();
    render("framed.toml").succeeds();
    render("camera.toml").fails_with(2, &["camera.toml", "--up", "[camera]"]);
}

/// The loader is there or not; a driver is not.
#[test]
fn a_device_that_is_asked_for_is_3_and_names_the_reference() {
    let folder = Folder::new();
    folder.write("a.ply", &sphere(200));
    let without_driver = |arguments: &[&str]| {
        let mut command = pointillist();
        command.env("VK_DRIVER_FILES", "/nonexistent").env("VK_ICD_FILENAMES", "/nonexistent");
        Ran::of(command.current_dir(folder.path()).args(arguments))
    };
    for device in ["vulkan", "voodoo"] {
        without_driver(&["render", "a.ply", "-o", "a.png", "--device", device])
            .fails_with(3, &["--device reference"]);
        without_driver(&["bench", "a.ply", "--device", device])
            .fails_with(3, &["--device reference"]);
    }
    assert_eq!(folder.names(), ["a.ply"]);

    for arguments in [
        &["render", "a.ply", "-o", "a.png", "--size", "32x24"][..],
        &["bench", "a.ply", "--size", "8x8", "--runs", "1"],
    ] {
        let ran = without_driver(arguments).succeeds();
        assert!(ran.stderr.starts_with("rendering by the CPU reference"), "{ran:?}");
    }
}
