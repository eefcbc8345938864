//! Disks and folders that do not take what is to be written.
#![cfg(target_os = "linux")]

use crate::{Folder, Ran, ply, run_in, said, sphere};
use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::process::Command;

const SMALL: [&str; 4] = ["--device", "reference", "--size", "64x48"];

/// `program` with the binary and its arguments behind it; `None`, said loudly, where this machine cannot run it.
fn behind(program: &[&str], folder: &Folder, arguments: &[&str]) -> Option<Ran> {
    let start = |command: &str, arguments: &[&str]| {
        let mut start = Command::new(program[0]);
        start.args(&program[1..]).arg(command).args(arguments);
        start.current_dir(folder.path()).output()
    };
    let binary = env!("CARGO_BIN_EXE_pointillist");
    if !start(binary, &["--version"]).is_ok_and(|output| output.status.success()) {
        said(&format!("SKIPPED: '{}' cannot run the binary here", program.join(" ")));
        return None;
    }
    let mut command = Command::new(program[0]);
    command.args(&program[1..]).arg(binary).args(arguments).current_dir(folder.path());
    Some(Ran::of(command.env_remove("POINTILLIST_VALIDATION")))
}

/// A disk of 64 KiB, mounted where this process alone sees it: what else is to be seen there is printed.
#[test]
fn a_full_disk_is_4_and_keeps_what_was_there() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(200));
    fs::create_dir(folder.path().join("disk")).expect("a folder");
    let inside = "mount -t tmpfs -o size=64k small disk && printf old > disk/old.exr && { \"$@\"; } ; \
                  code=$?; ls -A disk >&2; cat disk/old.exr >&2; exit $code";
    let program = ["unshare", "--map-root-user", "--mount", "sh", "-c", inside, "sh"];
    for output in ["disk/a.exr", "disk/old.exr"] {
        let arguments = [&["render", "ball.ply", "-o", output][..], &SMALL].concat();
        let Some(ran) = behind(&program, &folder, &arguments) else { return };
        let words = [output, "cannot write the file; free some space", "old.exr\nold"];
        let ran = ran.fails_with(4, &words);
        assert!(!ran.stderr.contains(".pointillist-"), "{}", ran.stderr);
    }
    for what in [
        &["bench", "ball.ply", "--runs", "1", "--json"][..],
        &["render", "ball.ply", "-o", "b.png", "--stats"],
    ] {
        // 3 KiB of JSON, so the disk is filled first.
        let inside =
            inside.replace("printf old > disk/old.exr", "head -c 65536 /dev/zero > disk/full");
        let program = ["unshare", "--map-root-user", "--mount", "sh", "-c", &inside, "sh"];
        let arguments = [what, &["disk/a.json"], &SMALL].concat();
        let Some(ran) = behind(&program, &folder, &arguments) else { return };
        // What was measured is shown, since it cannot be kept.
        assert_eq!(ran.stdout.contains("ball"), what[0] == "bench", "{ran:?}");
        let ran = Ran { stdout: String::new(), ..ran };
        ran.fails_with(4, &["disk/a.json", "free some space"]);
    }
}

