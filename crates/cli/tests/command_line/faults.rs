//! Faults of a device that works: the layer of `tests/faulty-layer` between the loader and the driver lets
//! calls fail. These need a Vulkan device and the validation layer, as the end-to-end tests do.
#![cfg(target_os = "linux")]

use crate::{Folder, Ran, pointillist, run_in, sphere};
use std::path::PathBuf;
use std::process::Command;

const HOST_MEMORY: i32 = -1;
const DEVICE_MEMORY: i32 = -2;
const INITIALIZATION: i32 = -3;
const LOST: i32 = -4;
const INCOMPATIBLE: i32 = -9;

/// A folder with points in it, and the layer's manifest in another.
struct Faulty {
    folder: Folder,
    manifest: Folder,
}

impl Faulty {
    fn new() -> Self {
        let faulty = Self { folder: Folder::new(), manifest: Folder::new() };
        faulty.folder.write("ball.ply", &sphere(300));
        faulty
    }

    /// The binary on a device with these faults.
    fn command(&self, faults: &str) -> Command {
        // Cargo builds it for this test, and puts it beside the test.
        let here = std::env::current_exe().expect("a path");
        let library: PathBuf = here.with_file_name("libfaulty_layer.so");
        assert!(library.is_file(), "{library:?} is missing");
        let set = faulty_layer::environment(self.manifest.path(), &library).expect("a manifest");
        let mut command = pointillist();
        command.envs(set).env(faulty_layer::FAULTS, faults);
        command.env("POINTILLIST_VALIDATION", "1").current_dir(self.folder.path());
        command
    }

    fn render(&self, faults: &str) -> Ran {
        self.render_on(faults, None)
    }

    fn render_on(&self, faults: &str, device: Option<&str>) -> Ran {
        let mut command = self.command(faults);
        let outputs = ["-o", "a.exr", "-o", "a.png", "--stats", "a.json", "--size", "48x32"];
        command.args(["render", "ball.ply"]).args(outputs);
        Ran::of(command.args(device.map(|name| format!("--device={name}"))))
    }

    /// Renders with a fault; whether the CPU did it, for a reason that contains this. The pictures are removed.
    #[track_caller]
    fn falls_back(&self, faults: &str, reason: &str) -> bool {
        let ran = self.render(faults);
        if ran.code != Some(0) {
            self.assert_clean(&ran.fails_with(4, &["--device reference"]));
            return false;
        }
        let line = ran.stderr.lines().next().unwrap_or_default();
        assert!(line.starts_with("rendering by the CPU reference, "), "{faults}: {ran:?}");
        assert!(line.contains(reason), "'{reason}' is not in: {line}");
        for name in ["a.exr", "a.png", "a.json"] {
            std::fs::remove_file(self.folder.path().join(name)).expect("an output");
        }
        self.assert_clean(&ran);
        true
    }

    /// Fails if a render left anything, or the validation layer had something to say.
    #[track_caller]
    fn assert_clean(&self, ran: &Ran) {
        assert!(!ran.stderr.contains("validation:"), "{ran:?}");
        assert_eq!(self.folder.names(), ["ball.ply"], "{ran:?}");
    }

    /// How often each call that can fail is made in a render.
    fn calls(&self) -> Vec<(String, u64)> {
        let counts = self.manifest.path().join("calls");
        let mut command = self.command("");
        command.env(faulty_layer::CALLS, &counts);
        Ran::of(command.args(["render", "ball.ply", "-o", "a.png", "--size", "48x32"])).succeeds();
        std::fs::remove_file(self.folder.path().join("a.png")).expect("a picture");
        let text = std::fs::read_to_string(&counts).expect("what the layer wrote");
        let parse = |line: &str| {
            let (call, count) = line.split_once(' ').expect("call and count");
            (call.to_owned(), count.parse().expect("a count"))
        };
        text.lines().map(parse).collect()
    }
}

#[test]
fn a_lost_device_is_4_and_says_where_and_what_to_do() {
    let faulty = Faulty::new();
    for call in ["vkQueueSubmit", "vkWaitForFences"] {
        // While the surfaces are built, and while they are traced.
        for (at, pass) in [(0, "'find_neighbors'"), (5, "'camera_trace'")] {
            let ran = faulty.render(&format!("{call}@{at}={LOST}"));
            let words = ["device lost in", pass, "--cells-per-pass 1", "--device reference"];
            let ran = ran.fails_with(4, &words);
            assert_eq!(ran.stderr.lines().count(), 1, "{ran:?}");
            faulty.assert_clean(&ran);
        }
    }
}

