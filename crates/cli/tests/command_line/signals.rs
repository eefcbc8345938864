//! Interruptions end a render soon, with 130, and leave nothing behind.
#![cfg(unix)]

use crate::{Folder, pointillist, sphere};
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

fn interrupted_by(signal: &str) {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(2000));
    let mut child = pointillist()
        .current_dir(folder.path())
        .args(["render", "ball.ply", "-o", "a.exr", "-o", "a.png", "--stats", "a.json"])
        .args(["--device", "reference", "--size", "8000x8000", "--progress", "always"])
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    let mut lines = BufReader::new(child.stderr.take().expect("a pipe")).lines();
    // 64 million pixels take many seconds; the first line comes after one.
    let is_tracing = |line: &String| line.starts_with("tracing: ");
    lines.by_ref().map(|line| line.expect("UTF-8")).find(is_tracing).expect("it traces");
    let sent = Instant::now();
    let kill = Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(kill.expect("kill runs").success());
    let status = child.wait().expect("it ends");
    assert_eq!(status.code(), Some(130));
    assert!(sent.elapsed() < Duration::from_secs(10), "{:?}", sent.elapsed());
    let last = lines.last().expect("a line").expect("UTF-8");
    assert_eq!(last, "error: interrupted");
    assert_eq!(folder.names(), ["ball.ply"]);
}

#[test]
fn sigint_is_130_and_leaves_nothing() {
    interrupted_by("-INT");
}

#[test]
fn sigterm_is_130_and_leaves_nothing() {
    interrupted_by("-TERM");
}

/// From before there is anything to end to after all was written: the driver is compiling, points are read, files are
/// written. Each file is whole or absent.
#[test]
fn signals_at_any_moment_leave_whole_files_or_none() {
    const OUTPUTS: [&str; 3] = ["a.exr", "a.png", "a.json"];
    for device in [&[][..], &["--device", "reference"]] {
        let folder = Folder::new();
        folder.write("ball.ply", &sphere(2000));
        let start = || {
            let mut command = pointillist();
            command.current_dir(folder.path()).args(["render", "ball.ply", "--size", "160x120"]);
            command.args(["-o", OUTPUTS[0], "-o", OUTPUTS[1], "--stats", OUTPUTS[2]]).args(device);
            command.stderr(Stdio::piped()).spawn().expect("the binary starts")
        };
        let whole = || OUTPUTS.map(|name| std::fs::read(folder.path().join(name)).ok());
        // Once to fill the driver's cache, once to take the time.
        start().wait().expect("it ends");
        let started = Instant::now();
        assert!(start().wait().expect("it ends").success());
        let duration = started.elapsed();
        let expected = whole();
        assert!(expected.iter().all(Option::is_some));
        for (step, signal) in (0..24).zip(["-INT", "-TERM", "-HUP"].into_iter().cycle()) {
            for name in OUTPUTS {
                let _ = std::fs::remove_file(folder.path().join(name));
            }
            let child = start();
            std::thread::sleep(duration * step / 22);
            // It fails where the process has ended.
            let _ = Command::new("kill").args([signal, &child.id().to_string()]).status();
            let output = child.wait_with_output().expect("it ends");
            // Without a code it had not yet begun: the shell says 130 then, too.
            let code = output.status.code();
            assert!(
                matches!(code, None | Some(0 | 130)) && (code.is_some() || step < 2),
                "{output:?}"
            );
            let found = whole();
            // Statistics differ from run to run.
            let same = found[..2]
                .iter()
                .zip(&expected)
                .all(|(file, whole)| file.is_none() || file == whole);
            assert!(same, "{step}: a picture is not whole");
            if let Some(stats) = &found[2] {
                serde_json::from_slice::<serde_json::Value>(stats).expect("whole statistics");
            }
            let allowed = |name: &String| name == "ball.ply" || OUTPUTS.contains(&name.as_str());
            assert!(folder.names().iter().all(allowed), "{step}: {:?}", folder.names());
        }
    }
}
