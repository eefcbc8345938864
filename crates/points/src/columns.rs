//! Arrays that lie one behind the other in a file, read side by side.
//!
//! Each array has its own place in the file and is read in blocks, so what is held is a block of
//! each and the points, however large the arrays are.

use crate::collect::Collector;
use crate::error::PointsError;
use crate::field::Type;
use crate::meaning::{SAMPLE_ROWS, Sample, printable};
use crate::source::Seekable;
use std::cell::RefCell;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

/// Most numbers that are held of points read at once.
const BLOCK: usize = 1 << 18;
/// Bytes of a file that are read at once for one array.
const BUFFER: usize = 1 << 16;

/// Arrays that take more bytes than this take at most [`MAX_EXPANSION`] times the file's: beyond,
/// the file is taken for one that was made to fill memory.
const FREE_BYTES: u64 = 1 << 28;
const MAX_EXPANSION: u64 = 100;

/// Refuses packed arrays that are far larger than the file. `bytes` is their size unpacked,
/// `length` the file's.
pub(crate) fn check_expansion(path: &Path, bytes: u64, length: u64) -> Result<(), PointsError> {
    if !is_too_large(bytes, length) {
        return Ok(());
    }
    Err(PointsError::wrong(
        path,
        "the size of the unpacked arrays",
        format!("{bytes} bytes"),
        &format!("at most {MAX_EXPANSION} times the file's {length}"),
        "save them without compression",
    ))
}

/// Whether so many bytes unpacked are refused of a file of this length.
pub(crate) fn is_too_large(bytes: u64, length: u64) -> bool {
    bytes > FREE_BYTES && bytes / MAX_EXPANSION > length
}

/// A file that is read at several places.
pub(crate) type Shared<'a> = RefCell<Seekable<'a>>;

/// A part of a file, read from its beginning.
pub(crate) struct Part<'f, 'a> {
    file: &'f Shared<'a>,
    start: u64,
    at: u64,
    end: u64,
}

impl<'f, 'a> Part<'f, 'a> {
    /// From `start` to `end`, or to the file's end where that is nearer.
    pub(crate) fn new(file: &'f Shared<'a>, start: u64, end: u64) -> Self {
        let end = end.min(file.borrow().length());
        Self { file, start, at: start, end: end.max(start) }
    }

    pub(crate) fn buffered(self) -> BufReader<Self> {
        let wanted = usize::try_from(self.end - self.at).unwrap_or(BUFFER);
        BufReader::with_capacity(wanted.clamp(16, BUFFER), self)
    }
}

impl Read for Part<'_, '_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let left = usize::try_from(self.end.saturating_sub(self.at)).unwrap_or(usize::MAX);
        let wanted = buffer.len().min(left);
        if wanted == 0 {
            return Ok(0);
        }
        let mut file = self.file.borrow_mut();
        file.seek(SeekFrom::Start(self.at))?;
        let count = file.read(&mut buffer[..wanted])?;
        self.at += count as u64;
        Ok(count)
    }
}

impl Seek for Part<'_, '_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let target = match to {
            SeekFrom::Start(place) => self.start.checked_add(place),
            SeekFrom::Current(step) => self.at.checked_add_signed(step),
            SeekFrom::End(step) => self.end.checked_add_signed(step),
        };
        let target = target.filter(|&target| target >= self.start);
        self.at = target.ok_or(io::ErrorKind::InvalidInput)?;
        Ok(self.at - self.start)
    }
}

/// How one number is stored.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Coding {
    Number(Type),
    /// A float of 16 bits.
    Half,
}

