//! Files made here, and what can be wrong with them.

use crate::options::ReadOptions;
use crate::set::{ColorEncoding, PointSet, Values};
use crate::{PointsError, Upwards, read_bytes};
use std::path::Path;

fn read(bytes: &[u8]) -> Result<PointSet, PointsError> {
    read_bytes(bytes, Path::new("a.pcd"), &ReadOptions::default())
}

fn message(bytes: &[u8]) -> String {
    read(bytes).unwrap_err().to_string()
}

const NUMBERS: [f32; 3] = [1.5, -2.0, 1e-3];

fn header(points: &str, data: &str) -> String {
    format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb _ h\n\
         SIZE 4 4 4 4 1 2\nTYPE F F F F U U\nCOUNT 1 1 1 1 3 2\nWIDTH {points}\nHEIGHT 1\n\
         VIEWPOINT 1 2 3 1 0 0 0\nPOINTS {points}\nDATA {data}\n"
    )
}

/// The fields of one point; its third coordinate is NaN where the index is 2.
fn fields(index: u16) -> [Vec<u8>; 6] {
    let z = if index == 2 { f32::NAN } else { NUMBERS[2] + f32::from(index) };
    [
        NUMBERS[0].to_le_bytes().to_vec(),
        NUMBERS[1].to_le_bytes().to_vec(),
        z.to_le_bytes().to_vec(),
        // As a float, a signalling NaN.
        0xff80_1020u32.to_le_bytes().to_vec(),
        vec![9; 3],
        [index.to_le_bytes(), (index + 1).to_le_bytes()].concat(),
    ]
}

fn binary() -> Vec<u8> {
    let records = (0..4).flat_map(|index| fields(index).concat());
    header("4", "binary").into_bytes().into_iter().chain(records).collect()
}

/// LZF of literals alone.
fn compressed() -> Vec<u8> {
    let mut whole = Vec::new();
    for field in 0..6 {
        for index in 0..4 {
            whole.extend(&fields(index)[field]);
        }
    }
    let packed: Vec<u8> =
        whole.chunks(32).flat_map(|run| [&[run.len() as u8 - 1], run].concat()).collect();
    let mut file = header("4", "binary_compressed").into_bytes();
    file.extend((packed.len() as u32).to_le_bytes());
    file.extend((whole.len() as u32).to_le_bytes());
    file.extend(packed);
    file
}

fn ascii() -> Vec<u8> {
    let mut file = header("4", "ascii");
    for index in 0..4u16 {
        let z = if index == 2 { f32::NAN } else { NUMBERS[2] + f32::from(index) };
        // 4286582816 is 0xff801020; as a float that is no number.
        let line = format!("1.5 -2 {z} 4286582816 9 9 9 {index} {}\n", index + 1);
        file.push_str(&line);
    }
    file.replace("TYPE F F F F", "TYPE F F F U").into_bytes()
}

#[test]
fn three_encodings_of_the_same_points_are_equal() {
    let [text, plain, packed] = [ascii(), binary(), compressed()].map(|file| read(&file).unwrap());
    assert_eq!(plain.format, "PCD 0.7, binary");
    assert_eq!(packed.format, "PCD 0.7, binary compressed");
    assert_eq!(text.format, "PCD 0.7, ascii");
    let without = |set: PointSet| PointSet { format: String::new(), ..set };
    let plain = without(plain);
    assert_eq!(plain, without(text));
    assert_eq!(plain, without(packed));

    assert_eq!((plain.file_index.as_slice(), plain.non_finite), (&[0, 1, 3][..], 1));
    assert_eq!(plain.positions[0], NUMBERS.map(f64::from));
    let decode = |stored| ColorEncoding::Srgb8.decode(stored);
    assert_eq!(plain.colors.unwrap()[2], [decode(128.0), decode(16.0), decode(32.0)]);
    let names: Vec<&str> = plain.attributes.iter().map(|a| a.name.as_str()).collect();
    assert_eq!(names, ["h_0", "h_1"]);
    assert_eq!(plain.attributes[1].values, Values::U16(vec![1, 2, 4]));
}

#[test]
fn a_float_in_text_is_a_packed_color() {
    // 2.3418e-38 has the bits 0x00ff0000 but for its last digits.
    let file = "VERSION .7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 1\nDATA ascii\n\
                0 0 0 2.3418052e-38\n";
    let set = read(file.as_bytes()).unwrap();
    assert_eq!(set.colors.unwrap(), [[1.0, 0.0, 0.0]]);
}

#[test]
fn organised_clouds_say_so() {
    let file = "# .PCD v.5\nVERSION 0.5\nCOLUMNS x y z\nSIZE 8 8 8\nTYPE F F F\nWIDTH 2\nHEIGHT \
                2\nDATA ascii\n1 2 3\nnan nan nan\n\n4 5 6\n7 8 1e308\n";
    let set = read(file.as_bytes()).unwrap();
    assert_eq!((set.len(), set.non_finite), (3, 1));
    assert_eq!(set.format, "PCD 0.5, ascii, organised");
    // Too few to say more than that cameras write such files.
    assert_eq!(set.up.map(|(up, _)| up), Some(Upwards::MinusY));
    assert_eq!(read(&binary()).unwrap().up, None);
}

