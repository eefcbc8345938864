//! Files made here: every encoding and type, and what can be wrong with them.

mod gaussians;

use super::*;
use crate::set::{Attribute, ColorEncoding, Values};
use std::io::{Cursor, Read};

const ENCODINGS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

/// One value of a record, in its type.
#[derive(Clone)]
enum Cell {
    I8(i8),
    U8(u8),
    I16(i16),
    U16(u16),
    I32(i32),
    U32(u32),
    F32(f32),
    F64(f64),
    /// A list of floats with a length of type uchar.
    List(Vec<f32>),
}

/// A record in an encoding; text ends with a line feed.
fn record(encoding: &str, cells: &[Cell]) -> Vec<u8> {
    let big = encoding == "binary_big_endian";
    let (mut bytes, mut words) = (Vec::new(), Vec::new());
    macro_rules! put {
        ($value:expr) => {{
            let value = $value;
            words.push(value.to_string());
            bytes.extend(if big { value.to_be_bytes() } else { value.to_le_bytes() });
        }};
    }
    for cell in cells {
        match cell {
            Cell::I8(value) => put!(*value),
            Cell::U8(value) => put!(*value),
            Cell::I16(value) => put!(*value),
            Cell::U16(value) => put!(*value),
            Cell::I32(value) => put!(*value),
            Cell::U32(value) => put!(*value),
            Cell::F32(value) => put!(*value),
            Cell::F64(value) => put!(*value),
            Cell::List(values) => {
                put!(values.len() as u8);
                for value in values {
                    put!(*value);
                }
            }
        }
    }
    if encoding == "ascii" { format!("{}\n", words.join(" ")).into_bytes() } else { bytes }
}

fn read_bytes(bytes: &[u8]) -> Result<PointSet, PointsError> {
    crate::read_bytes(bytes, Path::new("a.ply"), &ReadOptions::default())
}

/// The same where the length of the file is not known.
fn read_pipe(bytes: impl Read) -> Result<PointSet, PointsError> {
    let progress: &mut dyn FnMut(u64, u64) = &mut |_, _| ();
    let source = Source::of_stream(bytes, progress);
    read(source, Path::new("a.ply"), &ReadOptions::default())
}

/// Reads a file given as text, and returns the message of its error.
fn message(text: &str) -> String {
    read_bytes(text.as_bytes()).unwrap_err().to_string()
}

/// An ascii file of float x y z with these lines.
fn ascii(count: &str, lines: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n\
         property float z\nend_header\n{lines}"
    )
}

/// Elements before and after the vertices, lists inside them, every type, odd order, colours,
/// normals, comments.
fn odd_file(encoding: &str, line_end: &str) -> Vec<u8> {
    let header = format!(
        "ply|format {encoding} 1.0|comment made by a test|obj_info odd|element camera 2|property \
         list uchar float view|property short gain|element empty 7|element vertex 3|property \
         double z|property uchar blue|property list uchar float weights|property float nx|property \
         uchar red|property int label|property float y|property uchar green|comment in between|\
         property float ny|property float nz|property uchar alpha|property double x|property \
         float32 temperature|element face 1|property list uchar float corners|end_header|"
    );
    let mut file = header.replace('|', line_end).into_bytes();
    let mut add = |cells: &[Cell]| file.extend(record(encoding, cells));
    add(&[Cell::List(vec![1.0, 2.5]), Cell::I16(-7)]);
    add(&[Cell::List(vec![]), Cell::I16(300)]);
    for i in 0..3u8 {
        let v = f32::from(i);
        add(&[
            Cell::F64(636_001.76 + f64::from(i)),
            Cell::U8(i),
            Cell::List(vec![v; i.into()]),
            Cell::F32(v + 0.1),
            Cell::U8(255),
            Cell::I32(-123_456_789 - i32::from(i)),
            Cell::F32(if i == 1 { f32::NAN } else { 0.1 + v }),
            Cell::U8(128),
            Cell::F32(v + 0.2),
            Cell::F32(v + 0.3),
            Cell::U8(200 + i),
            Cell::F64(-1e300),
            Cell::F32(v * 1e-30),
        ]);
    }
    add(&[Cell::List(vec![0.0, 1.0, 2.0])]);
    file
}

