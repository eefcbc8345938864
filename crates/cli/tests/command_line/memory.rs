//! Memory that runs out: by limits of the process, as batch systems and `ulimit` set them.
#![cfg(all(target_os = "linux", target_env = "gnu"))]

use crate::{Folder, Ran, said, sphere};
use std::path::Path;
use std::process::Command;

/// Runs the binary under a limit of this many KiB: of address space (`-v`) or of data (`-d`).
fn under(limit: &str, kibibytes: u64, folder: &Path, arguments: &[&str]) -> Ran {
    let script = format!("ulimit {limit} {kibibytes} && exec \"$@\"");
    let mut shell = Command::new("sh");
    shell.args(["-c", &script, "sh", env!("CARGO_BIN_EXE_pointillist")]).args(arguments);
    Ran::of(shell.current_dir(folder).env_remove("POINTILLIST_VALIDATION"))
}

/// Each run ends with 0 or 4, and one that fails says in one line of error what to do; nothing is left but pictures.
#[track_caller]
fn walk(limit: &str, steps: &[u64], folder: &Folder, arguments: &[&str]) -> Vec<u64> {
    let mut failed = Vec::new();
    for &kibibytes in steps {
        let ran = under(limit, kibibytes, folder.path(), arguments);
        let errors: Vec<&str> =
            ran.stderr.lines().filter(|line| line.starts_with("error: ")).collect();
        match ran.code {
            Some(0) => assert!(errors.is_empty(), "{kibibytes}: {ran:?}"),
            Some(4) => {
                assert_eq!(errors.len(), 1, "{kibibytes}: {ran:?}");
                let advice = ["raise the limit", "fewer points", "--device reference", "--crop"];
                let is_advised = advice.iter().any(|word| errors[0].contains(word));
                assert!(is_advised && errors[0].contains("; "), "{kibibytes}: {ran:?}");
                failed.push(kibibytes);
            }
            _ => panic!("{arguments:?} under {limit} {kibibytes}: {ran:?}"),
        }
        let picture = folder.path().join("a.png");
        assert_eq!(picture.exists(), ran.code == Some(0), "{kibibytes}: {ran:?}");
        let _ = std::fs::remove_file(picture);
        assert_eq!(folder.names(), ["ball.ply"], "{kibibytes}: {ran:?}");
    }
    failed
}

/// The walk ends at 24 MB: below some 20 MB there is no room for the program itself, its 15 MB of code and the stack of
/// its first thread, and the system's loader ends it before it has begun.
const STEPS: [u64; 20] = [
    3_000_000, 2_000_000, 1_500_000, 1_200_000, 1_000_000, 800_000, 700_000, 600_000, 550_000,
    500_000, 450_000, 400_000, 300_000, 200_000, 150_000, 100_000, 60_000, 45_000, 30_000, 24_000,
];

/// 100 000 points take 16 MB at least, and smoothing and lists some times more.
fn with_points() -> Folder {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(100_000));
    folder
}

const RENDER: [&str; 6] = ["render", "ball.ply", "-o", "a.png", "--size", "320x240"];

#[test]
fn address_space_that_runs_out_is_4_on_the_cpu() {
    let folder = with_points();
    let failed = walk("-v", &STEPS, &folder, &[&RENDER[..], &["--device", "reference"]].concat());
    assert!(failed.contains(&24_000) && !failed.contains(&500_000), "{failed:?}");
}

/// Where the driver does not fit, the CPU renders, which needs a fifth of it.
#[test]
fn address_space_that_runs_out_is_4_or_the_cpus_work_by_default() {
    let folder = with_points();
    let failed = walk("-v", &STEPS, &folder, &RENDER);
    assert!(failed.contains(&24_000) && !failed.contains(&300_000), "{failed:?}");
    let ran = under("-v", 300_000, folder.path(), &RENDER).succeeds();
    assert!(ran.stderr.contains("rendering by the CPU reference"), "{ran:?}");
    std::fs::remove_file(folder.path().join("a.png")).expect("a picture");
    let insists = [&RENDER[..], &["--device", "vulkan"]].concat();
    let ran = under("-v", 300_000, folder.path(), &insists);
    ran.fails_with(4, &["a Vulkan driver", "needs about", "(ulimit -v)", "--device reference"]);
}

#[test]
fn data_that_runs_out_is_4() {
    let folder = with_points();
    let steps = [400_000, 250_000, 200_000, 170_000, 150_000, 100_000, 50_000, 20_000, 8_000];
    walk("-d", &steps, &folder, &RENDER);
    walk("-d", &steps[5..], &folder, &[&RENDER[..], &["--device", "reference"]].concat());
}

/// No more threads than the limit has room for: their stacks are 2 MiB each.
#[test]
fn threads_that_do_not_fit_are_left_out() {
    let folder = with_points();
    let arguments = [&RENDER[..], &["--device", "reference", "--threads", "1000"]].concat();
    walk("-v", &[1_000_000, 300_000], &folder, &arguments);
    said("1000 threads were asked for under 300 MB");
}
