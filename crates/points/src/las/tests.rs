//! Files made here: every point format, plain and compressed, and what can be wrong with them.

use super::record::length_of;
use crate::options::ReadOptions;
use crate::set::{ColorEncoding, PointSet, Values};
use crate::{PointsError, read_bytes};
use ::laz::{LasZipCompressor, LazVlr, LazVlrBuilder};
use std::io::Cursor;
use std::path::Path;
use std::time::{Duration, Instant};

const SCALE: f64 = 0.01;
const OFFSET: [f64; 3] = [500_000.0, 4_900_000.0, -7.5];

fn read(bytes: &[u8]) -> Result<PointSet, PointsError> {
    read_bytes(bytes, Path::new("a.las"), &ReadOptions::default())
}

fn message(bytes: &[u8]) -> String {
    read(bytes).unwrap_err().to_string()
}

/// What a file is made of.
struct Made {
    minor: u8,
    format: u8,
    /// Bytes of each record behind those of the format.
    extra: u16,
    points: u32,
    compression: Compression,
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum Compression {
    None,
    Chunks(u32),
    Varying,
}

impl Made {
    fn plain(format: u8, points: u32) -> Self {
        let minor = if format > 5 { 4 } else { 2 };
        Self { minor, format, extra: 0, points, compression: Compression::None }
    }

    fn record_length(&self) -> usize {
        length_of(self.format) + usize::from(self.extra)
    }

    fn record(&self, index: u32) -> Vec<u8> {
        let mut record = vec![0; self.record_length()];
        let mut put = |place: usize, bytes: &[u8]| {
            record[place..place + bytes.len()].copy_from_slice(bytes);
        };
        let i = index as i32;
        for (axis, value) in [i * 7, -i, i * i % 1000].into_iter().enumerate() {
            put(4 * axis, &value.to_le_bytes());
        }
        put(12, &(index as u16 * 3).to_le_bytes());
        if self.format < 6 {
            // Return 2 of 5, flight line's edge, class 6 withheld.
            put(14, &[2 | 5 << 3 | 1 << 7, 6 | 4 << 5, -9i8 as u8, 200]);
            put(18, &77u16.to_le_bytes());
        } else {
            // Return 12 of 15; overlap; channel 2, scan direction.
            put(14, &[12 | 15 << 4, 8 | 2 << 4 | 1 << 6, 65, 200]);
            put(18, &(-1500i16).to_le_bytes());
            put(20, &77u16.to_le_bytes());
        }
        if let Some(place) = [0, 20, 0, 20, 20, 20, 22, 22, 22, 22, 22]
            .get(usize::from(self.format))
            .filter(|&&place| place > 0)
        {
            put(*place, &(1e6 + f64::from(index)).to_le_bytes());
        }
        let color = match self.format {
            2 => 20,
            3 | 5 => 28,
            7 | 8 | 10 => 30,
            _ => 0,
        };
        if color > 0 {
            for channel in 0..3u16 {
                put(color + 2 * usize::from(channel), &(1000 * (channel + 1)).to_le_bytes());
            }
        }
        if matches!(self.format, 8 | 10) {
            put(36, &(index as u16).to_le_bytes());
        }
        record[length_of(self.format)..].fill(index as u8);
        record
    }