#[test]
fn three_encodings_of_the_same_points_are_equal() {
    for line_end in ["\n", "\r\n"] {
        let [text, little, big] = ENCODINGS.map(|encoding| {
            let set = read_bytes(&odd_file(encoding, line_end)).unwrap();
            PointSet { format: String::new(), ..set }
        });
        assert_eq!(text, little);
        assert_eq!(text, big);

        assert_eq!(text.non_finite, 1);
        assert_eq!(text.file_index, [0, 2]);
        let y = |i: f32| f64::from(0.1 + i);
        assert_eq!(text.positions, [[-1e300, y(0.0), 636_001.76], [-1e300, y(2.0), 636_003.76]]);
        assert_eq!(text.normals, Some(vec![[0.1, 0.2, 0.3], [2.1, 2.2, 2.3]]));
        assert_eq!(text.color_encoding, Some(ColorEncoding::Srgb8));
        let colors = text.colors.as_ref().unwrap();
        let decode = |stored: u8| ColorEncoding::Srgb8.decode(stored.into());
        assert_eq!(colors[..], [[1.0, decode(128), 0.0], [1.0, decode(128), decode(2)]]);
        let attributes = [
            ("label", Values::I32(vec![-123_456_789, -123_456_791])),
            ("alpha", Values::U8(vec![200, 202])),
            ("temperature", Values::F32(vec![0.0, 2e-30])),
        ]
        .map(|(name, values)| Attribute { name: name.to_owned(), values });
        assert_eq!(text.attributes, attributes);
    }
}

#[test]
fn format_is_told_in_words() {
    let words = ENCODINGS.map(|encoding| read_bytes(&odd_file(encoding, "\n")).unwrap().format);
    let expected =
        ["PLY 1.0, ascii", "PLY 1.0, binary little-endian", "PLY 1.0, binary big-endian"];
    assert_eq!(words, expected);
}

/// The last face is not read, so a cut inside it leaves the points whole.
#[test]
fn files_cut_at_any_byte_do_not_panic() {
    for encoding in ENCODINGS {
        let whole = odd_file(encoding, "\n");
        let faces = record(encoding, &[Cell::List(vec![0.0, 1.0, 2.0])]).len();
        // A text ends as well without its last line feed, or with fewer digits of its last value.
        let last = (2e-30f32).to_string();
        let spare = if encoding == "ascii" { last.len() } else { 0 };
        let needed = whole.len() - faces;
        for length in 0..whole.len() {
            let read = read_bytes(&whole[..length]);
            assert!(read.is_err() || length + spare >= needed, "{encoding}, {length} bytes");
            assert!(read.is_ok() || length < needed, "{encoding}, {length} bytes");
        }
    }
}

/// Every byte in turn is replaced by some that mean something; most of these files are damaged.
#[test]
fn files_with_a_wrong_byte_do_not_panic() {
    for encoding in ENCODINGS {
        let whole = odd_file(encoding, "\n");
        for place in 0..whole.len() {
            for byte in *b"\0\xff\x80 9-\n\r" {
                let mut file = whole.clone();
                file[place] = byte;
                let _ = read_bytes(&file);
            }
        }
    }
}

#[test]
fn positions_of_every_type_are_read() {
    let one = [
        ("char", Cell::I8(-5), -5.0),
        ("int8", Cell::I8(127), 127.0),
        ("uchar", Cell::U8(200), 200.0),
        ("uint8", Cell::U8(255), 255.0),
        ("short", Cell::I16(-32_768), -32_768.0),
        ("int16", Cell::I16(5), 5.0),
        ("ushort", Cell::U16(65_535), 65_535.0),
        ("uint16", Cell::U16(5), 5.0),
        ("int", Cell::I32(-2_147_483_648), -2_147_483_648.0),
        ("int32", Cell::I32(5), 5.0),
        ("uint", Cell::U32(4_294_967_295), 4_294_967_295.0),
        ("uint32", Cell::U32(5), 5.0),
        ("float", Cell::F32(1e38), f64::from(1e38f32)),
        ("float32", Cell::F32(-0.1), f64::from(-0.1f32)),
        ("double", Cell::F64(1e300), 1e300),
        ("float64", Cell::F64(-0.1), -0.1),
    ];
    for encoding in ENCODINGS {
        for (name, cell, value) in one.clone() {
            let mut file = format!(
                "ply\nformat {encoding} 1.0\nelement vertex 1\nproperty {name} x\nproperty {name} \
                 y\nproperty {name} z\nend_header\n"
            )
            .into_bytes();
            file.extend(record(encoding, &[cell.clone(), cell.clone(), cell]));
            assert_eq!(read_bytes(&file).unwrap().positions, [[value; 3]], "{encoding}, {name}");
        }
    }
}

