//! One coloured cloud in every format and encoding: one picture; and points that lack a value.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use ::e57::{E57Writer, Record, RecordValue};
use harness::{
    Bench, assert_same_bits, assert_same_film, fibonacci_sphere, plan_of, render_twin, set_of,
    shared_data, with_attribute,
};
use points::{PointSet, ReadOptions};
use std::fmt::Write;
use std::io::Cursor;
use std::path::Path;

const SCENE: &str = "
[image]
size = [96, 96]
[camera]
eye = [0.6, 0.9, 3.2]
target = [0, 0, 0]
[[lights]]
kind = \"directional\"
direction = [-0.5, -1.0, -0.6]
irradiance = [3.0, 3.0, 3.0]
";

/// Points with coordinates that text, 32 bits and steps of 1/1024 hold exactly, and their colours.
fn cloud() -> Vec<([f64; 3], [u8; 3])> {
    let color = |i: usize| [(i * 37) as u8, 255 - (i / 2) as u8, (i * i) as u8];
    let exact = |p: [f64; 3]| p.map(|x| (x * 1024.0).round() / 1024.0);
    fibonacci_sphere(500).into_iter().enumerate().map(|(i, p)| (exact(p), color(i))).collect()
}

/// How a number of a colour is stored.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stored {
    Byte,
    /// Of 16 bits.
    Short,
    /// Of 16 bits, the byte in the upper half.
    Shifted,
    /// Of 32 bits.
    Int,
    /// A fraction of 1, of 32 bits and of 64.
    Single,
    Double,
    /// A byte as a float of 32 bits.
    Float255,
}

impl Stored {
    fn value(self, byte: u8) -> f64 {
        let byte = f64::from(byte);
        match self {
            Self::Byte | Self::Int | Self::Float255 => byte,
            Self::Short => byte * 257.0,
            Self::Shifted => byte * 256.0,
            Self::Single => f64::from((byte / 255.0) as f32),
            Self::Double => byte / 255.0,
        }
    }

    fn bytes(self, byte: u8, big: bool) -> Vec<u8> {
        let value = self.value(byte);
        let mut bytes = match self {
            Self::Byte => vec![byte],
            Self::Short | Self::Shifted => (value as u16).to_le_bytes().to_vec(),
            Self::Int => (value as i32).to_le_bytes().to_vec(),
            Self::Single | Self::Float255 => (value as f32).to_le_bytes().to_vec(),
            Self::Double => value.to_le_bytes().to_vec(),
        };
        if big {
            bytes.reverse();
        }
        bytes
    }

    /// The names of its type in PLY, VTK and NumPy.
    fn names(self) -> [&'static str; 3] {
        match self {
            Self::Byte => ["uchar", "UInt8", "u1"],
            Self::Short | Self::Shifted => ["ushort", "UInt16", "<u2"],
            Self::Int => ["int", "Int32", "<i4"],
            Self::Single | Self::Float255 => ["float", "Float32", "<f4"],
            Self::Double => ["double", "Float64", "<f8"],
        }
    }

    const ALL: [Self; 7] = [
        Self::Byte,
        Self::Short,
        Self::Shifted,
        Self::Int,
        Self::Single,
        Self::Double,
        Self::Float255,
    ];
}

fn packed([r, g, b]: [u8; 3], alpha: u8) -> u32 {
    u32::from_be_bytes([alpha, r, g, b])
}

/// A line a point.
fn lines(line: impl Fn([f64; 3], [u8; 3]) -> String) -> String {
    cloud().into_iter().fold(String::new(), |mut text, (p, color)| {
        let _ = writeln!(text, "{}", line(p, color));
        text
    })
}

/// Coordinates and colour, with something between.
fn row([x, y, z]: [f64; 3], separator: &str, color: [u8; 3], stored: Stored) -> String {
    let values = [x, y, z].into_iter().chain(color.map(|byte| stored.value(byte)));
    values.map(|value| value.to_string()).collect::<Vec<_>>().join(separator)
}

/// Every point's bytes.
fn records(record: impl Fn([f64; 3], [u8; 3]) -> Vec<u8>) -> Vec<u8> {
    cloud().into_iter().flat_map(|(p, color)| record(p, color)).collect()
}

fn f32s(p: [f64; 3], big: bool) -> Vec<u8> {
    let bytes = |x: f64| if big { (x as f32).to_be_bytes() } else { (x as f32).to_le_bytes() };
    p.into_iter().flat_map(bytes).collect()
}

