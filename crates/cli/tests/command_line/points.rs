//! Of a point file, what its numbers mean: names of other programs, values that are none, which way is up.

use crate::{Folder, Ran, run_in};
use serde_json::{Value, json};
use std::fmt::Write;

fn render(folder: &Folder, arguments: &[&str]) -> Ran {
    let small = ["render", "--device", "reference", "--size", "48x36"];
    run_in(folder.path(), &[&small, arguments].concat())
}

/// Even points of a ball, with numbers of these names after x, y and z: the place in the file, and 2
/// where x is over 0, else 6.
fn ball(names: [&str; 2], none: impl Fn(u32) -> bool) -> String {
    let mut text = format!("x,y,z,{},{}\n", names[0], names[1]);
    for i in 0..400 {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 400.0;
        let (sin, cos) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        let class = if cos > 0.0 { 2 } else { 6 };
        let value = if none(i) { "nan".to_owned() } else { i.to_string() };
        writeln!(text, "{:.4},{:.4},{z:.4},{value},{class}", radius * cos, radius * sin)
            .expect("a string takes all");
    }
    text
}

#[test]
fn names_of_other_programs_mean_the_same_to_scenes_and_filters() {
    let folder = Folder::new();
    let mut pixels: Vec<Value> = Vec::new();
    for (i, names) in [
        ["intensity", "classification"],
        ["scalar_Intensity", "scalar_Classification"],
        ["Intensity", "CLASSIFICATION"],
    ]
    .into_iter()
    .enumerate()
    {
        let file = format!("{i}.csv");
        folder.write(&file, &ball(names, |_| false));
        let stats = format!("{i}.json");
        let ran = render(
            &folder,
            &[
                &file,
                "-o",
                "a.png",
                "--stats",
                &stats,
                "--set",
                "objects.0.filter.classification=[2]",
                "--set",
                "objects.0.filter.range={ intensity = [0, 350] }",
                "--set",
                "objects.0.material.albedo=attribute:intensity",
            ],
        )
        .succeeds();
        assert!(ran.stderr.contains("of 400 points (range"), "{}", ran.stderr);
        let text = std::fs::read_to_string(folder.path().join(&stats)).expect("statistics");
        let stats: Value = serde_json::from_str(&text).expect("JSON");
        pixels.push(stats["pixels"].clone());
    }
    assert!(pixels.iter().all(|hash| *hash == pixels[0]), "{pixels:?}");
    render(
        &folder,
        &["0.csv", "-o", "a.png", "--set", "objects.0.material.albedo=attribute:tensity"],
    )
    .fails_with(2, &["attribute:tensity", "it has intensity, classification, x, y, z"]);
}

#[test]
fn values_that_are_none_are_counted() {
    let folder = Folder::new();
    folder.write("a.csv", &ball(["temp", "class"], |i| i % 4 == 0));
    let albedo = "objects.0.material.albedo=attribute:temp";
    let ran =
        render(&folder, &["a.csv", "-o", "a.png", "--stats", "a.json", "--set", albedo]).succeeds();
    let line = "100 of 400 points have no 'temp' (NaN) and are drawn in purple";
    assert!(ran.stderr.contains(line), "{}", ran.stderr);
    let text = std::fs::read_to_string(folder.path().join("a.json")).expect("statistics");
    let stats: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(stats["missing"], json!(100));
    let volume = "objects.0.volume={ scalar = 'temp', color_map = 'gray', extinction = 1 }";
    let ran = render(&folder, &["a.csv", "-o", "a.png", "--set", volume]).succeeds();
    let line = "100 of 400 points have no finite 'temp'";
    assert!(ran.stderr.contains(line), "{}", ran.stderr);

    folder.write("none.csv", &ball(["temp", "class"], |_| true));
    for value in
        [albedo, volume, "objects.0.material={ albedo = 'attribute:temp', value_range = [0, 1] }"]
    {
        render(&folder, &["none.csv", "-o", "a.png", "--set", value])
            .fails_with(2, &["none.csv", "temp", "take another attribute"]);
    }
}

