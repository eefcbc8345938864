//! Which points of a file are taken, and where they lie: `[objects.filter]`, survey coordinates.

use crate::{Folder, Ran, run_in};
use serde_json::{Value, json};
use std::fmt::Write;

/// A ball of `count` points about `center`, in double precision, with a `classification` of 2 where x is
/// over the centre's, else 6, and `intensity`, which is the place in the file. Coordinates from the centre
/// are multiples of 2⁻²⁰, so that adding a centre that is one too rounds nothing.
fn ball(count: u32, center: [f64; 3]) -> String {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {count}\nproperty double x\nproperty double y\n\
         property double z\nproperty uchar classification\nproperty ushort intensity\nend_header\n"
    );
    for i in 0..count {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let (sin, cos) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        let even = |x: f64| (x * 1_048_576.0).round() / 1_048_576.0;
        let [x, y, z] = [radius * cos, radius * sin, z].map(even);
        let class = if x > 0.0 { 2 } else { 6 };
        let at = [center[0] + x, center[1] + y, center[2] + z];
        writeln!(text, "{} {} {} {class} {i}", at[0], at[1], at[2]).expect("a string takes all");
    }
    text
}

fn scene(filter: &str) -> String {
    format!(
        "image.size = [48, 36]\n[[lights]]\nkind = \"directional\"\ndirection = [0.3, -1, -0.5]\n\
         irradiance = [3, 3, 3]\n[[objects]]\npoints = \"ball.ply\"\n{filter}"
    )
}

fn render(folder: &Folder, arguments: &[&str]) -> Ran {
    run_in(folder.path(), &[&["render", "--device", "reference"], arguments].concat())
}

fn stats(folder: &Folder, name: &str) -> Value {
    let text = std::fs::read_to_string(folder.path().join(name)).expect("statistics");
    serde_json::from_str(&text).expect("one JSON object")
}

#[test]
fn counts_before_and_after_a_filter_are_told_everywhere() {
    let folder = Folder::new();
    folder.write("ball.ply", &ball(1000, [0.0; 3]));
    let filter = "[objects.filter]\nevery = 2\nrange = { intensity = [0, 599] }\n";
    folder.write("s.toml", &scene(filter));
    let ran = render(&folder, &["s.toml", "-o", "a.exr", "--stats", "a.json"]).succeeds();
    let told = "ball.ply: kept 300 of 1000 points (every = 2, range = { intensity = [0, 599] })";
    assert!(ran.stderr.contains(told), "{}", ran.stderr);
    let stats = stats(&folder, "a.json");
    assert_eq!((&stats["points"], &stats["filtered_out"]), (&json!(300), &json!(700)));

    let ran = run_in(folder.path(), &["info", "s.toml", "--json"]).succeeds();
    let info: Value = serde_json::from_str(&ran.stdout).expect("JSON alone on stdout");
    let points = &info["objects"][0]["points"];
    assert_eq!((&points["points"], &points["filtered_out"]), (&json!(300), &json!(700)));
    assert_eq!(points["attributes"]["intensity"]["max"], 598.0);
    let text = run_in(folder.path(), &["info", "s.toml"]).succeeds().stdout;
    assert!(text.contains("  points   300 of 1000\n"), "{text}");
}

#[test]
fn two_objects_take_different_points_of_one_file() {
    let folder = Folder::new();
    folder.write("ball.ply", &ball(1000, [0.0; 3]));
    let second = "filter.classification = [2]\n[[objects]]\npoints = \"ball.ply\"\n\
                  filter.classification = [6]\n[[objects]]\npoints = \"ball.ply\"\n\
                  material.albedo = \"attribute:intensity\"\nfilter.classification = [6]\n";
    folder.write("s.toml", &scene(second));
    let ran = run_in(folder.path(), &["info", "s.toml", "--json"]).succeeds();
    let info: Value = serde_json::from_str(&ran.stdout).expect("JSON alone on stdout");
    let count = |object: usize| info["objects"][object]["points"]["points"].as_u64();
    let counts = [0, 1, 2].map(|object| count(object).expect("a count"));
    assert_eq!((counts[0] + counts[1], counts[1]), (1000, counts[2]));
    // Once for each filter.
    let ran = render(&folder, &["s.toml", "-o", "a.png"]).succeeds();
    assert_eq!(ran.stderr.matches("ball.ply: kept").count(), 2, "{}", ran.stderr);
}

