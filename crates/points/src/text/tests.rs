//! Tables as programs and people write them, and what can be wrong with them.

use crate::error::PointsError;
use crate::options::ReadOptions;
use crate::read::read_bytes;
use crate::set::{ColorEncoding, PointSet, Values};
use std::path::Path;

fn read_as(name: &str, text: &[u8]) -> Result<PointSet, PointsError> {
    read_bytes(text, Path::new(name), &ReadOptions::default())
}

fn read(text: impl AsRef<[u8]>) -> PointSet {
    read_as("a.txt", text.as_ref()).unwrap_or_else(|error| panic!("{error}"))
}

fn message(text: impl AsRef<[u8]>) -> String {
    read_as("a.txt", text.as_ref()).unwrap_err().to_string()
}

fn names(set: &PointSet) -> Vec<&str> {
    set.attributes.iter().map(|attribute| attribute.name.as_str()).collect()
}

fn bytes(color: [u8; 3]) -> [f32; 3] {
    color.map(|byte| ColorEncoding::Srgb8.decode(byte.into()))
}

#[test]
fn separators_comments_and_line_ends_do_not_matter() {
    let expected = [[1.0, -2.5, 3000.0], [4.0, 0.5, 6.0]];
    for text in [
        "1 -2.5 3e3\n4 .5 6\n",
        "  1\t-2.5   3E+3  \n\n\n4\t.5 6.",
        "1,-2.5,3e3\r\n4,0.5,6\r\n",
        "1, -2.5, 3e3,\n4, 0.5, 6,\n",
        "1;-2.5;3e3\n4;0.5;6",
        "1;-2,5;3000,0\n4;0,5;6,0",
        "1,0 -2,5 3000,0\n4,0 0,5 6,0",
        "1\t-2,5\t3e3\n4\t0,5\t6\n",
        "1|-2.5|3e3\n4|0.5|6\n",
        "\u{feff}1 -2.5 3e3\n4 0.5 6\n",
        "1 -2.5 3e3\r4 0.5 6\r",
        "# one\n// two\n% three\n1 -2.5 3e3 # four\n# five\n4 0.5 6 // six\n",
        "\"1\",\"-2.5\",\"3e3\"\n\"4\",\"0.5\",\"6\"\n",
        "x y z\n1 -2.5 3e3\n4 0.5 6\n",
        "\"X [m]\";\"Y [m]\";\"Z [m]\"\r\n1;-2,5;3000\r\n4;0,5;6\r\n",
        "//X Y Z\n1 -2.5 3e3\n4 0.5 6\n",
        "# x, y, z\n1, -2.5, 3e3\n4, 0.5, 6\n",
        "2\n1 -2.5 3e3\n4 0.5 6\n",
        "1\n1 -2.5 3e3\n1\n4 0.5 6\n",
        "//X Y Z\n2\n1 -2.5 3e3\n4 0.5 6\n",
        "2\nwater, or what is left of it\nH 1 -2.5 3e3\nO 4 0.5 6\n",
        "1D0 -2.5d0 3D+3\n4 0.5 6\n",
    ] {
        for name in ["a.txt", "a"] {
            if name == "a" && text.contains("water") {
                continue; // only its extension tells
            }
            let set = read_as(name, text.as_bytes()).unwrap_or_else(|e| panic!("{text:?}: {e}"));
            assert_eq!(set.positions, expected, "{text:?}");
            assert!(set.attributes.is_empty() && set.colors.is_none(), "{text:?}");
        }
    }
}

/// Spreadsheets and pandas write what is not a number as nothing.
#[test]
fn a_value_may_be_missing_at_the_end_of_the_first_line() {
    let last = |text: &str, name: &str| -> Vec<f64> {
        let set = read(text);
        assert_eq!(set.positions[0], [1.0, 2.0, 3.0], "{text:?}");
        set.attribute(name).map_or(Vec::new(), |values| values.iter().collect())
    };
    let named = last("x,y,z,t\n1,2,3,\n4,5,6,\n7,8,9,0.5\n", "t");
    assert!(named[0].is_nan() && named[1].is_nan() && named[2] == 0.5, "{named:?}");
    let all = last(&format!("x;y;z;t\n{}", "1;2;3;\n".repeat(1500)), "t");
    assert!(all.len() == 1500 && all.iter().all(|value| value.is_nan()));
    let placed = last("1,2,3,\n4,5,6,10\n7,8,9,11.5\n", "intensity");
    assert!(placed[0].is_nan() && placed[1..] == [10.0, 11.5], "{placed:?}");
    let after_preamble = "Export of a survey\nDate: 2024\n\nx,y,z,t\n1,2,3,\n4,5,6,2\n";
    assert_eq!(last(after_preamble, "t")[1], 2.0);
    // Else a separator at the end separates nothing.
    assert!(read("x,y,z\n1,2,3,\n4,5,6,\n").attributes.is_empty());
    assert!(read("1,2,3,\n4,5,6,\n").attributes.is_empty());
}

