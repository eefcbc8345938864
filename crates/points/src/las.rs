//! LAS and LAZ files, versions 1.0 to 1.5, point formats 0 to 10.
//!
//! Version 1.5 adds three numbers about GPS times to the header and no longer has the counts of 32
//! bits; its points are those of version 1.4. Times come as they are stored, without the offset that
//! the header may name.
//!
//! The reader is our own; LAZ is decompressed by the crate `laz`. Coordinates are the stored
//! integers times their scale plus their offset, in f64. Points marked as withheld come too, like
//! all others: `flags` says so, and a filter may leave them out.

mod crs;
mod extra;
mod laz;
mod record;

use crate::collect::Collector;
use crate::error::{PointsError, Quoted};
use crate::field::Type;
use crate::options::ReadOptions;
use crate::set::PointSet;
use crate::source::{Seekable, Source};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

/// Bytes of the header that all versions have.
const HEADER: u64 = 227;
/// Bytes of the header of version 1.4; later ones only add to it.
const HEADER_1_4: u64 = 375;
/// Bytes before the contents of a variable length record, and of an extended one.
const VLR_HEADER: u64 = 54;
const EVLR_HEADER: u64 = 60;
/// Variable length records that are looked at, of either kind.
const MAX_RECORDS: u32 = 1 << 12;
/// Bytes that are read at once, about.
const BLOCK: usize = 1 << 20;

/// Where the header has flags, and the one that says that well-known text counts.
const GLOBAL_ENCODING: u64 = 6;
const WKT_COUNTS: u8 = 1 << 4;

const EXPORT: &str = "the file is damaged: copy or export it again";
/// Of what has the name of a LAS file only.
const OTHER: &str = "give the file the extension of what it is, or export it again";
/// Of a file whose writer did not come to its end.
const UNFINISHED: &str = "the program that wrote it did not finish: export it again, or have the header repaired (lasinfo -repair)";
/// Of what others read.
const CONVERT: &str = "convert it to LAS 1.4, for example with PDAL or las2las";

pub(crate) fn sniff(start: &[u8]) -> bool {
    start.starts_with(b"LASF")
}

/// What the header says that matters here.
struct Header {
    version: [u8; 2],
    /// 0 to 10.
    format: u8,
    compressed: bool,
    record_length: u16,
    points: u64,
    /// Where the points begin.
    data: u64,
    scale: [f64; 3],
    offset: [f64; 3],
    header_size: u16,
    records: u32,
    /// Where extended records begin, and how many there are.
    extended: (u64, u32),
}

/// A variable length record.
struct Record {
    user: [u8; 16],
    id: u16,
    /// Where its contents are, and how many bytes.
    place: u64,
    length: u64,
}

