//! Numbers and presets that are mistyped: each error speaks in the words of its option.

use crate::{Folder, run_in, sphere};

#[test]
fn negative_numbers_are_told_in_the_words_of_their_option() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(100));
    let render = ["render", "ball.ply", "-o", "a.png"];
    let after = |options: &[&'static str]| [&render[..], options].concat();
    for (arguments, words) in [
        (after(&["--threads", "-1"]), &["--threads", "from 1 to 1024"][..]),
        (after(&["--size", "-1x5"]), &["--size", "expected WxH"]),
        (after(&["--cells-per-pass", "-1"]), &["--cells-per-pass", "-1"]),
        (vec!["fill", "ball.ply", "-o", "b.ply", "--count", "-1"], &["--count", "-1 is not in"]),
        (vec!["compare", "a.png", "b.png", "--max-abs", "-1"], &["--max-abs", "at least 0"]),
        (vec!["compare", "a.png", "b.png", "--flip", "-1"], &["--flip", "at least 0"]),
    ] {
        let ran = run_in(folder.path(), &arguments).fails_with(2, words);
        assert!(!ran.stderr.contains("unexpected argument"), "{}", ran.stderr);
    }
    // Of a file's coordinates, which lie outside of every picture.
    let ran = run_in(folder.path(), &after(&["--size", "64x48", "--crop", "1000,2000,5,5"]));
    ran.fails_with(2, &["1000", "objects.0.filter.box"]);
    let ran = run_in(folder.path(), &after(&["--size", "64x48", "--crop", "60,40,5,5"]));
    assert!(!ran.fails_with(2, &["crop"]).stderr.contains("filter.box"));
}

/// Also where the pictures differ.
#[test]
fn compare_logs_a_result() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(100));
    for (name, exposure) in [("a.png", "0"), ("b.png", "1")] {
        let render = ["render", "ball.ply", "--size", "8x8", "--device", "reference", "-o", name];
        run_in(folder.path(), &[&render[..], &["--exposure", exposure]].concat()).succeeds();
    }
    for (other, code) in [("a.png", 0), ("b.png", 1)] {
        let arguments = ["compare", "a.png", other, "--max-abs", "0", "--log", "json"];
        let ran = run_in(folder.path(), &arguments);
        assert_eq!(ran.code, Some(code), "{ran:?}");
        let line: serde_json::Value = serde_json::from_str(&ran.stderr).expect("one object");
        assert_eq!((&line["event"], &line["exit"]), (&"result".into(), &code.into()));
        let over = line["over"].as_array().expect("a list");
        assert_eq!(over.is_empty(), code == 0, "{line}");
    }
}

#[test]
fn two_presets_are_one_too_many() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(100));
    for (command, more) in
        [("render", &["-o", "a.png"][..]), ("check", &[]), ("bench", &["--runs", "1"])]
    {
        for value in ["7", "papr", "\"other\""] {
            let set = format!("render.preset={value}");
            let arguments =
                [&[command, "ball.ply", "--preset", "paper", "--set", &set], more].concat();
            let words = ["--preset paper", &format!("--set {set}"), "different presets"];
            run_in(folder.path(), &arguments).fails_with(2, &words);
        }
    }
    let same = ["check", "ball.ply", "--preset", "paper", "--set", "render.preset=\"paper\""];
    run_in(folder.path(), &same).succeeds();
}

#[test]
fn the_rows_of_a_suite_are_listed_where_it_is_named() {
    let folder = Folder::new();
    let ran = run_in(folder.path(), &["bench", "paper", "--list"]).succeeds();
    assert!(ran.stdout.starts_with("paper: "), "{}", ran.stdout);
    assert!(ran.stdout.contains("horse") && !ran.stdout.contains("scaling"), "{}", ran.stdout);
    folder.write("ball.ply", &sphere(10));
    run_in(folder.path(), &["bench", "ball.ply", "--list"]).fails_with(2, &["ball.ply", "suite"]);
    run_in(folder.path(), &["bench", "papr", "--list"]).fails_with(2, &["papr"]);
}