/// A note names the choice where it is not y, and what overrides it.
#[test]
fn which_way_is_up_is_said_and_can_be_overridden() {
    let folder = Folder::new();
    let lidar = (0..64 * 4).fold(String::new(), |mut text, i| {
        let (turn, row) = (f64::from(i % 64) * 0.098, f64::from(i / 64));
        let _ = writeln!(text, "{:.4} {:.4} {:.4}", 5.0 * turn.cos(), 5.0 * turn.sin(), 1.0 - row);
        text
    });
    let head = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n";
    folder.write("lidar.pcd", &format!("{head}WIDTH 64\nHEIGHT 4\nDATA ascii\n{lidar}"));
    folder.write("plain.pcd", &format!("{head}WIDTH 256\nHEIGHT 1\nDATA ascii\n{lidar}"));
    let pixels = |arguments: &[&str]| {
        let ran = render(&folder, &[arguments, &["-o", "a.png", "--stats", "a.json"]].concat());
        let stderr = ran.succeeds().stderr;
        let text = std::fs::read_to_string(folder.path().join("a.json")).expect("statistics");
        let stats: Value = serde_json::from_str(&text).expect("JSON");
        (stats["pixels"].clone(), stderr)
    };
    let (found, stderr) = pixels(&["lidar.pcd"]);
    let line =
        "lidar.pcd: z is up, as in the rows of a lidar's beams; --up y or --up -y says otherwise";
    assert!(stderr.contains(line), "{stderr}");
    let (asked, stderr) = pixels(&["plain.pcd", "--up", "z"]);
    assert!(!stderr.contains("is up"), "{stderr}");
    // The same light and the same view.
    assert_eq!(found, asked);
    assert_ne!(found, pixels(&["lidar.pcd", "--up", "y"]).0);
}

/// A depth image, organised as PCL writes it, of a wall and a box before it.
#[test]
fn a_depth_image_is_first_seen_from_its_sensor() {
    let folder = Folder::new();
    let image = (0..32 * 24).fold(String::new(), |mut text, i| {
        let (column, row) = (f64::from(i % 32) - 15.5, f64::from(i / 32) - 11.5);
        let z = if column.abs() < 5.0 && row > 0.0 { 2.0 } else { 3.0 };
        let _ = writeln!(text, "{} {} {z}", column / 31.0 * z, row / 31.0 * z);
        text
    });
    let head = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n";
    let viewpoint = "VIEWPOINT 0 0 0 1 0 0 0\n";
    folder
        .write("depth.pcd", &format!("{head}WIDTH 32\nHEIGHT 24\n{viewpoint}DATA ascii\n{image}"));
    let stderr = |arguments: &[&str]| {
        let common = ["depth.pcd", "-o", "a.exr"];
        render(&folder, &[&common, arguments].concat()).succeeds().stderr
    };
    let line = "depth.pcd: one depth image, seen from where its sensor stood, 0 0 0, 53 by 41 degrees; --up y, \
                --up z or --up -y shows it from outside";
    assert!(stderr(&[]).contains(line), "{}", stderr(&[]));
    let info = run_in(folder.path(), &["info", "a.exr"]).succeeds().stdout;
    assert!(info.contains("eye = [0.0, 0.0, 0.0]"), "{info}");
    let camera = "camera={ eye = [1, 0, -1], target = [0, 0, 3], up = [0, -1, 0] }";
    for other in [&["--up", "-y"][..], &["--set", camera]] {
        assert!(!stderr(other).contains("sensor"), "{other:?}");
    }
    let info = run_in(folder.path(), &["info", "depth.pcd", "--json"]).succeeds().stdout;
    let info: Value = serde_json::from_str(&info).expect("JSON");
    let sensor = &info["sensors"][0];
    assert_eq!((&sensor["position"], &sensor["columns"]), (&json!([0.0, 0.0, 0.0]), &json!(32)));
    assert_eq!((&sensor["up"], &sensor["points"]), (&json!([0.0, -1.0, 0.0]), &json!(768)));
}