pub(crate) fn read(
    source: Source<'_>,
    path: &Path,
    options: &ReadOptions,
) -> Result<PointSet, PointsError> {
    let io_error = |source| PointsError::Io { path: path.into(), source };
    let mut file = source.seekable().map_err(io_error)?;
    let header = Header::read(&mut file, path)?;
    let records = header.variable_records(&mut file, path)?;
    let known = record::length_of(header.format);
    let described = records.iter().filter(|record| record.is("LASF_Spec", extra::RECORD_ID));
    let described: Vec<Vec<u8>> = described
        .take(extra::MAX_RECORDS)
        .map(|record| file.bytes_at(record.place, record.length.min(extra::MAX_BYTES)))
        .collect::<Result<_, _>>()
        .map_err(io_error)?;
    let extra = extra::of_records(&described, known, header.record_length.into());
    let unread = usize::from(header.record_length) - known - extra::bytes_of(&extra);
    let layout = record::Layout::new(&header, extra);

    let mut collector = Collector::new(layout.fields(), path, options)?;
    let mut notes = Vec::new();
    if unread > 0 {
        notes.push(format!(
            "{unread} extra bytes of each point are left out, since no record of the file describes them as numbers"
        ));
    }
    if header.scale[2] == 0.0 {
        let height = header.offset[2];
        notes.push(format!("the scale factor of z is 0, so all points have the height {height}"));
    }
    let prefers_text = file.bytes_at(GLOBAL_ENCODING, 2).map_err(io_error)?[0] & WKT_COUNTS != 0;
    if let Some(system) = crs::of(&mut file, &records, prefers_text).map_err(io_error)? {
        notes.extend(system.doubts());
        if system.degrees {
            collector.is_in_degrees(system.in_words());
        }
    }
    let left = file.length().saturating_sub(header.data);
    if header.compressed {
        // Hardly any point takes less than a byte.
        collector.expect(header.points.min(left))?;
    } else {
        let there = left / u64::from(header.record_length);
        if header.points == 0
            && there > 0
            && header.extended.1 == 0
            && !matches!(header.format, 4 | 5)
        {
            let expected = format!("the count of those in the {left} bytes that follow");
            return Err(PointsError::wrong(path, "the number of points", 0, &expected, UNFINISHED));
        }
        if there < header.points {
            return Err(header.cut_off(there, Some(left), path));
        }
        collector.expect(header.points)?;
    }
    let mut row = Vec::new();
    let mut take = |bytes: &[u8]| {
        layout.values(bytes, &mut row);
        collector.push(&row)
    };
    let kind = if header.compressed {
        let vlr = records.iter().find(|r| r.is("laszip encoded", laz::RECORD_ID));
        let vlr = vlr.ok_or_else(|| PointsError::Missing {
            path: path.into(),
            missing: "LASzip record".to_owned(),
            place: "among the variable length records of compressed points".to_owned(),
            help: EXPORT,
        })?;
        let vlr = file.bytes_at(vlr.place, vlr.length).map_err(io_error)?;
        laz::read(file, &header, &vlr, path, &mut take)?;
        "LAZ"
    } else {
        read_plain(&mut file, &header, &mut take).map_err(|error| error.at(path))?;
        "LAS"
    };
    let [major, minor] = header.version;
    let format = format!("{kind} {major}.{minor}, point format {}", header.format);
    let mut set = collector.finish(&format)?;
    set.notes.extend(notes);
    Ok(set)
}

/// What may go wrong while points are read.
enum Failed {
    Io(io::Error),
    Points(PointsError),
}

impl Failed {
    fn at(self, path: &Path) -> PointsError {
        match self {
            Self::Io(source) => PointsError::Io { path: path.into(), source },
            Self::Points(error) => error,
        }
    }
}

fn read_plain(
    file: &mut Seekable<'_>,
    header: &Header,
    take: &mut dyn FnMut(&[u8]) -> Result<(), PointsError>,
) -> Result<(), Failed> {
    let size = usize::from(header.record_length);
    let mut block = vec![0; (BLOCK / size).max(1) * size];
    file.seek(SeekFrom::Start(header.data)).map_err(Failed::Io)?;
    let mut left = header.points;
    while left > 0 {
        let count = left.min((block.len() / size) as u64);
        let bytes = &mut block[..count as usize * size];
        file.read_exact(bytes).map_err(Failed::Io)?;
        for record in bytes.chunks_exact(size) {
            take(record).map_err(Failed::Points)?;
        }
        left -= count;
    }
    Ok(())
}

