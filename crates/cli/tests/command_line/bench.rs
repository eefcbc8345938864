//! `bench`: suites, what is skipped, and what changed. On the CPU, so that no device is needed.

use crate::{Folder, Ran, pointillist, sphere};
use serde_json::{Value, json};
use std::path::Path;

const QUICK: [&str; 6] = ["--device", "reference", "--size", "24x16", "--runs", "2"];

/// Runs `bench`, without models and with `TMPDIR` a folder of its own.
fn bench(folder: &Folder, arguments: &[&str]) -> Ran {
    let scratch = folder.path().join("scratch");
    std::fs::create_dir_all(&scratch).expect("a folder");
    let mut command = pointillist();
    command.env_remove("POINTILLIST_MODELS").env("TMPDIR", &scratch);
    let ran = Ran::of(command.current_dir(folder.path()).arg("bench").args(arguments));
    let left = std::fs::read_dir(&scratch).expect("the folder").count();
    assert_eq!(left, 0, "temporary files are left by {arguments:?}");
    ran
}

fn quick(folder: &Folder, arguments: &[&str]) -> Ran {
    bench(folder, &[arguments, &QUICK].concat())
}

fn read_json(path: &Path) -> Value {
    let text = std::fs::read_to_string(path).expect("a JSON file");
    serde_json::from_str(&text).expect("JSON")
}

/// A suite of a shaded ball, a glass one, and two tori; `ball.toml` is its scene.
fn write_suite(folder: &Folder) {
    folder.write("ball.ply", &sphere(400));
    folder.write(
        "ball.toml",
        "[[lights]]\nkind = \"directional\"\ndirection = [0, -1, -1]\nirradiance = [3, 3, 3]\n\
         [[objects]]\npoints = \"ball.ply\"\n",
    );
    folder.write(
        "mine.toml",
        "about = \"my own\"\n\
         [[rows]]\nname = \"ball | shaded\"\nscene = \"ball.toml\"\npaper_ms = 40\n\
         [[rows]]\nname = \"glass\"\nscene = \"ball.toml\"\n\
         set = [\"objects.0.material={ kind = \\\"glass\\\" }\"]\ncells_per_pass = [1, 0]\n\
         [[rows]]\nname = \"torus\"\nscene = \"ball.toml\"\ngenerate = \"torus\"\n\
         point_counts = [500, 1000]\n",
    );
}

#[test]
fn suites_are_listed_and_unknown_names_list_them() {
    let folder = Folder::new();
    let listed = bench(&folder, &["--list"]).succeeds().stdout;
    for name in ["paper", "scaling", "cells-per-pass", "smoke"] {
        assert!(listed.lines().any(|line| line.starts_with(name)), "{listed}");
        bench(&folder, &["papr"]).fails_with(2, &["'papr'", "did you mean 'paper'?", name]);
    }
    bench(&folder, &["none.toml"]).fails_with(2, &["none.toml"]);
}

