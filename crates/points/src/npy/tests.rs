//! Arrays made here: every type and order, and what can be wrong with them. Those that NumPy itself
//! wrote are in `tests/tables.rs`.

use crate::error::PointsError;
use crate::options::ReadOptions;
use crate::read::read_bytes;
use crate::set::{ColorEncoding, PointSet, Values};
use flate2::Compression;
use flate2::write::DeflateEncoder;
use std::io::Write;
use std::path::Path;

/// A file with this header, padded as NumPy does it.
fn with_header(text: &str, data: &[u8]) -> Vec<u8> {
    let mut text = text.to_owned();
    while !(10 + text.len() + 1).is_multiple_of(64) {
        text.push(' ');
    }
    text.push('\n');
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((text.len() as u16).to_le_bytes());
    file.extend(text.as_bytes());
    file.extend(data);
    file
}

fn npy(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let fortran = if fortran { "True" } else { "False" };
    with_header(
        &format!("{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}"),
        data,
    )
}

fn f4(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// An archive of these arrays.
fn npz(arrays: &[(&str, Vec<u8>)], deflate: bool) -> Vec<u8> {
    let mut file = Vec::new();
    let mut directory = Vec::new();
    for (name, data) in arrays {
        let name = format!("{name}.npy");
        let packed = match deflate {
            true => {
                let mut encoder = DeflateEncoder::new(Vec::new(), Compression::default());
                encoder.write_all(data).unwrap();
                encoder.finish().unwrap()
            }
            false => data.clone(),
        };
        let mut crc = flate2::Crc::new();
        crc.update(data);
        let mut entry = Vec::new();
        entry.extend(20u16.to_le_bytes());
        entry.extend(0u16.to_le_bytes());
        entry.extend((if deflate { 8u16 } else { 0 }).to_le_bytes());
        entry.extend([0; 2]);
        entry.extend(0x21u16.to_le_bytes()); // the first day there is
        entry.extend(crc.sum().to_le_bytes());
        entry.extend((packed.len() as u32).to_le_bytes());
        entry.extend((data.len() as u32).to_le_bytes());
        entry.extend((name.len() as u16).to_le_bytes());
        entry.extend(0u16.to_le_bytes());

        let start = file.len() as u32;
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(&entry);
        directory.extend([0; 10]);
        directory.extend(start.to_le_bytes());
        directory.extend(name.as_bytes());
        file.extend(b"PK\x03\x04");
        file.extend(&entry);
        file.extend(name.as_bytes());
        file.extend(&packed);
    }
    let start = file.len() as u32;
    file.extend(&directory);
    file.extend(b"PK\x05\x06\0\0\0\0");
    file.extend([(arrays.len() as u16).to_le_bytes(); 2].as_flattened());
    file.extend((directory.len() as u32).to_le_bytes());
    file.extend(start.to_le_bytes());
    file.extend([0; 2]);
    file
}

fn try_read(file: &[u8]) -> Result<PointSet, PointsError> {
    read_bytes(file, Path::new("a.npy"), &ReadOptions::default())
}

fn read(file: &[u8]) -> PointSet {
    try_read(file).unwrap_or_else(|error| panic!("{error}"))
}

fn message(file: &[u8]) -> String {
    try_read(file).unwrap_err().to_string()
}

fn names(set: &PointSet) -> Vec<&str> {
    set.attributes.iter().map(|attribute| attribute.name.as_str()).collect()
}

const TWO: [[f64; 3]; 2] = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];

