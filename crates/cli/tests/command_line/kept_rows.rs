//! `bench` keeps what it has measured where it ends early. On the CPU, so that no device is needed.
#![cfg(unix)]

use crate::{Folder, Ran, pointillist, run_in, sphere};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

const QUICK: [&str; 6] = ["--device", "reference", "--size", "16x12", "--runs", "1"];

/// A quick scene, and one that takes minutes.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(400));
    folder.write("quick.toml", "[[objects]]\npoints = \"ball.ply\"\n");
    folder.write(
        "slow.toml",
        "[image]\nsize = [4000, 4000]\nsamples = 64\n[[objects]]\npoints = \"ball.ply\"\n",
    );
    folder
}

fn report(folder: &Folder) -> Value {
    let text = std::fs::read_to_string(folder.path().join("a.json")).expect("a report");
    let report: Value = serde_json::from_str(&text).expect("whole JSON");
    let schema = Ran::of(pointillist().args(["schema", "--bench"])).succeeds().stdout;
    let schema: Value = serde_json::from_str(&schema).expect("JSON");
    let validator = jsonschema::validator_for(&schema).expect("a schema");
    assert!(validator.is_valid(&report), "{:?}", validator.iter_errors(&report).next());
    report
}

#[test]
fn an_interruption_keeps_the_rows_before_it() {
    let folder = folder();
    let mut child = pointillist()
        .current_dir(folder.path())
        .args(["bench", "quick.toml", "slow.toml", "--json", "a.json", "--markdown", "a.md"])
        .args(["--device", "reference", "--runs", "1", "--progress", "always"])
        .stderr(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    let mut lines = BufReader::new(child.stderr.take().expect("a pipe")).lines();
    // The first line of the second row's tracing: the first row is done by then.
    let is_second = |line: &String| line.starts_with("2/2 slow: tracing");
    lines.by_ref().map(|line| line.expect("UTF-8")).find(is_second).expect("a line");
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.expect("kill runs").success());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(130));
    let report = report(&folder);
    assert_eq!(report["complete"], false);
    assert_eq!(report["rows"].as_array().map(Vec::len), Some(1));
    assert_eq!(report["rows"][0]["name"], "quick");
    let markdown = std::fs::read_to_string(folder.path().join("a.md")).expect("a table");
    assert!(markdown.contains("| quick |") && markdown.contains("incomplete"), "{markdown}");
    let table = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(table.contains("quick") && table.contains("incomplete"), "{table}");
    let names = ["a.json", "a.md", "ball.ply", "quick.toml", "slow.toml"];
    assert_eq!(folder.names(), names);
}

/// The points are missing, which is found when they are read.
#[test]
fn a_row_that_fails_keeps_the_rows_before_it() {
    let folder = folder();
    folder.write(
        "flat.ply",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
    );
    folder.write("bad.toml", "[[objects]]\npoints = \"flat.ply\"\n");
    let outputs = ["--json", "a.json", "--markdown", "a.md"];
    let arguments = [&["bench", "quick.toml", "bad.toml"][..], &outputs, &QUICK].concat();
    let ran = run_in(folder.path(), &arguments);
    assert_eq!(ran.code, Some(2), "{ran:?}");
    assert!(ran.stderr.contains("flat.ply") && ran.stdout.contains("quick"), "{ran:?}");
    let report = report(&folder);
    assert_eq!(report["complete"], false);
    assert_eq!(report["rows"][0]["name"], "quick");
    assert!(folder.names().contains(&"a.md".to_owned()));

    let all = [&["bench", "quick.toml"][..], &outputs, &QUICK].concat();
    let ran = run_in(folder.path(), &all).succeeds();
    assert!(!ran.stdout.contains("incomplete"), "{ran:?}");
    assert_eq!(self::report(&folder)["complete"], true);
}
