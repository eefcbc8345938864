//! Pictures, by the CPU reference.

use crate::{Folder, Ran, ply, pointillist, run_in, sphere};
use serde_json::Value;
use std::path::Path;

const SMALL: [&str; 5] = ["--device", "reference", "--size", "64x48", "--quiet"];

fn render(folder: &Folder, arguments: &[&str]) -> Ran {
    run_in(folder.path(), &[&["render"], arguments, &SMALL].concat())
}

fn json(path: &Path) -> Value {
    let text = std::fs::read_to_string(path).expect("a JSON file");
    serde_json::from_str(&text).expect("valid JSON")
}

#[test]
fn one_render_writes_every_format_and_says_nothing_when_quiet() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(2000));
    let outputs = [
        "ball.ply", "-o", "a.exr", "-o", "a.png", "-o", "a.jpg", "-o", "b.JPEG", "--stats",
        "a.json",
    ];
    let ran = render(&folder, &[&outputs[..], &["--quality", "draft"]].concat()).succeeds();
    assert_eq!((ran.stdout.as_str(), ran.stderr.as_str()), ("", ""));
    assert_eq!(folder.names(), ["a.exr", "a.jpg", "a.json", "a.png", "b.JPEG", "ball.ply"]);
    let starts = |name: &str, magic: &[u8]| {
        let bytes = std::fs::read(folder.path().join(name)).expect("a picture");
        assert!(bytes.starts_with(magic), "{name}");
    };
    starts("a.exr", b"\x76\x2f\x31\x01");
    starts("a.png", b"\x89PNG\r\n\x1a\n");
    starts("a.jpg", b"\xff\xd8\xff");
    starts("b.JPEG", b"\xff\xd8\xff");

    let row = json(&folder.path().join("a.json"));
    assert_eq!(row["name"], "ball");
    assert_eq!(row["rays"]["camera"], 64 * 48);
    // A point file gets a key light and a fill light.
    assert!(row["rays"]["shadow"].as_u64().expect("a count") > 300, "{row}");
    for kind in ["reflected", "refracted"] {
        assert_eq!(row["rays"][kind], 0);
    }
    for time in ["trace_ms", "wall_ms", "build_ms"] {
        for part in ["median", "min", "max"] {
            assert!(row[time][part].as_f64().expect("a number") >= 0.0, "{row}");
        }
    }
    let spent = ["read_ms", "plan_ms"].map(|time| row[time].as_f64().expect("a number"));
    assert!(spent.iter().all(|&ms| ms > 0.0), "{row}");
    assert!(spent[0] + spent[1] < row["wall_ms"]["median"].as_f64().expect("a number"), "{row}");
    assert_eq!(row["points"], 2000);
    assert_eq!(row["fits"]["full"], 2000);
    assert_eq!(row["passes"], 1);
    assert_eq!(row["primary"], "grid", "few pixels");
    assert!(row.get("loop").is_some(), "{row}");
    assert!(row["tests_per_ray"].as_f64().expect("a number") > 1.0, "{row}");
    assert!(row["bytes_per_point"].as_f64().expect("a number") > 64.0, "{row}");
    assert_eq!(row["pixels"].as_str().expect("a hash").len(), 16);
    // The framed sphere fills some of the picture, but not all of it.
    let hits = row["hits"].as_u64().expect("a count");
    assert!((300..64 * 48 - 300).contains(&hits), "{hits} pixels hit");
}

#[test]
fn the_same_render_gives_the_same_bytes_wherever_it_is_started() {
    let folder = Folder::new();
    let points = folder.write("ball.ply", &sphere(500));
    let absolute = points.to_str().expect("UTF-8");
    render(&folder, &["ball.ply", "-o", "a.exr"]).succeeds();
    render(&folder, &[absolute, "-o", "b.exr", "--cells-per-pass", "1"]).succeeds();
    let read = |name: &str| std::fs::read(folder.path().join(name)).expect("a picture");
    assert!(read("a.exr") == read("b.exr"));
}

#[test]
fn a_crop_is_a_part_of_the_whole() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(500));
    let channels = ["--channels", "point,tests,cells,iterations,trust,fit"];
    let into = |output: &str, crop: &[&str]| {
        render(&folder, &[&["ball.ply", "-o", output][..], &channels, crop].concat()).succeeds();
    };
    into("whole.exr", &[]);
    into("part.exr", &["--crop", "20,10,30,25"]);
    let read = |name: &str| film::read_exr(&folder.path().join(name)).expect("an EXR");
    let (whole, part) = (read("whole.exr"), read("part.exr"));
    assert_eq!((part.data_origin, part.data_size), ([20, 10], [30, 25]));
    assert_eq!(part.display_size, [64, 48]);
    assert_eq!(part.channels.len(), 12 + 6);
    for (name, values) in &part.channels {
        let all = &whole.channels[name];
        for (i, value) in values.iter().enumerate() {
            let (x, y) = (20 + i % 30, 10 + i / 30);
            assert_eq!(value.to_bits(), all[y * 64 + x].to_bits(), "{name} at {x}, {y}");
        }
    }
}