#[test]
fn colors_are_decoded_by_their_type() {
    let of = |kind: &str, names: [&str; 3], values: &str| {
        let [r, g, b] = names;
        let file = format!(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty {kind} {r}\nproperty {kind} {g}\n\
             property {kind} {b}\nproperty int x\nproperty int y\nproperty int z\nend_header\n\
             {values} 0 0 0\n"
        );
        let set = read_bytes(file.as_bytes()).unwrap();
        assert!(set.attributes.is_empty());
        set.colors.unwrap()[0]
    };
    // 20 / 255 is on the curved part.
    let byte = ((20.0f64 / 255.0 + 0.055) / 1.055).powf(2.4) as f32;
    let rgb = ["red", "green", "blue"];
    assert_eq!(of("uchar", rgb, "255 0 20"), [1.0, 0.0, byte]);
    assert_eq!(of("uchar", ["diffuse_red", "diffuse_green", "diffuse_blue"], "255 0 20")[2], byte);
    assert_eq!(of("int", ["R", "G", "B"], "255 -1 20"), [1.0, 0.0, byte]);
    assert_eq!(of("int", ["r", "g", "b"], "256 0 20"), [1.0, 0.0, byte]);
    // 5140 / 65535 = 20 / 255
    assert_eq!(of("ushort", rgb, "65535 0 5140"), [1.0, 0.0, byte]);
    let half = ((0.5f64 + 0.055) / 1.055).powf(2.4) as f32;
    assert_eq!(of("float", rgb, "0.5 1 -1"), [half, 1.0, 0.0]);
    assert_eq!(of("double", rgb, "0.5 2 -1"), [half, 1.0, 0.0]);
    assert_eq!(of("float", rgb, "255 0 20"), [1.0, 0.0, byte]);
}

#[test]
fn a_color_that_is_not_whole_is_left_as_attributes() {
    let file = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
                property float z\nproperty uchar red\nproperty float green\nproperty uchar blue\n\
                property float nx\nend_header\n1 2 3 4 5 6 7\n";
    let set = read_bytes(file.as_bytes()).unwrap();
    assert_eq!((set.colors.as_ref(), set.normals.as_ref()), (None, None));
    let names: Vec<&str> = set.attributes.iter().map(|a| a.name.as_str()).collect();
    assert_eq!(names, ["red", "green", "blue", "nx"]);
}

