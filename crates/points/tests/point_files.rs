//! Point files as others made them, and files that are none.

#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use points::{PointSet, PointSummary, PointsError, Values};
use std::path::{Path, PathBuf};

fn read(path: &Path) -> Result<PointSet, PointsError> {
    points::read(path, &mut |_, _| ())
}

/// The collected point sets, where `POINTILLIST_DATA` names their folder.
fn data(test: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("POINTILLIST_DATA").map(PathBuf::from);
    if let Some(folder) = folder.filter(|folder| folder.is_dir()) {
        return Some(folder);
    }
    // Not eprintln!, which the test runner swallows where a test passes.
    let line =
        format!("SKIPPED: {test}: POINTILLIST_DATA names no folder of collected point sets\n");
    std::io::Write::write_all(&mut std::io::stderr(), line.as_bytes()).expect("stderr");
    None
}

/// File, points, attributes besides colours and normals, box to the decimals of the collection's
/// list.
type Row = (&'static str, usize, &'static [&'static str], [f64; 3], [f64; 3], f64);

const LAS: &[&str] = &[
    "intensity",
    "return_number",
    "number_of_returns",
    "scan_direction",
    "edge_of_flight_line",
    "classification",
    "flags",
    "scan_angle",
    "user_data",
    "point_source_id",
    "gps_time",
];

const ROWS: [Row; 25] = [
    ("surfaces/bunny.ply", 35_947, &[], [-0.0947, 0.0330, -0.0619], [0.0610, 0.1873, 0.0588], 6e-5),
    (
        "surfaces/horse.ply",
        48_485,
        &[],
        [-0.0420, -0.0917, -0.0764],
        [0.0420, 0.0917, 0.0764],
        6e-5,
    ),
    (
        "surfaces/armadillo.ply",
        172_974,
        &[],
        [-63.5001, -54.2415, -57.7145],
        [63.5001, 97.0804, 57.7140],
        6e-5,
    ),
    (
        "surfaces/igea.ply",
        134_345,
        &[],
        [-0.0346, -0.0497, -0.0495],
        [0.0346, 0.0497, 0.0495],
        6e-5,
    ),
    (
        "surfaces/originals/bun_zipper_ascii.ply",
        35_947,
        &["confidence", "intensity"],
        [-0.0947, 0.0330, -0.0619],
        [0.0610, 0.1873, 0.0588],
        6e-5,
    ),
    (
        "surfaces/originals/horse_big_endian.ply",
        48_485,
        &["confidence"],
        [-0.0420, -0.0917, -0.0764],
        [0.0420, 0.0917, 0.0764],
        6e-5,
    ),
    (
        "scans/lone_star.ply",
        518_862,
        &["intensity"],
        [0.602, 0.364, 0.896],
        [33.043, 41.124, 16.576],
        6e-4,
    ),
    (
        "scans/autzen_trim.las",
        110_000,
        LAS,
        [636_001.76, 848_935.20, 406.26],
        [637_179.22, 849_497.90, 520.51],
        1e-9,
    ),
    (
        "scans/autzen_trim.laz",
        110_000,
        LAS,
        [636_001.76, 848_935.20, 406.26],
        [637_179.22, 849_497.90, 520.51],
        1e-9,
    ),
    ("scans/office1.pcd", 254_456, &[], [-2.645, -2.196, 1.833], [1.504, 1.581, 5.364], 6e-4),
    ("scans/milk_color.pcd", 13_704, &[], [-0.140, -0.264, 0.714], [0.014, -0.012, 0.891], 6e-4),
    (
        "scans/bunny_float.e57",
        30_571,
        &[],
        [-0.0947, 0.0400, -0.0619],
        [0.0610, 0.1873, 0.0588],
        6e-5,
    ),
    ("scans/tiny_rgb.e57", 2_090, &[], [-9.780, 4.514, 295.525], [-6.774, 7.515, 298.532], 6e-4),
    ("scans/pond.ply", 70_051, &["psz"], [-1.502, 0.571, -2.632], [1.976, 1.092, 0.510], 6e-4),
    (
        "volumes/lox_post.ply",
        109_744,
        &["pressure", "speed"],
        [-14.987, -14.997, 0.0],
        [15.000, 14.997, 4.821],
        6e-4,
    ),
    (
        "volumes/combustor.ply",
        47_025,
        &["density", "speed"],
        [0.0, -5.662, 23.331],
        [16.510, 5.662, 36.195],
        6e-4,
    ),
    (
        "volumes/blunt_fin.ply",
        40_960,
        &["density", "energy", "speed"],
        [-7.816, 0.0, 0.0],
        [14.362, 8.328, 5.724],
        6e-4,
    ),
    (
        "volumes/disk_out.ply",
        8_499,
        &["temp", "pres", "speed"],
        [-5.75, -5.75, -10.0],
        [5.75, 5.75, 10.16],
        6e-3,
    ),
    (
        "volumes/sph_shock.ply",
        20_736,
        &["density", "h", "u"],
        [-0.4961, -0.1601, -0.1467],
        [0.4922, 0.1601, 0.1467],
        6e-5,
    ),
    (
        "volumes/sph_mhd.ply",
        4_843,
        &["density", "h", "speed", "bmag"],
        [-7.633, -7.777, -7.333],
        [7.662, 7.778, 7.333],
        6e-4,
    ),
    (
        "volumes/sph_hilbert.ply",
        46_843,
        &["density"],
        [-1.199, -1.198, 0.073],
        [1.200, 1.193, 2.471],
        6e-4,
    ),
    (
        "volumes/sph_dam_break.ply",
        24_389,
        &["density"],
        [-1.513, 0.031, -0.764],
        [1.516, 3.966, 0.766],
        6e-4,
    ),
    ("volumes/ironprot_100k.ply", 100_000, &["density"], [0.0; 3], [67.0; 3], 0.0),
    (
        "terrain/puget_512.ply",
        262_144,
        &[],
        [0.0, 320.0, 0.0],
        [163_520.0, 163_840.0, 4372.6],
        6e-2,
    ),
    (
        "terrain/rainier_256.ply",
        65_536,
        &[],
        [108_000.0, 58_880.0, 363.7],
        [148_800.0, 99_680.0, 4379.8],
        6e-2,
    ),
];

#[test]
fn collected_files_have_the_counts_and_boxes_of_their_list() {
    let Some(data) = data("collected_files_have_the_counts_and_boxes_of_their_list") else {
        return;
    };
    for (name, points, attributes, min, max, tolerance) in ROWS {
        let set = read(&data.join(name)).unwrap();
        let dropped = if name == "scans/office1.pcd" { 52_744 } else { 0 };
        assert_eq!((set.len(), set.dropped()), (points, dropped), "{name}");
        let names: Vec<&str> = set.attributes.iter().map(|a| a.name.as_str()).collect();
        assert_eq!(names, attributes, "{name}");
        let (found_min, found_max) = set.bounds().unwrap();
        for (found, listed) in found_min.iter().chain(&found_max).zip(min.iter().chain(&max)) {
            assert!((found - listed).abs() <= tolerance, "{name}: {found} is not {listed}");
        }
        let colored = ["terrain", "pond", "_big", "autzen", ".pcd", "rgb"]
            .iter()
            .any(|part| name.contains(part));
        assert_eq!(set.colors.is_some(), colored, "{name}");
        assert_eq!(set.normals.is_some(), name.contains("pond"), "{name}");
    }
}

#[test]
fn no_collected_file_is_left_out() {
    let Some(data) = data("no_collected_file_is_left_out") else { return };
    let mut names = Vec::new();
    for folder in ["surfaces", "surfaces/originals", "scans", "volumes", "terrain"] {
        for entry in std::fs::read_dir(data.join(folder)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            let points = [".ply", ".las", ".laz", ".pcd", ".e57"];
            if points.iter().any(|end| name.ends_with(end)) {
                names.push(format!("{folder}/{name}"));
            }
        }
    }
    for name in &names {
        assert!(ROWS.iter().any(|row| row.0 == name), "{name} is not in the list");
    }
    assert_eq!(names.len(), ROWS.len());
}

/// The collection holds two models twice: as text or big-endian, and converted to little-endian.
#[test]
fn conversions_equal_their_originals() {
    let Some(data) = data("conversions_equal_their_originals") else { return };
    for (a, b) in [
        ("surfaces/bunny.ply", "surfaces/originals/bun_zipper_ascii.ply"),
        ("surfaces/horse.ply", "surfaces/originals/horse_big_endian.ply"),
    ] {
        let [a, b] = [a, b].map(|name| read(&data.join(name)).unwrap());
        assert!(a.positions == b.positions);
    }
}

#[test]
fn ranges_are_those_of_the_list() {
    let Some(data) = data("ranges_are_those_of_the_list") else { return };
    for (file, attribute, min, max, tolerance) in [
        ("scans/lone_star.ply", "intensity", 17.0, 2744.0, 0.0),
        ("volumes/lox_post.ply", "pressure", -0.5415, 4.3958, 6e-5),
        ("volumes/combustor.ply", "speed", 0.0, 1528.9, 6e-2),
        ("volumes/ironprot_100k.ply", "density", 0.0, 255.0, 0.0),
    ] {
        let summary = PointSummary::of(&read(&data.join(file)).unwrap()).to_json();
        let range = &summary["attributes"][attribute];
        let found = ["min", "max"].map(|end| range[end].as_f64().unwrap());
        assert!((found[0] - min).abs() <= tolerance, "{file}: {found:?}");
        assert!((found[1] - max).abs() <= tolerance, "{file}: {found:?}");
    }
}

#[test]
fn other_kinds_of_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let error_of = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        read(&path).unwrap_err().to_string()
    };
    let wood = error_of("c", b"plywood");
    assert!(wood.contains("begins with 'plywood', expected a point file (PLY"), "{wood}");
    assert!(error_of("c.ply", b"plywood").contains("c.ply:1: found 'plywood'"));
    assert!(error_of("d.ply", b"").contains("d.ply: the file is empty"));
    assert!(error_of("e.ply", b"ply").contains("e.ply:2: found the end of the file"));

    let missing = read(&folder.path().join("none.ply")).unwrap_err();
    assert!(matches!(&missing, PointsError::Io { .. }) && missing.to_string().contains("none.ply"));
    assert!(matches!(read(folder.path()), Err(PointsError::IsFolder { .. })));
}

/// Contents count, not names.
#[test]
fn points_are_read_whatever_the_file_is_called() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("points.txt");
    let text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
                property float z\nproperty uchar density\nend_header\n1 2 3 4\n";
    std::fs::write(&path, text).unwrap();
    let set = read(&path).unwrap();
    assert_eq!(set.positions, [[1.0, 2.0, 3.0]]);
    assert_eq!(set.attribute("density"), Some(&Values::U8(vec![4])));
    assert_eq!(set.attribute("Density"), None);
}