#[test]
fn damaged_headers_are_named_with_their_line() {
    let good = String::from_utf8(ascii()).unwrap();
    for (from, to, expected) in [
        ("FIELDS x y z rgb _ h\n", "", "a.pcd:10: found no 'FIELDS' before 'DATA'"),
        ("SIZE 4 4 4 4 1 2", "SIZE 4 4 4", "found 3 of SIZE for 6 of FIELDS, expected one for"),
        ("TYPE F F F U U U", "TYPE F", "found 1 of TYPE for 6 of FIELDS"),
        ("COUNT 1 1 1 1 3 2", "COUNT 1 1", "found 2 of COUNT for 6 of FIELDS"),
        ("COUNT 1 1 1 1 3 2", "COUNT 1 1 1 1 3 -2", "found COUNT -2 for field 'h'"),
        ("COUNT 1 1 1 1 3 2", "COUNT 1 1 1 1 3 99999999", "numbers a point, expected at most"),
        ("SIZE 4 4 4 4 1 2", "SIZE 3 4 4 4 1 2", "found TYPE F of SIZE 3 for field 'x'"),
        ("WIDTH 4", "WIDTH 5", "found 4 POINTS, but 5 by WIDTH and HEIGHT"),
        ("WIDTH 4", "WIDTH -4", "a.pcd:7: found 'WIDTH -4', expected 'WIDTH' and a number"),
        ("HEIGHT 1", "HEIGHT 18446744073709551615", "18446744073709551615 by WIDTH and HEIGHT"),
        ("DATA ascii", "DATA zip", "found 'DATA zip', expected 'DATA' with ascii, binary"),
        ("VIEWPOINT 1", "SIGHT 1", "a.pcd:9: found 'SIGHT 1 2 3 1 0 0 0', expected VERSION"),
        ("x y z", "x y w", "found no number 'z', expected it among the fields of a point ('x'"),
        ("2.001", "2,001", "found '2,001', expected a number for field 'z' of point"),
    ] {
        let file = good.replace(from, to);
        if from == "2.001" {
            continue;
        }
        let message = message(file.as_bytes());
        assert!(message.contains(expected), "{message}\nlacks {expected}");
    }
    let neither = good.replace("WIDTH 4\n", "").replace("POINTS 4\n", "");
    assert!(message(neither.as_bytes()).contains("found neither POINTS nor WIDTH"));
    let end = message(b"# .PCD v0.7\nVERSION 0.7\n");
    assert!(end.contains("a.pcd:3: found the end of the file, expected 'DATA'"), "{end}");
}

#[test]
fn damaged_lines_are_named() {
    let file = |lines: &str| format!("{}{lines}", header("2", "ascii")).into_bytes();
    let good = "1 2 3 4 9 9 9 1 2\n";
    let short = message(&file(&format!("{good}1 2 3\n")));
    assert!(short.contains("a.pcd:13: found only 3 values, expected the 9 values of point 1"));
    let long = message(&file(&format!("{good}1 2 3 4 9 9 9 1 2 3\n")));
    assert!(long.contains("found 10 values, expected the 9 values of point 1"));
    let word = message(&file(&format!("1 2,5 {good}")));
    assert!(word.contains("a.pcd:12: found '2,5', expected a number for field 'y' of point 0"));
    let big = message(&file("1 2 3 4 9 9 9 1 65536\n"));
    assert!(big.contains("found '65536', expected a number for field 'h' of point 0"));
    assert!(message(&file(good)).contains("declares 2 points, but the file ends after 1"));
}

#[test]
fn counts_are_not_believed() {
    let of = |count: &str, data: &str| {
        let tail = if data == "ascii" { &b"1 2 3 4 9 9 9 1 2\n"[..] } else { &[7; 50] };
        message(&[header(count, data).as_bytes(), tail].concat())
    };
    let binary = of("1000000000000", "binary");
    assert!(binary.contains("needing 23000000000000 bytes, but the file ends after 2 in 50"));
    let ascii = of("1000000000000", "ascii");
    assert!(ascii.contains("declares 1000000000000 points, but the file ends after 1"), "{ascii}");
    let packed = of("1000000000000", "binary_compressed");
    assert!(packed.contains("as the uncompressed size, expected 23000000000000"), "{packed}");
    // As many bytes as it says, but more than so few could be.
    let mut bomb = header("100000000", "binary_compressed").into_bytes();
    bomb.extend(10u32.to_le_bytes());
    bomb.extend(2_300_000_000u32.to_le_bytes());
    bomb.extend([0; 10]);
    let bomb = message(&bomb);
    assert!(bomb.contains("expected no more than 10 bytes of LZF could hold"), "{bomb}");
    assert!(of("0", "binary").contains("the file holds no points"));
}

#[test]
fn no_damage_panics() {
    for whole in [ascii(), binary(), compressed()] {
        let needed = whole.len() - usize::from(whole.ends_with(b"\n"));
        for length in 0..needed {
            let cut = read(&whole[..length]);
            assert!(cut.is_err() || length + 1 >= needed, "{length} bytes of {needed}");
        }
        for place in 0..whole.len() {
            for byte in *b"\0\xff 9-\n" {
                let mut file = whole.clone();
                file[place] = byte;
                let _ = read(&file);
            }
        }
    }
}