fn ply(stored: Stored, encoding: &str) -> Vec<u8> {
    let kind = stored.names()[0];
    let head = format!(
        "ply\nformat {encoding} 1.0\nelement vertex 500\nproperty float x\nproperty float y\nproperty \
         float z\nproperty {kind} red\nproperty {kind} green\nproperty {kind} blue\nend_header\n"
    );
    let big = encoding == "binary_big_endian";
    let colors = |color: [u8; 3]| color.into_iter().flat_map(move |byte| stored.bytes(byte, big));
    let body = match encoding {
        "ascii" => lines(|p, color| row(p, " ", color, stored)).into_bytes(),
        _ => records(|p, color| f32s(p, big).into_iter().chain(colors(color)).collect()),
    };
    [head.into_bytes(), body].concat()
}

/// `kind` is the letter of the type, U or F.
fn pcd(kind: char, ascii: bool) -> Vec<u8> {
    let data = if ascii { "ascii" } else { "binary" };
    let head = format!(
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F {kind}\nCOUNT 1 1 1 1\n\
         WIDTH 500\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 500\nDATA {data}\n"
    );
    let alpha = if ascii && kind == 'F' { 0 } else { 255 };
    let body = match ascii {
        false => records(|p, color| {
            [f32s(p, false), packed(color, alpha).to_le_bytes().to_vec()].concat()
        }),
        true => lines(|[x, y, z], color| match packed(color, alpha) {
            bits if kind == 'F' => format!("{x} {y} {z} {:e}", f32::from_bits(bits)),
            bits => format!("{x} {y} {z} {bits}"),
        })
        .into_bytes(),
    };
    [head.into_bytes(), body].concat()
}

fn npy(descr: &str, shape: &str, data: Vec<u8>) -> Vec<u8> {
    let mut head = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}");
    let length = (head.len() + 11).next_multiple_of(64) - 10;
    head += &" ".repeat(length - head.len() - 1);
    head.push('\n');
    [b"\x93NUMPY\x01\x00", &(length as u16).to_le_bytes()[..], head.as_bytes(), &data].concat()
}

fn npy_records(stored: Stored) -> Vec<u8> {
    let kind = stored.names()[2];
    let descr = format!(
        "[('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('r', '{kind}'), ('g', '{kind}'), ('b', '{kind}')]"
    );
    let data = records(|p, color| {
        let colors = color.into_iter().flat_map(|byte| stored.bytes(byte, false));
        f32s(p, false).into_iter().chain(colors).collect()
    });
    npy(&descr, "(500,)", data)
}

/// Packed colours as ROS has them, between bytes without meaning.
fn npy_packed(kind: &str, alpha: u8) -> Vec<u8> {
    let descr = format!(
        "[('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('', '|V4'), ('rgb', '{kind}'), ('', '|V12')]"
    );
    let data = records(|p, color| {
        let bits = packed(color, alpha).to_le_bytes().to_vec();
        [f32s(p, false), vec![0; 4], bits, vec![0; 12]].concat()
    });
    npy(&descr, "(500,)", data)
}

fn npy_columns(kind: &str, factor: f64) -> Vec<u8> {
    let data = records(|p, color| {
        let values = p.into_iter().chain(color.map(|byte| f64::from(byte) * factor));
        match kind {
            "'<f4'" => values.flat_map(|value| (value as f32).to_le_bytes()).collect(),
            _ => values.flat_map(f64::to_le_bytes).collect(),
        }
    });
    npy(kind, "(500, 6)", data)
}

fn vtk_xml(stored: Stored) -> Vec<u8> {
    let positions = lines(|[x, y, z], _| format!("{x} {y} {z}"));
    let colors = lines(|_, color| row([0.0; 3], " ", color, stored)[6..].to_owned());
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\">\
         <PolyData><Piece NumberOfPoints=\"500\"><Points><DataArray type=\"Float32\" \
         NumberOfComponents=\"3\" format=\"ascii\">\n{positions}</DataArray></Points><PointData>\
         <DataArray type=\"{}\" Name=\"RGB\" NumberOfComponents=\"3\" format=\"ascii\">\n{colors}\
         </DataArray></PointData></Piece></PolyData></VTKFile>\n",
        stored.names()[1]
    )
    .into_bytes()
}

fn vtk_legacy(stored: Stored) -> Vec<u8> {
    let positions = lines(|[x, y, z], _| format!("{x} {y} {z}"));
    // In text, colour scalars are fractions of 1.
    let colors = lines(|_, color| row([0.0; 3], " ", color, stored)[6..].to_owned());
    format!(
        "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET POLYDATA\nPOINTS 500 float\n{positions}\
         POINT_DATA 500\nCOLOR_SCALARS rgb 3\n{colors}"
    )
    .into_bytes()
}