#[test]
fn positions_of_every_type_and_order_are_read() {
    let values = [1u8, 2, 3, 4, 5, 6];
    macro_rules! bytes {
        ($type:ty, $to:ident) => {
            values.iter().flat_map(|&value| <$type>::from(value).$to()).collect::<Vec<u8>>()
        };
    }
    let halves = [0x3c00u16, 0x4000, 0x4200, 0x4400, 0x4500, 0x4600];
    for (descr, data) in [
        ("'|u1'", bytes!(u8, to_le_bytes)),
        ("'|i1'", values.to_vec()),
        ("'<i2'", bytes!(i16, to_le_bytes)),
        ("'>u2'", bytes!(u16, to_be_bytes)),
        ("'>i4'", bytes!(i32, to_be_bytes)),
        ("'<u4'", bytes!(u32, to_le_bytes)),
        ("'<i8'", bytes!(i64, to_le_bytes)),
        ("'>u8'", bytes!(u64, to_be_bytes)),
        ("'<f2'", halves.iter().flat_map(|half| half.to_le_bytes()).collect()),
        ("'>f2'", halves.iter().flat_map(|half| half.to_be_bytes()).collect()),
        ("'<f4'", bytes!(f32, to_le_bytes)),
        ("'>f4'", bytes!(f32, to_be_bytes)),
        ("'<f8'", bytes!(f64, to_le_bytes)),
        ("'>f8'", bytes!(f64, to_be_bytes)),
    ] {
        let set = read(&npy(descr, false, "(2, 3)", &data));
        assert_eq!(set.positions, TWO, "{descr}");
        assert_eq!(set.format, "NPY, shape (2, 3), columns taken for x y z");
    }
    let columns = f4(&[1.0, 4.0, 2.0, 5.0, 3.0, 6.0]);
    assert_eq!(read(&npy("'<f4'", true, "(2, 3)", &columns)).positions, TWO);
    let rows = f4(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(read(&npy("'<f4'", false, "(1, 2, 3)", &rows)).positions, TWO);
    // Python 2 wrote its numbers so.
    assert_eq!(read(&npy("'<f4'", false, "(2L, 3L)", &rows)).positions, TWO);
    let mut later = npy("'<f4'", false, "(2, 3)", &rows);
    later[6] = 2;
    later.splice(8..10, (118u32).to_le_bytes());
    assert_eq!(read(&later).positions, TWO);
}

#[test]
fn three_rows_of_many_columns_are_axes() {
    let axes: Vec<f32> = (0..60u8).map(f32::from).collect();
    let set = read(&npy("'<f4'", false, "(3, 20)", &f4(&axes)));
    assert_eq!(set.len(), 20);
    assert_eq!(set.positions[1], [1.0, 21.0, 41.0]);
    assert_eq!(set.format, "NPY, shape (3, 20), rows taken for x y z");
    let set = read(&npy("'<f4'", true, "(3, 20)", &f4(&axes)));
    assert_eq!(set.positions[1], [3.0, 4.0, 5.0]);
    let set = read(&npy("'<f4'", false, "(3, 4)", &f4(&axes[..12])));
    assert_eq!(set.positions, [[0.0, 1.0, 2.0], [4.0, 5.0, 6.0], [8.0, 9.0, 10.0]]);
    assert_eq!(names(&set), ["intensity"]);
}

#[test]
fn columns_without_names_are_what_they_look_like() {
    let set = read(&npy("'<f4'", false, "(1, 6)", &f4(&[1.0, 2.0, 3.0, 255.0, 0.0, 128.0])));
    assert_eq!(set.color_encoding, Some(ColorEncoding::Srgb8));
    let set = read(&npy("'<f4'", false, "(1, 6)", &f4(&[1.0, 2.0, 3.0, 1.0, 0.0, 0.5])));
    assert_eq!(set.colors, Some(vec![[1.0, 0.0, ColorEncoding::Fraction.decode(0.5)]]));
    let set = read(&npy("'<f4'", false, "(1, 5)", &f4(&[1.0, 2.0, 3.0, 7.0, 8.0])));
    assert_eq!(set.attribute("column_5"), Some(&Values::F32(vec![8.0])));
}

#[test]
fn named_fields_are_read_whatever_lies_between() {
    let descr = "[('name', '|S3'), ('pos', '>f4', (3,)), (('a title', 'rgb'), '|u1', 3), \
                 ('when', '<M8[ns]'), ('', '|V2'), ('w', '<f8', (2,)), \
                 ('inner', [('intensity', '<u2'), ('z', '<i2')])]";
    let mut data = b"abc".to_vec();
    data.extend([1.0f32, 2.0, 3.0].iter().flat_map(|value| value.to_be_bytes()));
    data.extend([255, 0, 7]);
    data.extend([9; 8]);
    data.extend([9; 2]);
    data.extend([0.25f64, 0.5].iter().flat_map(|value| value.to_le_bytes()));
    data.extend(500u16.to_le_bytes());
    data.extend((-4i16).to_le_bytes());
    let set = read(&npy(descr, false, "(1,)", &data));
    assert_eq!(set.positions, [[1.0, 2.0, 3.0]]);
    assert_eq!(names(&set), ["w_0", "w_1", "inner_intensity", "inner_z"]);
    assert_eq!(set.attribute("w_1"), Some(&Values::F64(vec![0.5])));
    assert_eq!(set.attributes[3].values.get(0), -4.0);
    assert_eq!(set.color_encoding, Some(ColorEncoding::Srgb8));
    assert_eq!(set.colors.unwrap()[0][0], 1.0);
    assert_eq!(set.format, "NPY, shape (1,), named fields");
}

#[test]
fn archives_are_read_packed_or_not() {
    let xyz = npy("'<f4'", false, "(2, 3)", &f4(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    let columns = npy("'<f4'", true, "(2, 3)", &f4(&[1.0, 4.0, 2.0, 5.0, 3.0, 6.0]));
    let rgb = npy("'|u1'", false, "(2, 3)", &[255, 0, 0, 0, 255, 0]);
    let density =
        npy("'<f8'", false, "(2,)", &[0.5f64.to_le_bytes(), 0.25f64.to_le_bytes()].concat());
    let faces = npy("'<i4'", false, "(1, 3)", &[0; 12]);
    let velocity = npy("'>f4'", false, "(2, 2)", &[0; 16]);
    for deflate in [false, true] {
        for (name, positions) in [("xyz", &xyz), ("Points", &columns), ("whatever", &xyz)] {
            let arrays = [
                ("faces", faces.clone()),
                ("density", density.clone()),
                (name, positions.clone()),
                ("colors", rgb.clone()),
                ("v", velocity.clone()),
            ];
            // Two arrays of three columns, one of which says what it is.
            let called_so = name != "whatever";
            let arrays =
                if called_so { &arrays[..] } else { &[arrays[1].clone(), arrays[2].clone()] };
            let set = read(&npz(arrays, deflate));
            assert_eq!(set.positions, TWO, "{name}");
            assert_eq!(set.attribute("density"), Some(&Values::F64(vec![0.5, 0.25])));
            if called_so {
                assert_eq!(names(&set), ["density", "v_0", "v_1"]);
                assert_eq!(set.colors, Some(vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
                assert_eq!(
                    set.format,
                    format!("NPZ, positions from {name}; left out: faces (1, 3)")
                );
            }
        }
        let axis = |values: &[f32]| npy("'<f4'", false, "(2,)", &f4(values));
        let axes = [("y", axis(&[2.0, 5.0])), ("x", axis(&[1.0, 4.0])), ("z", axis(&[3.0, 6.0]))];
        let set = read(&npz(&axes, deflate));
        assert_eq!(set.positions, TWO);
        assert_eq!(set.format, "NPZ, positions from x y z");
    }
}

#[test]
fn what_is_wrong_with_an_array_is_named() {
    let rows = f4(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let header = "a.npy: found ";
    for (file, expected) in [
        (
            npy("'<f4'", false, "(2,)", &rows),
            "a.npy: found the shape (2,) as the NumPy header, expected (n, 3), or more columns; \
             save it again with numpy.save",
        ),
        (npy("'<f4'", false, "(2, 2)", &rows), "found the shape (2, 2)"),
        (npy("'<f4'", false, "()", &rows), "found the shape ()"),
        (npy("'<f4'", false, "(1, 5000)", &rows), "expected at most 1000 columns"),
        (npy("'|O'", false, "(2, 3)", &rows), "found elements that are no numbers"),
        (npy("[('x', '<f4'), ('o', 'O')]", false, "(2,)", &rows), "elements that are no numbers"),
        (npy("'<q9'", false, "(2, 3)", &rows), "found the type '<q9'"),
        (npy("'<c8'", false, "(2, 3)", &rows), "found elements that are no numbers"),
        (npy("'<f99999999999999999999'", false, "(2, 3)", &rows), "found the type '<f999"),
        (npy("'<U4611686018427387904'", false, "(2, 3)", &rows), "an element of more than"),
        (npy("[('x', '<f4', (3, 9999999999))]", false, "(2,)", &rows), "an element of more than"),
        (npy("[('a', '<f4')]", false, "(6,)", &rows), "found no number 'x', expected it among"),
        (npy("[('a',)]", false, "(6,)", &rows), "found a field that is none"),
        (npy("[]", false, "(6,)", &rows), "found elements that are no numbers"),
        (npy("'<f4'", false, "(-1, 3)", &rows), "expected a dictionary with descr"),
        (
            npy("'<f4'", false, "(3, 3)", &rows),
            "a.npy: the header declares 3 points needing 36 bytes, but the file ends after 2 in \
             24 bytes; the file is cut off",
        ),
        (npy("'<f4'", false, "(9999999999999999, 3)", &rows), "declares 9999999999999999 points"),
        (npy("'<f4'", false, "(9999999999, 9999999999, 3)", &rows), "found the shape"),
        (npy("'<f4'", false, "(0, 3)", &rows), "the file holds no points"),
        (with_header("{'descr': '<f4'}", &rows), "expected a dictionary with descr"),
        (with_header("__import__('os').system('true')", &rows), "expected a dictionary"),
        (with_header(&"[".repeat(60_000), &rows), "expected a dictionary"),
        (b"\x93NUMPY\x09\x00\x00\x00".to_vec(), "found version 9"),
        (b"\x93NUMPY\x01\x00\xff\xff{".to_vec(), "the end of the file after 1 of 65535 bytes"),
        (b"\x93NUMPY\x02\x00\xff\xff\xff\xff{".to_vec(), "a length of 4294967295 bytes"),
        (b"\x93NUMPY".to_vec(), "found version 0"),
    ] {
        let found = message(&file);
        assert!(found.contains(expected) && found.starts_with("a.npy: "), "{expected}: {found}");
        let is_of_header = found.starts_with(header) || found.contains("no points");
        assert!(is_of_header || found.contains("declares"), "{found}");
    }
}

#[test]
fn what_is_wrong_with_an_archive_is_named() {
    let xyz = npy("'<f4'", false, "(2, 3)", &f4(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    let long = npy("'<f4'", false, "(3, 3)", &f4(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    let axis = npy("'<f4'", false, "(2,)", &f4(&[1.0, 2.0]));
    for (arrays, expected) in [
        (vec![], "found no positions, expected it among the arrays (none); save them under the"),
        (
            vec![("a", axis.clone()), ("b", xyz.clone()), ("c", xyz.clone())],
            "among the arrays ('a' (2,), 'b' (2, 3), 'c' (2, 3))",
        ),
        (vec![("a", b"\x93NUMPX 0123456789".to_vec())], "as the NumPy header of 'a', expected"),
        (vec![("xyz", long)], "declares 3 values of 'xyz' needing 36 bytes, but the file ends"),
    ] {
        for deflate in [false, true] {
            let found = message(&npz(&arrays, deflate));
            assert!(found.contains(expected), "{expected}: {found}");
        }
    }
    let mut damaged = npz(&[("xyz", xyz.clone())], false);
    let place = 30 + 7 + xyz.len() - 1;
    damaged[place] ^= 1;
    let found = message(&damaged);
    assert!(found.contains("found bytes whose checksum is not the archive's as the data of 'xyz'"));
    let mut damaged = npz(&[("xyz", xyz.clone())], true);
    damaged[45] ^= 0xff;
    let found = message(&damaged);
    assert!(found.contains("as the data of 'xyz', expected what the header says"), "{found}");
    let cut = &npz(&[("xyz", xyz)], true)[..100];
    assert!(message(cut).contains("as the archive's directory, expected that of a zip archive"));
}

/// A megabyte that unpacks to a gigabyte of zeros, for points or before them.
#[test]
fn archives_that_are_made_to_fill_memory_are_refused() {
    let zeros = npy("'<f4'", false, "(30000000, 3)", &vec![0; 360_000_000]);
    let found = message(&npz(&[("xyz", zeros)], true));
    assert!(found.contains("found 360000000 bytes as the size of the unpacked arrays"), "{found}");
}

/// Each of a thousand columns would be found by unpacking all those before it.
#[test]
fn columns_that_take_long_to_unpack_are_refused() {
    let zeros = npy("'<f8'", true, "(4000, 999)", &vec![0; 4000 * 999 * 8]);
    let xyz = npy("'<f4'", false, "(4000, 3)", &vec![0; 48_000]);
    let found = message(&npz(&[("a", zeros.clone()), ("xyz", xyz.clone())], true));
    assert!(found.contains("found 999 columns one after the other as the order of 'a'"), "{found}");
    let few = npy("'<f8'", true, "(4000, 3)", &vec![0; 96_000]);
    assert_eq!(read(&npz(&[("xyz", few)], true)).len(), 4000);
    assert_eq!(read(&npz(&[("xyz", xyz), ("a", zeros)], false)).len(), 4000);
}

#[test]
fn odd_archives_are_refused_or_read() {
    let xyz = npy("'<f4'", false, "(2, 3)", &f4(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    let whole = npz(&[("xyz", xyz.clone())], false);
    let directory = whole.windows(4).position(|four| four == b"PK\x01\x02").unwrap();
    let patched = |local: usize, bytes: &[u8]| {
        let mut file = whole.clone();
        for place in [local, directory + local + 2] {
            file[place..place + bytes.len()].copy_from_slice(bytes);
        }
        file
    };
    let many: Vec<String> = (0..1001).map(|number| number.to_string()).collect();
    let many: Vec<_> = many.iter().map(|name| (name.as_str(), Vec::new())).collect();
    for (file, expected) in [
        (patched(8, &12u16.to_le_bytes()), "as the packing of 'xyz', expected store or deflate"),
        (
            patched(6, &1u16.to_le_bytes()),
            "found encryption as the packing of 'xyz', expected none",
        ),
        // Lengths that the file does not have.
        (patched(18, &[0xff; 4]), ""),
        (patched(22, &1000u32.to_le_bytes()), ""),
        (patched(22, &100u32.to_le_bytes()), "checksum is not the archive's as the data of 'xyz'"),
        (patched(22, &140u32.to_le_bytes()), "declares 2 values of 'xyz' needing 24 bytes"),
        (npz(&[("a\nb", xyz.clone()), ("c", xyz.clone())], false), "('a_b' (2, 3), 'c' (2, 3))"),
        (npz(&vec![("a", xyz.clone()); 3], false), ""),
        (npz(&many, false), "found 1001 entries as the archive's directory, expected at most 1000"),
        (b"PK\x05\x06".iter().copied().chain([0; 18]).collect(), "among the arrays (none)"),
    ] {
        match try_read(&file) {
            Ok(set) => assert!(expected.is_empty() && set.len() == 2, "{expected}"),
            Err(error) => assert!(error.to_string().contains(expected), "{expected}: {error}"),
        }
    }
}

/// A map of points keeps its points in rows and columns; a lattice of values is none.
#[test]
fn lattices_of_values_are_no_points() {
    let values: Vec<u8> = f4(&(0..4 * 5 * 12).map(|i| i as f32).collect::<Vec<_>>());
    let read = |shape: &str| {
        let bytes = npy("'<f4'", false, shape, &values);
        read_bytes(&bytes, Path::new("a.npy"), &ReadOptions::default())
    };
    for (shape, points) in [("(4, 20, 3)", 80), ("(4, 6, 10)", 24), ("(2, 2, 20, 3)", 80)] {
        assert_eq!(read(shape).unwrap().len(), points, "{shape}");
    }
    for shape in ["(4, 5, 12)", "(12, 10, 2)", "(4, 5, 12, 1)", "(1, 4, 5, 12)", "(240, 1, 1)"] {
        let error = read(shape).map(|set| set.format).unwrap_err().to_string();
        let found =
            format!("a.npy: found {shape} as the shape of the array, expected rows of points");
        assert!(error.starts_with(&found) && error.contains("numpy.indices"), "{error}");
    }
}

/// What may as well be something else is read, with a word.
#[test]
fn doubtful_shapes_are_noted() {
    for (shape, expected) in [
        ("(2, 4, 10, 3)", Some("lattice with 3 values at each node")),
        ("(1, 1, 80, 3)", None),
        ("(8, 10, 3)", None),
        ("(4, 60)", Some("4 rows of 60 columns; if its columns are the points, save a.T")),
        ("(80, 3)", None),
        ("(3, 80)", None),
    ] {
        let bytes = npy("'<f4'", false, shape, &f4(&[0.5; 240]));
        let notes = read_bytes(&bytes, Path::new("a.npy"), &ReadOptions::default()).unwrap().notes;
        let found =
            notes.iter().find(|note| expected.is_some_and(|expected| note.contains(expected)));
        assert_eq!(found.is_some(), expected.is_some(), "{shape}: {notes:?}");
        assert!(expected.is_some() || notes.is_empty(), "{shape}: {notes:?}");
    }
    let picture = npy("'|u1'", false, "(8, 10, 3)", &[7; 240]);
    let set = read_bytes(&picture, Path::new("a.npy"), &ReadOptions::default()).unwrap();
    assert!(set.notes[0].contains("8-bit integers is like a picture's"), "{:?}", set.notes);
}

/// By numbers and, of records, by names.
#[test]
fn columns_are_what_the_user_says() {
    let columns = |list: &str| ReadOptions {
        columns: crate::assign::Columns::in_order(list).unwrap(),
        ..ReadOptions::default()
    };
    let rows =
        npy("'<f4'", false, "(2, 5)", &f4(&[9.0, 1.0, 2.0, 3.0, 4.0, 8.0, 5.0, 6.0, 7.0, 0.5]));
    let set = read_bytes(&rows, Path::new("a.npy"), &columns("_,z,y,x,temp")).unwrap();
    assert_eq!(set.positions, [[3.0, 2.0, 1.0], [7.0, 6.0, 5.0]]);
    assert_eq!(set.attributes.len(), 1);
    assert_eq!(set.attribute("temp"), Some(&Values::F32(vec![4.0, 0.5])));
    assert!(set.notes.is_empty());
    let record =
        npy("[('E', '<f4'), ('N', '<f4'), ('H', '<f4')]", false, "(1,)", &f4(&[1.0, 2.0, 3.0]));
    let set = read_bytes(&record, Path::new("a.npy"), &columns("y,x,z")).unwrap();
    assert_eq!(set.positions, [[2.0, 1.0, 3.0]]);
    let error = read_bytes(&record, Path::new("a.npy"), &columns("x,y,z,red")).unwrap_err();
    assert!(
        error.to_string().contains("found 4 as the column of 'red', expected a number from 1 to 3")
    );
}
