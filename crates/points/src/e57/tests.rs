//! Files that the crate `e57` writes, and what can be wrong with them.

use crate::options::ReadOptions;
use crate::sensor::SCANNER;
use crate::set::{ColorEncoding, PointSet, Values};
use crate::{PointsError, read_bytes};
use ::e57::{
    E57Writer, Extension, Quaternion, Record, RecordDataType, RecordName, RecordValue, Transform,
    Translation,
};
use std::io::Cursor;
use std::path::Path;
use std::time::{Duration, Instant};

use RecordValue::{Double, Integer, ScaledInteger, Single};

fn read(bytes: &[u8]) -> Result<PointSet, PointsError> {
    read_bytes(bytes, Path::new("a.e57"), &ReadOptions::default())
}

fn message(bytes: &[u8]) -> String {
    read(bytes).unwrap_err().to_string()
}

fn record(name: RecordName, data_type: RecordDataType) -> Record {
    Record { name, data_type }
}

fn integer(min: i64, max: i64) -> RecordDataType {
    RecordDataType::Integer { min, max }
}

/// A scan to write.
struct Made {
    prototype: Vec<Record>,
    points: Vec<Vec<RecordValue>>,
    pose: Option<Transform>,
}

impl Made {
    fn new(prototype: Vec<Record>, points: Vec<Vec<RecordValue>>) -> Self {
        Self { prototype, points, pose: None }
    }
}

fn file_with(scans: &[Made], xml: impl Fn(String) -> String) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = E57Writer::new(&mut bytes, "a").unwrap();
    writer.register_extension(Extension::new("nor", "http://www.libe57.org/nor")).unwrap();
    for scan in scans {
        let mut points = writer.add_pointcloud("b", scan.prototype.clone()).unwrap();
        points.set_transform(scan.pose.clone());
        for point in &scan.points {
            points.add_point(point.clone()).unwrap();
        }
        points.finalize().unwrap();
    }
    writer.finalize_customized_xml(|text| Ok(xml(text))).unwrap();
    drop(writer);
    bytes.into_inner()
}

fn file(scans: &[Made]) -> Vec<u8> {
    file_with(scans, |text| text)
}

fn xyz(kind: &RecordDataType) -> Vec<Record> {
    [RecordName::CartesianX, RecordName::CartesianY, RecordName::CartesianZ]
        .map(|name| record(name, kind.clone()))
        .to_vec()
}

/// Single floats without anything else.
fn plain(points: u16) -> Made {
    let point = |i| [0.5, -1.0, f32::from(i)].map(Single).to_vec();
    Made::new(xyz(&RecordDataType::F32), (0..points).map(point).collect())
}

#[test]
fn every_kind_of_number_is_read() {
    let normal = |axis: &str| RecordName::Unknown {
        namespace: "nor".to_owned(),
        name: format!("normal{axis}"),
    };
    let mut prototype = vec![
        record(
            RecordName::CartesianX,
            RecordDataType::ScaledInteger { min: -1000, max: 1_000_000, scale: 1e-3, offset: 4e6 },
        ),
        record(RecordName::CartesianY, RecordDataType::F64),
        record(RecordName::CartesianZ, RecordDataType::F32),
        record(RecordName::Intensity, RecordDataType::U16),
        record(RecordName::ColorRed, RecordDataType::U8),
        record(RecordName::ColorGreen, RecordDataType::U8),
        record(RecordName::ColorBlue, RecordDataType::U8),
        record(RecordName::RowIndex, integer(0, 700)),
        record(RecordName::ColumnIndex, integer(5, 5)),
        record(RecordName::TimeStamp, RecordDataType::F64),
    ];
    prototype.extend(["X", "Y", "Z"].map(|axis| record(normal(axis), RecordDataType::F32)));
    let point = |i: u16| {
        let mut point = vec![
            ScaledInteger(i64::from(i) * 100 - 1000),
            Double(4_918_340.125 + f64::from(i)),
            Single(0.1),
            Integer(i64::from(i) * 60),
            Integer(255),
            Integer(0),
            Integer(20),
            Integer(i.into()),
            Integer(5),
            Double(0.25 * f64::from(i)),
        ];
        point.extend([0.0, 0.6, 0.8].map(Single));
        point
    };
    // Enough for several packets.
    let set = read(&file(&[Made::new(prototype, (0..700).map(point).collect())])).unwrap();
    assert_eq!((set.len(), set.format.as_str()), (700, "E57 1.0"));
    for i in [0, 1, 699u16] {
        let at = usize::from(i);
        let n = f64::from(i);
        let x = (n * 100.0 - 1000.0) * 1e-3 + 4e6;
        assert_eq!(set.positions[at], [x, 4_918_340.125 + n, f64::from(0.1f32)]);
        let value = |name: &str| set.attribute(name).map(|values| values.get(at));
        assert_eq!(value("intensity"), Some(60.0 * n));
        assert_eq!(value("row_index"), Some(n));
        assert_eq!(value("column_index"), Some(5.0));
        assert_eq!(value("gps_time"), Some(0.25 * n));
    }
    assert!(matches!(set.attribute("intensity"), Some(Values::U16(_))));
    assert!(matches!(set.attribute("column_index"), Some(Values::U8(_))));
    let decode = |stored| ColorEncoding::Srgb8.decode(stored);
    assert_eq!(set.colors.unwrap()[5], [1.0, 0.0, decode(20.0)]);
    assert_eq!(set.normals.unwrap()[5], [0.0, 0.6, 0.8]);
}

