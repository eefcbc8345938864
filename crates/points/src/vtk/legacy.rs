//! Legacy VTK files, ascii and binary, of versions 1 to 5.1.

mod cursor;
mod scan;

use crate::columns::{Coding, Numbers, Part, Records, Shared};
use crate::error::PointsError;
use crate::field::Type;
use crate::options::ReadOptions;
use crate::set::PointSet;
use crate::source::Source;
use crate::vtk::ascii::Words;
use crate::vtk::lattice::{Axis, Lattice};
use crate::vtk::{Described, Parts, Role};
use std::cell::RefCell;
use std::io::{self, Read};
use std::path::Path;

/// Whether a file that begins so is legacy VTK.
pub(crate) fn sniff(start: &[u8]) -> bool {
    start.get(..5).is_some_and(|start| start.eq_ignore_ascii_case(b"# vtk"))
}

/// Reads the points.
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
    let mut arrays: Vec<(Described, Box<dyn Numbers + '_>)> = Vec::new();
    match outline.positions {
        Positions::Stored(stored) => arrays.push(stored.open(&file)),
        Positions::Lattice(axes) => {
            let (name, kind) = ("points".to_owned(), Type::F64);
            let described = Described { name, width: 3, kind, role: Role::Position };
            arrays.push((described, Box::new(Lattice::new(axes))));
        }
    }
    arrays.extend(outline.arrays.into_iter().map(|array| array.open(&file)));
    let mut parts = Parts::new(path, options, outline.points);
    parts.take(arrays, outline.points)?;
    parts.finish(&outline.in_words)
}

/// What a file has, and where.
struct Outline {
    points: u64,
    positions: Positions,
    /// For points.
    arrays: Vec<Stored>,
    in_words: String,
}

enum Positions {
    Stored(Stored),
    Lattice([Axis; 3]),
}

/// An array that is in the file from its first value to its last.
struct Stored {
    described: Described,
    values: u64,
    encoding: Encoding,
    at: u64,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Text,
    /// Bytes of a colour, in text as fractions of 1.
    Fractions,
    Binary(Type),
    /// Eight values a byte.
    Bits,
    /// No numbers.
    Strings,
}

impl Encoding {
    /// How a binary file stores a type.
    fn of_type(name: &str) -> Option<Self> {
        Some(Self::Binary(match name.to_ascii_lowercase().as_str() {
            "unsigned_char" => Type::U8,
            "char" | "signed_char" => Type::I8,
            "unsigned_short" => Type::U16,
            "short" => Type::I16,
            "unsigned_int" => Type::U32,
            // VTK writes its ids as ints.
            "int" | "vtkidtype" => Type::I32,
            "unsigned_long" | "unsigned_long_long" | "vtktypeuint64" => Type::U64,
            "long" | "long_long" | "vtktypeint64" => Type::I64,
            "float" => Type::F32,
            "double" => Type::F64,
            "bit" => return Some(Self::Bits),
            "string" | "utf8_string" => return Some(Self::Strings),
            _ => return None,
        }))
    }

    /// The type that holds the values.
    fn kind(self) -> Type {
        match self {
            Self::Binary(kind) => kind,
            Self::Text => Type::F64,
            Self::Bits | Self::Fractions | Self::Strings => Type::U8,
        }
    }
}

impl Stored {
    /// The array, to be read from its beginning.
    fn open<'f>(self, file: &'f Shared<'_>) -> (Described, Box<dyn Numbers + 'f>) {
        let reader = Part::new(file, self.at, u64::MAX).buffered();
        let width = self.described.width;
        let numbers: Box<dyn Numbers + 'f> = match self.encoding {
            Encoding::Text | Encoding::Strings => Box::new(Words::new(reader)),
            Encoding::Fractions => Box::new(Words::new(reader).scaled(255.0)),
            Encoding::Binary(kind) => {
                Box::new(Records::of(reader, Coding::Number(kind), true, width))
            }
            Encoding::Bits => Box::new(Bits { reader, byte: 0, left: 0 }),
        };
        (self.described, numbers)
    }
}

/// Eight values a byte, the highest bit first.
struct Bits<R> {
    reader: R,
    byte: u8,
    left: u32,
}

impl<R: Read> Numbers for Bits<R> {
    fn next(&mut self, out: &mut [f64]) -> io::Result<usize> {
        for value in &mut *out {
            if self.left == 0 {
                let mut byte = [0];
                self.reader.read_exact(&mut byte)?;
                [self.byte] = byte;
                self.left = 8;
            }
            self.left -= 1;
            *value = f64::from(self.byte >> self.left & 1);
        }
        Ok(out.len())
    }
}
