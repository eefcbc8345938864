//! Collected files that were refused once, or of which something was lost.

#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use points::{PointSet, PointsError, Values};
use std::path::{Path, PathBuf};

/// A file of the collection; `None` without it.
fn reported(test: &str, name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("POINTILLIST_DATA").map(PathBuf::from);
    let path = folder.map(|folder| folder.join("reported").join(name)).filter(|path| path.exists());
    if path.is_none() {
        // Not eprintln!, which the test runner swallows where a test passes.
        let line =
            format!("SKIPPED: {test}: POINTILLIST_DATA names no folder with reported/{name}\n");
        std::io::Write::write_all(&mut std::io::stderr(), line.as_bytes()).expect("stderr");
    }
    path
}

fn read(path: &Path) -> Result<PointSet, PointsError> {
    points::read(path, &mut |_, _| ())
}

#[test]
fn las_of_version_1_5_is_read() {
    let Some(path) = reported("las_of_version_1_5_is_read", "las15.las") else { return };
    let set = read(&path).unwrap();
    assert_eq!((set.len(), set.format.as_str()), (1000, "LAS 1.5, point format 6"));
    assert!(set.notes.is_empty(), "{:?}", set.notes);
}

#[test]
fn extra_bytes_of_two_records_are_read() {
    let Some(path) = reported("extra_bytes_of_two_records_are_read", "las_two_eb_vlrs.las") else {
        return;
    };
    let set = read(&path).unwrap();
    assert!(matches!(set.attribute("Deviation"), Some(Values::U16(_))));
    assert!(matches!(set.attribute("confidence"), Some(Values::U8(_))));
}

#[test]
fn lzma_of_the_highest_preset_is_read() {
    let Some(path) = reported("lzma_of_the_highest_preset_is_read", "min_lzma9.vtp") else {
        return;
    };
    assert_eq!(read(&path).unwrap().len(), 3);
}

#[test]
fn compressed_splats_are_named() {
    let Some(path) = reported("compressed_splats_are_named", "c03_supersplat.ply") else { return };
    let message = read(&path).unwrap_err().to_string();
    assert!(message.contains("found SuperSplat's compressed PLY, expected"), "{message}");
    assert!(
        message.ends_with("save it as PLY, which SuperSplat and splat-transform do"),
        "{message}"
    );
}

/// 60 by 40 cells of 10 m from (500000, 4600000); its first row is the northern one.
#[test]
fn an_esri_grid_is_a_terrain() {
    let Some(path) = reported("an_esri_grid_is_a_terrain", "c26_dem.asc") else { return };
    let set = read(&path).unwrap();
    assert_eq!(set.len() as u64 + set.invalid, 60 * 40);
    assert_eq!(set.positions[0], [500_005.0, 4_600_395.0, 110.0]);
    assert_eq!(set.up.map(|(up, _)| up), Some(points::Upwards::Z));
    let (min, max) = set.bounds().unwrap();
    assert_eq!((min[0], min[1], max[0]), (500_005.0, 4_600_005.0, 500_595.0));
}
