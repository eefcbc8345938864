//! What an EXR says of itself: provenance, standard attributes, and what other programs read there.

use crate::{Folder, Ran, run_in, said, sphere};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

fn render(folder: &Folder, arguments: &[&str]) -> Ran {
    let small = ["--device", "reference", "--size", "64x48", "--quiet"];
    run_in(folder.path(), &[&["render"], arguments, &small].concat()).succeeds()
}

fn strings(folder: &Folder, name: &str) -> BTreeMap<String, String> {
    film::read_exr(&folder.path().join(name)).expect("an EXR").strings
}

fn info(folder: &Folder, name: &str) -> Value {
    let ran = run_in(folder.path(), &["info", name, "--json"]).succeeds();
    serde_json::from_str(&ran.stdout).expect("one JSON object")
}

#[test]
fn a_changed_header_is_caught_where_pixels_are_equal() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(300));
    render(&folder, &["ball.ply", "-o", "a.exr", "--quality", "draft"]);
    // One sample by any filter is one sample: the same pixels from another scene.
    let set = ["--set", "image.filter=\"box\""];
    render(&folder, &[&["ball.ply", "-o", "b.exr", "--quality", "draft"], &set[..]].concat());
    let compare = |arguments: &[&str]| {
        run_in(folder.path(), &[&["compare", "a.exr", "b.exr"], arguments].concat())
    };
    let ran = compare(&["--max-abs", "0"]).succeeds();
    assert!(ran.stdout.contains("headers  2 attributes differ, see --headers"), "{}", ran.stdout);
    let ran = compare(&["--max-abs", "0", "--headers"]);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    let line = "header   pointillist/scene: 'filter = \"gaussian\"' against 'filter = \"box\"'";
    assert!(ran.stdout.contains(line), "{}", ran.stdout);
    let ran = compare(&["--headers", "--json"]);
    let found: Value = serde_json::from_str(&ran.stdout).expect("one JSON object");
    assert_eq!((ran.code, &found["pass"]), (Some(1), &Value::Bool(false)));
    let names: Vec<&str> = found["headers"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|difference| difference["name"].as_str().expect("a name"))
        .collect();
    assert_eq!(names, ["pointillist/scene", "pointillist/scene.sha256"]);
    run_in(folder.path(), &["compare", "a.exr", "a.exr", "--headers"]).succeeds();
}

#[test]
fn provenance_names_what_made_the_picture_and_nothing_that_passes() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(300));
    folder.write("other.ply", &sphere(301));
    std::fs::create_dir(folder.path().join("moved")).expect("a folder");
    folder.write("moved/ball.ply", &sphere(300));
    render(&folder, &["ball.ply", "-o", "a.exr"]);
    render(&folder, &["moved/ball.ply", "-o", "b.exr", "--progress", "never"]);
    render(&folder, &["other.ply", "-o", "other.exr"]);
    render(&folder, &["ball.ply", "-o", "seed.exr", "--set", "render.seed=7"]);
    let (a, b) = (strings(&folder, "a.exr"), strings(&folder, "b.exr"));
    assert_eq!(a, b, "the same points in another folder, at another time");
    let own: Vec<&str> = a.keys().filter_map(|name| name.strip_prefix("pointillist/")).collect();
    let settings = ["scene", "scene.sha256", "seed", "version"];
    let expected = [&["device", "exposure", "origin", "points.0.sha256"], &settings[..]].concat();
    assert_eq!(own, expected, "the reference has no driver");
    assert_eq!(a["pointillist/device"], "reference (CPU, f32)");
    assert_eq!(a["pointillist/version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(a["pointillist/seed"], "0");
    assert!(own.iter().all(|name| name.len() + "pointillist/".len() <= 31), "for old readers");
    for hash in ["pointillist/scene.sha256", "pointillist/points.0.sha256"] {
        assert!(a[hash].len() == 64 && a[hash].bytes().all(|b| b.is_ascii_hexdigit()), "{a:?}");
    }
    let folder_name = folder.path().to_string_lossy().into_owned();
    assert!(a.values().all(|value| !value.contains(&folder_name)));

    let other = strings(&folder, "other.exr");
    assert_ne!(a["pointillist/points.0.sha256"], other["pointillist/points.0.sha256"]);
    let seed = strings(&folder, "seed.exr");
    assert_eq!(seed["pointillist/seed"], "7");
    assert_ne!(a["pointillist/scene.sha256"], seed["pointillist/scene.sha256"]);
    assert_eq!(a["pointillist/points.0.sha256"], seed["pointillist/points.0.sha256"]);
}

#[test]
fn images_that_a_scene_is_made_from_have_their_hashes() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(300));
    let scene = "[background]\nenvironment = \"sky.png\"\n[[objects]]\npoints = \"ball.ply\"\n\
                 [[objects]]\npoints = \"ball.ply\"\nmaterial = { texture = \"map.png\" }\n";
    folder.write("scene.toml", scene);
    let image = |name: &str, pixels: &[[u8; 3]; 2]| {
        film::write_png([2, 1], pixels, &folder.path().join(name)).expect("written");
    };
    image("sky.png", &[[1, 2, 3], [4, 5, 6]]);
    image("map.png", &[[7, 8, 9], [10, 11, 12]]);
    render(&folder, &["scene.toml", "-o", "a.exr"]);
    let a = strings(&folder, "a.exr");
    // Of `struct.pack('<II8B', 2, 1, 1, 2, 3, 255, 4, 5, 6, 255)`, by Python's hashlib.
    let sky = "4424e00ef6f1f4b6c7fa39c95da7a2faaf4c2cfb95aa60a344688ef4aa46796b";
    assert_eq!(a["pointillist/environment.sha256"], sky);
    assert!(!a.contains_key("pointillist/texture.0.sha256"), "the first object has no texture");
    image("map.png", &[[7, 8, 9], [10, 11, 13]]);
    render(&folder, &["scene.toml", "-o", "b.exr"]);
    let b = strings(&folder, "b.exr");
    let differs = |name: &String| a[name] != b[name];
    let differing: Vec<&String> = a.keys().filter(|&name| differs(name)).collect();
    assert_eq!(differing, ["pointillist/texture.1.sha256"]);
    assert_eq!(a.len(), b.len());
}