/// LAS 1.2, point format 2, in steps of 1/1024.
fn las(factor: u16) -> Vec<u8> {
    let mut head = vec![0u8; 227];
    head[..4].copy_from_slice(b"LASF");
    (head[24], head[25], head[104]) = (1, 2, 2);
    head[94..96].copy_from_slice(&227u16.to_le_bytes());
    head[96..100].copy_from_slice(&227u32.to_le_bytes());
    head[105..107].copy_from_slice(&26u16.to_le_bytes());
    head[107..111].copy_from_slice(&500u32.to_le_bytes());
    for axis in 0..3 {
        head[131 + 8 * axis..139 + 8 * axis].copy_from_slice(&(1.0f64 / 1024.0).to_le_bytes());
    }
    let body = records(|p, color| {
        let steps = p.into_iter().flat_map(|x| ((x * 1024.0) as i32).to_le_bytes());
        let colors = color.into_iter().flat_map(|byte| (u16::from(byte) * factor).to_le_bytes());
        steps.chain([0; 8]).chain(colors).collect()
    });
    [head, body].concat()
}

fn e57() -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = E57Writer::new(&mut bytes, "file").expect("a writer");
    let prototype = vec![
        Record::CARTESIAN_X_F64,
        Record::CARTESIAN_Y_F64,
        Record::CARTESIAN_Z_F64,
        Record::COLOR_RED_U8,
        Record::COLOR_GREEN_U8,
        Record::COLOR_BLUE_U8,
    ];
    let mut points = writer.add_pointcloud("cloud", prototype).expect("a scan");
    for (p, color) in cloud() {
        let values = p.map(RecordValue::Double).into_iter();
        let colors = color.map(|byte| RecordValue::Integer(byte.into()));
        points.add_point(values.chain(colors).collect()).expect("a point");
    }
    points.finalize().expect("a scan");
    writer.finalize().expect("a file");
    drop(writer);
    bytes.into_inner()
}

/// Every file: its name, and what is in it.
fn files() -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    let mut add = |name: String, bytes: Vec<u8>| files.push((name, bytes));
    for stored in Stored::ALL {
        for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
            add(format!("{stored:?}-{encoding}.ply"), ply(stored, encoding));
        }
        add(format!("{stored:?}.npy"), npy_records(stored));
        add(format!("{stored:?}.vtp"), vtk_xml(stored));
        let names = "x,y,z,red,green,blue\n";
        let table = lines(|p, color| row(p, ",", color, stored));
        add(format!("{stored:?}.csv"), format!("{names}{table}").into_bytes());
        add(format!("{stored:?}.xyz"), lines(|p, color| row(p, " ", color, stored)).into_bytes());
        if ![Stored::Short, Stored::Shifted].contains(&stored) {
            let vertices = lines(|p, color| format!("v {}", row(p, " ", color, stored)));
            add(format!("{stored:?}.obj"), vertices.into_bytes());
            let vertices = lines(|p, color| row(p, " ", color, stored));
            add(format!("{stored:?}.off"), format!("COFF\n500 0 0\n{vertices}").into_bytes());
        }
    }
    for (kind, ascii) in [('U', true), ('U', false), ('F', true), ('F', false)] {
        add(format!("{kind}-{ascii}.pcd"), pcd(kind, ascii));
    }
    for (kind, alpha) in [("<f4", 0), ("<f4", 255), ("<u4", 255), ("<i4", 255)] {
        add(format!("packed{}-{alpha}.npy", &kind[1..]), npy_packed(kind, alpha));
    }
    for (kind, factor) in
        [("'<f4'", 1.0), ("'<f8'", 1.0), ("'<f4'", 1.0 / 255.0), ("'<f8'", 1.0 / 255.0)]
    {
        add(format!("{}-{factor:.0}.npy", &kind[2..4]), npy_columns(kind, factor));
    }
    // Four decimals, as in files for people.
    let short = |[x, y, z]: [f64; 3], color: [u8; 3]| {
        let [r, g, b] = color.map(|byte| f64::from(byte) / 255.0);
        format!("v {x} {y} {z} {r:.4} {g:.4} {b:.4}")
    };
    add("short.obj".to_owned(), lines(short).into_bytes());
    add("fractions.vtk".to_owned(), vtk_legacy(Stored::Double));
    for factor in [1, 256, 257] {
        add(format!("{factor}.las"), las(factor));
    }
    add("bytes.e57".to_owned(), e57());
    files
}