/// All that is asked for is in the rows, and the report is what its schema says.
#[test]
fn a_suite_of_ones_own_is_timed_and_reported() {
    let folder = Folder::new();
    write_suite(&folder);
    let outputs = ["mine.toml", "--json", "b.json", "--markdown", "b.md", "--plot", "b.svg"];
    let ran = quick(&folder, &outputs).succeeds();
    let names = ["ball | shaded", "glass, K = 1", "glass, K = all", "torus, 500 points"];
    for name in names {
        assert!(ran.stdout.contains(name), "{name}: {}", ran.stdout);
    }
    assert!(ran.stdout.contains("paper frames/s"), "{}", ran.stdout);
    assert_eq!(ran.stderr, "", "progress is for terminals");

    let report = read_json(&folder.path().join("b.json"));
    let schema = run_schema("--bench");
    let validator = jsonschema::validator_for(&schema).expect("a schema");
    let errors: Vec<String> = validator.iter_errors(&report).map(|e| e.to_string()).collect();
    assert_eq!(errors, Vec::<String>::new());
    assert!(!validator.is_valid(&json!({ "device": "x" })), "the schema asks for nothing");

    let rows = report["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 5);
    assert_eq!(rows[0]["size"], json!([24, 16]));
    assert_eq!(rows[0]["paper_frames_per_second"], json!(25.0));
    assert_eq!(rows[1]["pixels"], rows[2]["pixels"], "K changes no pixel");
    assert_eq!([&rows[1]["cells_per_pass"], &rows[2]["cells_per_pass"]], [1, 0]);
    assert_eq!([&rows[3]["points"], &rows[4]["points"]], [500, 1000]);
    assert!(rows[0]["rays"]["shadow"].as_u64() > Some(0), "{report}");
    assert!(rows[1]["rays"]["refracted"].as_u64() > Some(0), "{report}");
    assert_eq!(rows[0]["suite"], "mine");
    assert_eq!(report["comparison"], Value::Null);

    let markdown = std::fs::read_to_string(folder.path().join("b.md")).expect("a table");
    let cells = |line: &str| line.replace("\\|", "").matches('|').count();
    let tables: Vec<&str> = markdown.split("\n\n").filter(|part| part.starts_with('|')).collect();
    assert_eq!(tables.len(), 2, "{markdown}");
    for table in tables {
        let counts: Vec<usize> = table.lines().map(cells).collect();
        assert_eq!(counts.len(), 2 + rows.len(), "{table}");
        assert!(counts.iter().all(|count| *count == counts[0]), "{table}");
    }
    let svg = std::fs::read_to_string(folder.path().join("b.svg")).expect("a plot");
    let document = roxmltree::Document::parse(&svg).expect("XML");
    assert_eq!(document.root_element().tag_name().name(), "svg");
    let lines = document.descendants().filter(|node| node.has_tag_name("polyline"));
    assert!(lines.count() >= 2, "no lines for build and trace: {svg}");
    assert!(svg.contains("build") && svg.contains("trace"), "{svg}");
}

fn run_schema(of: &str) -> Value {
    let ran = Ran::of(pointillist().args(["schema", of])).succeeds();
    serde_json::from_str(&ran.stdout).expect("JSON")
}

#[test]
fn suites_meet_their_schema() {
    let schema = run_schema("--suite");
    let validator = jsonschema::validator_for(&schema).expect("a schema");
    let row = json!({ "name": "a", "scene": "a.toml", "cells_per_pass": [1, 0] });
    assert!(validator.is_valid(&json!({ "about": "x", "rows": [row] })));
    for wrong in [
        json!({ "about": "x", "rows": [] }),
        json!({ "about": "x", "rows": [{ "name": "a" }] }),
        json!({ "about": "x", "rows": [{ "name": "a", "scene": "a.toml", "cells_per_pass": [-1] }] }),
    ] {
        assert!(!validator.is_valid(&wrong), "{wrong}");
    }
}

#[test]
fn faults_of_a_suite_are_named_by_line_before_anything_is_timed() {
    let folder = Folder::new();
    write_suite(&folder);
    let suite = std::fs::read_to_string(folder.path().join("mine.toml")).expect("the suite");
    for (from, to, words) in [
        ("paper_ms", "paper_fps", &["bad.toml:5:1", "rows[0].paper_fps", "'paper_ms'"][..]),
        ("[1, 0]", "[1, 0.5]", &["bad.toml:10:22", "cells_per_pass[1]", "0.5"]),
        ("\"torus\"\npoint", "\"cone\"\npoint", &["bad.toml:14:12", "sphere", "torus"]),
        (
            "scene = \"ball.toml\"\npaper",
            "scene = \"bal.toml\"\npaper",
            &["row 'ball | shaded'", "bal.toml"],
        ),
        (
            "kind = \\\"glass\\\"",
            "kind = \\\"glas\\\"",
            &["row 'glass'", "did you mean \"glass\"?"],
        ),
    ] {
        assert!(suite.contains(from), "{from}");
        folder.write("bad.toml", &suite.replacen(from, to, 1));
        quick(&folder, &["bad.toml", "--json", "b.json"]).fails_with(2, words);
    }
    assert!(!folder.names().contains(&"b.json".to_owned()));
}

/// Without models every row of the paper's table is skipped, which is said thrice.
#[test]
fn rows_without_models_are_skipped_loudly() {
    let folder = Folder::new();
    let ran = quick(&folder, &["paper", "--json", "b.json"]).succeeds();
    let report = read_json(&folder.path().join("b.json"));
    assert_eq!(report["rows"], json!([]));
    let skipped = report["skipped"].as_array().expect("a list");
    assert_eq!(skipped.len(), 11);
    for row in skipped {
        let [name, reason] =
            [&row["name"], &row["reason"]].map(|text| text.as_str().expect("text"));
        assert!(reason.contains("POINTILLIST_MODELS"), "{reason}");
        assert!(reason.contains("fetch-models"), "{reason}");
        assert!(!reason.contains("scratch"), "a temporary folder is named: {reason}");
        for said in [&ran.stdout, &ran.stderr] {
            assert!(said.contains(name) && said.contains(reason), "{name}: {said}");
        }
    }
}

#[test]
fn rows_beyond_a_limit_or_beyond_memory_are_skipped() {
    let folder = Folder::new();
    let options = ["scaling", "--max-points", "10000", "--json", "b.json"];
    quick(&folder, &options).succeeds();
    let report = read_json(&folder.path().join("b.json"));
    assert_eq!(report["rows"][0]["name"], "torus, 10000 points");
    assert_eq!(report["rows"].as_array().map(Vec::len), Some(1));
    assert_eq!(report["skipped"].as_array().map(Vec::len), Some(6));
    assert!(report["skipped"][0]["reason"].to_string().contains("--max-points"), "{report}");

    write_suite(&folder);
    folder.write(
        "huge.toml",
        "about = \"more than any machine has\"\n[[rows]]\nname = \"torus\"\nscene = \"ball.toml\"\n\
         generate = \"torus\"\npoint_counts = [500, 1000000000]\n",
    );
    let ran = quick(&folder, &["huge.toml", "--json", "c.json"]).succeeds();
    let report = read_json(&folder.path().join("c.json"));
    assert_eq!(report["rows"].as_array().map(Vec::len), Some(1));
    let reason = report["skipped"][0]["reason"].as_str().expect("a reason").to_owned();
    assert!(reason.contains("does not fit") && reason.contains("bytes of memory"), "{reason}");
    assert!(ran.stderr.contains(&reason), "{}", ran.stderr);
}

/// Times of a report multiplied, and widened downwards and upwards.
fn doctored(report: &Value, factor: f64, wide: f64) -> Value {
    let mut old = report.clone();
    for row in old["rows"].as_array_mut().expect("rows") {
        for time in ["trace_ms", "build_ms"] {
            for (part, factor) in
                [("min", factor / wide), ("median", factor), ("max", factor * wide)]
            {
                let ms = row[time][part].as_f64().expect("a time");
                row[time][part] = json!(ms * factor);
            }
        }
    }
    old
}

#[test]
fn changed_speeds_and_pictures_are_found() {
    let folder = Folder::new();
    write_suite(&folder);
    let compare = |old: &Value, suite: &str| {
        folder.write("old.json", &old.to_string());
        quick(&folder, &[suite, "--compare", "old.json", "--json", "new.json"])
    };
    let verdict = || read_json(&folder.path().join("new.json"))["comparison"].clone();
    quick(&folder, &["mine.toml", "--json", "b.json"]).succeeds();
    let report = read_json(&folder.path().join("b.json"));

    // A thousand times as wide: whatever this machine does meanwhile is within it.
    let ran = compare(&doctored(&report, 1.0, 1e3), "mine.toml").succeeds();
    assert!(ran.stdout.contains("same") && !ran.stdout.contains("slower,"), "{}", ran.stdout);
    assert_eq!(verdict()["pass"], true);

    let ran = compare(&doctored(&report, 1e-4, 1.0), "mine.toml");
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.stdout.contains("slower, "), "{}", ran.stdout);
    assert_eq!(verdict()["rows"][0]["trace"]["verdict"], "slower");
    assert_eq!(verdict()["rows"][0]["same_picture"], true);

    let ran = compare(&doctored(&report, 1e4, 1.0), "mine.toml").succeeds();
    assert!(ran.stdout.contains("faster, "), "{}", ran.stdout);

    let mut other = doctored(&report, 1.0, 1e3);
    other["rows"][2]["pixels"] = json!("0123456789abcdef");
    other["device"] = json!("another");
    let ran = compare(&other, "mine.toml");
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.stdout.contains("changed") && ran.stdout.contains("another"), "{}", ran.stdout);
    let found: Vec<Value> = verdict()["rows"].as_array().expect("rows").clone();
    let changed: Vec<&Value> = found.iter().filter(|row| row["same_picture"] == false).collect();
    assert_eq!(changed.len(), 1);
    assert_eq!(changed[0]["name"], "glass, K = all");

    let mut larger = doctored(&report, 1.0, 1e3);
    larger["rows"][0]["size"] = json!([64, 48]);
    larger["rows"][0]["pixels"] = json!("0123456789abcdef");
    let ran = compare(&larger, "mine.toml");
    assert!(ran.stdout.contains("changed, was 64x48"), "{}", ran.stdout);
    assert_eq!(verdict()["rows"][0]["other_size"], json!([64, 48]));
    compare(&report, "smoke")
        .fails_with(2, &["old.json", "none of the rows", "ball | shaded; glass"]);

    let mut renamed = doctored(&report, 1.0, 1e3);
    renamed["rows"][0]["name"] = json!("gone");
    let ran = compare(&renamed, "mine.toml").succeeds();
    assert!(ran.stdout.contains("new row") && ran.stdout.contains("missing row"), "{}", ran.stdout);
}