#[test]
fn lines_that_end_with_carriage_returns_alone_are_read() {
    let file = ascii("2", "1 2 3\n4 5 6\n").replace('\n', "\r");
    assert_eq!(read_bytes(file.as_bytes()).unwrap().positions, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
}

#[test]
fn text_may_have_blank_lines_tabs_and_no_last_line_feed() {
    let file = ascii("2", "\n  1\t2 3  \r\n \n4 5 6");
    assert_eq!(read_bytes(file.as_bytes()).unwrap().positions, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
}

#[test]
fn what_is_not_finite_is_dropped_in_every_spelling() {
    let lines = "nan 0 0\n0 -inf 0\n0 0 -nan(ind)\n1.#QNAN 0 0\n1 2 3\n1e39 0 0\nInfinity 0 0\n";
    let set = read_bytes(ascii("7", lines).as_bytes()).unwrap();
    assert_eq!(set.positions, [[1.0, 2.0, 3.0]]);
    assert_eq!((set.file_index, set.non_finite), (vec![4], 6));
}

#[test]
fn damage_in_text_is_named_with_its_line() {
    let garbage = message(&ascii("2", "1 2 3\n4 x5 6\n"));
    assert_eq!(
        garbage,
        "a.ply:9: found 'x5', expected a number of type float for property 'y' of vertex 1; correct \
         the line or export the file again"
    );
    let short = message(&ascii("2", "1 2 3\n\n4 5\n"));
    assert!(short.starts_with("a.ply:10: found only 2 values, expected a value for property 'z'"));
    let long = message(&ascii("1", "1 2 3 4\n"));
    assert!(
        long.starts_with("a.ply:8: found 4 values, expected the 3 values of vertex 0"),
        "{long}"
    );
    let file = ascii("1", "1 2 -1\n").replace("float z", "uchar z");
    assert!(message(&file).contains("found '-1', expected a number of type uchar"));
    let bytes = [ascii("1", "").as_bytes(), b"1 \xff\xfe 3\n"].concat();
    assert!(read_bytes(&bytes).unwrap_err().to_string().starts_with("a.ply:8: found '"));
}

#[test]
fn damage_in_a_header_is_named_with_its_line() {
    let header = ascii("1", "1 2 3\n");
    for (from, to, expected) in [
        ("ascii 1.0", "ascii 2.0", "a.ply:2: found 'format ascii 2.0', expected 'format' with"),
        ("ascii", "binary", "a.ply:2: found 'format binary 1.0'"),
        ("format ascii 1.0\n", "", "a.ply:6: found no 'format' before 'end_header'"),
        ("vertex 1", "vertex -1", "a.ply:3: found 'element vertex -1', expected 'element', a name"),
        ("vertex 1", "vertex 1e3", "a.ply:3: found 'element vertex 1e3'"),
        ("element vertex 1\n", "", "a.ply:3: found 'float x', expected an 'element' before"),
        ("float y", "real y", "a.ply:5: found 'property real y', expected a type: char"),
        ("float y", "float x", "a.ply:5: found a second property 'x'"),
        ("float y", "float", "a.ply:5: found 'property float', expected 'property', a type"),
        ("float y", "list float int y", "expected an integer type for a list's length"),
        ("end_header", "the end", "a.ply:7: found 'the end', expected format, element"),
        ("end_header\n1 2 3\n", "", "a.ply:7: found the end of the file, expected 'end_header'"),
    ] {
        let message = message(&header.replace(from, to));
        let expected = expected.replace("found 'float x'", "found 'property float x'");
        assert!(message.contains(&expected), "{message}\nlacks {expected}");
    }
}

#[test]
fn missing_parts_are_named_with_what_is_there() {
    let header = ascii("1", "1 2 3\n");
    let no_z = message(&header.replace("float z", "float height"));
    assert!(
        no_z.contains(
            "no number 'z', expected it among the fields of a point ('x', 'y', 'height')"
        ),
        "{no_z}"
    );
    let list = message(&header.replace("float z", "list uchar float z"));
    assert!(list.contains("no number 'z'"), "{list}");
    let no_vertex = message(&header.replace("vertex", "point"));
    assert!(
        no_vertex
            .contains("no element 'vertex', expected it among the header's elements ('point')"),
        "{no_vertex}"
    );
}

#[test]
fn files_without_a_usable_point_say_so_with_counts() {
    for encoding in ENCODINGS {
        let file = ascii("0", "").replace("ascii", encoding);
        assert!(message(&file).contains("the file holds no points"));
    }
    let nan = message(&ascii("2", "nan 0 0\ninf 0 0\n"));
    assert!(nan.contains("no usable point: 2 in the file, 2 of them dropped"), "{nan}");
}

#[test]
fn headers_that_promise_too_much_fail_with_what_is_there() {
    let binary = |count: &str| {
        let mut file = ascii(count, "").replace("ascii", "binary_little_endian").into_bytes();
        file.extend(record("binary_little_endian", &vec![Cell::F32(1.0); 8]));
        file
    };
    let message = |file: &[u8]| read_bytes(file).unwrap_err().to_string();
    let huge = message(&binary("1000000000000"));
    assert!(
        huge.contains(
            "declares 1000000000000 of element 'vertex' needing 12000000000000 bytes, but the file \
             ends after 2 in 32 bytes"
        ),
        "{huge}"
    );
    // 2^64 - 1 records of 12 bytes are more bytes than 64 bits count.
    assert!(message(&binary("18446744073709551615")).contains("221360928884514619380 bytes"));
    let text = message(ascii("1000000000000", "1 2 3\n4 5 6\n").as_bytes());
    assert!(
        text.contains("declares 1000000000000 of element 'vertex', but the file ends after 2;")
    );

    // The same where the length of the file is not known.
    let pipe = read_pipe(Cursor::new(binary("1000"))).unwrap_err().to_string();
    assert!(pipe.contains("ends after 2 in 32 bytes"), "{pipe}");
    let pipe = read_pipe(Cursor::new(binary("5000000000")));
    assert!(matches!(pipe, Err(PointsError::TooMany { found: 5_000_000_000, .. })));
}

#[test]
fn hostile_counts_before_the_vertices_end_quickly() {
    for encoding in ENCODINGS {
        for properties in ["", "property list uint double values\n", "property double value\n"] {
            let before = format!("element other 18446744073709551615\n{properties}element vertex");
            let file = ascii("1", "1 2 3\n1 2 3\n");
            let file = file.replace("element vertex", &before).replace("ascii", encoding);
            let read = read_bytes(file.as_bytes());
            assert_eq!(read.is_ok(), properties.is_empty(), "{encoding}, {properties}");
        }
    }
}

#[test]
fn negative_list_lengths_are_errors() {
    let header = ascii("1", "").replace("float z\n", "float z\nproperty list char int w\n");
    let mut file = header.replace("ascii", "binary_big_endian").into_bytes();
    let position = vec![Cell::F32(1.0); 3];
    file.extend(record("binary_big_endian", &[&position[..], &[Cell::I8(-1)]].concat()));
    let error = read_bytes(&file).unwrap_err();
    assert!(matches!(error, PointsError::ListLength { length: -1.0, .. }), "{error}");
    let text = read_bytes(format!("{header}1 1 1 -1\n").as_bytes()).unwrap_err().to_string();
    assert!(text.contains("found '-1', expected a number of type char for property 'w'"), "{text}");
}

/// Blocks are a megabyte: records must survive the seams, and progress must come to an end.
#[test]
fn files_longer_than_a_block_are_read_whole() {
    let count = 200_000u32;
    for encoding in ENCODINGS {
        let mut file = ascii(&count.to_string(), "").replace("ascii", encoding).into_bytes();
        for i in 0..count {
            file.extend(record(encoding, &[0, 1, 2].map(|axis| Cell::F32((3 * i + axis) as f32))));
        }
        let mut last = (0, 0);
        let length = file.len() as u64;
        let mut progress = |done, all| {
            assert!(done >= last.0);
            last = (done, all);
        };
        let source = Source::of_file(Cursor::new(file), length, &mut progress);
        let set = read(source, Path::new("a"), &ReadOptions::default());
        assert_eq!(last, (length, length));
        let set = set.unwrap();
        assert_eq!(set.len(), count as usize);
        assert!(set.positions.iter().flatten().enumerate().all(|(i, &value)| value == i as f64));
    }
}

#[test]
fn gaussians_have_colors_opacity_and_scales() {
    let names = "x y z nx ny nz f_dc_0 f_dc_1 f_dc_2 f_rest_0 f_rest_44 opacity scale_0 scale_1 \
                 scale_2 rot_0";
    let properties: String =
        names.split(' ').map(|name| format!("property float {name}\n")).collect();
    let file = format!(
        "ply\nformat ascii 1.0\nelement vertex 2\n{properties}end_header\n\
         1 2 3 0 0 0 0 1.772453850905516 -9 7 7 0 0 1 -1 0.5\n\
         4 5 6 0 0 0 0 0 0 7 7 1e9 0 nan -1e9 0.5\n"
    );
    let set = read_bytes(file.as_bytes()).unwrap();
    assert_eq!(set.format, "PLY 1.0, ascii, 3D Gaussians");
    assert_eq!(set.normals, None);
    let colors = set.colors.as_ref().unwrap();
    // Half of full intensity, in sRGB.
    let half = ((0.5f64 + 0.055) / 1.055).powf(2.4) as f32;
    assert_eq!(colors[0], [half, 1.0, 0.0]);
    let names: Vec<&str> = set.attributes.iter().map(|a| a.name.as_str()).collect();
    assert_eq!(names, ["opacity", "scale_0", "scale_1", "scale_2", "rot_0"]);
    let value = |name: &str, point| set.attribute(name).unwrap().get(point);
    assert_eq!((value("opacity", 0), value("opacity", 1)), (0.5, 1.0));
    assert_eq!((value("scale_0", 0), value("scale_2", 1)), (1.0, 0.0));
    assert_eq!(value("scale_1", 0), f64::from(1.0f64.exp() as f32));
    assert_eq!(value("rot_0", 1), 0.5);
}

/// Fifty thousand names are compared with each other; so are those of elements.
#[test]
fn headers_of_many_names_are_read_quickly() {
    let begin = std::time::Instant::now();
    let properties: String = (0..50_000).map(|i| format!("property uchar p{i}\n")).collect();
    let file = ascii("1", "").replace("end_header", &format!("{properties}end_header"));
    assert!(message(&file).contains("but the file ends after 0"));
    let elements: String = (0..50_000).map(|i| format!("element e{i} 0\n")).collect();
    let file =
        ascii("1", "1 2 3\n").replace("element vertex", &format!("{elements}element vertex"));
    assert_eq!(read_bytes(file.as_bytes()).unwrap().len(), 1);
    // Unoptimised and among other tests; squares of names would take longer.
    assert!(begin.elapsed() < std::time::Duration::from_secs(5), "{:?}", begin.elapsed());
}
