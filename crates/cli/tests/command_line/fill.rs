//! `fill`: what it writes, and how it ends where it cannot.

use crate::{Folder, Ran, run_in, sphere};
use serde_json::Value;

fn fill(folder: &Folder, arguments: &[&str]) -> Ran {
    run_in(folder.path(), &[&["fill"], arguments].concat())
}

#[test]
fn a_surface_is_filled_with_points_that_carry_scalars() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(2000));
    let ran = fill(&folder, &["ball.ply", "-o", "filled.ply", "--count", "1500"]).succeeds();
    assert_eq!(ran.stdout, "");
    assert!(ran.stderr.contains("2000 points, and 1500 inside -> filled.ply"), "{}", ran.stderr);
    let ran = run_in(folder.path(), &["info", "filled.ply", "--json"]).succeeds();
    let found: Value = serde_json::from_str(&ran.stdout).expect("one JSON object");
    assert_eq!(found["points"], 3500);
    for (name, min, max) in [("boundary", 0.0, 1.0), ("depth", 0.0, 1.0)] {
        let range = &found["attributes"][name];
        assert_eq!(
            (range["min"].as_f64(), range["max"].as_f64()),
            (Some(min), Some(max)),
            "{name}"
        );
    }
    assert!(found["attributes"]["density"]["max"].as_f64().is_some_and(|most| most <= 1.0));

    // The same again, from another format.
    let text: Vec<String> = sphere(2000).lines().skip(10).map(str::to_owned).collect();
    folder.write("ball.xyz", &text.join("\n"));
    fill(&folder, &["ball.xyz", "-o", "again.ply", "--count", "1500", "--quiet"]).succeeds();
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).expect("a file");
    // `float` of a PLY is 32 bits, numbers of a text are 64: the points are as many, not the same.
    assert_eq!(bytes("again.ply").len(), bytes("filled.ply").len());
}

#[test]
fn what_cannot_be_filled_is_an_error_and_leaves_no_file() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(500));
    folder.write("one.xyz", "1 2 3\n1 2 3\n");
    let names = folder.names();
    for (arguments, words) in [
        (&["none.ply", "-o", "out.ply"][..], &["none.ply"][..]),
        (&["one.xyz", "-o", "out.ply"], &["one.xyz", "no inside", "--reach"]),
        (&["ball.ply", "-o", "out.exr"], &["out.exr", "'.ply'"]),
        (&["ball.ply", "-o", "ball.ply"], &["ball.ply", "also an input"]),
        (&["ball.ply", "-o", "nowhere/out.ply"], &["nowhere/out.ply", "does not exist"]),
        (&["ball.ply", "-o", "out.ply", "--count", "0"], &["--count"]),
        (&["ball.ply", "-o", "out.ply", "--reach", "0.6"], &["--reach", "at most 0.5"]),
        (&["ball.ply", "-o", "out.ply", "--reach", "-1"], &["--reach", "more than 0"]),
        (&["ball.ply"], &["--output"]),
    ] {
        fill(&folder, arguments).fails_with(2, words);
    }
    assert_eq!(folder.names(), names);
}