/// A quarter turn about z: x becomes y, y becomes -x.
#[test]
fn scans_are_put_where_their_poses_say() {
    let half = 0.5f64.sqrt();
    let pose = Transform {
        rotation: Quaternion { w: half, x: 0.0, y: 0.0, z: half },
        translation: Translation { x: 4e6, y: 0.0, z: -10.0 },
    };
    let posed = Made { pose: Some(pose), ..plain(2) };
    let mut colored = plain(1);
    let colors = [RecordName::ColorRed, RecordName::ColorGreen, RecordName::ColorBlue];
    colored.prototype.extend(colors.map(|name| record(name, integer(0, 1023))));
    colored.points[0].extend([1023, 0, 0].map(Integer));
    colored.prototype.push(record(RecordName::Intensity, RecordDataType::U8));
    colored.points[0].push(Integer(9));
    let set = read(&file(&[posed, colored])).unwrap();
    assert_eq!((set.len(), set.format.as_str()), (3, "E57 1.0, 2 scans"));
    let close = |a: [f64; 3], b: [f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-9);
    assert!(close(set.positions[1], [4e6 + 1.0, 0.5, -9.0]), "{:?}", set.positions);
    assert_eq!(set.positions[2], [0.5, -1.0, 0.0]);
    // The second scan has no pose.
    let [sensor] = set.sensors.as_slice() else { panic!("{:?}", set.sensors) };
    assert_eq!((sensor.position, sensor.points.clone()), ([4e6, 0.0, -10.0], 0..2));
    // Ahead of a scanner is x, which became y; its right is -y, which became x.
    let axes = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]];
    assert!((0..3).all(|i| close(sensor.axes[i], axes[i])), "{:?}", sensor.axes);
    assert_eq!((sensor.image, set.sensor_of(1)), (None, Some([4e6, 0.0, -10.0])));
    assert_eq!(set.sensor_of(2), None);
    // What the first scan has not.
    let colors = set.colors.unwrap();
    assert!(colors[0].iter().all(|channel| (channel - 0.8).abs() < 2e-3), "{colors:?}");
    assert_eq!(colors[2], [1.0, 0.0, 0.0]);
    let Some(Values::F64(intensity)) = &set.attributes.first().map(|a| &a.values) else {
        panic!("{:?}", set.attributes);
    };
    assert!(intensity[0].is_nan() && intensity[2] == 9.0);
}

/// A pose that moves nothing is what programs write that know none; rows and columns show whether it is true.
#[test]
fn a_scan_in_the_origin_is_believed_where_rows_follow_heights() {
    let unmoved = Transform {
        rotation: Quaternion { w: 1.0, x: 0.0, y: 0.0, z: 0.0 },
        translation: Translation { x: 0.0, y: 0.0, z: 0.0 },
    };
    let mut prototype = xyz(&RecordDataType::F64);
    prototype.push(record(RecordName::RowIndex, integer(0, 30)));
    prototype.push(record(RecordName::ColumnIndex, integer(0, 60)));
    let sensors = |shift: f64| {
        let point = |i: u16| {
            let (row, column) = (f64::from(i / 60), f64::from(i % 60));
            let (turn, height) = (-0.02 * column, 0.03 * row - 0.5);
            let reach = 3.0 + f64::from(i % 7);
            let across = reach * height.cos();
            let p =
                [across * turn.cos() + shift, across * turn.sin(), reach * height.sin() + shift];
            let pixel = [i / 60, i % 60].map(|n| Integer(n.into()));
            p.map(Double).into_iter().chain(pixel).collect::<Vec<_>>()
        };
        let scan = Made::new(prototype.clone(), (0..1800).map(point).collect());
        read(&file(&[Made { pose: Some(unmoved.clone()), ..scan }])).unwrap().sensors
    };
    let seen = sensors(0.0);
    assert_eq!((seen[0].position, seen[0].image), ([0.0; 3], Some([60, 30])));
    assert_eq!(seen[0].axes, SCANNER);
    assert_eq!(sensors(20.0), []);
    let plain = Made { pose: Some(unmoved), ..plain(9) };
    assert_eq!(read(&file(&[plain])).unwrap().sensors, []);
}