/// As a user who is not root, whom permissions do not hold back.
#[test]
fn folders_and_files_without_permission_are_2_and_named() {
    let folder = Folder::new();
    let mode = |name: &str, mode: u32| {
        let path = folder.path().join(name);
        fs::set_permissions(path, Permissions::from_mode(mode)).expect("an owner may");
    };
    folder.write("ball.ply", &sphere(100));
    folder.write("secret.ply", &sphere(100));
    folder.write("s.toml", "[[objects]]\npoints = 'secret.ply'\n");
    folder.write("secret.toml", "[[objects]]\npoints = 'ball.ply'\n");
    for name in ["closed", "open"] {
        fs::create_dir(folder.path().join(name)).expect("a folder");
    }
    for (name, bits) in
        [(".", 0o755), ("closed", 0o555), ("open", 0o777), ("secret.ply", 0), ("secret.toml", 0)]
    {
        mode(name, bits);
    }
    let root = fs::metadata("/proc/self").is_ok_and(|own| {
        use std::os::unix::fs::MetadataExt;
        own.uid() == 0
    });
    let user = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", "--"];
    let program: &[&str] = if root { &user } else { &["env"] };
    let run = |arguments: &[&str]| behind(program, &folder, &[arguments, &SMALL].concat());
    let Some(ran) = run(&["render", "ball.ply", "-o", "closed/a.png"]) else { return };
    ran.fails_with(2, &["closed/a.png", "cannot write to the folder 'closed'", "choose another"]);
    for (file, words) in [
        ("secret.ply", &["secret.ply", "permission"][..]),
        ("s.toml", &["secret.ply", "permission"]),
        ("secret.toml", &["secret.toml", "permission"]),
    ] {
        let ran = run(&["render", file, "-o", "open/a.png"]).expect("it ran before");
        ran.fails_with(2, words);
    }
    run(&["render", "ball.ply", "-o", "open/a.png"]).expect("it ran before").succeeds();
    assert_eq!(fs::read_dir(folder.path().join("open")).expect("a folder").count(), 1);
}

/// Before any work: the point file would fail.
#[test]
fn a_write_protected_output_is_2_before_any_work() {
    let folder = Folder::new();
    folder.write("a.png", "old");
    let path = folder.path().join("a.png");
    fs::set_permissions(&path, Permissions::from_mode(0o444)).expect("an owner may");
    run_in(folder.path(), &["render", "none.ply", "-o", "a.png"])
        .fails_with(2, &["a.png", "write-protected"]);
    assert_eq!(fs::read_to_string(&path).expect("still there"), "old");
    symlink("/nonexistent/a.png", folder.path().join("b.png")).expect("a link");
    folder.write("ball.ply", &ply(&["0 0 0", "1 0 0"]));
    run_in(folder.path(), &[&["render", "ball.ply", "-o", "b.png"][..], &SMALL].concat())
        .fails_with(2, &["b.png", "/nonexistent"]);
}

/// A pipe whose reader takes all of it.
#[test]
fn a_pipe_is_written_to_directly() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(100));
    let status = Command::new("mkfifo").arg(folder.path().join("pipe.exr")).status();
    assert!(status.expect("mkfifo runs").success());
    let reader = std::thread::spawn({
        let path = folder.path().join("pipe.exr");
        move || fs::read(path).expect("a pipe")
    });
    run_in(folder.path(), &[&["render", "ball.ply", "-o", "pipe.exr"][..], &SMALL].concat())
        .succeeds();
    run_in(folder.path(), &[&["render", "ball.ply", "-o", "file.exr"][..], &SMALL].concat())
        .succeeds();
    let piped = reader.join().expect("it read");
    assert!(piped == fs::read(folder.path().join("file.exr")).expect("a picture"));
    assert_eq!(folder.names(), ["ball.ply", "file.exr", "pipe.exr"]);
}

/// As `pointillist ... >&-` does.
#[test]
fn closed_streams_are_no_error() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(100));
    let script = format!("exec '{}' \"$@\" <&- >&- 2>&-", env!("CARGO_BIN_EXE_pointillist"));
    for (arguments, code) in [
        (&["schema"][..], 0),
        (&["render", "ball.ply", "-o", "a.png", "--progress", "always"], 0),
        (&["render", "none.ply", "-o", "b.png"], 2),
    ] {
        let options: &[&str] = if arguments.len() > 1 { &SMALL } else { &[] };
        let mut shell = Command::new("sh");
        shell.args(["-c", &script, "sh"]).args(arguments).args(options);
        let status = shell.current_dir(folder.path()).status().expect("sh runs");
        assert_eq!(status.code(), Some(code), "{arguments:?}");
    }
    assert_eq!(folder.names(), ["a.png", "ball.ply"]);
}