#[test]
fn filters_may_be_set_and_kept_points_are_those_of_a_smaller_file() {
    let folder = Folder::new();
    folder.write("ball.ply", &ball(2000, [0.0; 3]));
    folder.write("s.toml", &scene(""));
    let set = ["--set", "objects.0.filter.every=10"];
    let ran =
        render(&folder, &[&["s.toml", "-o", "a.exr", "--stats", "a.json"][..], &set].concat());
    assert!(ran.succeeds().stderr.contains("kept 200 of 2000 points (every = 10)"));
    let text = ball(2000, [0.0; 3]);
    let (header, lines) = text.split_once("end_header\n").expect("a header");
    let lines: Vec<&str> = lines.lines().step_by(10).collect();
    let header = header.replace("vertex 2000", "vertex 200");
    folder.write("ball.ply", &format!("{header}end_header\n{}\n", lines.join("\n")));
    render(&folder, &["s.toml", "-o", "b.exr", "--stats", "b.json"]).succeeds();
    assert_eq!(stats(&folder, "a.json")["pixels"], stats(&folder, "b.json")["pixels"]);
    // A point file alone takes one too.
    let ran = render(&folder, &[&["ball.ply", "-o", "c.png"][..], &set].concat()).succeeds();
    assert!(ran.stderr.contains("ball.ply: kept 20 of 200 points"), "{}", ran.stderr);
}

#[test]
fn filters_that_leave_nothing_or_name_what_is_not_there_are_2() {
    let folder = Folder::new();
    folder.write("ball.ply", &ball(100, [0.0; 3]));
    folder.write("s.toml", &scene("filter.range.z = [5, 6]\n"));
    let named = "ball.ply: the filter (range = { z = [5, 6] }) keeps none of 100 points; widen it";
    for command in [&["info", "s.toml"][..], &["check", "s.toml"]] {
        run_in(folder.path(), command).fails_with(2, &[named]);
    }
    render(&folder, &["s.toml", "-o", "a.png"]).fails_with(2, &[named]);
    let missing = ["--set", "objects.0.filter.range={ height = [0, 1] }"];
    render(&folder, &[&["s.toml", "-o", "a.png"][..], &missing].concat()).fails_with(
        2,
        &["found no attribute 'height', which the filter asks for", "'classification'"],
    );
    assert_eq!(folder.names(), ["ball.ply", "s.toml"]);
}

/// What the scene does not name is not read, but an error knows of it.
#[test]
fn attributes_that_were_not_read_are_named_in_errors() {
    let folder = Folder::new();
    folder.write("ball.ply", &ball(100, [0.0; 3]));
    folder.write("s.toml", &scene("material.albedo = \"attribute:height\"\n"));
    render(&folder, &["s.toml", "-o", "a.png"])
        .fails_with(2, &["attribute:height", "it has classification, intensity, x, y, z"]);
}

/// At 4.9e6, f32 has steps of half a metre. The shift and the camera are multiples of 2⁻²⁰, so nothing is
/// rounded before the middle of the scene is subtracted, and every pixel is the same.
#[test]
fn survey_coordinates_change_no_pixel() {
    let folder = Folder::new();
    let shift = [636_001.75, 4_918_340.5, -2322.25];
    let camera = |shift: [f64; 3]| {
        let [eye, target] = [[2.5, 1.0, 3.25], [0.125, 0.0, -0.0625]]
            .map(|at: [f64; 3]| [0, 1, 2].map(|axis| at[axis] + shift[axis]));
        format!("camera = {{ eye = {eye:?}, target = {target:?}, vertical_fov = 30 }}\n")
    };
    for (name, shift) in [("near", [0.0; 3]), ("far", shift)] {
        folder.write("ball.ply", &ball(3000, shift));
        let lamp = [0, 1, 2].map(|axis| [3.0, 4.0, 5.0][axis] + shift[axis]);
        let lamp = format!(
            "[[lights]]\nkind = \"point\"\nposition = {lamp:?}\nintensity = [20, 30, 40]\n"
        );
        folder.write("s.toml", &format!("{}{}{lamp}", camera(shift), scene("")));
        let [picture, row] = ["exr", "json"].map(|ending| format!("{name}.{ending}"));
        render(&folder, &["s.toml", "-o", &picture, "--stats", &row]).succeeds();
    }
    let [near, far] = ["near.json", "far.json"].map(|name| stats(&folder, name));
    assert_eq!(near["pixels"], far["pixels"]);
    let hits = near["hits"].as_u64().expect("a count");
    assert!(hits > 300, "{hits} pixels show the ball");
    for axis in 0..3 {
        let origin = |row: &Value| row["origin"][axis].as_f64().expect("a number");
        assert_eq!(origin(&far) - origin(&near), shift[axis]);
    }
    let exr = film::read_exr(&folder.path().join("far.exr")).expect("an EXR");
    // A ball of 2, whose points are not quite symmetric: its middle in tenths.
    let origin = exr.strings.get("pointillist/origin").map(String::as_str);
    assert_eq!(origin, Some("636001.7 4918340.5 -2322.3"));
    let info = run_in(folder.path(), &["info", "s.toml", "--json"]).succeeds().stdout;
    let info: Value = serde_json::from_str(&info).expect("JSON alone on stdout");
    assert_eq!(info["origin"], far["origin"]);
    assert_eq!(info["objects"][0]["points"]["origin"], far["origin"]);
}

