//! E57 files (ASTM E2807): the points of all scans, in the coordinates of the file.
//!
//! The reader is our own: the crate `e57` keeps every value of a stream that others do not catch up
//! with, so that a file of a few megabytes may ask for all memory. The tests read files that the
//! crate writes.
//!
//! Poses are applied, to normals too. Spherical coordinates become cartesian where a point has no
//! valid cartesian ones. Points that the file marks as invalid, or of which it knows a direction
//! alone, are dropped and counted.

mod bits;
mod pages;
mod prototype;
mod xml;

use crate::collect::Collector;
use crate::e57::bits::Stream;
use crate::e57::pages::Pages;
use crate::e57::prototype::Layout;
use crate::e57::xml::Scan;
use crate::error::PointsError;
use crate::options::ReadOptions;
use crate::sensor::{self, Pixels};
use crate::set::PointSet;
use crate::source::Source;
use std::io;
use std::path::Path;

const EXPORT: &str = "the file is damaged: copy or export it again";
/// Of what others read.
const CONVERT: &str = "open it in CloudCompare and save it as LAS or PLY";

/// First byte of a packet.
const INDEX: u8 = 0;
const DATA: u8 = 1;
const IGNORED: u8 = 2;

pub(crate) fn sniff(start: &[u8]) -> bool {
    start.starts_with(b"ASTM-E57")
}

/// What is wrong inside of a file.
enum Fault {
    Io(io::Error),
    /// The place, what was found there, and what was expected.
    Wrong(String, String, String),
    /// The same, of what is sound but not read.
    Unread(String, String, String),
    /// The file has none: it may be one of images.
    NoScans,
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl Fault {
    fn wrong(place: impl Into<String>, found: impl ToString, expected: impl Into<String>) -> Self {
        Self::Wrong(place.into(), found.to_string(), expected.into())
    }

    fn unread(place: impl Into<String>, found: impl ToString, expected: impl Into<String>) -> Self {
        Self::Unread(place.into(), found.to_string(), expected.into())
    }

    fn at(self, path: &Path) -> PointsError {
        match self {
            Self::NoScans => PointsError::Missing {
                path: path.into(),
                missing: "scan".to_owned(),
                place: "as data3D in the XML section".to_owned(),
                help: "the file holds no points: export it again with its scans",
            },
            Self::Unread(place, found, expected) => {
                PointsError::wrong(path, &place, found, &expected, CONVERT)
            }
            Self::Io(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                let expected = "as many as its header says";
                PointsError::wrong(path, "bytes of the file", "fewer", expected, EXPORT)
            }
            Self::Io(source) => PointsError::Io { path: path.into(), source },
            Self::Wrong(place, found, expected) => {
                PointsError::wrong(path, &place, found, &expected, EXPORT)
            }
        }
    }
}

pub(crate) fn read(
    source: Source<'_>,
    path: &Path,
    options: &ReadOptions,
) -> Result<PointSet, PointsError> {
    let at = |fault: Fault| fault.at(path);
    let file = source.seekable().map_err(|error| at(error.into()))?;
    let mut pages = Pages::new(file).map_err(at)?;
    let document = pages.xml().map_err(at)?;
    let scans = xml::scans(&document).map_err(at)?;
    let layout = Layout::new(&scans);

    let mut collector = Collector::new(&layout.fields, path, options)?;
    let bits = pages.length().saturating_mul(8);
    let fits = |scan: &Scan| scan.count.min(bits / scan.record_bits().max(1));
    collector.expect(scans.iter().map(fits).fold(0, u64::saturating_add))?;
    let mut taken = Vec::new();
    for (index, scan) in scans.iter().enumerate() {
        let before = collector.seen();
        let mut reader = Reader::new(index, scan, &layout);
        reader.read(&mut pages, path, &mut collector)?;
        taken.push(sensor::Scan {
            pose: scan.pose,
            is_posed: scan.is_posed,
            has_angles: layout.has_angles(index),
            pixels: reader.pixels.map(|(pixels, _)| pixels),
            points: before..collector.seen(),
        });
    }
    let of_scans = match scans.len() {
        1 => String::new(),
        count => format!(", {count} scans"),
    };
    let set = collector.finish(&format!("E57 {}{of_scans}", pages.version()))?;
    Ok(PointSet { sensors: sensor::of_scans(&taken), ..set })
}

/// Reads one scan.
struct Reader<'a> {
    index: usize,
    scan: &'a Scan,
    layout: &'a Layout,
    streams: Vec<Stream>,
    /// Of a scan with columns and rows, with the places of these among its numbers.
    pixels: Option<(Pixels, [usize; 2])>,
    /// Logical place behind the last packet.
    end: u64,
    done: u64,
}