fn read(name: &str, bytes: &[u8]) -> PointSet {
    points::read_bytes(bytes, Path::new(name), &ReadOptions::default())
        .unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn one_cloud_has_one_picture_in_every_format_and_encoding() {
    let bytes = ply(Stored::Byte, "ascii");
    let expected = plan_of(SCENE, &[read("expected.ply", &bytes)]);
    let film = render_twin(&expected).film;
    let reds = film.color.iter().filter(|pixel| pixel[0] > 0.3).count();
    assert!(reds > 500, "{reds} pixels of the sphere are bright");
    let files = files();
    assert!(files.len() > 60, "{} files", files.len());
    for (name, bytes) in &files {
        let set = read(name, bytes);
        assert!(set.colors.is_some(), "{name}: no colours, {}", set.format);
        // Of columns without names, what they were taken for may be in doubt.
        let sure = set.notes.iter().all(|note| note.starts_with("the columns have no names"));
        assert!(sure, "{name}: {:?}", set.notes);
        let plan = plan_of(SCENE, &[set]);
        // Everything that the picture depends on; the pictures of some, to be sure.
        assert_eq!(plan.cloud.points, expected.cloud.points, "{name}: points");
        assert!(plan.colors == expected.colors, "{name}: colours");
        if name.starts_with("Single") || !name.contains('-') && name.len() < 10 {
            assert_same_film(name, &render_twin(&plan).film, &film);
        }
    }
}

#[test]
fn reported_files_have_one_picture() {
    let (Some(bytes), Some(floats), Some(obj)) = (
        shared_data("reported/min_u8.ply"),
        shared_data("reported/min_float255.ply"),
        shared_data("reported/min_objfloat.obj"),
    ) else {
        return;
    };
    let [expected, floats, obj] = [bytes, floats, obj].map(|path| {
        let mut set = points::read(&path, &mut |_, _| {}).expect("a readable file");
        // Text of 64 bits and of 32 differs by a rounding, which moves points, not colours.
        for position in set.positions.iter_mut().flatten() {
            *position = f64::from(*position as f32);
        }
        render_twin(&plan_of(SCENE, &[set])).film
    });
    assert_same_film("floats of 0 to 255", &floats, &expected);
    assert_same_film("fractions in OBJ", &obj, &expected);
}

/// Half of a sphere lacks the attribute, in stripes; the other half has one value of it. Every hit is in the colour of
/// that value or in purple, and nothing between them, under every map, on the device and the CPU.
#[test]
fn points_without_a_value_are_purple_and_not_interpolated() {
    let positions = fibonacci_sphere(2_000);
    let is_none = |p: [f64; 3]| (1.5 * p[1]).floor() % 2.0 == 0.0;
    let lacking = positions.iter().filter(|&&p| is_none(p)).count() as u64;
    let set =
        with_attribute(set_of(positions), "temp", |p| if is_none(p) { f64::NAN } else { 7.0 });
    for map in ["viridis", "turbo", "gray"] {
        let text = format!(
            "{SCENE}[[objects]]\npoints = \"a.ply\"\nmaterial = {{ albedo = \"attribute:temp\", color_map = \
             \"{map}\" }}\n"
        );
        let plan = plan_of(&text, std::slice::from_ref(&set));
        assert_eq!((plan.missing[0].points, plan.missing[0].of), (lacking, 2_000));
        let on_device = Bench::open().render(&plan);
        assert_same_bits(map, &on_device, &render_twin(&plan));
        let value = plan.colors.chunks(3).find(|color| color[0] > 0.0).expect("a value");
        let (mut purple, mut valued) = (0, 0);
        for (pixel, position) in on_device.film.color.iter().zip(&on_device.film.position) {
            let &[r, g, b, _] = pixel;
            if r.max(b) == 0.0 {
                continue;
            }
            let is_value = (r * value[1] - g * value[0]).abs() <= 1e-5 && g > 0.0;
            let is_purple = g == 0.0 && r == b;
            assert!(is_value || is_purple, "{map}: {pixel:?}");
            purple += u32::from(is_purple);
            valued += u32::from(is_value);
            // Farther from the stripes' edges than a trust ball reaches, 0.12.
            let y = f64::from(position[1]);
            if (1.5 * y - (1.5 * y).round()).abs() > 0.25 {
                assert_eq!(is_purple, is_none([0.0, y, 0.0]), "{map}: {position:?}");
            }
        }
        assert!(purple > 500 && valued > 500, "{map}: {purple} and {valued}");
    }
}

/// A colour that is not a number takes no part either, and is drawn as if there were none.
#[test]
fn colors_that_are_no_numbers_make_no_pixel_that_is_none() {
    let mut set = set_of(fibonacci_sphere(500));
    let color = |i: usize| if i.is_multiple_of(3) { [f32::NAN; 3] } else { [0.2, 0.4, 0.1] };
    set.colors = Some((0..500).map(color).collect());
    let plan = plan_of(SCENE, &[set]);
    assert_eq!(plan.missing[0].points, 167);
    let film = render_twin(&plan).film;
    let lit: Vec<_> = film.color.iter().filter(|pixel| pixel[0] > 0.0).collect();
    assert!(lit.len() > 1_000, "{} pixels", lit.len());
    for pixel in lit {
        assert!(pixel.iter().all(|channel| channel.is_finite()), "{pixel:?}");
        let ratio = pixel[1] / pixel[0];
        assert!((ratio - 1.0).abs() < 1e-5 || (ratio - 2.0).abs() < 1e-4, "{pixel:?}");
    }
}