#[test]
fn device_memory_that_runs_out_is_4_and_says_for_what_and_what_to_do() {
    let faulty = Faulty::new();
    let ran = faulty.render(&format!("vkAllocateMemory@0={DEVICE_MEMORY}"));
    let ran = ran.fails_with(4, &["out of device memory for '", "bytes", "fewer points"]);
    faulty.assert_clean(&ran);
    // The device says beforehand that it has too little.
    let ran = faulty.render("heap=20000").fails_with(4, &["bytes", "--device reference"]);
    faulty.assert_clean(&ran);
}

/// Each of them once, at its first and its last call: most of them clean up behind them.
#[test]
fn every_call_may_fail() {
    let faulty = Faulty::new();
    let calls = faulty.calls();
    assert!(calls.len() >= 25, "{calls:?}");
    for (call, count) in &calls {
        let results: &[i32] = match call.as_str() {
            "vkCreateInstance" => &[HOST_MEMORY, INCOMPATIBLE],
            "vkCreateDevice" => &[INITIALIZATION, DEVICE_MEMORY],
            "vkWaitForFences" => &[LOST],
            _ => &[DEVICE_MEMORY],
        };
        for result in results {
            let mut places = vec![0, count - 1];
            places.dedup();
            for at in places {
                let fault = format!("{call}@{at}={result}");
                // Until a device is open, the CPU can do its work; who asked for it gets an error.
                let fell_back = faulty.falls_back(&fault, "");
                let ran = faulty.render_on(&fault, Some("vulkan"));
                let code = if fell_back { 3 } else { 4 };
                let ran = ran.fails_with(code, &["--device reference"]);
                assert!(
                    !fell_back || at == 0 || call.starts_with("vkEnumerate"),
                    "{call}: the device was open already: {ran:?}"
                );
                assert_eq!(ran.stderr.lines().count(), 1, "{call}: {ran:?}");
                faulty.assert_clean(&ran);
            }
        }
    }
}

#[test]
fn devices_says_why_one_is_of_no_use() {
    let faulty = Faulty::new();
    for (fault, reason) in [
        ("version=1.0", "it offers Vulkan 1.0 and 1.1 is needed"),
        ("no-compute", "it has no compute queue"),
    ] {
        let ran = Ran::of(faulty.command(fault).arg("devices"));
        let ran = ran.succeeds();
        assert!(ran.stdout.contains(&format!("not usable: {reason}")), "{ran:?}");
        assert!(ran.stdout.contains("--device reference always works"), "{ran:?}");
        let default = ran.stdout.lines().find(|line| line.starts_with("default    reference: "));
        assert!(default.is_some_and(|line| line.contains(reason)), "{ran:?}");
        assert!(faulty.falls_back(fault, reason));
        for device in ["0", "vulkan"] {
            let ran = faulty.render_on(fault, Some(device));
            faulty.assert_clean(&ran.fails_with(3, &[reason, "--device reference"]));
        }
    }
    let ran = Ran::of(faulty.command("").arg("devices")).succeeds();
    assert!(ran.stdout.contains("           usable"), "{ran:?}");
}

/// The same picture, and no times of kernels.
#[test]
fn a_device_without_a_clock_renders() {
    let faulty = Faulty::new();
    let outputs = ["--size", "48x32", "--stats", "s.json", "-o"];
    let render = |fault: &str, name: &str| {
        let mut command = faulty.command(fault);
        Ran::of(command.args(["render", "ball.ply"]).args(outputs).arg(name)).succeeds();
        std::fs::read(faulty.folder.path().join(name)).expect("a picture")
    };
    assert!(render("no-timestamps", "a.exr") == render("", "b.exr"));
}

/// Who is no Vulkan at all needs none of it: neither the faults nor the layer are met.
#[test]
fn what_needs_no_device_opens_none() {
    let faulty = Faulty::new();
    let counts = faulty.manifest.path().join("calls");
    for arguments in [
        &["render", "ball.ply", "-o", "a.png", "--size", "8x8", "--device", "reference"][..],
        &["render", "ball.ply", "-o", "b.png", "--size", "8x8", "--device", "reference-f64"],
        &["info", "ball.ply"],
        &["check", "ball.ply"],
        &["schema"],
        &["compare", "a.png", "b.png"],
        &["bench", "ball.ply", "--size", "8x8", "--runs", "1", "--device", "reference"],
    ] {
        let mut command = faulty.command("vkCreateInstance@0=-3");
        command.env(faulty_layer::CALLS, &counts);
        Ran::of(command.args(arguments)).succeeds();
    }
    assert!(!counts.exists(), "an instance was made");
    run_in(faulty.folder.path(), &["compare", "a.png", "a.png"]).succeeds();
}