/// The header has the sky, not what it looked like, and the camera whose up it was turned by; what is rendered from it is
/// the same to the bit. Under the integrator "direct" its sun is no light.
#[test]
fn skies_and_gradients_are_rendered_again() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(300));
    for (background, stated) in [
        ("background.sky={ elevation = 20, ground = 0.5 }", "[background.sky]\nelevation = 20.0\n"),
        ("background.sky.sun=[1, 1, 1]", "[background.sky]\nsun = [1.0, 1.0, 1.0]\n"),
        (
            "background.gradient=[[0, 0, 0], [1, 2, 3]]",
            "gradient = [[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]]\n",
        ),
    ] {
        render(&folder, &["ball.ply", "--up", "z", "--set", background, "-o", "a.exr"]);
        let scene = &strings(&folder, "a.exr")["pointillist/scene"];
        assert!(scene.contains(stated) && scene.matches("[[lights]]").count() == 2, "{scene}");
        render(&folder, &["a.exr", "-o", "b.exr"]);
        run_in(folder.path(), &["compare", "a.exr", "b.exr", "--max-abs", "0"]).succeeds();
    }
    let below = ["render", "ball.ply", "--set", "background.sky.sun=[1, -1, 0]", "-o", "c.exr"];
    run_in(folder.path(), &below).fails_with(2, &["background.sky.sun", "45.00 degrees below"]);
}

#[test]
fn info_of_a_picture_tells_windows_channels_and_provenance() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(300));
    let crop = ["--crop", "20,10,30,25", "--half", "--channels", "tests"];
    render(&folder, &[&["ball.ply", "-o", "a.exr", "-o", "a.png"][..], &crop].concat());
    let text = run_in(folder.path(), &["info", "a.exr"]).succeeds().stdout;
    for line in [
        "display  64x48 at 0,0",
        "data     30x25 at 20,10",
        "ZIP, scan lines",
        "seed  0",
        "N.X     half",
        "tests   float",
    ] {
        assert!(text.contains(line), "no '{line}' in\n{text}");
    }
    let found = info(&folder, "a.exr");
    assert_eq!(found["format"], "OpenEXR");
    assert_eq!(found["display_window"], serde_json::json!({ "origin": [0, 0], "size": [64, 48] }));
    let part = &found["parts"][0];
    assert_eq!(part["data_window"], serde_json::json!({ "origin": [20, 10], "size": [30, 25] }));
    assert_eq!(part["channels"]["R"]["type"], "half");
    let z = &part["channels"]["Z"];
    assert_eq!(z["type"], "float");
    let picture = film::read_exr(&folder.path().join("a.exr")).expect("an EXR");
    let infinite = picture.channels["Z"].iter().filter(|z| z.is_infinite()).count();
    assert_eq!((&z["infinite"], &z["nan"]), (&infinite.into(), &0.into()));
    assert_eq!(found["provenance"]["device"], "reference (CPU, f32)");
    assert_eq!(part["attributes"]["worldToCamera"]["type"], "m44f");
    let png = info(&folder, "a.png");
    assert_eq!((&png["size"], &png["bits"]), (&serde_json::json!([30, 25]), &8.into()));
    run_in(folder.path(), &["info", "none.exr"]).fails_with(2, &["none.exr", "check its name"]);
    folder.write("text.exr", "no picture");
    run_in(folder.path(), &["info", "text.exr"])
        .fails_with(2, &["text.exr", "expected an OpenEXR"]);
}

