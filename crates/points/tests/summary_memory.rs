//! A summary's memory does not grow with the file. A test of its own program: whatever ran beside it would count.

use peak_alloc::PeakAlloc;
use points::{ReadOptions, Unwatched, summarize};
use std::io::{BufWriter, Write};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Most memory that a summary takes, whatever the file. docs/point-files.md has the figure.
const MOST_BYTES: usize = 160 << 20;

/// Ten million points of 28 bytes, a tenth of them where the one before is: neither their bytes nor what a set would hold of them
/// fits into what is allowed.
#[test]
fn memory_does_not_grow_with_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.ply");
    let count = 10_000_000u32;
    let mut file = BufWriter::new(std::fs::File::create(&path).unwrap());
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty float x\n\
         property float y\nproperty float z\nproperty float value\nproperty double time\n\
         property ushort kind\nproperty ushort other\nend_header\n"
    )
    .unwrap();
    for i in 0..count {
        // Every tenth is a copy. The others are nodes of a square lattice of edge 0.25.
        let node = i - u32::from(i % 10 == 9);
        let place = [node % 4096, node / 4096].map(|node| node as f32 * 0.25);
        for value in [place[0], place[1], 1.0, (i % 1000) as f32] {
            file.write_all(&value.to_le_bytes()).unwrap();
        }
        file.write_all(&f64::from(i).to_le_bytes()).unwrap();
        for value in [(i % 77) as u16, i as u16] {
            file.write_all(&value.to_le_bytes()).unwrap();
        }
    }
    file.into_inner().unwrap();
    MEMORY.reset_peak_usage();
    let before = MEMORY.current_usage();
    let summary = summarize(&path, &ReadOptions::default(), &Unwatched).unwrap();
    let peak = MEMORY.peak_usage() - before;
    assert!(peak < MOST_BYTES, "{} MB", peak >> 20);

    assert_eq!(summary.points, u64::from(count));
    assert_eq!((summary.min, summary.max), ([0.0, 0.0, 1.0], [1023.75, 610.25, 1.0]));
    // Four nodes of five have a neighbour at 0.25 in their row, and others in the next.
    assert_eq!(summary.spacing, Some(0.25));
    assert!(!summary.coincident_counted);
    // Of the sample's part, a quarter or more, the copies are a tenth: 250 000, give or take 500.
    let copies = summary.coincident as f64 / f64::from(count / 10);
    assert!((copies - 1.0).abs() < 0.01, "{copies}");
    let of = |name: &str| summary.attributes.iter().find(|known| known.0 == name).unwrap();
    assert_eq!(of("time").1.0, Some((0.0, f64::from(count - 1))));
    assert!(of("time").2.counts.iter().all(|&times| times.abs_diff(625_000) <= 1));
    assert_eq!(of("kind").2.counts.iter().sum::<u64>(), u64::from(count));
}
