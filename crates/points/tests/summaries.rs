//! Summaries of files: the same in passes over a file as of the set that is held.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use points::{PointSummary, PointsError, ReadOptions, Unwatched, summarize};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

fn of_file(path: &Path) -> Result<PointSummary, PointsError> {
    summarize(path, &ReadOptions::default(), &Unwatched)
}

fn of_set(path: &Path) -> Result<PointSummary, PointsError> {
    Ok(PointSummary::of(&points::read(path, &mut |_, _| ())?))
}

fn files_below(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { files_below(&path, files) } else { files.push(path) }
    }
}

/// Whether two summaries are the same. A set holds colours as linear light of 32 bits: their floats come back with
/// seven digits, which may move a value across the end of a part of the histogram.
fn assert_same(mut passes: PointSummary, mut held: PointSummary, name: &str) {
    assert_eq!(passes.attributes.len(), held.attributes.len(), "{name}");
    for (passes, held) in passes.attributes.iter_mut().zip(&mut held.attributes) {
        let is_color = matches!(&*held.0, "red" | "green" | "blue");
        if let (true, Some(a), Some(b)) = (is_color, passes.1.0, held.1.0) {
            for (a, b) in
                [(a.0, b.0), (a.1, b.1), (passes.2.low, held.2.low), (passes.2.high, held.2.high)]
            {
                assert!((a - b).abs() <= 1e-6 * b.abs().max(1.0), "{name}: {a}, not {b}");
            }
            let all = held.2.counts.iter().sum::<u64>();
            assert_eq!(passes.2.counts.iter().sum::<u64>(), all, "{name}");
            for (a, b) in passes.2.counts.iter().zip(held.2.counts) {
                assert!(a.abs_diff(b) <= all / 1000, "{name}: {a}, not {b}");
            }
            (passes.1, passes.2) = (held.1, held.2.clone());
        }
    }
    assert_eq!(passes, held, "{name}");
}

/// Compares the two ways for every file below a folder that can be read; how many those were.
fn same_both_ways(folder: &Path) -> usize {
    let mut files = Vec::new();
    files_below(folder, &mut files);
    let mut compared = 0;
    for path in files {
        match (of_file(&path), of_set(&path)) {
            (Ok(passes), Ok(held)) => {
                assert_same(passes, held, &path.display().to_string());
                compared += 1;
            }
            (Err(passes), Err(held)) => assert_eq!(passes.to_string(), held.to_string()),
            (passes, held) => panic!("{}: {passes:?}, but {held:?}", path.display()),
        }
    }
    compared
}

#[test]
fn passes_over_files_find_what_is_in_the_set() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    // All but the packed archive are of one kind or another that is read.
    assert!(same_both_ways(&data) >= 20);
}

#[test]
fn passes_over_collected_files_find_what_is_in_the_set() {
    let folder = std::env::var_os("POINTILLIST_DATA").map(PathBuf::from);
    let Some(folder) = folder.filter(|folder| folder.is_dir()) else {
        let line = "SKIPPED: passes_over_collected_files_find_what_is_in_the_set: \
                    POINTILLIST_DATA names no folder of collected point sets\n";
        std::io::stderr().write_all(line.as_bytes()).unwrap();
        return;
    };
    assert!(same_both_ways(&folder) >= 25);
}

