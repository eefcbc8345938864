//! `--log json`: every line of stderr is an object with a time, a level, an event and a message.

use crate::{Folder, Ran, pointillist, run_in, sphere};
use serde_json::Value;

/// The objects on stderr.
#[track_caller]
fn objects(ran: &Ran) -> Vec<Value> {
    let parse = |line: &str| {
        let object: Value = serde_json::from_str(line).unwrap_or_else(|_| panic!("{line}"));
        let time = object["time"].as_str().unwrap_or_default();
        // 2026-11-30T17:00:00.000Z
        let digits = time.bytes().filter(u8::is_ascii_digit).count();
        assert!(time.len() == 24 && time.ends_with('Z') && digits == 17, "{line}");
        let level = object["level"].as_str().unwrap_or_default();
        assert!(["info", "warning", "error"].contains(&level), "{line}");
        assert!(object["event"].is_string() && object["message"].is_string(), "{line}");
        object
    };
    ran.stderr.lines().map(parse).collect()
}

fn of<'a>(objects: &'a [Value], event: &str) -> Vec<&'a Value> {
    objects.iter().filter(|object| object["event"] == event).collect()
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(2000));
    folder.write("one.ply", &crate::ply(&["0 0 0"]));
    folder
}

#[test]
fn a_render_logs_stages_and_its_result() {
    let folder = folder();
    let arguments = ["render", "ball.ply", "-o", "a.png", "-o", "a.exr", "--size", "64x48"];
    let log = ["--device", "reference", "--log", "json"];
    let ran = run_in(folder.path(), &[&arguments[..], &log].concat()).succeeds();
    let objects = objects(&ran);
    let stages = of(&objects, "stage");
    for name in ["reading points", "fitting surfaces", "tracing", "writing pictures"] {
        let of_stage = |state: &str| {
            let is = |object: &&&Value| object["stage"] == name && object["state"] == state;
            stages.iter().find(is).copied()
        };
        let (Some(begin), Some(end)) = (of_stage("begin"), of_stage("end")) else {
            panic!("{name}: {ran:?}");
        };
        assert!(begin["total"].is_u64() && end["seconds"].is_number(), "{name}: {ran:?}");
        assert!(begin["time"].as_str() <= end["time"].as_str());
    }
    let results = of(&objects, "result");
    let [result] = results[..] else { panic!("{ran:?}") };
    assert_eq!(objects.last(), Some(result));
    assert_eq!(result["outputs"], serde_json::json!(["a.png", "a.exr"]));
    assert_eq!(result["points"], 2000);
    assert_eq!(result["size"], serde_json::json!([64, 48]));
    for stage in ["read", "plan", "build", "trace"] {
        assert!(result["seconds"][stage].is_number(), "{result}");
    }
}

#[test]
fn a_long_stage_logs_how_far_it_is() {
    let folder = folder();
    let arguments = ["render", "ball.ply", "-o", "a.png", "--size", "2000x1000", "--samples", "2"];
    let log = ["--device", "reference", "--log=json"];
    let ran = run_in(folder.path(), &[&arguments[..], &log].concat()).succeeds();
    let objects = objects(&ran);
    let progress = of(&objects, "progress");
    assert!(!progress.is_empty(), "{ran:?}");
    for object in progress {
        let [done, total] = ["done", "total"].map(|key| object[key].as_u64().expect("a count"));
        assert!(done <= total && object["stage"].is_string(), "{object}");
    }
}

#[test]
fn warnings_and_errors_have_their_levels() {
    let folder = folder();
    let log = ["--device", "reference", "--log", "json", "--size", "16x16"];
    let arguments = ["render", "one.ply", "-o", "a.png", "--half"];
    let ran = run_in(folder.path(), &[&arguments[..], &log].concat()).succeeds();
    let objects_of_one = objects(&ran);
    let warnings = of(&objects_of_one, "warning");
    assert!(warnings.iter().any(|object| {
        object["level"] == "warning" && object["message"].to_string().contains("--half")
    }));
    // What a person reads begins with these words; a field says it here.
    assert!(!ran.stderr.contains("warning: "), "{ran:?}");

    for (arguments, code) in [
        (&["render", "none.ply", "-o", "b.png", "--log", "json"][..], 2),
        (&["render", "ball.ply", "--log", "json"], 2),
        (&["render", "ball.ply", "-o", "b.png", "--samples", "many", "--log=json"], 2),
        (&["paint", "--log", "json"], 2),
        (&["--log", "json"], 2),
        (&["compare", "a.png", "none.png", "--log", "json"], 2),
        (&["render", "ball.ply", "-o", "b.png", "--device", "nobody's", "--log", "json"], 3),
    ] {
        let ran = run_in(folder.path(), arguments).fails_with(code, &[]);
        let objects = objects(&ran);
        let error = objects.last().unwrap_or_else(|| panic!("{arguments:?}: {ran:?}"));
        assert_eq!((&error["level"], &error["event"]), (&"error".into(), &"error".into()));
        assert_eq!(error["exit"], code, "{ran:?}");
        assert!(!error["message"].to_string().contains("error: "), "{ran:?}");
    }
}

/// Each command that says anything on stderr.
#[test]
fn all_commands_log_objects() {
    let folder = folder();
    folder.write("s.toml", "[[objects]]\npoints = \"ball.ply\"\n");
    run_in(folder.path(), &["render", "ball.ply", "-o", "a.png", "--device", "reference"])
        .succeeds();
    for arguments in [
        &["check", "s.toml"][..],
        &["info", "ball.ply"],
        &["info", "s.toml", "--json"],
        &["info", "a.png"],
        &["bench", "s.toml", "--runs", "1", "--size", "8x8", "--device", "reference"],
        &["compare", "a.png", "a.png"],
        &["devices"],
        &["schema"],
    ] {
        let ran = run_in(folder.path(), &[arguments, &["--log", "json"]].concat()).succeeds();
        let objects = objects(&ran);
        let is_silent = ["devices", "schema"].contains(&arguments[0]);
        assert_eq!(of(&objects, "result").len(), usize::from(!is_silent), "{arguments:?}: {ran:?}");
        assert!(!ran.stdout.contains("\"event\""), "{ran:?}");
    }
}

/// Names may hold anything.
#[cfg(unix)]
#[test]
fn odd_names_are_escaped() {
    use std::os::unix::ffi::OsStrExt;
    let folder = Folder::new();
    let name = std::ffi::OsStr::from_bytes(b"a\"\x1b\x7f\xff\n.ply");
    let mut command = pointillist();
    command.current_dir(folder.path()).arg("render").arg(name);
    let ran = Ran::of(command.args(["-o", "a.png", "--log", "json"])).fails_with(2, &[]);
    assert_eq!(objects(&ran).len(), 1, "{ran:?}");
}

#[test]
fn quiet_logs_errors_alone() {
    let folder = folder();
    let quiet = ["--quiet", "--log", "json", "--device", "reference"];
    let arguments = ["render", "ball.ply", "-o", "a.png", "--size", "16x16"];
    let ran = run_in(folder.path(), &[&arguments[..], &quiet].concat()).succeeds();
    assert_eq!(ran.stderr, "");
}
