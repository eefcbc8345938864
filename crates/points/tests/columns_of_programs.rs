//! What columns mean in the tables that people had trouble with.

#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use points::PointSet;
use std::path::PathBuf;

/// The collected point sets, where `POINTILLIST_DATA` names their folder.
fn data(test: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("POINTILLIST_DATA").map(PathBuf::from);
    if let Some(folder) = folder.filter(|folder| folder.is_dir()) {
        return Some(folder.join("reported"));
    }
    let line =
        format!("SKIPPED: {test}: POINTILLIST_DATA names no folder of collected point sets\n");
    std::io::Write::write_all(&mut std::io::stderr(), line.as_bytes()).expect("stderr");
    None
}

fn names(set: &PointSet) -> Vec<&str> {
    set.attributes.iter().map(|attribute| attribute.name.as_str()).collect()
}

#[test]
fn reported_tables_are_read_as_they_are_meant() {
    let Some(folder) = data("reported_tables_are_read_as_they_are_meant") else { return };
    let read = |name: &str| {
        points::read(&folder.join(name), &mut |_, _| ()).unwrap_or_else(|e| panic!("{e}"))
    };
    let red = [200, 40, 20].map(|byte| points::ColorEncoding::Srgb8.decode(byte.into()));
    for (name, attributes) in [
        ("min_s3dis.txt", &["label"][..]),
        ("min_rgba.txt", &["alpha"]),
        ("min_stpls3d.txt", &["label", "column_8"]),
    ] {
        let set = read(name);
        let colors = set.colors.as_ref().expect("colours");
        assert!(colors.iter().all(|&color| color == red), "{name}: {:?}", colors[0]);
        assert_eq!((set.len(), names(&set)), (500, attributes.to_vec()), "{name}");
        assert_eq!(set.notes.len(), 1, "{name}: {:?}", set.notes);
    }
    let survey = read("min_pnezd.csv");
    assert_eq!(survey.positions[0], [499_999.411, 4_600_000.229, 109.98]);
    assert_eq!(names(&survey), ["point_number"]);
    assert_eq!(survey.notes.len(), 1);
    let model = read("min_colmap.txt");
    assert_eq!(model.positions[1], [2.01848, 0.108877, -0.0260841]);
    assert_eq!(names(&model), ["POINT3D_ID", "ERROR"]);
    assert!(model.colors.is_some() && model.notes.is_empty());
    let plane = read("t_cfdpost.csv");
    assert_eq!(plane.positions[0], [0.0093557, -0.024063, 0.999667]);
    assert_eq!(names(&plane), ["Pressure [ Pa ]", "Velocity [ m s^-1 ]"]);
    for plain in ["min_outlier.xyz", "min_degrees.csv", "min_nan.csv", "floaters20.npy"] {
        let notes = read(plain).notes;
        assert!(!notes.iter().any(|note| note.contains("taken for")), "{plain}: {notes:?}");
    }
}
