//! Many small renders in one process: no memory, file, thread or descriptor more than at the start, and silence of the
//! validation layer. All kinds of scenes, from files to files; some renders are interrupted, and the device is closed
//! and opened again between.
//!
//! `SOAK=10000 cargo test --release -p pointillist-tests --test soak` renders so many; `tools/soak` does, and starts
//! a thousand processes too.
#![cfg(target_os = "linux")]
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use gpu::{Device, DeviceChoice, Instance, InstanceOptions};
use harness::scenes::plan_of_scene;
use harness::{fibonacci_sphere, said};
use points::{Unwatched, Watch};
use render::{RenderError, Renderer};
use scene::Scene;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicI32, Ordering};

/// Renders where `SOAK` does not say: some ten seconds.
const FEW: usize = 480;
/// Renders with one device.
const A_DEVICE: usize = 40;
/// What a third of the devices may leave more than they found. Allocators keep what they have split, in jumps of up to 20 MB
/// that come later and later, and give some of it back; most devices leave nothing, so a third of them have left no more than
/// 5 KB a render. A leak is the same with each device: one small buffer or pipeline a render is more than this.
const SLACK_BYTES: i64 = (16 << 10) * A_DEVICE as i64;

const HEAD: &str = "size = [16, 12]\n[camera]\neye = [0, 0.4, 4]\ntarget = [0, 0, 0]\n\
    [[lights]]\nkind = 'directional'\ndirection = [-1, -1, -1]\nirradiance = [3, 3, 3]\n";
/// What is behind [`HEAD`].
const SCENES: [(&str, &str); 6] = [
    ("lit", "[[objects]]\npoints = 'ball.ply'\n"),
    (
        "glass",
        "[[objects]]\npoints = 'ball.ply'\nmaterial = { kind = 'glass', ior = [1.4, 1.5, 1.6] }\n",
    ),
    (
        "mirror",
        "[background]\nenvironment = 'sky.png'\n[[objects]]\npoints = 'ball.ply'\nmaterial = { kind = 'mirror' }\n",
    ),
    (
        "refined",
        "[render]\nloop = 'images'\n[[objects]]\npoints = 'ball.ply'\nsurface = { refine = 'project' }\n\
         material = { texture = 'sky.png' }\n",
    ),
    (
        "smoke",
        "[[objects]]\npoints = 'ball.ply'\n[objects.volume]\nscalar = 'heat'\nradius = 0.4\nstep = 0.1\n\
         transfer = [{ value = 0, color = [0, 0, 1], extinction = 0 }, { value = 1, color = [1, 0, 0], extinction = 3 }]\n",
    ),
    ("samples", "[[objects]]\npoints = 'ball.ply'\n"),
];

fn write_scenes(folder: &Path) {
    let mut points =
        "ply\nformat ascii 1.0\nelement vertex 120\nproperty float x\nproperty float y\n\
        property float z\nproperty float heat\nend_header\n"
            .to_owned();
    for [x, y, z] in fibonacci_sphere(120) {
        writeln!(points, "{x} {y} {z} {}", 0.5 + 0.5 * y).expect("a string");
    }
    fs::write(folder.join("ball.ply"), points).expect("a written file");
    film::write_png([4, 2], &[[90, 120, 200]; 8], &folder.join("sky.png")).expect("a written file");
    for (name, text) in SCENES {
        let samples = if name == "samples" { 2 } else { 1 };
        let text = format!("[image]\nsamples = {samples}\n{HEAD}{text}");
        fs::write(folder.join(format!("{name}.toml")), text).expect("a written file");
    }
}

/// Asks for an end when it was asked so often.
struct Impatient(AtomicI32);

