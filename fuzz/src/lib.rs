//! What the targets share: bytes become a file, and what is read from it keeps its promises.

use points::{PointSet, PointsError, ReadOptions};
use std::path::{Path, PathBuf};

/// A file of these bytes in the folder for temporary files, one a process, written over each time.
///
/// # Panics
/// If it cannot be written.
#[must_use]
pub fn file_of(bytes: &[u8], extension: &str) -> PathBuf {
    let name = format!("pointillist-fuzz-{}.{extension}", std::process::id());
    let path = std::env::temp_dir().join(name);
    std::fs::write(&path, bytes).expect("the folder for temporary files can be written to");
    path
}

/// Reads points, which may fail, but not otherwise than it says. `name` is what the file would be called.
///
/// # Panics
/// If what was read is not what [`PointSet`] promises, or an error has nothing to say.
pub fn read_points(bytes: &[u8], name: &str) {
    match points::read_bytes(bytes, Path::new(name), &ReadOptions::default()) {
        Ok(set) => assert_whole(&set),
        Err(error) => assert_told(&error, name),
    }
}

fn assert_whole(set: &PointSet) {
    let count = set.len();
    assert!(count > 0, "no point and no error");
    assert!(set.positions.as_flattened().iter().all(|x| x.is_finite()), "a position is infinite");
    assert_eq!(set.file_index.len(), count, "file_index");
    assert!(set.file_index.is_sorted_by(|a, b| a < b), "file_index is not in the file's order");
    assert!(set.colors.as_ref().is_none_or(|colors| colors.len() == count), "colors");
    assert_eq!(set.colors.is_some(), set.color_encoding.is_some(), "color_encoding");
    assert!(set.normals.as_ref().is_none_or(|normals| normals.len() == count), "normals");
    for attribute in &set.attributes {
        assert_eq!(attribute.values.len(), count, "attribute '{}'", attribute.name);
    }
    assert!(!set.format.is_empty(), "no format");
}

fn assert_told(error: &PointsError, name: &str) {
    let message = error.to_string();
    // No line of a terminal is longer than what somebody reads.
    assert!(message.len() < 2000, "{} bytes of message", message.len());
    assert!(message.starts_with(name), "the file is not named: {message}");
}

/// The bytes as an E57 file whose pages have the checksums that they should: without them every file that differs
/// from a seed would be refused at once.
#[must_use]
pub fn with_checksums(bytes: &[u8]) -> Vec<u8> {
    const PAGE: usize = 1024;
    let mut file = bytes.to_vec();
    for page in file.chunks_exact_mut(PAGE) {
        let (data, checksum) = page.split_at_mut(PAGE - 4);
        checksum.copy_from_slice(&crc32c(data).to_be_bytes());
    }
    file
}

/// CRC-32C, bit by bit.
fn crc32c(bytes: &[u8]) -> u32 {
    let step = |crc: u32| (crc >> 1) ^ (0x82f6_3b78 & (crc & 1).wrapping_neg());
    !bytes.iter().fold(u32::MAX, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| step(crc)))
}