/// Full intensity is 1 or 255 where floats come without limits.
#[test]
fn floats_without_limits_are_colors_of_either_kind() {
    for (stored, encoding) in [
        ([200.0, 40.0, 20.0], ColorEncoding::Srgb8),
        ([200.0 / 255.0, 40.0 / 255.0, 20.0 / 255.0], ColorEncoding::Fraction),
    ] {
        let mut scan = plain(1);
        let colors = [RecordName::ColorRed, RecordName::ColorGreen, RecordName::ColorBlue];
        scan.prototype.extend(colors.map(|name| record(name, RecordDataType::F32)));
        scan.points[0].extend(stored.map(Single));
        let bytes = file_with(&[scan], |text| {
            assert!(!text.contains("colorLimits"), "the writer states limits");
            text
        });
        let set = read(&bytes).unwrap();
        assert_eq!(set.color_encoding, Some(encoding));
        let expected = [200.0, 40.0, 20.0].map(|byte| ColorEncoding::Srgb8.decode(byte));
        for (found, expected) in set.colors.unwrap()[0].into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6, "{found}, not {expected}");
        }
    }
}

#[test]
fn spherical_coordinates_become_cartesian_and_invalid_points_go() {
    let right = std::f64::consts::FRAC_PI_2;
    let prototype = vec![
        record(RecordName::SphericalRange, RecordDataType::F64),
        record(RecordName::SphericalAzimuth, RecordDataType::F64),
        record(RecordName::SphericalElevation, RecordDataType::F64),
        record(RecordName::SphericalInvalidState, integer(0, 2)),
        record(RecordName::Intensity, RecordDataType::F32),
        record(RecordName::IsIntensityInvalid, integer(0, 1)),
    ];
    let point = |range, azimuth, elevation, state, intensity, invalid| {
        vec![
            Double(range),
            Double(azimuth),
            Double(elevation),
            Integer(state),
            Single(intensity),
            Integer(invalid),
        ]
    };
    let points = vec![
        point(2.0, 0.0, 0.0, 0, 1.0, 0),
        point(2.0, right, 0.0, 0, 1.0, 1),
        point(2.0, 0.0, right, 0, 1.0, 0),
        point(2.0, 0.0, 0.0, 1, 1.0, 0),
        point(2.0, 0.0, 0.0, 2, 1.0, 0),
        point(f64::NAN, 0.0, 0.0, 0, 1.0, 0),
    ];
    let set = read(&file(&[Made::new(prototype, points)])).unwrap();
    let expected = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
    assert_eq!(set.len(), 3);
    for (found, expected) in set.positions.iter().zip(expected) {
        assert!((0..3).all(|axis| (found[axis] - expected[axis]).abs() < 1e-15), "{found:?}");
    }
    assert_eq!((set.invalid, set.non_finite, set.in_file()), (2, 1, 6));
    // Angles are seen from the origin, whether or not there is a pose.
    assert_eq!((set.sensors[0].position, set.sensors[0].points.clone()), ([0.0; 3], 0..6));
    let intensity = set.attribute("intensity").unwrap();
    assert!(intensity.get(1).is_nan() && intensity.get(0) == 1.0);
    assert_eq!(set.attributes.len(), 1);
}