#[test]
fn files_that_make_no_sense_are_2_before_anything_is_timed() {
    let folder = Folder::new();
    write_suite(&folder);
    folder.write("old.json", "{\n  \"device\": 3\n}");
    folder.write("odd.json", r#"{ "device": "x", "rows": [{ "name": "a", "pixels": "",
        "trace_ms": { "median": 1, "min": 2, "max": 1 }, "build_ms": { "median": 1, "min": 1, "max": 1 } }] }"#);
    for (options, words) in [
        (&["--compare", "none.json"][..], &["none.json"][..]),
        (&["--compare", "old.json"], &["old.json:2:", "bench --json"]),
        (&["--compare", "odd.json"], &["odd.json", "row 'a'"]),
        (&["--plot", "a.png"], &["a.png", ".svg"]),
        (&["--json", "mine.toml"], &["mine.toml", "input"]),
        (&["--compare", "old.json", "--json", "old.json"], &["old.json"]),
        (&["--json", "nowhere/a.json"], &["nowhere/a.json"]),
        (&["--tolerance", "5"], &["--compare"]),
        (&["--compare", "old.json", "--tolerance", "-1"], &["--tolerance"]),
    ] {
        quick(&folder, &[&["mine.toml"][..], options].concat()).fails_with(2, words);
    }
}