impl Coding {
    /// In bytes.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::Number(kind) => kind.size(),
            Self::Half => 2,
        }
    }

    /// The type that holds it.
    pub(crate) fn kind(self) -> Type {
        match self {
            Self::Number(kind) => kind,
            Self::Half => Type::F32,
        }
    }

    fn read(self, bytes: &[u8], big: bool) -> f64 {
        match (self, big) {
            (Self::Number(kind), false) => kind.read::<false>(bytes),
            (Self::Number(kind), true) => kind.read::<true>(bytes),
            (Self::Half, false) => half(u16::from_le_bytes([bytes[0], bytes[1]])),
            (Self::Half, true) => half(u16::from_be_bytes([bytes[0], bytes[1]])),
        }
    }
}

/// The value of a float of 16 bits.
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let exponent = i32::from(bits >> 10 & 0x1f);
    let fraction = f64::from(bits & 0x3ff) / 1024.0;
    let size = match exponent {
        0 => fraction * 2f64.powi(-14),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1.0 + fraction) * 2f64.powi(exponent - 15),
    };
    sign * size
}

/// Numbers that come one after the other.
pub(crate) trait Numbers {
    /// Fills `out` with the next numbers, and says how many there were: fewer only at the end.
    fn next(&mut self, out: &mut [f64]) -> io::Result<usize>;
}

/// Binary records of one size.
pub(crate) struct Records<R> {
    reader: R,
    size: usize,
    /// Of the numbers that are read of each.
    places: Vec<Place>,
    buffer: Vec<u8>,
}

/// Where in a record a number is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) offset: usize,
    pub(crate) coding: Coding,
    pub(crate) big: bool,
}

impl<R: Read> Records<R> {
    /// Records of `size` bytes with at least one number.
    pub(crate) fn new(reader: R, size: usize, places: Vec<Place>) -> Self {
        assert!(size > 0 && !places.is_empty(), "records: nothing in them");
        Self { reader, size, places, buffer: Vec::new() }
    }

    /// Records that are `width` numbers of one kind.
    pub(crate) fn of(reader: R, coding: Coding, big: bool, width: usize) -> Self {
        let places = (0..width).map(|i| Place { offset: i * coding.size(), coding, big });
        Self::new(reader, width * coding.size(), places.collect())
    }
}

impl<R: Read> Numbers for Records<R> {
    fn next(&mut self, out: &mut [f64]) -> io::Result<usize> {
        let width = self.places.len();
        let at_once = (BUFFER / self.size).max(1);
        let mut done = 0;
        for out in out.chunks_mut(at_once * width) {
            self.buffer.resize(out.len() / width * self.size, 0);
            let whole = fill(&mut self.reader, &mut self.buffer)? / self.size;
            let records = self.buffer[..whole * self.size].chunks_exact(self.size);
            for (record, out) in records.zip(out.chunks_exact_mut(width)) {
                for (value, place) in out.iter_mut().zip(&self.places) {
                    *value = place.coding.read(&record[place.offset..], place.big);
                }
            }
            done += whole * width;
            if whole * width < out.len() {
                break;
            }
        }
        Ok(done)
    }
}

/// Reads until the buffer is full or nothing is left.
pub(crate) fn fill(reader: &mut impl Read, buffer: &mut [u8]) -> io::Result<usize> {
    let mut filled = 0;
    while filled < buffer.len() {
        match reader.read(&mut buffer[filled..]) {
            Ok(0) => break,
            Ok(count) => filled += count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => (),
            Err(error) => return Err(error),
        }
    }
    Ok(filled)
}

/// An array with a value or several a point.
pub(crate) struct Array<'f> {
    /// For messages.
    pub(crate) name: String,
    /// Values a point.
    pub(crate) width: usize,
    pub(crate) numbers: Box<dyn Numbers + 'f>,
}

/// Arrays of one length.
pub(crate) struct SideBySide<'f> {
    arrays: Vec<Array<'f>>,
    /// Of each array, the values of the block.
    blocks: Vec<Vec<f64>>,
    path: &'f Path,
    points: u64,
    /// Points of the block.
    there: usize,
    /// Points before it.
    before: u64,
}