    fn file(&self) -> Vec<u8> {
        let size: u16 = [227, 227, 227, 235, 375, 393][usize::from(self.minor)];
        let mut header = vec![0; size.into()];
        let mut put = |place: usize, bytes: &[u8]| {
            header[place..place + bytes.len()].copy_from_slice(bytes);
        };
        let compressed = self.compression != Compression::None;
        let vlr = compressed.then(|| {
            let builder = LazVlrBuilder::default();
            let builder = builder.with_point_format(self.format, self.extra).unwrap();
            match self.compression {
                Compression::Chunks(count) => builder.with_fixed_chunk_size(count).build(),
                _ => builder.with_variable_chunk_size().build(),
            }
        });
        let mut vlrs = Vec::new();
        if let Some(vlr) = &vlr {
            let mut contents = Vec::new();
            vlr.write_to(&mut contents).unwrap();
            vlrs.extend(variable_record("laszip encoded", LazVlr::RECORD_ID, &contents));
        }
        let data = u32::from(size) + vlrs.len() as u32;
        put(0, b"LASF");
        put(24, &[1, self.minor]);
        put(94, &size.to_le_bytes());
        put(96, &data.to_le_bytes());
        put(100, &u32::from(compressed).to_le_bytes());
        put(104, &[self.format | u8::from(compressed) << 7]);
        put(105, &(self.record_length() as u16).to_le_bytes());
        if self.minor < 4 {
            put(107, &self.points.to_le_bytes());
        } else {
            put(247, &u64::from(self.points).to_le_bytes());
        }
        for (axis, offset) in OFFSET.iter().enumerate() {
            put(131 + 8 * axis, &SCALE.to_le_bytes());
            put(155 + 8 * axis, &offset.to_le_bytes());
        }
        let head = [header, vlrs].concat();
        let Some(vlr) = vlr else {
            let records = (0..self.points).flat_map(|index| self.record(index));
            return head.into_iter().chain(records).collect();
        };
        let mut file = Cursor::new(head);
        file.set_position(file.get_ref().len() as u64);
        let mut compressor = LasZipCompressor::new(&mut file, vlr).unwrap();
        for index in 0..self.points {
            if self.compression == Compression::Varying && [40, 50].contains(&index) {
                compressor.finish_current_chunk().unwrap();
            }
            compressor.compress_one(&self.record(index)).unwrap();
        }
        compressor.done().unwrap();
        drop(compressor);
        file.into_inner()
    }
}

fn variable_record(user: &str, id: u16, contents: &[u8]) -> Vec<u8> {
    let mut record = vec![0; 54];
    record[2..2 + user.len()].copy_from_slice(user.as_bytes());
    record[18..20].copy_from_slice(&id.to_le_bytes());
    record[20..22].copy_from_slice(&(contents.len() as u16).to_le_bytes());
    record.extend(contents);
    record
}

/// A plain file with one more variable length record before its points.
fn with_record(mut file: Vec<u8>, record: &[u8]) -> Vec<u8> {
    let size = u16::from_le_bytes([file[94], file[95]]);
    let data = u32::from_le_bytes([file[96], file[97], file[98], file[99]]) + record.len() as u32;
    file[96..100].copy_from_slice(&data.to_le_bytes());
    file[100] = file[100].wrapping_add(1);
    let points = file.split_off(size.into());
    [file, record.to_vec(), points].concat()
}

#[test]
fn every_point_format_is_read_plain_and_compressed() {
    for format in 0..=10 {
        for extra in [0, 3] {
            let of = |compression| {
                let made = Made { extra, compression, ..Made::plain(format, 100) };
                read(&made.file()).unwrap()
            };
            let plain = of(Compression::None);
            let expected: Vec<[f64; 3]> = (0..100)
                .map(|i| {
                    let stored = [i * 7, -i, i * i % 1000].map(f64::from);
                    [0, 1, 2].map(|axis| stored[axis] * SCALE + OFFSET[axis])
                })
                .collect();
            assert_eq!(plain.positions, expected, "format {format}");
            let value = |name: &str| plain.attribute(name).map(|values| values.get(50));
            assert_eq!(value("intensity"), Some(150.0));
            assert_eq!(value("user_data"), Some(200.0));
            assert_eq!(value("point_source_id"), Some(77.0));
            let [number, of_all, class, flags, angle, edge, direction] = match format {
                0..6 => [2.0, 5.0, 6.0, 4.0, -9.0, 1.0, 0.0],
                _ => [12.0, 15.0, 65.0, 8.0, 0.006 * -1500.0, 0.0, 1.0],
            };
            assert_eq!(value("return_number"), Some(number));
            assert_eq!(value("number_of_returns"), Some(of_all));
            assert_eq!(value("classification"), Some(class));
            assert_eq!(value("flags"), Some(flags));
            assert!((value("scan_angle").unwrap() - angle).abs() < 1e-6);
            assert_eq!(value("edge_of_flight_line"), Some(edge));
            assert_eq!(value("scan_direction"), Some(direction));
            assert_eq!(value("scanner_channel"), (format > 5).then_some(2.0));
            let has_time = !matches!(format, 0 | 2);
            assert_eq!(value("gps_time"), has_time.then_some(1e6 + 50.0), "format {format}");
            assert_eq!(value("nir"), matches!(format, 8 | 10).then_some(50.0));
            let has_color = matches!(format, 2 | 3 | 5 | 7 | 8 | 10);
            let decode = |stored| ColorEncoding::Srgb16.decode(stored);
            let color = [decode(1000.0), decode(2000.0), decode(3000.0)];
            assert_eq!(plain.colors.as_ref().map(|c| c[99]), has_color.then_some(color));

            for compression in [Compression::Chunks(30), Compression::Varying] {
                let laz = of(compression);
                assert_eq!(laz.format, plain.format.replace("LAS", "LAZ"));
                let laz = PointSet { format: plain.format.clone(), ..laz };
                assert!(laz == plain, "format {format}, {extra} extra bytes, {compression:?}");
            }
        }
    }
}

#[test]
fn every_version_has_its_count() {
    for minor in 0..=5 {
        let file = Made { minor, ..Made::plain(1, 5) }.file();
        let set = read(&file).unwrap();
        assert_eq!((set.len(), set.format), (5, format!("LAS 1.{minor}, point format 1")));
    }
    // Times are given as they are stored, whatever offset the header of version 1.5 has.
    for compression in [Compression::None, Compression::Chunks(3)] {
        let mut file = Made { minor: 5, compression, ..Made::plain(7, 5) }.file();
        file[6] = 1 << 6;
        file[391..393].copy_from_slice(&1500u16.to_le_bytes());
        let set = read(&file).unwrap();
        assert_eq!(set.attribute("gps_time").unwrap().get(4), 1e6 + 4.0);
        assert_eq!(set.colors.map(|colors| colors.len()), Some(5));
    }
    // Version 1.4 may leave the count where older versions have it.
    let mut old_place = Made { minor: 4, ..Made::plain(1, 5) }.file();
    old_place[247] = 0;
    old_place[107] = 4;
    assert_eq!(read(&old_place).unwrap().len(), 4);
}

/// A file of version 1.4 or later with an extended record behind its points.
fn with_extended(mut file: Vec<u8>, id: u16, contents: &[u8]) -> Vec<u8> {
    let place = file.len() as u64;
    file[235..243].copy_from_slice(&place.to_le_bytes());
    file[243..247].copy_from_slice(&1u32.to_le_bytes());
    let mut record = vec![0; 60];
    record[2..11].copy_from_slice(b"LASF_Spec");
    record[18..20].copy_from_slice(&id.to_le_bytes());
    record[20..28].copy_from_slice(&(contents.len() as u64).to_le_bytes());
    [file, record, contents.to_vec()].concat()
}

fn describe(kind: u8, options: u8, name: &str, scale: f64, offset: f64) -> Vec<u8> {
    let mut bytes = vec![0; 192];
    bytes[2..4].copy_from_slice(&[kind, options]);
    bytes[4..4 + name.len()].copy_from_slice(name.as_bytes());
    bytes[112..120].copy_from_slice(&scale.to_le_bytes());
    bytes[136..144].copy_from_slice(&offset.to_le_bytes());
    bytes
}

/// Programs that add a number to a file add a record of their own: `Deviation` of 16 bits, then
/// `confidence` of 8. A record that describes all three bytes by itself replaces the others.
#[test]
fn extra_bytes_of_several_records_are_all_read() {
    let (deviation, confidence) =
        (describe(3, 0, "Deviation", 0.0, 0.0), describe(1, 0, "confidence", 0.0, 0.0));
    let both = [&deviation[..], &confidence[..]].concat();
    let record = |contents: &[u8]| variable_record("LASF_Spec", 4, contents);
    for compression in [Compression::None, Compression::Chunks(2)] {
        let file = Made { extra: 3, compression, ..Made::plain(6, 3) }.file();
        let mut files = vec![with_extended(file.clone(), 4, &both)];
        if compression == Compression::None {
            // Records stand in the order in which they were added.
            let two =
                with_record(with_record(file.clone(), &record(&confidence)), &record(&deviation));
            files.push(two);
            files.push(with_extended(
                with_record(file.clone(), &record(&deviation)),
                4,
                &confidence,
            ));
            files.push(with_record(with_record(file, &record(&both)), &record(&deviation)));
        }
        for file in files {
            let set = read(&file).unwrap();
            let values = Values::U16(vec![0, 0x0101, 0x0202]);
            assert_eq!(set.attribute("Deviation"), Some(&values), "{compression:?}");
            assert_eq!(set.attribute("confidence"), Some(&Values::U8(vec![0, 1, 2])));
            assert_eq!(set.attribute("Deviation_2"), None);
        }
    }
}

#[test]
fn extra_bytes_have_the_names_types_and_scales_of_their_description() {
    let descriptions = [
        describe(1, 0, "amplitude", 9.0, 9.0),
        describe(2, 1 << 3 | 1 << 4, "height", 0.5, 10.0),
        describe(0, 1, "padding", 0.0, 0.0),
        describe(11, 0, "pair", 0.0, 0.0),
        // Beyond the record.
        describe(10, 0, "more", 0.0, 0.0),
    ]
    .concat();
    let made = Made { extra: 6, ..Made::plain(0, 3) };
    let file = with_record(made.file(), &variable_record("LASF_Spec", 4, &descriptions));
    let set = read(&file).unwrap();
    assert_eq!(set.attribute("amplitude"), Some(&Values::U8(vec![0, 1, 2])));
    assert_eq!(set.attribute("height"), Some(&Values::F64(vec![10.0, 10.5, 11.0])));
    assert_eq!(set.attribute("pair_1"), Some(&Values::U8(vec![0, 1, 2])));
    assert_eq!((set.attribute("padding"), set.attribute("more")), (None, None));
}

#[test]
fn damaged_headers_say_what_is_wrong() {
    let with = |place: usize, bytes: &[u8]| {
        let mut file = Made::plain(3, 5).file();
        file[place..place + bytes.len()].copy_from_slice(bytes);
        message(&file)
    };
    let huge = u32::MAX.to_le_bytes();
    for (message, expected) in [
        (with(24, &[2]), "found 2.2 as the version, expected 1.0 to 1.5; convert it"),
        (with(25, &[7]), "found 1.7 as the version"),
        (with(25, &[4]), "found 227 bytes of 397 as the size of the header, expected at least 375"),
        (with(94, &[9, 0]), "found 9 bytes of 397 as the size of the header"),
        (with(104, &[11]), "found 11 as the point format, expected 0 to 10"),
        (
            with(105, &[33, 0]),
            "found 33 bytes as the length of a point record, expected at least 34",
        ),
        (with(96, &huge), "found 4294967295 as the offset to the points, expected 227 to 397"),
        (with(96, &[0; 4]), "found 0 as the offset to the points"),
        (with(131, &f64::NAN.to_le_bytes()), "as the scale factors, expected finite numbers"),
        (with(155, &f64::INFINITY.to_le_bytes()), "as the offsets, expected finite numbers"),
        (
            with(107, &huge),
            "declares 4294967295 points needing 146028888030 bytes, but the file ends after 5 in \
             170 bytes",
        ),
        (
            with(105, &[255, 255]),
            "declares 5 points needing 327675 bytes, but the file ends after 0",
        ),
        (with(107, &[0; 4]), "found 0 as the number of points"),
        (with(104, &[3 | 1 << 7]), "found no LASzip record"),
    ] {
        assert!(message.contains(expected), "{message}\nlacks {expected}");
    }
    assert!(message(b"LASF").contains("found 4 bytes as the file, expected a LAS header of 227"));
}

#[test]
fn records_that_reach_too_far_are_passed_over() {
    let mut file = Made::plain(0, 5).file();
    file[100..104].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(read(&file).unwrap().len(), 5);
    let mut long = with_record(file, &variable_record("LASF_Spec", 4, &[1; 192]));
    long[227 + 20..227 + 22].copy_from_slice(&[255, 255]);
    assert_eq!(read(&long).unwrap().len(), 5);
    // Extended records from nowhere, of a length that overflows.
    let mut extended = Made::plain(6, 5).file();
    extended[235..243].copy_from_slice(&(u64::MAX - 10).to_le_bytes());
    extended[243..247].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(read(&extended).unwrap().len(), 5);
    extended[235..243].copy_from_slice(&20u64.to_le_bytes());
    extended[40..48].copy_from_slice(&u64::MAX.to_le_bytes());
    assert_eq!(read(&extended).unwrap().len(), 5);
}

#[test]
fn compressed_files_are_not_believed() {
    let made = |format| Made { compression: Compression::Chunks(10), ..Made::plain(format, 25) };
    let with = |format: u8, place: usize, bytes: &[u8]| {
        let mut file = made(format).file();
        file[place..place + bytes.len()].copy_from_slice(bytes);
        message(&file)
    };
    let many = with(3, 107, &u32::MAX.to_le_bytes());
    assert!(many.contains("as the number of points, expected no more than LAZ could hold"));
    let more = with(3, 107, &100_000u32.to_le_bytes());
    assert!(more.contains("but the file ends after") || more.contains("bits without"), "{more}");
    let other = with(3, 104, &[1 | 1 << 7]);
    assert!(other.contains("expected the items of the point format"), "{other}");
    // In the LASzip record, which is behind a header of 227 bytes and its own of 54.
    let vlr = |place: usize| 227 + 54 + place;
    assert!(with(3, vlr(0), &[9, 0]).contains("as the LASzip record, expected one that can"));
    assert!(with(3, vlr(0), &[3, 0]).contains("layers, which this point format has not"));
    assert!(with(3, vlr(32), &[0, 0]).contains("as the LASzip record, expected the items"));
    assert!(with(3, vlr(38), &[9, 0]).contains("expected the items of the point format"));
    // A chunk of layers: its first point of 30 bytes, its count, the sizes of its layers.
    let chunk = 375 + 54 + 34 + 6 + 8;
    let none = with(6, chunk + 30, &[0; 4]);
    assert!(none.contains("found a chunk without points as compressed point 0"), "{none}");
    assert!(with(6, chunk + 34, &[255; 4]).contains("the file ends after 0"));
}

/// Damage anywhere ends in points or an error, soon.
#[test]
fn no_damage_panics_or_hangs() {
    for (format, compression) in [
        (3, Compression::None),
        (3, Compression::Chunks(7)),
        (2, Compression::Varying),
        (8, Compression::Chunks(7)),
        (7, Compression::Varying),
    ] {
        let whole = Made { compression, extra: 1, ..Made::plain(format, 10) }.file();
        let timed = |bytes: &[u8]| {
            let begin = Instant::now();
            let result = read(bytes);
            assert!(begin.elapsed() < Duration::from_secs(1), "format {format}: {result:?}");
            result
        };
        // Each decompressor takes a millisecond to set up.
        let step = if compression == Compression::None { 1 } else { 5 };
        for length in (0..whole.len()).step_by(step) {
            assert!(timed(&whole[..length]).is_err() || compression != Compression::None);
        }
        for place in (24..whole.len()).step_by(step) {
            let mut file = whole.clone();
            for byte in [0, 0xff, 0x80] {
                file[place] = byte;
                let _ = timed(&file);
            }
        }
    }
}

/// Bytes that no record describes hold data that nobody sees.
#[test]
fn extra_bytes_without_a_description_are_noted() {
    let mut made = Made { extra: 4, ..Made::plain(1, 10) };
    let plain = read(&made.file()).unwrap();
    let note = "4 extra bytes of each point are left out, since no record of the file describes";
    assert!(plain.notes.len() == 1 && plain.notes[0].starts_with(note), "{:?}", plain.notes);
    let described = variable_record("LASF_Spec", 4, &describe(9, 0, "height", 0.0, 0.0));
    assert_eq!(read(&with_record(made.file(), &described)).unwrap().notes, [""; 0]);
    made.extra = 0;
    assert_eq!(read(&made.file()).unwrap().notes, [""; 0]);
}

#[test]
fn headers_that_would_lose_all_points_are_refused() {
    let whole = Made::plain(1, 10).file();
    let with = |place: usize, bytes: &[u8]| {
        let mut file = whole.clone();
        file[place..place + bytes.len()].copy_from_slice(bytes);
        file
    };
    let unfinished = message(&with(107, &[0; 4]));
    assert!(
        unfinished.contains(
            "found 0 as the number of points, expected the count of those in the 280 bytes"
        ),
        "{unfinished}"
    );
    for axis in 0..2 {
        let flat = message(&with(131 + 8 * axis, &[0; 8]));
        assert!(flat.contains("as the scale factors, expected numbers other than 0"), "{flat}");
    }
    let flat = read(&with(147, &[0; 8])).unwrap();
    assert_eq!(flat.notes, ["the scale factor of z is 0, so all points have the height -7.5"]);
    let other = message(&with(0, b"\x01SOS"));
    assert!(other.contains("begin with '\\u{1}SOS' as the file, expected LASF"), "{other}");
}