impl Watch for Impatient {
    fn stage(&self, _: &'static str, _: u64) {}

    fn done(&self, _: u64) {}

    fn interrupted(&self) -> bool {
        self.0.fetch_sub(1, Ordering::Relaxed) <= 0
    }
}

/// What the system has given to this process.
#[derive(Debug, Clone, Copy)]
struct Held {
    bytes: usize,
    descriptors: usize,
    threads: usize,
}

impl Held {
    fn now() -> Self {
        let count = |folder: &str| fs::read_dir(folder).expect("a folder of /proc").count();
        let statm = fs::read_to_string("/proc/self/statm").expect("statm");
        let pages: usize = statm.split(' ').nth(1).expect("pages").parse().expect("a number");
        Self {
            bytes: pages * 4096,
            descriptors: count("/proc/self/fd"),
            threads: count("/proc/self/task"),
        }
    }
}

#[test]
fn many_renders_leave_nothing_behind() {
    let asked = std::env::var("SOAK").ok().and_then(|count| count.parse().ok());
    let count: usize = asked.unwrap_or(FEW);
    let folder = tempfile::tempdir().expect("a folder");
    write_scenes(folder.path());
    let files = || fs::read_dir(folder.path()).expect("a folder").count();
    let before = files();

    // The validation layer (1.3.239) itself keeps 90 KB a render: memory is looked at without it.
    let (mut done, mut interrupted, mut held) = (0, 0, Vec::new());
    while done < count {
        interrupted += with_a_device(folder.path(), done, false);
        done += A_DEVICE;
        held.push(Held::now());
    }
    let (warm, end) = (held[held.len() / 2], held[held.len() - 1]);
    let mut grown: Vec<i64> =
        held.windows(2).map(|two| two[1].bytes as i64 - two[0].bytes as i64).collect();
    grown.sort_unstable();
    let grown = grown.get(grown.len() / 3).copied().expect("renders with several devices");
    said(&format!(
        "soak: {done} renders, {interrupted} of them interrupted, {} devices; after half of them: {warm:?}; at the \
         end: {end:?}; a third of the devices left {grown} bytes or less",
        done / A_DEVICE,
    ));
    assert!(interrupted > done / 40, "{interrupted} of {done} were interrupted");
    assert!(end.descriptors <= warm.descriptors, "descriptors: {warm:?}, {end:?}");
    assert!(end.threads <= warm.threads, "threads: {warm:?}, {end:?}");
    assert!(grown <= SLACK_BYTES, "memory grows with each device: {held:?}");

    let mut watched = 0;
    while watched < count / 4 {
        with_a_device(folder.path(), watched, true);
        watched += A_DEVICE;
    }
    said(&format!(
        "soak: {watched} renders more, of which the validation layer had nothing to say"
    ));
    assert_eq!(files(), before, "files are left");
}

/// Opens a device, renders with it, from the `first` render on, and closes it; how many were interrupted.
fn with_a_device(folder: &Path, first: usize, validation: bool) -> usize {
    let instance =
        Instance::new(&InstanceOptions { validation }).expect("Vulkan, and its validation layer");
    let device = Device::open(&instance, &DeviceChoice::Default).expect("a usable device");
    let mut interrupted = 0;
    for at in first..first + A_DEVICE {
        let (name, _) = SCENES[at % SCENES.len()];
        let patience = if at % 7 == 3 { (at / 7 % 8) as i32 } else { i32::MAX };
        interrupted += usize::from(!render(&device, folder, name, patience));
    }
    drop(device);
    assert_eq!(instance.validation_messages(), Vec::<String>::new());
    interrupted
}

/// From a scene file to a picture, which is removed; `false` where patience ran out.
fn render(device: &Arc<Device>, folder: &Path, name: &str, patience: i32) -> bool {
    let scene = Scene::load(&folder.join(format!("{name}.toml")), &[]).expect("a scene");
    let plan = Arc::new(plan_of_scene(&scene));
    let watch = Impatient(AtomicI32::new(patience));
    let watch: &dyn Watch = if patience == i32::MAX { &Unwatched } else { &watch };
    let rendered =
        Renderer::new(device, &plan, watch).and_then(|mut renderer| renderer.frame(watch));
    match rendered {
        Ok((picture, _)) => {
            let out = folder.join("out.exr");
            film::write(&picture.finish(), plan.provenance(), &out).expect("a written file");
            fs::remove_file(&out).expect("it was written");
            true
        }
        Err(RenderError::Interrupted) => false,
        Err(error) => panic!("{name}: {error}"),
    }
}