impl<'f> SideBySide<'f> {
    /// Reads a first block, to be looked at.
    pub(crate) fn new(
        arrays: Vec<Array<'f>>,
        points: u64,
        path: &'f Path,
    ) -> Result<Self, PointsError> {
        let blocks = arrays.iter().map(|_| Vec::new()).collect();
        let mut table = Self { arrays, blocks, path, points, there: 0, before: 0 };
        table.advance()?;
        Ok(table)
    }

    /// Reads the next block. Afterwards, `there` is 0 at the end.
    fn advance(&mut self) -> Result<(), PointsError> {
        self.before += self.there as u64;
        let columns: usize = self.arrays.iter().map(|array| array.width).sum();
        let most = BLOCK / columns.max(64);
        self.there = usize::try_from(self.points - self.before).map_or(most, |left| left.min(most));
        for (array, block) in self.arrays.iter_mut().zip(&mut self.blocks) {
            block.resize(self.there * array.width, 0.0);
            let found = array.numbers.next(block).map_err(|error| match error.kind() {
                io::ErrorKind::UnexpectedEof => cut_off(self.path, array, self.points, self.before),
                _ => data_error(self.path, &array.name, error),
            })?;
            if found < block.len() {
                let whole = (found / array.width) as u64;
                return Err(cut_off(self.path, array, self.points, self.before + whole));
            }
        }
        Ok(())
    }

    /// The first rows. `floats` tells which columns are of a float type.
    pub(crate) fn sample(&self, floats: Vec<bool>) -> Sample {
        let columns = self.arrays.iter().map(|array| array.width).sum();
        let mut values = Vec::new();
        for point in 0..self.there.min(SAMPLE_ROWS) {
            self.row(point, &mut values);
        }
        Sample { columns, values, floats }
    }

    fn row(&self, point: usize, row: &mut Vec<f64>) {
        for (array, block) in self.arrays.iter().zip(&self.blocks) {
            row.extend_from_slice(&block[point * array.width..(point + 1) * array.width]);
        }
    }

    /// Hands on all points, array after array in each row.
    pub(crate) fn collect(mut self, collector: &mut Collector<'_>) -> Result<(), PointsError> {
        let mut row = Vec::new();
        while self.there > 0 {
            for point in 0..self.there {
                row.clear();
                self.row(point, &mut row);
                collector.push(&row)?;
            }
            self.advance()?;
        }
        Ok(())
    }
}

/// What is wrong with the bytes of an array: they are damaged, or cannot be read.
pub(crate) fn data_error(path: &Path, name: &str, error: io::Error) -> PointsError {
    use io::ErrorKind::{InvalidData, InvalidInput, UnexpectedEof, Unsupported};
    match error.kind() {
        Unsupported => PointsError::wrong(
            path,
            &format!("the data of '{}'", printable(name)),
            error,
            "what is read of its format",
            "save it with another compression, or without",
        ),
        InvalidData | InvalidInput | UnexpectedEof => PointsError::wrong(
            path,
            &format!("the data of '{}'", printable(name)),
            error,
            "what the header says",
            "the file is damaged: copy or export it again",
        ),
        _ => PointsError::Io { path: path.into(), source: error },
    }
}

fn cut_off(path: &Path, array: &Array<'_>, declared: u64, found: u64) -> PointsError {
    PointsError::CutOff {
        path: path.into(),
        what: format!("values of '{}'", printable(&array.name)),
        declared,
        found,
        bytes_declared: None,
        bytes_found: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_those_of_ieee_754() {
        for (bits, value) in [
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x7bff, 65504.0),
            (0x0001, 2f64.powi(-24)),
            (0x0400, 2f64.powi(-14)),
            (0x3555, 0.333_251_953_125),
            (0x7c00, f64::INFINITY),
            (0xfc00, f64::NEG_INFINITY),
        ] {
            assert_eq!(half(bits), value, "{bits:#x}");
        }
        assert!(half(0x7e00).is_nan());
        assert!(half(0x8000).is_sign_negative());
    }
}