impl<'a> Reader<'a> {
    fn new(index: usize, scan: &'a Scan, layout: &'a Layout) -> Self {
        let streams = scan.columns.iter().map(|column| Stream::new(column.codec.bits()));
        let pixels = scan.find("columnIndex").zip(scan.find("rowIndex"));
        let pixels = pixels.map(|(column, row)| (Pixels::new(scan.count), [column, row]));
        Self { index, scan, layout, streams: streams.collect(), pixels, end: 0, done: 0 }
    }

    fn read(
        &mut self,
        pages: &mut Pages<'_>,
        path: &Path,
        collector: &mut Collector<'_>,
    ) -> Result<(), PointsError> {
        if self.scan.count == 0 {
            return Ok(());
        }
        let begin = self.begin(pages).map_err(|fault| fault.at(path))?;
        pages.seek(begin);
        while self.done < self.scan.count {
            match self.packet(pages) {
                Ok(()) => (),
                Err(Fault::Io(error)) if error.kind() == io::ErrorKind::UnexpectedEof => {
                    return Err(PointsError::CutOff {
                        path: path.into(),
                        what: format!("points of scan {}", self.index),
                        declared: self.scan.count,
                        found: self.done,
                        bytes_declared: None,
                        bytes_found: None,
                    });
                }
                Err(fault) => return Err(fault.at(path)),
            }
            self.points(collector)?;
        }
        Ok(())
    }

    /// The logical place of the first packet. Notes where the packets end.
    fn begin(&mut self, pages: &mut Pages<'_>) -> Result<u64, Fault> {
        let section_begin = pages.logical(self.scan.place);
        pages.seek(section_begin);
        let mut section = [0; 32];
        pages.read(&mut section)?;
        if section[0] != 1 {
            let place = format!("the kind of the section of scan {}", self.index);
            return Err(Fault::wrong(place, section[0], "1, a compressed vector"));
        }
        let number = |place: usize| {
            let mut bytes = [0; 8];
            bytes.copy_from_slice(&section[place..place + 8]);
            u64::from_le_bytes(bytes)
        };
        self.end = section_begin.saturating_add(number(8));
        Ok(pages.logical(number(16)))
    }

    /// Adds what a packet has to the streams.
    fn packet(&mut self, pages: &mut Pages<'_>) -> Result<(), Fault> {
        let begin = pages.position();
        if begin >= self.end {
            return Err(Fault::Io(io::ErrorKind::UnexpectedEof.into()));
        }
        let mut head = [0; 4];
        pages.read(&mut head)?;
        let length = u64::from(u16::from_le_bytes([head[2], head[3]])) + 1;
        match head[0] {
            INDEX | IGNORED => (),
            DATA => {
                let mut count = [0; 2];
                pages.read(&mut count)?;
                let count = usize::from(u16::from_le_bytes(count));
                if count != self.streams.len() {
                    let place = format!("the number of streams of a packet of scan {}", self.index);
                    let expected = format!("{}, as in the prototype", self.streams.len());
                    return Err(Fault::wrong(place, count, expected));
                }
                let mut lengths = vec![0; 2 * count];
                pages.read(&mut lengths)?;
                let lengths: Vec<usize> = lengths
                    .chunks_exact(2)
                    .map(|pair| u16::from_le_bytes([pair[0], pair[1]]).into())
                    .collect();
                let all = 6 + 2 * count as u64 + lengths.iter().sum::<usize>() as u64;
                if all > length {
                    let place = format!("the length of a packet of scan {}", self.index);
                    return Err(Fault::wrong(place, length, format!("at least {all}")));
                }
                for (stream, &bytes) in self.streams.iter_mut().zip(&lengths) {
                    pages.read(stream.room(bytes))?;
                }
            }
            other => {
                let place = format!("the kind of a packet of scan {}", self.index);
                return Err(Fault::wrong(place, other, "0, 1 or 2"));
            }
        }
        pages.seek(begin + length);
        Ok(())
    }

    /// Takes all points of which every number has arrived.
    fn points(&mut self, collector: &mut Collector<'_>) -> Result<(), PointsError> {
        let there = self.streams.iter().map(Stream::values).min().unwrap_or(0);
        let mut values = vec![0.0; self.streams.len()];
        let mut row = vec![0.0; self.layout.fields.len()];
        for _ in 0..there.min(self.scan.count - self.done) {
            for ((value, stream), column) in
                values.iter_mut().zip(&mut self.streams).zip(&self.scan.columns)
            {
                *value = column.codec.value(stream.next());
            }
            match self.layout.fill(self.index, self.scan, &values, &mut row) {
                true => {
                    if let Some((pixels, places)) = &mut self.pixels {
                        let pixel = places.map(|place| values[place]);
                        pixels.see(pixel, collector.position_of(&row));
                    }
                    collector.push(&row)?;
                }
                false => collector.push_invalid()?,
            }
            self.done += 1;
        }
        for stream in &mut self.streams {
            stream.forget();
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
