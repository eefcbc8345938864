//! Scenes out of pictures, and files that have moved since.

use crate::{Folder, Ran, run_in, sphere};
use std::path::Path;

const SMALL: [&str; 5] = ["--device", "reference", "--size", "32x24", "--quiet"];

fn render(folder: &Path, arguments: &[&str]) -> Ran {
    run_in(folder, &[&["render"], arguments, &SMALL].concat())
}

/// A folder with a scene of two objects in folders of their own, and a picture of it.
fn rendered() -> Folder {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.path().join("data/deep")).expect("folders");
    folder.write("data/a.ply", &sphere(300));
    folder.write("data/deep/b.ply", &sphere(200));
    let absolute = folder.path().join("data/deep/b.ply");
    let scene = format!(
        "[[lights]]\nkind = 'headlight'\nat_target = [1, 1, 1]\n[[objects]]\npoints = 'data/a.ply'\n\
         [[objects]]\npoints = '{}'\ntransform = {{ translate = [1, 0, 0] }}\n",
        absolute.display()
    );
    folder.write("scene.toml", &scene);
    render(folder.path(), &["scene.toml", "-o", "a.exr"]).succeeds();
    folder
}

fn equal(folder: &Path, a: &str, b: &str) {
    run_in(folder, &["compare", a, b, "--max-abs", "0", "--headers"]).succeeds();
}

#[test]
fn a_picture_renders_again_from_its_header() {
    let folder = rendered();
    render(folder.path(), &["a.exr", "-o", "again.exr"]).succeeds();
    equal(folder.path(), "a.exr", "again.exr");
    let ran = run_in(folder.path(), &["info", "a.exr", "--scene"]).succeeds();
    assert_eq!(ran.stderr, "");
    folder.write("out.toml", &ran.stdout);
    render(folder.path(), &["out.toml", "-o", "out.exr"]).succeeds();
    equal(folder.path(), "a.exr", "out.exr");
    let ran = run_in(folder.path(), &["check", "a.exr"]).succeeds();
    assert!(ran.stdout.contains("a.exr: ok, 2 objects"), "{}", ran.stdout);
    // Single values are overridden as in a scene file.
    let other = ["--set", "objects.0.material.albedo=[0.1, 0.2, 0.3]"];
    render(folder.path(), &[&["a.exr", "-o", "c.exr"], &other[..]].concat()).succeeds();
    let ran = run_in(folder.path(), &["compare", "a.exr", "c.exr", "--max-abs", "0"]);
    assert_eq!(ran.code, Some(1));
}

#[test]
fn files_that_have_moved_are_all_named_and_found_below_the_root() {
    let folder = rendered();
    let elsewhere = Folder::new();
    std::fs::copy(folder.path().join("a.exr"), elsewhere.path().join("a.exr")).expect("a copy");
    std::fs::rename(folder.path().join("data"), folder.path().join("moved")).expect("a new name");

    let ran = run_in(elsewhere.path(), &["render", "a.exr", "-o", "b.exr"]);
    ran.fails_with(
        2,
        &["objects[0].points", "objects[1].points", "data/a.ply", "deep/b.ply", "--root"],
    );

    // Below the folder itself, by the last part; and of the absolute path by its tail.
    let root = folder.path().join("moved");
    let root = root.to_str().expect("UTF-8");
    render(elsewhere.path(), &["a.exr", "-o", "b.exr", "--root", root]).succeeds();
    equal(elsewhere.path(), "a.exr", "b.exr");
    run_in(elsewhere.path(), &["check", "a.exr", "--root", root]).succeeds();
    let scene = folder.path().join("scene.toml");
    let scene = scene.to_str().expect("UTF-8");
    run_in(elsewhere.path(), &["info", scene, "--root", root]).succeeds();
    run_in(elsewhere.path(), &["info", scene]).fails_with(2, &["data/a.ply"]);

    // One is not there: all places are named.
    std::fs::remove_file(folder.path().join("moved/deep/b.ply")).expect("a file");
    let ran = run_in(elsewhere.path(), &["check", "a.exr", "--root", root]);
    let ran = ran.fails_with(2, &["objects[1].points", "moved/deep/b.ply", "moved/b.ply"]);
    assert!(!ran.stderr.contains("objects[0]"), "{}", ran.stderr);
}

#[test]
fn a_root_is_a_folder_and_for_scenes() {
    let folder = rendered();
    for (arguments, words) in [
        (&["check", "a.exr", "--root", "nowhere"][..], &["--root nowhere", "no such folder"][..]),
        (&["check", "data/a.ply", "--root", "data"], &["--root", "point file"]),
        (&["info", "scene.toml", "--scene"], &["scene.toml", "--scene"]),
    ] {
        run_in(folder.path(), arguments).fails_with(2, words);
    }
    film::write_planes(
        [2, 2],
        [0; 2],
        [2, 2],
        vec![("R".into(), vec![0.0; 4])],
        &folder.path().join("p.exr"),
    )
    .expect("a file");
    run_in(folder.path(), &["check", "p.exr"]).fails_with(2, &["p.exr", "no scene in its header"]);
}