#[test]
fn channels_add_diagnostics_and_change_nothing_else() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(500));
    // With one sample, channels count what all rays of a pixel do.
    let draft = ["--quality", "draft"];
    render(&folder, &[&["ball.ply", "-o", "plain.exr"], &draft[..]].concat()).succeeds();
    let repeated = ["--channels", "trust,tests", "--channels", "fit", "--channels", "tests"];
    let outputs = ["ball.ply", "-o", "a.exr", "-o", "a.png", "--stats", "a.json"];
    let ran = render(&folder, &[&outputs[..], &repeated, &draft].concat()).succeeds();
    assert_eq!(ran.stderr, "");
    let read = |name: &str| film::read_exr(&folder.path().join(name)).expect("an EXR").channels;
    let (plain, mut with) = (read("plain.exr"), read("a.exr"));
    let [fits, tests, fractions] =
        ["fit", "tests", "trust"].map(|name| with.remove(name).expect("a channel"));
    assert!(plain == with, "the other channels are those of a render without");

    for ((object, fit), fraction) in plain["object"].iter().zip(fits).zip(fractions) {
        let hit = *object >= 0.0;
        assert_eq!(fit, if hit { 3.0 } else { -1.0 });
        assert!(if hit { (0.0..=1.0).contains(&fraction) } else { fraction == -1.0 });
    }
    let row = json(&folder.path().join("a.json"));
    let kinds = ["camera", "shadow", "reflected", "refracted"];
    let rays: f64 = kinds.iter().map(|kind| row["rays"][kind].as_f64().expect("a count")).sum();
    let counted = row["tests_per_ray"].as_f64().expect("a number") * rays;
    let sum: f64 = tests.into_iter().map(f64::from).sum();
    assert!((sum - counted).abs() < 1e-6 * counted, "{sum} against {counted}");
}

/// Spheres and discs are counted, and shown as such.
#[test]
fn points_are_drawn_as_spheres_and_discs() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(500));
    for (kind, shown) in [("sphere", 5.0), ("disc", 4.0)] {
        let set = format!("objects.0.surface.kind={kind}s");
        let outputs = ["ball.ply", "-o", "a.exr", "--stats", "a.json", "--channels", "fit"];
        let ran = render(&folder, &[&outputs[..], &["--set", &set]].concat()).succeeds();
        assert_eq!(ran.stderr, "");
        let row = json(&folder.path().join("a.json"));
        assert_eq!((&row["fits"][kind], &row["fits"]["full"]), (&500.into(), &0.into()));
        let channels = film::read_exr(&folder.path().join("a.exr")).expect("an EXR").channels;
        let fits = &channels["fit"];
        assert!(fits.contains(&shown) && fits.iter().all(|fit| [shown, -1.0].contains(fit)));
    }
}

/// Nobody is told twice, and a picture is the same to the byte.
#[test]
fn channels_without_an_exr_are_a_warning() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(500));
    let arguments = ["render", "ball.ply", "--device", "reference", "--size", "64x48", "-o"];
    let render = |output: &str, channels: &[&str]| {
        run_in(folder.path(), &[&arguments[..], &[output], channels].concat()).succeeds()
    };
    let plain = render("a.png", &[]);
    assert!(!plain.stderr.contains("warning"), "{}", plain.stderr);
    let warned = render("b.png", &["--channels", "point,fit"]);
    assert_eq!(warned.stderr.matches("warning: --channels is ignored").count(), 1);
    assert!(warned.stderr.contains(".exr"), "{}", warned.stderr);
    let read = |name: &str| std::fs::read(folder.path().join(name)).expect("a picture");
    assert!(read("a.png") == read("b.png"));
}

#[test]
fn double_precision_is_another_device() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(500));
    let f64_device = ["--device", "reference-f64", "--size", "64x48"];
    let arguments = ["render", "ball.ply", "-o", "a.png", "--stats", "a.json"];
    run_in(folder.path(), &[&arguments[..], &f64_device].concat()).succeeds();
    assert_eq!(json(&folder.path().join("a.json"))["device"], "reference (CPU, f64)");
}

/// Two objects of one file; `--set` reaches into the second.
#[test]
fn a_scene_is_rendered_with_its_overrides() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(500));
    let object = "[[objects]]\npoints = \"ball.ply\"\n";
    folder.write("two.toml", &format!("{object}{object}transform.translate = [3, 0, 0]\n"));
    let hash = |option: &[&str]| {
        let base = ["two.toml", "-o", "a.png", "--stats", "a.json"];
        render(&folder, &[&base[..], option].concat()).succeeds();
        let row = json(&folder.path().join("a.json"));
        assert_eq!(row["points"], 1000);
        row["pixels"].as_str().expect("a hash").to_owned()
    };
    let plain = hash(&[]);
    assert_eq!(plain, hash(&[]));
    assert_ne!(plain, hash(&["--set", "objects.1.transform.scale=0.5"]));
}