/// What a program prints, or `None`, said loudly, where it is not there.
fn printed(test: &str, program: &str, arguments: &[&str], folder: &Path) -> Option<String> {
    match Command::new(program).args(arguments).current_dir(folder).output() {
        Ok(output) if output.status.success() => {
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            Some(text.split_whitespace().collect::<Vec<_>>().join(" "))
        }
        Ok(output) => {
            let errors = String::from_utf8_lossy(&output.stderr).into_owned();
            if errors.contains("ModuleNotFoundError") || errors.contains("ImportError") {
                said(&format!("SKIPPED: a part of {test}: no module OpenEXR for {program} here"));
                return None;
            }
            panic!("{program} rejects the file: {errors}");
        }
        Err(error) => {
            said(&format!("SKIPPED: a part of {test}: no {program} here: {error}"));
            None
        }
    }
}

const PYTHON: &str = "
import OpenEXR, sys
file = OpenEXR.File(sys.argv[1], separate_channels=True)
header = file.header()
for name, channel in sorted(file.channels().items()):
    pixels = channel.pixels
    print(name, pixels.dtype, pixels.shape[1], pixels.shape[0], repr(float(pixels[12, 15])))
for name in ['pointillist/device', 'pointillist/seed', 'software']:
    print(name, header[name])
print(header['dataWindow'][0].tolist(), header['dataWindow'][1].tolist())
print(header['displayWindow'][0].tolist(), header['displayWindow'][1].tolist())
print([repr(float(v)) for v in header['worldToCamera'].flatten()])
";

#[test]
fn other_programs_read_what_was_written() {
    const TEST: &str = "other_programs_read_what_was_written";
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(300));
    for (name, more, kind) in [("float.exr", &[][..], "float"), ("half.exr", &["--half"], "half")] {
        let crop = ["--crop", "20,10,30,25", "--channels", "tests,fit"];
        render(&folder, &[&["ball.ply", "-o", name][..], &crop, more].concat());
        let picture = film::read_exr(&folder.path().join(name)).expect("an EXR");
        let expect = |program: &str, text: Option<String>, words: &[&str]| {
            let Some(text) = text else { return };
            for word in words {
                assert!(text.contains(word), "{program}, {name}: no '{word}' in\n{text}");
            }
        };
        let bits = if kind == "half" { "16-bit" } else { "32-bit" };
        let color = format!("R, {bits} floating-point, sampling 1 1");
        let header = [
            "dataWindow (type box2i): (20 10) - (49 34)",
            "displayWindow (type box2i): (0 0) - (63 47)",
            "pixelAspectRatio (type float): 1",
            "red (0.64 0.33) green (0.3 0.6) blue (0.15 0.06) white (0.3127 0.329)",
            "worldToCamera (type m44f)",
            "worldToNDC (type m44f)",
            "pointillist/device (type string): \"reference (CPU, f32)\"",
            "Z, 32-bit floating-point, sampling 1 1",
            "object, 32-bit floating-point, sampling 1 1",
            "tests, 32-bit floating-point, sampling 1 1",
            &color,
        ];
        expect("exrheader", printed(TEST, "exrheader", &[name], folder.path()), &header);
        let color = format!("'R': {kind}");
        let found = printed(TEST, "exrinfo", &["-v", name], folder.path());
        expect("exrinfo", found, &["[ 20, 10 - 49 34 ] 30 x 25", "'Z': float", &color]);
        let color = format!("R ({kind})");
        let mixed = [
            "30 x 25",
            "pixel data origin: x=20, y=10",
            "full/display size: 64 x 48",
            "pointillist/seed: \"0\"",
        ];
        let found = printed(TEST, "oiiotool", &["--info", "-v", name], folder.path());
        expect("oiiotool", found.clone(), &mixed);
        if kind == "half" {
            expect("oiiotool", found, &[&color, "Z (float)"]);
        }

        let found = printed(TEST, "python3", &["-c", PYTHON, name], folder.path());
        let words =
            ["pointillist/device reference (CPU, f32)", "[20, 10] [49, 34]", "[0, 0] [63, 47]"];
        for (channel, values) in &picture.channels {
            let shown = ["R", "G", "B", "A", "N.X", "N.Y", "N.Z"].contains(&channel.as_str());
            let dtype = if shown && kind == "half" { "float16" } else { "float32" };
            let value = f64::from(values[12 * 30 + 15]);
            assert!(value.is_finite(), "{channel} hit the ball in the middle");
            // Python writes 1e-05 where Rust writes 1e-5, so the number is compared as one.
            let Some(text) = found.as_ref().map(|text| format!(" {text}")) else { continue };
            let line = text.split(&format!(" {channel} {dtype} 30 25 ")).nth(1).unwrap_or("");
            let number: f64 =
                line.split(' ').next().and_then(|n| n.parse().ok()).unwrap_or(f64::NAN);
            assert_eq!(number, value, "{channel} of {name} in Python");
        }
        expect("Python's OpenEXR", found, &words);
    }
}