#[test]
fn damaged_descriptions_say_what_is_wrong() {
    let with = |from: &str, to: &str| {
        message(&file_with(&[plain(5)], |text| {
            assert!(text.contains(from), "no {from} in {text}");
            text.replace(from, to)
        }))
    };
    let count = "recordCount=\"5\"";
    for (from, to, expected) in [
        (count, "recordCount=\"-5\"", "found -5 as recordCount of scan 0, expected a number"),
        (count, "", "found none as recordCount of scan 0"),
        (count, "recordCount=\"6\"", "declares 6 points of scan 0, but the file ends after 5"),
        (count, "recordCount=\"18446744073709551615\"", "but the file ends after 5"),
        (count, "recordCount=\"0\"", "the file holds no points"),
        ("fileOffset=\"48\"", "fileOffset=\"99999999999999\"", "found fewer as bytes of the file"),
        ("fileOffset=\"48\"", "fileOffset=\"52\"", "as the kind of the section of scan 0"),
        ("cartesianZ", "height", "found no number 'x'"),
        ("<prototype", "<other", "as the XML section, expected XML"),
        (
            "data3D",
            "data4D",
            "found no scan, expected it as data3D in the XML section; the file holds no points",
        ),
        ("type=\"Float\"", "type=\"Text\"", "found Text as the type of 'cartesianX' in the proto"),
        (
            "type=\"Float\" precision=\"single\"",
            "type=\"Integer\" minimum=\"3\" maximum=\"2\"",
            "found 2 as the maximum of 'cartesianX' in the prototype of scan 0, expected at least",
        ),
        (
            "type=\"Float\" precision=\"single\"",
            "type=\"Integer\" minimum=\"3\" maximum=\"3\"",
            "found 5 points without a bit as the prototype of scan 0",
        ),
        (
            "type=\"Float\" precision=\"single\"",
            "type=\"Integer\" minimum=\"x\"",
            "found x as minimum of 'cartesianX'",
        ),
    ] {
        let message = with(from, to);
        assert!(message.contains(expected), "{message}\nlacks {expected}");
    }
    let deep = with("<data3D", &format!("{}<data3D", "<a>".repeat(300_000)));
    assert!(deep.contains("as the XML section"), "{deep}");
}

/// Makes the checksums right again.
fn mend(file: &mut [u8]) {
    let table = super::pages::checksum_table();
    for page in file.chunks_exact_mut(1024) {
        let sum = !page[..1020].iter().fold(!0, |sum: u32, &byte| {
            table[((sum ^ u32::from(byte)) & 0xff) as usize] ^ sum >> 8
        });
        page[1020..].copy_from_slice(&sum.to_be_bytes());
    }
}

#[test]
fn damaged_bytes_are_noticed() {
    let whole = file(&[plain(5)]);
    let with = |place: usize, bytes: &[u8]| {
        let mut file = whole.clone();
        file[place..place + bytes.len()].copy_from_slice(bytes);
        mend(&mut file);
        message(&file)
    };
    assert!(message(&whole[..40]).contains("found 40 bytes as the file, expected an E57 header"));
    assert!(with(8, &[2]).contains("found 2.0 as the version, expected 1.0"));
    assert!(with(40, &[0; 8]).contains("found 0 as the size of a page, expected 64 to 1048576"));
    let huge = [255; 8];
    assert!(with(40, &huge).contains("as the size of a page"));
    assert!(with(32, &huge).contains("as the length of the XML section, expected at most"));
    assert!(with(24, &huge).contains("found fewer as bytes of the file"));
    // The section has 32 bytes from 48 on; then a packet.
    assert!(with(48, &[7]).contains("found 7 as the kind of the section of scan 0"));
    assert!(with(64, &huge).contains("found fewer") || with(64, &huge).contains("ends after 0"));
    assert!(with(80, &[9]).contains("found 9 as the kind of a packet of scan 0"));
    assert!(
        with(82, &[9, 0]).contains("found 10 as the length of a packet of scan 0, expected at")
    );
    assert!(with(84, &[9, 0]).contains("found 9 as the number of streams of a packet of scan 0"));
    assert!(
        with(86, &[0, 0]).contains("as the kind of a packet")
            || with(86, &[0, 0]).contains("ends after 0")
    );
    let mut flipped = whole.clone();
    flipped[100] ^= 1;
    assert!(message(&flipped).contains("as the checksum of page 0, expected"));
    assert!(read(&whole[..whole.len() - 1]).is_err());
}

#[test]
fn no_damage_panics_or_hangs() {
    let mut scan = plain(3);
    scan.prototype.push(record(RecordName::Intensity, integer(-3, 17)));
    for (i, point) in (0..).zip(&mut scan.points) {
        point.push(Integer(i));
    }
    let whole = file(&[scan]);
    let begin = Instant::now();
    for length in (0..whole.len()).step_by(7) {
        let mut file = whole[..length].to_vec();
        mend(&mut file);
        assert!(read(&file).is_err());
    }
    for place in 0..whole.len() {
        for byte in *b"\0\xff9<" {
            let mut file = whole.clone();
            file[place] = byte;
            mend(&mut file);
            let _ = read(&file);
        }
    }
    assert!(begin.elapsed() < Duration::from_secs(60), "{:?}", begin.elapsed());
}