#[test]
fn useless_points_are_counted_and_an_object_without_surface_is_background() {
    let folder = Folder::new();
    folder.write("one.ply", &ply(&["1 2 3", "nan 0 0", "0 inf 0"]));
    let arguments = ["render", "one.ply", "-o", "a.png", "--device", "reference", "--size", "8x8"];
    let ran = run_in(folder.path(), &arguments).succeeds();
    assert!(ran.stderr.contains("one.ply: dropped 2 of 3 points"), "{}", ran.stderr);
    assert!(ran.stderr.contains("object 'one'"), "{}", ran.stderr);
    assert!(ran.stderr.contains("background"), "{}", ran.stderr);
    assert_eq!(ran.stdout, "");
    folder.write("none.ply", &ply(&["nan 0 0"]));
    render(&folder, &["none.ply", "-o", "b.png"]).fails_with(2, &["none.ply"]);
}

/// Names of files are bytes.
#[cfg(target_os = "linux")]
#[test]
fn names_need_not_be_utf_8() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = Folder::new();
    let points = folder.write(OsStr::from_bytes(b"b\xe4ll.ply"), &sphere(200));
    let output = folder.path().join(OsStr::from_bytes(b"b\xe4ll.exr"));
    let mut command = pointillist();
    command.arg("render").arg(points).arg("-o").arg(&output).args(SMALL);
    Ran::of(&mut command).succeeds();
    assert!(output.is_file());
}

#[test]
fn bench_times_frames_on_the_reference() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(500));
    let options = ["bench", "ball.ply", "--runs", "3", "--json", "b.json", "--markdown", "b.md"];
    let ran = run_in(folder.path(), &[&options[..], &SMALL].concat()).succeeds();
    assert!(ran.stdout.contains("ball") && ran.stdout.contains("trace ms"), "{}", ran.stdout);
    let report = json(&folder.path().join("b.json"));
    for key in ["device", "driver", "cpu", "version"] {
        assert!(report[key].is_string(), "{report}");
    }
    let rows = report["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 1);
    assert_eq!(rows[0]["name"], "ball");
    let trace = &rows[0]["trace_ms"];
    assert!(trace["min"].as_f64() <= trace["median"].as_f64(), "{report}");
    let markdown = std::fs::read_to_string(folder.path().join("b.md")).expect("a table");
    assert!(markdown.contains("| ball | 500 |"), "{markdown}");
}

/// 16384 x 16384 pixels need 13 GB; the limit on the process is 4 GB.
#[cfg(target_os = "linux")]
#[test]
fn a_picture_beyond_memory_is_4_with_a_way_out() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(200));
    let render = format!(
        "ulimit -v 4000000; exec '{}' render ball.ply -o a.png --device reference --size 16384x16384",
        env!("CARGO_BIN_EXE_pointillist")
    );
    let mut shell = std::process::Command::new("sh");
    let ran = Ran::of(shell.current_dir(folder.path()).args(["-c", &render]));
    ran.fails_with(4, &["16384x16384", "--crop"]);
    assert_eq!(folder.names(), ["ball.ply"]);
}

/// What is aside until it is whole is nobody's business: a limit on the size of files stands for a
/// full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_file_that_cannot_be_finished_is_named_as_typed_and_leaves_nothing() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(200));
    std::os::unix::fs::symlink("/dev/null", folder.path().join("no.png")).expect("a link");
    for outputs in ["-o a.exr", "-o no.png --stats a.json"] {
        let render = format!(
            "trap '' XFSZ; ulimit -f 0; \
             exec '{}' render ball.ply {outputs} --device reference --size 64x48",
            env!("CARGO_BIN_EXE_pointillist")
        );
        let mut shell = std::process::Command::new("sh");
        let ran = Ran::of(shell.current_dir(folder.path()).args(["-c", &render]));
        let ran = ran.fails_with(4, &["error: a.", "cannot write the file", "ulimit -f"]);
        assert!(!ran.stderr.contains(".pointillist-"), "{}", ran.stderr);
    }
    assert_eq!(folder.names(), ["ball.ply", "no.png"]);
}

/// /dev/stdout is a link to a pipe, which can only be written to directly.
#[cfg(target_os = "linux")]
#[test]
fn statistics_can_go_to_stdout_and_are_alone_there() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(200));
    let ran = render(&folder, &["ball.ply", "-o", "a.png", "--stats", "/dev/stdout"]).succeeds();
    let row: Value = serde_json::from_str(&ran.stdout).expect("JSON alone");
    assert_eq!(row["points"], 200);
}
