//! VTK's XML files: `.vtu`, `.vtp`, `.vts`, `.vtr` and `.vti`, with any number of pieces.

mod markup;
mod packed;
mod pieces;
mod scan;

pub(crate) use pieces::{read_series, sniff_series};

use crate::columns::{Coding, Numbers, Part, Records, Shared, check_expansion};
use crate::error::PointsError;
use crate::field::Type;
use crate::meaning::printable;
use crate::options::ReadOptions;
use crate::set::PointSet;
use crate::source::Source;
use crate::vtk::ascii::Words;
use crate::vtk::lattice::{Axis, Lattice};
use crate::vtk::xml::packed::{Base64, Lengths, Packed, Packing};
use crate::vtk::{Described, Parts, Role};
use std::cell::RefCell;
use std::io::Read;
use std::path::Path;

/// Whether a file that begins so is VTK's XML.
pub(crate) fn sniff(start: &[u8]) -> bool {
    let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start).trim_ascii_start();
    text.starts_with(b"<") && text.windows(8).any(|window| window == b"<VTKFile")
}

/// What a file has, and where.
struct Outline {
    /// As the file calls it: `PolyData`.
    kind: String,
    lengths: Lengths,
    packing: Option<Packing>,
    pieces: Vec<Piece>,
    /// Where the appended data begins, and whether it is base64.
    appended: Option<(u64, bool)>,
}

/// A part of the points.
struct Piece {
    points: u64,
    positions: Positions,
    /// For points.
    arrays: Vec<Stored>,
}

enum Positions {
    Stored(Stored),
    Lattice([Axis; 3]),
    /// Along three axes.
    Listed([Stored; 3], [u64; 3]),
}

/// An array of the file.
#[derive(Clone)]
struct Stored {
    described: Described,
    place: Place,
}

#[derive(Clone, Copy)]
enum Place {
    /// Numbers in text, from here to there.
    Text(u64, u64),
    /// Base64, from here to there.
    Inline(u64, u64),
    /// So far behind the beginning of the appended data.
    Appended(u64),
}

/// Reads the points of all pieces.
pub(crate) fn read(
    source: Source<'_>,
    path: &Path,
    options: &ReadOptions,
) -> Result<PointSet, PointsError> {
    let io_error = |source| PointsError::Io { path: path.into(), source };
    let file: Shared<'_> = RefCell::new(source.seekable().map_err(io_error)?);
    file.borrow_mut().begin_pass(false);
    let outline = scan::outline(&file, path)?;
    file.borrow_mut().begin_pass(true);
    let length = file.borrow().length();
    let total = outline.pieces.iter().fold(0, |sum: u64, piece| sum.saturating_add(piece.points));
    // What is packed may be a hundred times the file; text takes two bytes a number at least.
    let most = match outline.packing {
        Some(_) => {
            let bytes = outline.pieces.iter().map(Piece::bytes).fold(0, u64::saturating_add);
            check_expansion(path, bytes, length)?;
            total
        }
        None => length / 6,
    };
    let mut parts = Parts::new(path, options, total.min(most));
    let Some(first) = outline.pieces.first() else { return parts.finish("") };
    // Arrays that all pieces have.
    let common: Vec<&Described> = (first.arrays.iter().map(|array| &array.described))
        .filter(|described| outline.pieces.iter().all(|piece| piece.find(described).is_some()))
        .collect();
    for piece in &outline.pieces {
        let mut arrays = vec![outline.positions(piece, &file, path)?];
        for described in &common {
            let found = piece.find(described);
            arrays.extend(found.map(|stored| outline.open(stored, piece.points, &file)));
        }
        parts.take(arrays, piece.points)?;
    }
    let packing = match outline.packing {
        None => "",
        Some(Packing::Zlib) => ", zlib",
        Some(Packing::Lz4) => ", LZ4",
        Some(Packing::Lzma) => ", LZMA",
    };
    let pieces = match outline.pieces.len() {
        1 => String::new(),
        count => format!(", {count} pieces"),
    };
    parts.finish(&format!("VTK XML, {}{packing}{pieces}", outline.kind))
}