impl Header {
    fn read(file: &mut Seekable<'_>, path: &Path) -> Result<Self, PointsError> {
        let io_error = |source| PointsError::Io { path: path.into(), source };
        let wrong = |place: &str, found: String, expected: &str| {
            PointsError::wrong(path, place, found, expected, EXPORT)
        };
        let sign = file.bytes_at(0, file.length().min(4)).map_err(io_error)?;
        if !sniff(&sign) {
            let found = format!("bytes that begin with {}", Quoted(&sign));
            return Err(PointsError::wrong(
                path,
                "the file",
                found,
                "LASF, as LAS and LAZ begin",
                OTHER,
            ));
        }
        if file.length() < HEADER {
            let found = format!("{} bytes", file.length());
            return Err(wrong("the file", found, "a LAS header of 227 bytes"));
        }
        let bytes = file.bytes_at(0, HEADER_1_4.min(file.length())).map_err(io_error)?;
        let number = |kind: Type, place: usize| kind.read::<false>(&bytes[place..]);
        let u16_at = |place| number(Type::U16, place) as u16;
        let u32_at = |place| number(Type::U32, place) as u32;
        let u64_at = |place: usize| {
            let mut array = [0; 8];
            array.copy_from_slice(&bytes[place..place + 8]);
            u64::from_le_bytes(array)
        };

        let version = [bytes[24], bytes[25]];
        if version[0] != 1 || version[1] > 5 {
            let found = format!("{}.{}", version[0], version[1]);
            return Err(PointsError::wrong(path, "the version", found, "1.0 to 1.5", CONVERT));
        }
        let is_1_4 = version[1] >= 4;
        let header_size = u16_at(94);
        let least = if is_1_4 { HEADER_1_4 } else { HEADER };
        if u64::from(header_size) < least || file.length() < least {
            let found = format!("{header_size} bytes of {}", file.length());
            return Err(wrong("the size of the header", found, &format!("at least {least}")));
        }
        // The highest bit says LAZ; the next was used by early versions of LASzip.
        let (format, compressed) = (bytes[104] & 0x3f, bytes[104] & 0xc0 != 0);
        if format > 10 {
            return Err(PointsError::wrong(path, "the point format", format, "0 to 10", CONVERT));
        }
        let record_length = u16_at(105);
        let least = record::length_of(format);
        if usize::from(record_length) < least {
            let found = format!("{record_length} bytes");
            let expected = format!("at least {least} for point format {format}");
            return Err(wrong("the length of a point record", found, &expected));
        }
        let legacy = u64::from(u32_at(107));
        let points = match is_1_4 {
            true if u64_at(247) > 0 => u64_at(247),
            _ => legacy,
        };
        let data = u64::from(u32_at(96));
        if data < u64::from(header_size) || data > file.length() {
            let expected = format!("{header_size} to {}", file.length());
            return Err(wrong("the offset to the points", data.to_string(), &expected));
        }
        let three = |place: usize| [0, 1, 2].map(|axis| number(Type::F64, place + 8 * axis));
        let (scale, offset) = (three(131), three(155));
        for (name, values) in [("the scale factors", scale), ("the offsets", offset)] {
            if !values.iter().all(|value| value.is_finite()) {
                return Err(wrong(name, format!("{values:?}"), "finite numbers"));
            }
        }
        if scale[0] == 0.0 || scale[1] == 0.0 {
            return Err(wrong("the scale factors", format!("{scale:?}"), "numbers other than 0"));
        }
        let extended = if is_1_4 { (u64_at(235), u32_at(243)) } else { (0, 0) };
        Ok(Self {
            version,
            format,
            compressed,
            record_length,
            points,
            data,
            scale,
            offset,
            header_size,
            records: u32_at(100),
            extended,
        })
    }

    /// Variable length records, plain and extended. Those that reach beyond what they may are left
    /// out with all behind them: points can be read without.
    fn variable_records(
        &self,
        file: &mut Seekable<'_>,
        path: &Path,
    ) -> Result<Vec<Record>, PointsError> {
        let io_error = |source| PointsError::Io { path: path.into(), source };
        let mut records = Vec::new();
        let plain = (u64::from(self.header_size), self.records, VLR_HEADER, self.data);
        let extended = (self.extended.0, self.extended.1, EVLR_HEADER, file.length());
        for (mut place, count, size, end) in [plain, extended] {
            for _ in 0..count.min(MAX_RECORDS) {
                let contents = place.saturating_add(size);
                if contents > end {
                    break;
                }
                let head = file.bytes_at(place, size).map_err(io_error)?;
                let mut user = [0; 16];
                user.copy_from_slice(&head[2..18]);
                let kind = if size == VLR_HEADER { Type::U16 } else { Type::U64 };
                let length = kind.read::<false>(&head[20..]) as u64;
                if contents.saturating_add(length) > end {
                    break;
                }
                let id = u16::from_le_bytes([head[18], head[19]]);
                records.push(Record { user, id, place: contents, length });
                place = contents + length;
            }
        }
        Ok(records)
    }

    /// The file ends after so many points.
    fn cut_off(&self, found: u64, bytes: Option<u64>, path: &Path) -> PointsError {
        let needed = u128::from(self.points) * u128::from(self.record_length);
        PointsError::CutOff {
            path: path.into(),
            what: "points".to_owned(),
            declared: self.points,
            found,
            bytes_declared: bytes.map(|_| needed),
            bytes_found: bytes,
        }
    }
}

impl Record {
    fn is(&self, user: &str, id: u16) -> bool {
        let name = self.user.split(|&byte| byte == 0).next().unwrap_or_default();
        name == user.as_bytes() && self.id == id
    }
}

#[cfg(test)]
mod tests;
