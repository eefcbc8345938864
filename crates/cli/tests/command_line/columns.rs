//! Which column of a file is what: `--columns`, `[objects.columns]`, and the notes about guesses.

use crate::{Folder, run_in};
use serde_json::{Value, json};

/// A ball of 200 points: a number, y, x, z, a class, then a colour.
fn ball() -> String {
    let row = |i: u32| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 200.0;
        let (sin, cos) = (2.399_963 * f64::from(i)).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        let [x, y] = [3.0 + radius * cos, 7.0 + radius * sin];
        format!("{}00 {y:.6} {x:.6} {z:.6} tree {} 40 {}\n", i + 1, i % 256, 255 - i % 256)
    };
    (0..200).map(row).collect()
}

const COLUMNS: &str = "_,y,x,z,_,red,green,blue";

fn scene(columns: &str) -> String {
    format!(
        "image.size = [32, 24]\nbackground.color = [0.18, 0.18, 0.18]\n[[lights]]\nkind = \
         \"directional\"\ndirection = [-0.5, -1.0, -0.6]\nirradiance = [2.5, 2.5, 2.5]\n[[lights]]\n\
         kind = \"headlight\"\nat_target = [0.6, 0.6, 0.6]\n\
         [[objects]]\npoints = \"ball.txt\"\n{columns}"
    )
}

#[test]
fn columns_are_said_on_the_command_line_and_in_scenes() {
    let folder = Folder::new();
    folder.write("ball.txt", &ball());
    let run = |arguments: &[&str]| run_in(folder.path(), arguments);
    let ran = run(&["info", "ball.txt", "--columns", COLUMNS, "--json"]).succeeds();
    let info: Value = serde_json::from_str(&ran.stdout).expect("only JSON on stdout");
    let max = &info["bounds"]["max"];
    assert!((max[0].as_f64().expect("a number") - 4.0).abs() < 0.02, "{info}");
    assert!((max[1].as_f64().expect("a number") - 8.0).abs() < 0.02, "{info}");
    assert_eq!(info["attributes"]["red"]["max"], json!(199.0), "{info}");
    assert!(!ran.stderr.contains("taken for"), "{}", ran.stderr);

    let columns =
        "[objects.columns]\ny = 2\nx = 3\nz = 4\nred = 6\ngreen = 7\nblue = 8\n_ = [1, 5]\n";
    folder.write("s.toml", &scene(columns));
    run(&["check", "s.toml"]).succeeds();
    let device = ["--device", "reference"];
    let of_file = ["render", "ball.txt", "--columns", COLUMNS, "--size", "32x24", "-o", "a.png"];
    let as_scenes = ["--quality", "draft", "--exposure", "0"];
    run(&[&of_file[..], &as_scenes, &device].concat()).succeeds();
    run(&[&["render", "s.toml", "-o", "b.png"], &device[..]].concat()).succeeds();
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).expect("a picture");
    assert!(bytes("a.png") == bytes("b.png"), "the option and the table mean the same");

    // One file, read twice.
    let twice =
        scene(columns) + "[[objects]]\npoints = \"ball.txt\"\ncolumns = { x = 4, y = 3, z = 2 }\n";
    folder.write("twice.toml", &twice);
    let ran = run(&["info", "twice.toml", "--json"]).succeeds();
    let info: Value = serde_json::from_str(&ran.stdout).expect("only JSON on stdout");
    let max = |object: usize| info["objects"][object]["points"]["bounds"]["max"][0].clone();
    assert!(max(0).as_f64() > Some(3.9) && max(1).as_f64() < Some(1.0), "{info}");
}

#[test]
fn columns_that_are_not_there_are_errors() {
    let folder = Folder::new();
    folder.write("ball.txt", &ball());
    folder.write("s.toml", &scene("columns = { x = \"E\", y = 2, z = 3 }"));
    folder.write(
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float E\nproperty float N\n\
        property float H\nend_header\n1 2 3\n",
    );
    let run = |arguments: &[&str]| run_in(folder.path(), arguments);
    run(&["check", "s.toml"]).fails_with(2, &["found 'E' as the column of 'x'", "'column_1'"]);
    run(&["info", "s.toml", "--columns", "x,y,z"])
        .fails_with(2, &["s.toml: --columns is for point files"]);
    run(&["render", "s.toml", "--columns", "x,y,z", "-o", "a.png"])
        .fails_with(2, &["s.toml: --columns is for point files", "[objects.columns]"]);
    run(&["info", "ball.txt", "--columns", "x,y"]).fails_with(2, &["found no 'z' in the list"]);
    folder.write("p.png", "");
    run(&["info", "p.png", "--columns", "x,y,z"])
        .fails_with(2, &["p.png: --columns is for point files, but this is a picture"]);
    folder.write("two.toml", &scene("columns = { x = 1, X = 2, z = 3 }"));
    run(&["check", "two.toml"])
        .fails_with(2, &["column 1 and column 2 as the columns of 'x' and 'X'"]);
    let far = "_,y,x,z,_,red,green,blue,alpha";
    run(&["render", "ball.txt", "--columns", far, "-o", "a.png"])
        .fails_with(2, &["found 9 as the column of 'alpha', expected a number from 1 to 8"]);
    run(&["info", "a.ply"])
        .fails_with(2, &["found no number 'x'", "--columns or [objects.columns]"]);
    run(&["info", "a.ply", "--columns", "x,y,z"]).succeeds();
    folder.write(
        "p.toml",
        "[[objects]]\npoints = \"a.ply\"\ncolumns = { x = \"E\", y = \"N\", z = \"H\" }\n",
    );
    run(&["check", "p.toml"]).succeeds();
}

/// What was guessed is one line, with the doubt.
#[test]
fn guesses_are_said_with_their_doubt() {
    let folder = Folder::new();
    let labelled: String = ball()
        .lines()
        .map(|line| {
            let words: Vec<&str> = line.split(' ').collect();
            format!("{} {} {} 200 40 20 {}\n", words[2], words[1], words[3], words[0].len() % 7)
        })
        .collect();
    folder.write("a.txt", &labelled);
    let ran = run_in(folder.path(), &["info", "a.txt"]).succeeds();
    let expected = "a.txt: the columns have no names and were taken for x y z red green blue label, \
                    judging by 200 rows (the colour in columns 4 to 6 is the same throughout; column 7 \
                    has few, small whole numbers); --columns or [objects.columns] says otherwise";
    assert!(ran.stderr.contains(expected), "{}", ran.stderr);
}