#[test]
fn columns_go_by_their_names_in_any_order() {
    let set = read(
        "Intensity,Blue,NZ,northing,G,z,R,label,Time,ny,Easting,nx,class\n\
         7,3,1,20,2,30,1,tree,0.1,0,10,0,2\n8,6,0,50,5,60,4,\"a, b\",,1,40,0,\n",
    );
    assert_eq!(set.positions, [[10.0, 20.0, 30.0], [40.0, 50.0, 60.0]]);
    // `Blue`, `G` and `R` are of no common set.
    assert_eq!(names(&set), ["intensity", "Blue", "G", "R", "Time", "classification"]);
    assert_eq!(set.normals, Some(vec![[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]));
    let time = set.attribute("Time").unwrap();
    assert!(time.get(0) == 0.1 && time.get(1).is_nan());
    assert_eq!(
        set.format,
        "text, separated by commas, names in line 1; left out for being text: label"
    );
}

/// A header of CloudCompare, with its count below.
#[test]
fn headers_behind_comment_signs_are_read() {
    let set = read("//X Y Z R G B Scalar_field Nx Ny Nz\n1\n1 2 3 255 0 10 0.25 0 0 1\n");
    assert_eq!(set.colors, Some(vec![bytes([255, 0, 10])]));
    assert_eq!(set.normals, Some(vec![[0.0, 0.0, 1.0]]));
    assert_eq!(set.attribute("Scalar_field"), Some(&Values::F64(vec![0.25])));
    assert_eq!(set.format, "text, separated by blanks, names in line 1");
}

#[test]
fn headers_of_paraview_are_read() {
    let set = read(
        "\"Points:0\",\"Points:1\",\"Points:2\",\"Normals:0\",\"Normals:1\",\"Normals:2\",\"pressure\"\n\
         1,2,3,0,0,1,9.5\n",
    );
    assert_eq!(set.positions, [[1.0, 2.0, 3.0]]);
    assert_eq!(set.normals, Some(vec![[0.0, 0.0, 1.0]]));
    assert_eq!(names(&set), ["pressure"]);
}

#[test]
fn columns_without_names_are_what_they_look_like() {
    let set = read("3\n1 2 3 -2000 255 0 10\n4 5 6 -1999 0 0 0\n7 8 9 5 1 2 3\n");
    assert_eq!(set.positions.len(), 3);
    assert_eq!(names(&set), ["intensity"]);
    assert_eq!(set.color_encoding, Some(ColorEncoding::Srgb8));
    assert_eq!(set.colors.as_ref().unwrap()[0], bytes([255, 0, 10]));
    assert_eq!(
        set.format,
        "text, separated by blanks, no names; taken for x y z intensity red green blue, judging \
         by 3 rows"
    );
    let set = read("1 2 3 0.6 0 0.8\n");
    assert_eq!(set.normals, Some(vec![[0.6, 0.0, 0.8]]));
    assert!(set.format.ends_with("taken for x y z nx ny nz, judging by the first row"));
    let set = read("1 2 3 0.5 0 1.0\n");
    assert_eq!(set.color_encoding, Some(ColorEncoding::Fraction));
}

/// What the first rows look like does not decide between 8 and 16 bits.
#[test]
fn colors_of_16_bits_are_told_by_the_whole_file() {
    let dark = "0 0 0 10 20 30\n".repeat(100_000);
    assert_eq!(read(&dark).color_encoding, Some(ColorEncoding::Srgb8));
    let set = read(dark + "0 0 0 65535 20 30\n");
    assert_eq!(set.color_encoding, Some(ColorEncoding::Srgb16));
    assert_eq!(set.colors.unwrap()[100_000][0], 1.0);
}

#[test]
fn survey_coordinates_keep_their_digits() {
    let set = read("636001.7612345678 4918340.001 -0.0000001\n1e300 5e-324 -0\n");
    assert_eq!(set.positions[0], [636_001.761_234_567_8, 4_918_340.001, -1e-7]);
    assert_eq!(set.positions[1], [1e300, 5e-324, 0.0]);
}

#[test]
fn rows_that_are_not_finite_are_dropped_and_counted() {
    let set = read("x,y,z,i\nnan,1,2,3\n,1,2,3\n1,inf,2,3\n1,2,-1.#IND,3\n1,2,3,\n1,2,3,NA\n");
    assert_eq!((set.len(), set.non_finite), (2, 4));
    assert_eq!(set.file_index, [4, 5]);
    assert!(set.attribute("intensity").unwrap().iter().all(f64::is_nan));
}

#[test]
fn many_rows_are_read_whole() {
    let mut text = String::from("x,y,z\n");
    for i in 0..200_000 {
        text += &format!("{i}.5,{},3\n", -i);
    }
    let mut told = Vec::new();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    std::fs::write(&path, &text).unwrap();
    let set = crate::read::read(&path, &mut |read, length| told.push((read, length))).unwrap();
    assert_eq!(set.len(), 200_000);
    assert_eq!(set.positions[199_999], [199_999.5, -199_999.0, 3.0]);
    assert!(told.is_sorted() && told.len() >= 2);
    assert_eq!(told.last(), Some(&(text.len() as u64, text.len() as u64)));
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    for (text, expected) in [
        (
            "1 2 3\n4 5\n",
            "a.txt:2: found 2 values, expected 3 values as in line 1; correct the line or export \
             the file again",
        ),
        ("1 2 3\n\n4 5 6 7\n", "a.txt:3: found 4 values, expected 3 values as in line 1"),
        ("# a\n1 2 3\n4 5 6\n7 x 9\n", "a.txt:4: found 'x', expected a number for 'y', column 2"),
        ("x,y,z,name\n1,2,3,a\n1,2,c,b\n", "a.txt:3: found 'c', expected a number for 'z'"),
        ("1,2,3\n1,2,3,4\n", "a.txt:2: found 4 values, expected 3 values as in line 1"),
        (
            "x y z\n1 2 3 4\n",
            "a.txt:1: found 3 names, expected 4, as line 2 has 4 values; name every column",
        ),
        (
            "a b c\n1 2 3\n",
            "a.txt: found no number 'x', expected it among the fields of a point \
          ('a', 'b', 'c')",
        ),
        ("1 2\n3 4\n", "a.txt:1: found '1 2', expected 3 numbers or more: x y z"),
        (
            "hello there\nnot a number\n",
            "a.txt:2: found 'not a number', expected 3 numbers or more",
        ),
        ("hello\n", "a.txt:1: found only names of columns, expected lines with x y z"),
        ("x y z\n", "a.txt: the file holds no points"),
        ("X,\"Y\",Z,intensity\n", "a.txt: the file holds no points"),
        ("0\n", "a.txt: the file holds no points"),
        ("# nothing\n\n", "a.txt:1: found no line of numbers, expected lines with x y z"),
        ("\n", "a.txt:1: found no line of numbers"),
        ("12\n", "a.txt:1: found only a count"),
        (
            "5\n1 2 3\n4 5 6\n",
            "a.txt: the header declares 5 points, but the file ends after 2; the file is cut off \
             or its header wrong: copy or export it again",
        ),
        (
            "99999999999999999\n1 2 3\n",
            "declares 99999999999999999 points, but the file ends after 1",
        ),
        (
            "10\n20\n0 0 0\n1 0 0\n",
            "a.txt:2: found a second line with a single number, 20, expected points: x y z on \
             each line; correct the line, or export the points as PTS or E57",
        ),
        ("nan nan nan\n", "found no usable point: 1 in the file, 1 of them dropped"),
        ("1 2 3\n4 5 1,234.5\n7 8 9\n", "a.txt:2: found '1,234.5', expected a number for 'z'"),
        ("1 2 3\n\0\0\0\n", "a.txt:2: found '\\0\\0\\0', expected a line of text with x y z"),
    ] {
        let found = message(text);
        assert!(found.contains(expected), "{text:?}: {found}");
    }
    let utf_16 = message(b"\xff\xfe1\0 \x002\0");
    assert_eq!(
        utf_16,
        "a.txt:1: found UTF-16, expected text of 8-bit characters; save it as UTF-8"
    );
    // A second scan whose count is beyond what is there.
    assert!(
        message("1\n1 2 3\n4\n4 5 6\n").contains("declares 5 points, but the file ends after 2")
    );
}

#[test]
fn lines_and_tables_without_measure_end_quickly() {
    let long = message("1 2 3\n".to_owned() + &"1 ".repeat(2_000_000));
    assert!(
        long.contains("a.txt:2: found more than 1048576 bytes, expected a shorter line"),
        "{long}"
    );
    let first = message("1 ".repeat(2_000_000));
    assert!(first.contains("a.txt:1: found "), "{first}");
    let wide = message("1 ".repeat(1001));
    assert!(wide.contains("a.txt:1: found 1001 columns, expected at most 1000"), "{wide}");
    assert_eq!(read("1 ".repeat(1000)).attributes.len(), 997);
    let quotes = message("1 2 3\n".to_owned() + &"\"".repeat(1_000_000));
    assert!(quotes.contains("a.txt:2: found "), "{quotes}");
}

/// By contents, whatever the name; and what is no table is left to other formats.
#[test]
fn tables_are_told_from_other_text() {
    for (text, is_table) in [
        ("1 2 3", true),
        ("x,y,z\n1,2,3", true),
        ("id,x,y,z\na,1,2,3\n", true),
        ("# made by hand\n\n1 2 3", true),
        ("12\n1 2 3", true),
        ("ply\nformat ascii 1.0\n", false),
        ("OFF\n8 6 0\n0 0 0\n", false),
        ("v 1 2 3\nv 1 2 3\n", false),
        ("<?xml version=\"1.0\"?>\n<a>1 2 3</a>\n", false),
        ("This is text.\nIt has 3 lines.\nNo more.\n", false),
        ("# vtk DataFile Version 3.0\ntitle of it\nASCII\n", false),
        ("1 2\n3 4\n", false),
        ("1 2 3\0", false),
        ("", false),
    ] {
        assert_eq!(super::sniff(text.as_bytes()), is_table, "{text:?}");
    }
}
