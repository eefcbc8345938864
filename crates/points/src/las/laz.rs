//! Compressed points.
//!
//! The crate `laz` decompresses them, chunk by chunk. It trusts its input, so what it gets is
//! checked before: items that are not those of the point format, layers longer than the file, and
//! more points than so few bytes can be are refused here. A damaged stream of bits can still make it
//! panic; [`guarded`] makes an error of that.

use super::{EXPORT, Failed, Header};
use crate::error::PointsError;
use crate::guard::guarded;
use crate::source::Seekable;
use laz::laszip::{ChunkTable, CompressorType};
use laz::record::{
    LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor,
};
use laz::{LazItem, LazItemType, LazVlr};
use std::io::{self, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

/// Of the record that says how points are compressed.
pub(super) const RECORD_ID: u16 = LazVlr::RECORD_ID;
/// Of what LASzip itself may read.
const DECOMPRESS: &str =
    "if other programs read the file, decompress it with laszip, else export it again";
/// Points that a byte may hold at most: real files have less than one.
const POINTS_A_BYTE: u64 = 32;
/// A small file may hold this many whatever its length.
const FEW_POINTS: u64 = 1 << 17;

type Take<'a> = dyn FnMut(&[u8]) -> Result<(), PointsError> + 'a;

/// Reads all points of the file.
pub(super) fn read(
    file: Seekable<'_>,
    header: &Header,
    vlr: &[u8],
    path: &Path,
    take: &mut Take<'_>,
) -> Result<(), PointsError> {
    let wrong = |place: &str, found: String, expected: &str| {
        PointsError::wrong(path, place, found, expected, EXPORT)
    };
    let length = file.length();
    if header.points > FEW_POINTS.max(length.saturating_mul(POINTS_A_BYTE)) {
        let found = format!("{} in {length} bytes", header.points);
        return Err(wrong("the number of points", found, "no more than LAZ could hold"));
    }
    let unread = |found: String, expected: &str| {
        PointsError::wrong(path, "the LASzip record", found, expected, DECOMPRESS)
    };
    let vlr = LazVlr::from_buffer(vlr)
        .map_err(|error| unread(error.to_string(), "one that can be read"))?;
    check_items(&vlr, header)
        .map_err(|found| unread(found, "the items of the point format, in a known version"))?;

    let mut points = Points { header, taken: 0, take };
    let result = guarded(|| {
        let mut file = BufReader::with_capacity(1 << 18, file);
        file.seek(SeekFrom::Start(header.data)).map_err(Failed::Io)?;
        match vlr.items()[0].version() {
            1 | 2 => points.sequential(&mut file, &vlr),
            _ => points.layered(&mut file, &vlr),
        }
    });
    let taken = points.taken;
    match result {
        Some(Ok(())) => Ok(()),
        Some(Err(Failed::Io(error))) if error.kind() == io::ErrorKind::UnexpectedEof => {
            Err(header.cut_off(taken, None, path))
        }
        Some(Err(Failed::Io(error))) if error.kind() == io::ErrorKind::InvalidData => {
            Err(wrong(&format!("compressed point {taken} (from 0)"), error.to_string(), "LAZ"))
        }
        Some(Err(other)) => Err(other.at(path)),
        None => {
            let place = format!("compressed point {taken} (from 0)");
            Err(wrong(&place, "bits without meaning".to_owned(), "LAZ"))
        }
    }
}

/// Whether the items are those of the header's point format and record length. Fails with what was
/// found.
fn check_items(vlr: &LazVlr, header: &Header) -> Result<(), String> {
    let items = vlr.items();
    let described = |item: &LazItem| {
        format!("{:?} of {} bytes, version {}", item.item_type(), item.size(), item.version())
    };
    let found = || items.iter().map(described).collect::<Vec<_>>().join(", ");
    let layered = header.format >= 6;
    let mut expected = Vec::new();
    if layered {
        expected.push((LazItemType::Point14, 30));
        match header.format {
            7 => expected.push((LazItemType::RGB14, 6)),
            8 | 10 => expected.push((LazItemType::RGBNIR14, 8)),
            _ => (),
        }
        if header.format >= 9 {
            expected.push((LazItemType::WavePacket14, 29));
        }
    } else {
        expected.push((LazItemType::Point10, 20));
        if matches!(header.format, 1 | 3 | 4 | 5) {
            expected.push((LazItemType::GpsTime, 8));
        }
        if matches!(header.format, 2 | 3 | 5) {
            expected.push((LazItemType::RGB12, 6));
        }
        if header.format >= 4 {
            expected.push((LazItemType::WavePacket13, 29));
        }
    }
    let known: u16 = expected.iter().map(|item| item.1).sum();
    let rest = header.record_length - known;
    if rest > 0 {
        let bytes = if layered { LazItemType::Byte14(rest) } else { LazItemType::Byte(rest) };
        expected.push((bytes, rest));
    }
    let same = items.len() == expected.len()
        && items.iter().zip(&expected).all(|(item, &(kind, size))| {
            let version = if layered { 3..=4 } else { 1..=2 };
            item.item_type() == kind && item.size() == size && version.contains(&item.version())
        });
    if same { Ok(()) } else { Err(found()) }
}

/// The points of a file on their way out.
struct Points<'a, 'b> {
    header: &'a Header,
    taken: u64,
    take: &'a mut Take<'b>,
}

impl Points<'_, '_> {
    fn left(&self) -> u64 {
        self.header.points - self.taken
    }

    /// Takes so many points of one chunk.
    fn chunk<R>(
        &mut self,
        count: u64,
        decompressor: &mut dyn RecordDecompressor<R>,
    ) -> Result<(), Failed> {
        let mut record = vec![0; self.header.record_length.into()];
        for _ in 0..count {
            decompressor.decompress_next(&mut record).map_err(Failed::Io)?;
            (self.take)(&record).map_err(Failed::Points)?;
            self.taken += 1;
        }
        Ok(())
    }

    /// Point formats 0 to 5: each chunk is one stream of bits, and the next begins where it ends.
    fn sequential(
        &mut self,
        file: &mut BufReader<Seekable<'_>>,
        vlr: &LazVlr,
    ) -> Result<(), Failed> {
        let chunked = match vlr_compressor(vlr) {
            Some(CompressorType::PointWise) => false,
            Some(CompressorType::PointWiseChunked) => true,
            _ => return Err(invalid("layers, which this point format has not")),
        };
        if !chunked {
            let mut decompressor = SequentialPointRecordDecompressor::new(file);
            decompressor.set_fields_from(vlr.items()).map_err(damaged)?;
            return self.chunk(self.left(), &mut decompressor);
        }
        let table = match vlr.uses_variable_size_chunks() {
            true => Some(chunk_table(file, self.header)?),
            false => None,
        };
        // The offset to the table of chunks.
        file.seek(SeekFrom::Start(self.header.data + 8)).map_err(Failed::Io)?;
        let mut index = 0;
        while self.left() > 0 {
            let size = match &table {
                None => u64::from(vlr.chunk_size()),
                Some(counts) => {
                    *counts.get(index).ok_or_else(|| invalid("too short a table of chunks"))?
                }
            };
            index += 1;
            let mut decompressor = SequentialPointRecordDecompressor::new(&mut *file);
            decompressor.set_fields_from(vlr.items()).map_err(damaged)?;
            self.chunk(size.min(self.left()), &mut decompressor)?;
        }
        Ok(())
    }

    /// Point formats 6 to 10: each chunk begins with its first point as it is, the number of its
    /// points, and the sizes of its layers.
    fn layered(&mut self, file: &mut BufReader<Seekable<'_>>, vlr: &LazVlr) -> Result<(), Failed> {
        if vlr_compressor(vlr) != Some(CompressorType::LayeredChunked) {
            return Err(invalid("no layers, which this point format has"));
        }
        let layers: usize = (vlr.items().iter())
            .map(|item| match item.item_type() {
                LazItemType::Point14 => 9,
                LazItemType::RGBNIR14 => 2,
                LazItemType::Byte14(count) => usize::from(count),
                _ => 1,
            })
            .sum();
        let first = usize::from(self.header.record_length);
        let mut place = self.header.data + 8;
        let length = file.get_ref().length();
        file.seek(SeekFrom::Start(place)).map_err(Failed::Io)?;
        while self.left() > 0 {
            let mut chunk = vec![0; first + 4 + 4 * layers];
            file.read_exact(&mut chunk).map_err(Failed::Io)?;
            let number = |at: usize| {
                u64::from(u32::from_le_bytes([
                    chunk[at],
                    chunk[at + 1],
                    chunk[at + 2],
                    chunk[at + 3],
                ]))
            };
            let count = number(first);
            let bytes: u64 = (0..layers).map(|layer| number(first + 4 + 4 * layer)).sum();
            place += chunk.len() as u64;
            if bytes > length.saturating_sub(place) {
                return Err(Failed::Io(io::ErrorKind::UnexpectedEof.into()));
            }
            if count == 0 {
                return Err(invalid("a chunk without points"));
            }
            place += bytes;
            let header = chunk.len();
            let whole = header + bytes as usize;
            chunk.try_reserve_exact(bytes as usize).map_err(|_| out_of_memory())?;
            chunk.resize(whole, 0);
            file.read_exact(&mut chunk[header..]).map_err(Failed::Io)?;
            let mut decompressor = LayeredPointRecordDecompressor::new(Cursor::new(chunk));
            decompressor.set_fields_from(vlr.items()).map_err(damaged)?;
            self.chunk(count.min(self.left()), &mut decompressor)?;
        }
        Ok(())
    }
}

/// How many points each chunk has, where they differ.
fn chunk_table(file: &mut BufReader<Seekable<'_>>, header: &Header) -> Result<Vec<u64>, Failed> {
    let length = file.get_ref().length();
    let mut offset = [0; 8];
    file.read_exact(&mut offset).map_err(Failed::Io)?;
    let mut place = u64::from_le_bytes(offset);
    if place <= header.data {
        // A writer that could not go back wrote it at the end.
        file.seek(SeekFrom::Start(length.saturating_sub(8))).map_err(Failed::Io)?;
        file.read_exact(&mut offset).map_err(Failed::Io)?;
        place = u64::from_le_bytes(offset);
    }
    if place > length.saturating_sub(8) {
        return Err(invalid("a table of chunks beyond the end of the file"));
    }
    file.seek(SeekFrom::Start(place)).map_err(Failed::Io)?;
    let mut head = [0; 8];
    file.read_exact(&mut head).map_err(Failed::Io)?;
    let chunks = u32::from_le_bytes([head[4], head[5], head[6], head[7]]);
    if u64::from(chunks) > length {
        return Err(invalid("more chunks than the file has bytes"));
    }
    file.seek(SeekFrom::Start(place)).map_err(Failed::Io)?;
    let table = ChunkTable::read(file, true).map_err(Failed::Io)?;
    Ok(table.as_ref().iter().map(|entry| entry.point_count).collect())
}

/// How the points lie in the file, which the crate keeps to itself: the first word of the record.
fn vlr_compressor(vlr: &LazVlr) -> Option<CompressorType> {
    let mut bytes = Vec::new();
    vlr.write_to(&mut bytes).ok()?;
    match bytes.first()? {
        1 => Some(CompressorType::PointWise),
        2 => Some(CompressorType::PointWiseChunked),
        3 => Some(CompressorType::LayeredChunked),
        _ => None,
    }
}

fn invalid(found: &str) -> Failed {
    Failed::Io(io::Error::new(io::ErrorKind::InvalidData, found.to_owned()))
}

fn damaged(error: laz::LasZipError) -> Failed {
    invalid(&error.to_string())
}

fn out_of_memory() -> Failed {
    Failed::Io(io::ErrorKind::OutOfMemory.into())
}