/// More blocks than one, dropped points in several, colours of bytes in fields of 16 bits, infinite values, and normals that come after the
/// vertices.
#[test]
fn what_depends_on_the_whole_file_is_decided_by_all_blocks() {
    let folder = tempfile::tempdir().unwrap();
    let mut ply = "ply\nformat ascii 1.0\nelement vertex 100000\nproperty float x\nproperty double y\n\
                   property float z\nproperty ushort red\nproperty ushort green\nproperty ushort blue\n\
                   property float a\nproperty short b\nproperty double c\nend_header\n"
        .to_owned();
    let mut obj = String::new();
    for i in 0..100_000 {
        let nothing = if i % 30_000 == 7 { "nan" } else { "1" };
        let bright = if i == 99_999 { 256 } else { i % 250 };
        let c = if i == 5 { "inf".to_owned() } else { (i % 7).to_string() };
        writeln!(ply, "{i} 0.5 {nothing} {} 3 {bright} {}.25 {} {c}", i % 9, i % 40, i % 300 - 7)
            .unwrap();
        writeln!(obj, "v {i} 0.5 {nothing}").unwrap();
    }
    for i in 0..100_000 {
        let x = if i % 30_000 == 7 { 1000 } else { i % 11 };
        writeln!(obj, "vn {x} -3 0.5").unwrap();
    }
    let dark = ply.replace(" 256 ", " 255 ");
    let black = ply.lines().map(|line| {
        let mut words: Vec<&str> = line.split(' ').collect();
        if words.len() == 9 {
            words[3..6].fill("0");
        }
        words.join(" ") + "\n"
    });
    let black: String = black.collect();
    for (name, text) in
        [("a.ply", &ply), ("dark.ply", &dark), ("black.ply", &black), ("a.obj", &obj)]
    {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let (passes, held) = (of_file(&path).unwrap(), of_set(&path).unwrap());
        assert_same(passes.clone(), held, name);
        assert_eq!((passes.points, passes.dropped.non_finite), (99_996, 4), "{name}");
        assert_eq!((passes.spacing, passes.coincident), (Some(1.0), 0), "{name}");
        let range =
            |of: &str| passes.attributes.iter().find(|known| known.0 == of).map(|known| known.1.0);
        match name {
            "a.ply" => assert_eq!(range("blue"), Some(Some((0.0, 256.0)))),
            "dark.ply" => assert_eq!(range("blue"), Some(Some((0.0, 255.0)))),
            "black.ply" => assert_eq!(range("blue"), None),
            _ => assert_eq!(range("nx"), Some(Some((0.0, 10.0)))),
        }
    }
}

/// A first colour after the megabyte that is looked at makes the reader begin again: nothing counts twice, and vertices without a
/// colour have no part in the ranges.
#[test]
fn what_a_reader_reads_again_counts_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    let mut obj = String::new();
    for i in 0..150_000 {
        writeln!(obj, "v {i} 0 0").unwrap();
    }
    obj += "v 150000 0 0 1 0.25 0.5\n";
    std::fs::write(&path, obj).unwrap();
    let summary = of_file(&path).unwrap();
    assert_eq!((summary.points, summary.coincident, summary.spacing), (150_001, 0, Some(1.0)));
    let ranges: Vec<_> =
        summary.attributes.iter().map(|(name, range, _)| (&**name, range.0)).collect();
    let of = |value| Some((value, value));
    assert_eq!(ranges, [("red", of(1.0)), ("green", of(0.25)), ("blue", of(0.5))]);
    assert_eq!(summary.attributes[0].2.counts.iter().sum::<u64>(), 1);
    assert!(summary.notes[0].starts_with("150000 of 150001 vertices"), "{:?}", summary.notes);
}

/// As an OBJ file's, where the second scan of a PTX file is the first with colours.
#[test]
fn scans_that_are_read_again_count_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ptx");
    let head = |points: u32| {
        format!("{points}\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n")
    };
    let mut ptx = head(40_000);
    for i in 0..40_000 {
        writeln!(ptx, "{i}.5 1 0 0.5").unwrap();
    }
    ptx += &head(1);
    ptx += "-0.5 1 0 0.5 10 20 30\n";
    std::fs::write(&path, ptx).unwrap();
    let summary = of_file(&path).unwrap();
    assert_eq!((summary.points, summary.coincident, summary.spacing), (40_001, 0, Some(1.0)));
}

/// What is not the same when it is read again is not summed up with what it was.
#[test]
fn a_file_that_changes_between_the_passes_is_an_error() {
    struct Growing(PathBuf, std::sync::atomic::AtomicU64);
    impl points::Watch for Growing {
        fn stage(&self, _: &'static str, _: u64) {
            use std::sync::atomic::Ordering;
            if self.1.fetch_add(1, Ordering::Relaxed) == 1 {
                let mut file = std::fs::OpenOptions::new().append(true).open(&self.0).unwrap();
                file.write_all(b"1 2 3\n").unwrap();
            }
        }
        fn done(&self, _: u64) {}
        fn interrupted(&self) -> bool {
            false
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.xyz");
    let mut text = String::new();
    // 28 bytes each are more than is held.
    for i in 0..1_300_000 {
        writeln!(text, "{i} 0 0").unwrap();
    }
    std::fs::write(&path, text).unwrap();
    let error =
        summarize(&path, &ReadOptions::default(), &Growing(path.clone(), 0.into())).unwrap_err();
    assert!(error.to_string().contains("changed while it was read"), "{error}");
}