/// The same with a shift that is rounded: by half a nanometre at 4.9e6, which is all that may differ.
#[test]
fn survey_coordinates_are_exact_to_the_micrometre() {
    let folder = Folder::new();
    let shift = [500_000.003, 4_900_000.007, 1234.567];
    let pictures = [("near", [0.0; 3]), ("far", shift)].map(|(name, shift)| {
        folder.write("ball.ply", &ball(3000, shift));
        let at = |place: [f64; 3]| [0, 1, 2].map(|axis| place[axis] + shift[axis]);
        let (eye, target) = (at([0.0, 0.0, 4.0]), at([0.0; 3]));
        let camera = format!("camera = {{ eye = {eye:?}, target = {target:?} }}\n");
        folder.write("s.toml", &format!("{camera}{}", scene("")));
        let picture = format!("{name}.exr");
        render(&folder, &["s.toml", "-o", &picture]).succeeds();
        film::read_exr(&folder.path().join(picture)).expect("an EXR")
    });
    let [near, far] = pictures.each_ref().map(|picture| &picture.channels["Z"]);
    let both = near.iter().zip(far).filter(|(a, b)| a.is_finite() && b.is_finite());
    let differences: Vec<f32> = both.map(|(a, b)| (a - b).abs()).collect();
    assert!(differences.len() > 300);
    let most = differences.into_iter().fold(0.0, f32::max);
    assert!(most < 1e-6 * 4.0, "{most}");
}

/// A LAS file of one point is 247 bytes; z is up in it, so the camera's up is z.
#[test]
fn the_way_up_is_that_of_the_format() {
    let folder = Folder::new();
    let mut las = vec![0u8; 227];
    las[..4].copy_from_slice(b"LASF");
    las[24..26].copy_from_slice(&[1, 2]);
    las[94..96].copy_from_slice(&227u16.to_le_bytes());
    las[96..100].copy_from_slice(&227u32.to_le_bytes());
    las[105..107].copy_from_slice(&20u16.to_le_bytes());
    las[107..111].copy_from_slice(&300u32.to_le_bytes());
    for axis in 0..3 {
        las[131 + 8 * axis..139 + 8 * axis].copy_from_slice(&0.01f64.to_le_bytes());
    }
    for i in 0..300i32 {
        let place = [i % 20 * 10, i / 20 * 10, i % 7];
        las.extend(place.iter().flat_map(|number| number.to_le_bytes()));
        las.extend([0; 8]);
    }
    std::fs::write(folder.path().join("a.las"), las).expect("the folder can be written to");
    let points: String = (0..300).map(|i| format!("{} {} 1\n", i % 20, i / 20)).collect();
    let header =
        "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 20\nHEIGHT 15\nDATA ascii\n";
    folder.write("a.pcd", &format!("{header}{points}"));
    folder.write("b.pcd", &format!("{header}{points}").replace("WIDTH 20\nHEIGHT 15", "WIDTH 300"));
    for (file, options, up) in [
        ("a.las", &[][..], "up = [0.0, 0.0, 1.0]"),
        ("a.las", &["--up", "y"], "up = [0.0, 1.0, 0.0]"),
        ("a.pcd", &[], "up = [0.0, -1.0, 0.0]"),
        ("b.pcd", &[], "up = [0.0, 1.0, 0.0]"),
        ("b.pcd", &["--up", "-y"], "up = [0.0, -1.0, 0.0]"),
    ] {
        let small = [file, "-o", "a.exr", "--size", "32x24"];
        render(&folder, &[&small[..], options].concat()).succeeds();
        let exr = film::read_exr(&folder.path().join("a.exr")).expect("an EXR");
        let scene = exr.strings.get("pointillist/scene").expect("the scene");
        assert!(scene.contains(up), "{file} {options:?}: {scene}");
    }
}