impl Piece {
    /// The array like this one, whatever type its numbers have.
    fn find(&self, described: &Described) -> Option<&Stored> {
        self.arrays.iter().find(|array| {
            array.described.name == described.name && array.described.width == described.width
        })
    }

    /// Of all arrays, unpacked.
    fn bytes(&self) -> u64 {
        let point = |stored: &Stored| stored.described.width * stored.described.kind.size();
        let stored: usize = self.arrays.iter().map(point).sum();
        let positions = match &self.positions {
            Positions::Stored(stored) => point(stored),
            _ => 24,
        };
        self.points.saturating_mul((stored + positions) as u64)
    }
}

impl Outline {
    /// The positions of a piece.
    fn positions<'f>(
        &self,
        piece: &Piece,
        file: &'f Shared<'_>,
        path: &Path,
    ) -> Result<(Described, Box<dyn Numbers + 'f>), PointsError> {
        let axes = match &piece.positions {
            Positions::Stored(stored) => return Ok(self.open(stored, piece.points, file)),
            Positions::Lattice(axes) => axes.clone(),
            Positions::Listed(arrays, counts) => {
                let mut lists = [const { Vec::new() }; 3];
                for ((list, stored), &count) in lists.iter_mut().zip(arrays).zip(counts) {
                    *list = self.list(stored, count, file, path)?;
                }
                lists.map(Axis::Listed)
            }
        };
        let (name, kind) = ("points".to_owned(), Type::F64);
        let described = Described { name, width: 3, kind, role: Role::Position };
        Ok((described, Box::new(Lattice::new(axes))))
    }

    /// All values of an array.
    fn list(
        &self,
        stored: &Stored,
        count: u64,
        file: &Shared<'_>,
        path: &Path,
    ) -> Result<Vec<f64>, PointsError> {
        const BLOCK: usize = 4096;
        let mut numbers = self.open(stored, count, file).1;
        let mut list = Vec::new();
        while (list.len() as u64) < count {
            let old = list.len();
            let wanted = usize::try_from(count).unwrap_or(usize::MAX).min(old + BLOCK);
            list.resize(wanted, 0.0);
            let found = numbers.next(&mut list[old..]).unwrap_or(0);
            if found < wanted - old {
                return Err(PointsError::CutOff {
                    path: path.into(),
                    what: format!("values of '{}'", printable(&stored.described.name)),
                    declared: count,
                    found: (old + found) as u64,
                    bytes_declared: None,
                    bytes_found: None,
                });
            }
        }
        Ok(list)
    }

    /// An array with values for so many points, to be read from its beginning.
    fn open<'f>(
        &self,
        stored: &Stored,
        points: u64,
        file: &'f Shared<'_>,
    ) -> (Described, Box<dyn Numbers + 'f>) {
        let Described { width, kind, .. } = stored.described;
        let needed = points.saturating_mul((width * kind.size()) as u64);
        let part = |start: u64, end: u64| Part::new(file, start, end).buffered();
        let bytes: Box<dyn Read + 'f> = match (stored.place, self.appended) {
            (Place::Text(start, end), _) => {
                return (stored.described.clone(), Box::new(Words::new(part(start, end))));
            }
            (Place::Inline(start, end), _) => Box::new(Base64::new(part(start, end))),
            (Place::Appended(offset), Some((start, base64))) => {
                let reader = part(start.saturating_add(offset), u64::MAX);
                if base64 { Box::new(Base64::new(reader)) } else { Box::new(reader) }
            }
            (Place::Appended(_), None) => Box::new(std::io::empty()),
        };
        let bytes = Packed::new(bytes, self.lengths, self.packing, needed);
        let records = Records::of(bytes, Coding::Number(kind), self.lengths.big, width);
        (stored.described.clone(), Box::new(records))
    }
}
