//! `compare`: of which pictures FLIP is computed without being asked for, and how to ask.

use crate::{Folder, Ran, run_in};
use serde_json::{Value, json};

/// An EXR with R, G and B, all of them 0.5 but one pixel.
fn picture(folder: &Folder, name: &str, size: [u32; 2], pixel: f32) {
    let count = (size[0] * size[1]) as usize;
    let plane = |name: &str| {
        let mut values = vec![0.5; count];
        values[count / 2] = pixel;
        (name.to_owned(), values)
    };
    let planes = ["R", "G", "B"].map(plane).to_vec();
    film::write_planes(size, [0; 2], size, planes, &folder.path().join(name)).expect("a file");
}

fn compare(folder: &Folder, arguments: &[&str]) -> Ran {
    run_in(folder.path(), &[&["compare"], arguments].concat())
}

fn compared(folder: &Folder, arguments: &[&str]) -> Value {
    let ran = compare(folder, &[arguments, &["--json"]].concat()).succeeds();
    serde_json::from_str(&ran.stdout).expect("one JSON object")
}

#[test]
fn flip_of_more_than_two_megapixels_is_for_those_who_ask() {
    let folder = Folder::new();
    // 2^21 pixels, and a row more.
    picture(&folder, "a.exr", [2048, 1025], 0.5);
    picture(&folder, "b.exr", [2048, 1025], 0.9);
    let found = compared(&folder, &["a.exr", "b.exr", "--max-abs", "0.5"]);
    assert_eq!((&found["flip"], &found["flip_details"]), (&Value::Null, &Value::Null));
    let why = found["flip_why"].as_str().expect("a reason");
    assert!(why.contains("2048x1025") && why.contains("--flip"), "{why}");
    let ran = compare(&folder, &["a.exr", "b.exr"]).succeeds();
    assert!(ran.stdout.contains("FLIP     left out of 2048x1025 pixels"), "{}", ran.stdout);
    assert!(ran.stdout.contains("pass, since no limit was given"), "{}", ran.stdout);

    // Asked for, with a limit or without.
    let found = compared(&folder, &["a.exr", "b.exr", "--flip"]);
    assert!(found["flip"].as_f64().is_some_and(|mean| mean > 0.0), "{found}");
    assert_eq!((&found["flip_why"], &found["limits"]["flip"]), (&Value::Null, &Value::Null));
    let ran = compare(&folder, &["a.exr", "b.exr", "--flip"]).succeeds();
    assert!(ran.stdout.contains("HDR-FLIP mean"), "{}", ran.stdout);
    assert!(ran.stdout.contains("pass, since no limit was given"), "{}", ran.stdout);
    assert_eq!(compare(&folder, &["a.exr", "b.exr", "--flip", "1e-9"]).code, Some(1));

    // 2^21 pixels get it, and equal ones of any size, the same bytes or not.
    picture(&folder, "c.exr", [2048, 1024], 0.5);
    picture(&folder, "d.exr", [2048, 1024], 0.9);
    assert!(compared(&folder, &["c.exr", "d.exr"])["flip"].is_f64());
    std::fs::copy(folder.path().join("a.exr"), folder.path().join("copy.exr")).expect("a copy");
    let found = compared(&folder, &["a.exr", "copy.exr", "--max-abs", "0"]);
    assert_eq!((&found["flip"], &found["flip_why"]), (&json!(0.0), &Value::Null));
    let half = film::read_exr(&folder.path().join("a.exr")).expect("an EXR").channels;
    let planes = half.into_iter().chain([("Z".to_owned(), vec![1.0; 2048 * 1025])]).collect();
    film::write_planes([2048, 1025], [0; 2], [2048, 1025], planes, &folder.path().join("z.exr"))
        .expect("a file");
    assert_eq!(compared(&folder, &["a.exr", "z.exr"])["flip"], json!(0.0), "other bytes");
}

#[test]
fn flip_without_a_limit_goes_behind_the_names() {
    let folder = Folder::new();
    picture(&folder, "a.exr", [8, 8], 0.5);
    compare(&folder, &["--flip", "a.exr", "a.exr"]).fails_with(2, &["--flip", "after the names"]);
    let found = compared(&folder, &["a.exr", "a.exr", "--no-flip"]);
    assert_eq!((&found["flip"], &found["flip_why"]), (&Value::Null, &json!("left out")));
    let found = compared(&folder, &["a.exr", "a.exr", "--channels", "R"]);
    assert!(found["flip_why"].as_str().is_some_and(|why| why.contains("R, G and B")), "{found}");
    compare(&folder, &["a.exr", "a.exr", "--channels", "R", "--flip"]).fails_with(2, &["RGB"]);
}