/// The temporary folder of an interrupted run is checked by hand: `bench` above looks at one that ended.
#[cfg(unix)]
#[test]
fn an_interruption_is_130_and_leaves_nothing() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};
    let folder = Folder::new();
    write_suite(&folder);
    folder.write(
        "long.toml",
        "about = \"takes long\"\n[[rows]]\nname = \"torus\"\nscene = \"ball.toml\"\n\
         generate = \"torus\"\npoint_counts = [200000]\n",
    );
    let names = folder.names();
    let scratch = tempfile::tempdir().expect("a folder");
    let mut child = pointillist()
        .current_dir(folder.path())
        .env("TMPDIR", scratch.path())
        .args(["bench", "long.toml", "--json", "a.json", "--device", "reference"])
        .args(["--size", "4000x4000", "--progress", "always"])
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .expect("the binary starts");
    let mut lines = BufReader::new(child.stderr.take().expect("a pipe")).lines();
    let mut next = || lines.next().expect("a line").expect("UTF-8");
    assert_eq!(next(), "1/1 torus, 200000 points");
    // The first stage that lasts over a second: the points are written by then.
    assert!(next().starts_with("1/1 torus, 200000 points: "));
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.expect("kill runs").success());
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    assert_eq!(folder.names(), names);
    assert_eq!(std::fs::read_dir(scratch.path()).expect("the folder").count(), 0);
}
