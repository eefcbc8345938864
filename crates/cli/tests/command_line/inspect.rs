//! `info`, `check`, `schema`: results alone on stdout.

use crate::{Folder, Ran, ply, pointillist, run_in, sphere};
use serde_json::{Value, json};
use std::process::Stdio;

#[test]
fn info_of_a_point_file_is_one_json_object() {
    let folder = Folder::new();
    folder.write("a.ply", &ply(&["0 0 0", "1 0 0", "1 0 0", "4 2 0", "nan 0 0"]));
    let ran = run_in(folder.path(), &["info", "a.ply", "--json"]).succeeds();
    let info: Value = serde_json::from_str(&ran.stdout).expect("JSON alone on stdout");
    assert_eq!(info["points"], 4);
    assert_eq!(info["dropped"]["count"], 1);
    assert_eq!(info["bounds"], json!({ "min": [0.0, 0.0, 0.0], "max": [4.0, 2.0, 0.0] }));
    // Of three positions, the nearest others are 1, 1 and the root of 13 away.
    assert_eq!((&info["spacing"], &info["spacing_sample"]), (&json!(1.0), &Value::Null));
    assert_eq!((&info["coincident"], &info["coincident_counted"]), (&json!(1), &json!(true)));
    assert_eq!(
        ran.stderr,
        "warning: a.ply: dropped 1 of 5 points, whose position is infinite or not a number\n"
    );
    let text = run_in(folder.path(), &["info", "a.ply"]).succeeds().stdout;
    assert!(text.contains("\ncoincide 1 (points at the place of an earlier one)\n"), "{text}");
    assert!(info["format"].as_str().expect("a name").contains("PLY"), "{info}");
    assert!(info["attributes"].is_object(), "{info}");

    folder.write("ball.ply", &sphere(100));
    let ran = run_in(folder.path(), &["info", "ball.ply", "--json"]).succeeds();
    assert_eq!(ran.stderr, "");
    let info: Value = serde_json::from_str(&ran.stdout).expect("JSON alone on stdout");
    let green = &info["attributes"]["green"];
    assert_eq!((&green["min"], &green["max"]), (&json!(100.0), &json!(100.0)));
    assert_eq!(green["histogram"]["counts"][0], 100);
    let text = run_in(folder.path(), &["info", "ball.ply"]).succeeds().stdout;
    assert!(text.contains("100") && text.contains("green"), "{text}");
}

#[test]
fn info_of_a_scene_lists_its_objects() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(100));
    folder.write(
        "s.toml",
        "[image]\nsize = [32, 24]\n[[objects]]\npoints = \"ball.ply\"\n[[objects]]\n\
         name = \"far\"\npoints = \"ball.ply\"\ntransform.translate = [10, 0, 0]\n",
    );
    let ran = run_in(folder.path(), &["info", "s.toml", "--json"]).succeeds();
    let info: Value = serde_json::from_str(&ran.stdout).expect("JSON alone on stdout");
    assert_eq!(info["points"], 200);
    assert_eq!(info["image"]["size"], json!([32, 24]));
    assert_eq!(info["objects"][1]["name"], "far");
    assert!(info["bounds"]["max"][0].as_f64().expect("a number") > 10.5, "{info}");
    let text = run_in(folder.path(), &["info", "s.toml"]).succeeds().stdout;
    assert!(text.contains("'ball'") && text.contains("'far'"), "{text}");
}

#[test]
fn check_says_ok_in_one_line() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(100));
    folder.write("plain.ply", &ply(&["0 0 0", "1 0 0"]));
    folder.write("s.toml", "[[objects]]\npoints = \"ball.ply\"\n");
    assert_eq!(
        run_in(folder.path(), &["check", "s.toml"]).succeeds().stdout,
        "s.toml: ok, 1 object\n"
    );
    run_in(folder.path(), &["check", "s.toml", "--set", "objects.0.surface.trust=7"])
        .fails_with(2, &["objects[0].surface.trust", "7"]);
    // What depends on the points is checked too.
    let plain = [
        "--set",
        "objects.0.points=\"plain.ply\"",
        "--set",
        "objects.0.material.albedo=\"points\"",
    ];
    run_in(folder.path(), &[&["check", "s.toml"][..], &plain].concat())
        .fails_with(2, &["plain.ply", "no colours"]);
}

#[test]
fn the_schema_is_json() {
    let ran = run_in(Folder::new().path(), &["schema"]).succeeds();
    let schema: Value = serde_json::from_str(&ran.stdout).expect("JSON");
    assert!(schema["properties"]["objects"].is_object());
}

/// As `pointillist schema | head -c 1` does: the pipe is closed long before everything is written.
#[test]
fn a_reader_that_leaves_is_no_error() {
    for arguments in [&["schema"][..], &["--help"]] {
        let mut child = pointillist()
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary starts");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        assert!(output.stderr.is_empty(), "{output:?}");
    }
}

/// A full disk, as far as it can be had without one.
#[cfg(target_os = "linux")]
#[test]
fn a_result_that_cannot_be_written_is_4() {
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("/dev/full");
    let output = pointillist().arg("schema").stdout(full).output().expect("the binary starts");
    assert_eq!(output.status.code(), Some(4), "{output:?}");
    assert!(!output.stderr.is_empty());
}

/// A PPM is an image, but none that is read.
#[test]
fn images_that_are_missing_or_of_no_use_are_2() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(100));
    folder.write("t.ppm", "P3\n1 1\n255\n9 9 9\n");
    folder.write("s.toml", "[[objects]]\npoints = \"ball.ply\"\n");
    let check = |set: &str| run_in(folder.path(), &["check", "s.toml", "--set", set]);
    check("background.environment=sky.exr")
        .fails_with(2, &["background.environment", "found no file at 'sky.exr'"]);
    check("objects.0.material.texture=t.ppm")
        .fails_with(2, &["t.ppm", "PNG, JPEG, OpenEXR or Radiance"]);
    check("objects.0.material.albedo=attribute:heat")
        .fails_with(2, &["attribute:heat", "ball.ply", "it has x, y, z"]);
    check("objects.0.material.albedo=attribute:z").succeeds();
    // An output over an input would be its end.
    let render =
        ["render", "s.toml", "-o", "t.ppm.png", "--set", "objects.0.material.texture=t.ppm.png"];
    folder.write("t.ppm.png", "");
    run_in(folder.path(), &render).fails_with(2, &["t.ppm.png"]);
}

/// Nothing in the folder of the scene, then a folder that the variable names.
#[test]
fn a_model_that_is_missing_is_2_and_named_with_variable_and_tool() {
    let folder = Folder::new();
    folder.write("s.toml", "[[objects]]\npoints = 'models/knot.ply'");
    let check = |models: Option<&str>| {
        let mut command = pointillist();
        command.env_remove("POINTILLIST_MODELS").current_dir(folder.path());
        if let Some(models) = models {
            command.env("POINTILLIST_MODELS", models);
        }
        Ran::of(command.args(["check", "s.toml"]))
    };
    let words = ["s.toml:2:10: objects[0].points:", "'models/knot.ply'", "tools/fetch-models"];
    check(None).fails_with(2, &words).fails_with(2, &["POINTILLIST_MODELS is not set"]);
    check(Some("")).fails_with(2, &["POINTILLIST_MODELS is not set"]);
    check(Some("all")).fails_with(2, &words).fails_with(2, &["'all', the folder that POINTILLIST"]);
    std::fs::create_dir_all(folder.path().join("all/deep")).expect("a folder");
    folder.write("all/deep/knot.ply", &sphere(100));
    check(Some("all")).succeeds();
}
