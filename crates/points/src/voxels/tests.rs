//! Tests of means in cubes: closed forms, and the same from a file and from a set.

use super::*;
use crate::filter::Filter;
use crate::options::ReadOptions;
use crate::read::read_bytes;
use crate::set::ColorEncoding;
use crate::summary::{PointSummary, summarize};
use crate::watch::Unwatched;
use std::path::Path;

fn attribute(name: &str, values: Values) -> Attribute {
    Attribute { name: name.to_owned(), values }
}

/// Points on the x axis, so that their cubes are parts of a line.
fn line(x: &[f64]) -> PointSet {
    PointSet {
        positions: x.iter().map(|&x| [x, 0.0, 0.0]).collect(),
        file_index: (0..x.len() as u32).map(|i| 10 * i).collect(),
        ..PointSet::default()
    }
}

#[test]
fn numbers_are_means_and_classes_the_most_frequent() {
    let set = PointSet {
        colors: Some(vec![[0.0, 0.25, 1.0], [1.0, 0.25, 0.0], [f32::NAN; 3], [0.5; 3]]),
        attributes: vec![
            attribute("Classification", Values::U8(vec![6, 2, 2, 9])),
            attribute("scalar_class", Values::F32(vec![6.0, 2.0, f32::NAN, f32::NAN])),
            attribute("return number", Values::F64(vec![3.0, 3.0, 1.0, 2.0])),
            attribute("intensity", Values::U16(vec![10, 11, 11, 7])),
            attribute("flags", Values::I8(vec![-1, -2, -3, 5])),
            attribute("t", Values::F32(vec![1.0, f32::NAN, 4.0, f32::NAN])),
        ],
        filtered_out: 5,
        ..line(&[0.25, 1.5, 0.75, 2.0])
    };
    let means = voxel_means(&set, 2.0, 1);
    assert_eq!(means.positions, [[2.5 / 3.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
    assert_eq!(means.file_index, [0, 30]);
    assert_eq!(means.colors, Some(vec![[0.5, 0.25, 0.5], [0.5; 3]]));
    assert_eq!((means.filtered_out, means.in_file()), (7, set.in_file()));
    let values = |name: &str| -> Vec<f64> { means.attribute(name).unwrap().iter().collect() };
    assert_eq!(values("Classification"), [2.0, 9.0]);
    // Of several that come equally often, the smallest; of none, no number.
    assert_eq!(values("scalar_class")[0], 2.0);
    assert!(values("scalar_class")[1].is_nan());
    assert_eq!(values("return number"), [3.0, 2.0]);
    // 32/3 is rounded.
    assert_eq!(values("intensity"), [11.0, 7.0]);
    assert_eq!(values("flags"), [-3.0, 5.0]);
    assert_eq!(values("t")[0], 2.5);
    assert!(values("t")[1].is_nan());
}

#[test]
fn normals_turn_to_one_side_and_then_to_that_of_most() {
    let of = |normals: &[[f32; 3]]| {
        let x: Vec<f64> = normals.iter().map(|_| 0.5).collect();
        let set = PointSet { normals: Some(normals.to_vec()), ..line(&x) };
        voxel_means(&set, 1.0, 1).normals.unwrap()[0]
    };
    assert_eq!(of(&[[0.0, 0.0, 2.0], [0.0, 0.0, -7.0], [0.0, 0.0, -1.0]]), [0.0, 0.0, -1.0]);
    assert_eq!(of(&[[0.0; 3], [f32::NAN; 3], [0.0, 3.0, 0.0]]), [0.0, 1.0, 0.0]);
    // As long as another, a normal counts as much.
    let [x, y, _] = of(&[[9.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!((x, x), (y, 0.5f64.sqrt() as f32));
    assert_eq!(of(&[[0.0; 3]]), [0.0; 3]);
}

#[test]
fn cubes_of_few_points_are_left_out() {
    let set = line(&[0.1, 5.0, 0.2, 0.3, 5.5, -0.1]);
    let means = voxel_means(&set, 1.0, 2);
    assert_eq!((means.len(), means.file_index.as_slice(), means.in_file()), (2, &[0, 10][..], 6));
    assert_eq!(voxel_means(&set, 1.0, 4).len(), 0);
}

/// Neither offset nor scale costs a digit of a point that is by itself, and means lie within their cubes.
#[test]
fn large_offsets_and_far_points_keep_their_digits() {
    let x = [4_912_345.678_912_3, -1e300, 1e15 + 0.125, f64::MAX, 1e-300, -0.0];
    for edge in [1e-12, 0.1, 1e-5] {
        let means = voxel_means(&line(&x), edge, 1);
        let found: Vec<f64> = means.positions.iter().map(|p| p[0]).collect();
        // The last two are in one cube, whose mean is half of the first.
        assert_eq!(found[..4], x[..4], "{edge}");
        assert_eq!(found[4..], [0.5e-300], "{edge}");
    }
    let base = 4_900_000.0;
    let means = voxel_means(&line(&[base + 0.01, base + 0.03, base + 0.11]), 0.1, 1);
    assert_eq!(means.len(), 2);
    // 1e-9 is a step of f64 there.
    assert!((means.positions[0][0] - base - 0.02).abs() <= 1e-9);
}

/// What stands in a file as PLY, with colours of the type and of values up to `full`.
fn ply(kind: &str, full: f64) -> String {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex 300\nproperty float x\nproperty float y\nproperty float z\n\
         property {kind} red\nproperty {kind} green\nproperty {kind} blue\nproperty float nx\nproperty float ny\n\
         property float nz\nproperty uchar label\nproperty float t\nend_header\n"
    );
    for i in 0..300u32 {
        // Numbers that look random.
        let [a, b, c, d] =
            [7919, 104_729, 1_299_709, 15_485_863].map(|p: u64| (u64::from(i) * p % 1009) as u32);
        let t = if i % 7 == 0 { "nan".to_owned() } else { (b as f64 / 8.0).to_string() };
        let color = [a, b, c].map(|v| match kind {
            "float" => (f64::from(v) / 1008.0 * full).to_string(),
            _ => (f64::from(v) / 1008.0 * full).round().to_string(),
        });
        let position = [b, c, d].map(|v| (f64::from(v) / 100.0).to_string());
        text += &format!(
            "{} {} {} {} {} {t}\n",
            position.join(" "),
            color.join(" "),
            f64::from(a) - 500.0,
            c,
            format_args!("1 {}", d % 5)
        );
    }
    text
}

/// A filter sees stored colours before it is known what they mean.
#[test]
fn a_filter_makes_the_means_of_the_whole_file() {
    let all = ReadOptions::default();
    let edge = 3.0;
    let filter = Filter { voxel: Some(Voxel::Edge(edge)), ..Filter::default() };
    let means = ReadOptions { filter, ..ReadOptions::default() };
    for (kind, full, encoding) in [
        ("uchar", 255.0, ColorEncoding::Srgb8),
        ("ushort", 255.0, ColorEncoding::Srgb8),
        ("ushort", 65535.0, ColorEncoding::Srgb16),
        ("float", 1.0, ColorEncoding::Fraction),
        ("float", 255.0, ColorEncoding::Fraction255),
        ("float", 65535.0, ColorEncoding::Fraction65535),
    ] {
        let text = ply(kind, full);
        let read = |options| read_bytes(text.as_bytes(), Path::new("a.ply"), options).unwrap();
        let (whole, found) = (read(&all), read(&means));
        assert_eq!(whole.color_encoding, Some(encoding));
        let expected = voxel_means(&whole, edge, 1);
        assert!(expected.len() > 20 && expected.len() < 200, "{}", expected.len());
        // NaN differs from itself.
        assert_eq!(format!("{found:?}"), format!("{expected:?}"), "{kind} to {full}");
    }
}

/// `summarize` holds no points but the cubes, and sees stored colours.
#[test]
fn a_summary_of_means_is_that_of_the_set() {
    let path = std::env::temp_dir().join(format!("voxels-{}.ply", std::process::id()));
    std::fs::write(&path, ply("uchar", 255.0)).unwrap();
    for voxel in [Voxel::Edge(3.0), Voxel::Auto] {
        let filter = Filter { voxel: Some(voxel), ..Filter::default() };
        let options = ReadOptions { filter, ..ReadOptions::default() };
        let set = crate::read::read_with(&path, &options, &mut |_, _| ()).unwrap();
        let summary = summarize(&path, &options, &Unwatched).unwrap();
        assert_eq!(summary, PointSummary::of(&set), "{voxel:?}");
        assert_eq!(summary.points + summary.filtered_out, 300);
    }
    std::fs::remove_file(&path).unwrap();
}

/// A square of a lattice, with a corner where points are ten times as near.
#[test]
fn an_automatic_edge_is_twice_the_median_distance() {
    let mut text = String::new();
    for (step, side) in [(1.0, 40), (0.1, 20)] {
        for i in 0..side * side {
            let [x, y] = [i % side, i / side].map(|n| f64::from(n) * step + 0.01);
            text += &format!("{x},{y},0.0\n");
        }
    }
    let filter = Filter { voxel: Some(Voxel::Auto), ..Filter::default() };
    let options = ReadOptions { filter, ..ReadOptions::default() };
    let set = read_bytes(text.as_bytes(), Path::new("a.csv"), &options).unwrap();
    assert_eq!((set.len(), set.in_file()), (400, 2000));
    let note = "voxel = \"auto\" takes cubes of 2.000e0, twice the median distance of points";
    assert_eq!(set.notes, [note]);
    // Points in one place have no distance.
    let set = read_bytes(b"1,2,3\n1,2,3\n", Path::new("a.csv"), &options).unwrap();
    assert_eq!((set.positions, set.notes), (vec![[1.0, 2.0, 3.0]], vec![]));
}
