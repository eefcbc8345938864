//! NumPy arrays: `.npy` files, and `.npz` archives of them.
//!
//! Points are rows: of an array of shape (n, k) with k from 3 on, or records with named fields. An
//! array of shape (3, n) with n beyond [`MOST_ROWS_OF_THREE`] is taken for columns. Headers are
//! Python literals and are read as such, never run; pickled objects are refused.

mod archive;
mod header;
mod literal;

use crate::assign::Columns;
use crate::collect::Collector;
use crate::color;
use crate::columns::{Array, Coding, Part, Place, Records, Shared, SideBySide, data_error};
use crate::error::PointsError;
use crate::field::{Field, Type};
use crate::guess::{self, numbered};
use crate::meaning::{self, Sample};
use crate::npy::header::{Header, MAGIC};
use crate::options::ReadOptions;
use crate::set::PointSet;
use crate::source::Source;
use crate::upright;
use std::cell::RefCell;
use std::io::{self, Read};
use std::path::Path;

pub(crate) use archive::{read as read_archive, sniff as sniff_archive};

/// An array of more columns is taken for something else.
const MAX_COLUMNS: usize = 1000;
/// Columns of a point in an array of three dimensions or more.
const MAP_COLUMNS: std::ops::RangeInclusive<u64> = 3..=10;
/// Up to so many columns, three rows are three points.
const MOST_ROWS_OF_THREE: u64 = 16;
/// Fewer points than columns are doubtful beyond so many of these.
const MOST_COLUMNS_OF_FEW: u64 = 40;

const HELP: &str = "save it again with numpy.save";

/// Whether a file that begins so is a NumPy array.
pub(crate) fn sniff(start: &[u8]) -> bool {
    start.starts_with(MAGIC)
}

/// Why an array is not read.
enum Trouble {
    Io(io::Error),
    /// What was found in the header, and what was expected.
    Header {
        found: String,
        expected: String,
    },
}

impl From<io::Error> for Trouble {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl Trouble {
    fn header(found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Header { found: found.into(), expected: expected.into() }
    }

    /// `name` is that of the array in its archive, if it is in one.
    fn at(self, path: &Path, name: Option<&str>) -> PointsError {
        match self {
            Self::Io(error) => data_error(path, name.unwrap_or("the header"), error),
            Self::Header { found, expected } => {
                let of = name.map_or_else(String::new, |name| format!(" of '{name}'"));
                PointsError::wrong(path, &format!("the NumPy header{of}"), found, &expected, HELP)
            }
        }
    }
}

/// Reads the rows of an array.
pub(crate) fn read(
    source: Source<'_>,
    path: &Path,
    options: &ReadOptions,
) -> Result<PointSet, PointsError> {
    let io_error = |source| PointsError::Io { path: path.into(), source };
    let file: Shared<'_> = RefCell::new(source.seekable().map_err(io_error)?);
    file.borrow_mut().begin_pass(false);
    let open = |place: u64| -> io::Result<Box<dyn Read + '_>> {
        Ok(Box::new(Part::new(&file, place, u64::MAX).buffered()))
    };
    let header = Header::read(&mut open(0).map_err(io_error)?).map_err(|e| e.at(path, None))?;
    if is_lattice(&header) {
        let found = header.shape_in_words();
        let expected = "rows of points, (n, 3) or with more columns, or a map of points, (rows, \
                        columns, 3) up to 10";
        let help = "of a lattice of values, save numpy.column_stack([numpy.indices(a.shape).reshape(\
                    a.ndim, -1).T, a.ravel()]) after a = a.squeeze()";
        return Err(PointsError::wrong(path, "the shape of the array", found, expected, help));
    }
    let rows = Rows::of(&header).map_err(|e| e.at(path, None))?;
    if !header.record.has_names && rows.names.len() < 3 {
        let found = format!("the shape {}", header.shape_in_words());
        return Err(Trouble::header(found, "(n, 3), or more columns").at(path, None));
    }
    let left = file.borrow().length().saturating_sub(header.length);
    let point_size = rows.point_size(&header);
    let needed = u128::from(rows.points) * u128::from(point_size);
    if needed > left.into() {
        return Err(PointsError::CutOff {
            path: path.into(),
            what: "points".to_owned(),
            declared: rows.points,
            found: left / point_size.max(1),
            bytes_declared: Some(needed),
            bytes_found: Some(left),
        });
    }
    file.borrow_mut().begin_pass(true);
    let arrays = rows.arrays(&header, "data", &open).map_err(io_error)?;
    let table = SideBySide::new(arrays, rows.points, path)?;
    let kinds = rows.kinds();
    let sample = table.sample(kinds.iter().map(|kind| kind.is_float()).collect());
    let (fields, note) = match (header.record.has_names, options.columns.is_empty()) {
        (true, _) => (named(&rows.names, &kinds, &sample, path, &options.columns)?, None),
        (false, true) => {
            let guess = guess::by_place(&sample, Some(&kinds), None);
            (guess.fields, guess.note)
        }
        (false, false) => (said(&sample, &kinds, path, &options.columns)?, None),
    };
    let mut collector = Collector::of_named(&fields, path, options)?;
    collector.expect(rows.points)?;
    table.collect(&mut collector)?;
    let shape = header.shape_in_words();
    let taken = if header.record.has_names {
        "named fields".to_owned()
    } else {
        let columns = if rows.transposed { "rows" } else { "columns" };
        format!("{columns} taken for {}", meaning::listed(&fields))
    };
    let mut set = collector.finish(&format!("NPY, shape {shape}, {taken}"))?;
    if options.columns.is_empty() {
        set.notes.extend(doubt(&header, &rows));
    }
    set.notes.extend(note);
    // Of a map, points come row after row, or column after column.
    if let ([rows, columns, width], false) = (&*header.shape, header.record.has_names)
        && MAP_COLUMNS.contains(width)
    {
        let (columns, rows) = (*columns, *rows);
        set.up = upright::of_map(&set, [columns, rows], header.fortran);
    }
    Ok(set)
}

/// Whether an array of three dimensions or more has a value at each node of a lattice, rather than
/// the columns of a point in its last dimension.
fn is_lattice(header: &Header) -> bool {
    match *header.shape {
        _ if header.record.has_names => false,
        [.., _, _, columns] => !MAP_COLUMNS.contains(&columns),
        _ => false,
    }
}

/// Why the shape or the type of an array is unlike points, if it is.
fn doubt(header: &Header, rows: &Rows) -> Option<String> {
    let shape = header.shape_in_words();
    let (points, width) = (rows.points, rows.names.len());
    let longer = header.shape.iter().filter(|&&length| length > 1).count();
    let bytes = |kind| matches!(kind, Type::U8 | Type::I8);
    match *header.shape {
        _ if header.record.has_names || rows.transposed => None,
        [_, _, _, .., _] if longer > 3 => Some(format!(
            "the shape {shape} was taken for {points} points of {width} numbers; if it is a lattice with \
             {width} values at each node, save its nodes' places and values as columns, as \
             numpy.column_stack([numpy.indices(a.shape[:-1]).reshape(a.ndim - 1, -1).T, a.reshape(-1, \
             {width})]) has them"
        )),
        [_, _, _] if rows.kinds().into_iter().all(bytes) => Some(format!(
            "the shape {shape} of 8-bit integers is like a picture's, but was taken for {points} points"
        )),
        [rows, columns] if columns > MOST_COLUMNS_OF_FEW && columns > rows => Some(format!(
            "the array has {rows} rows of {columns} columns; if its columns are the points, save a.T"
        )),
        _ => None,
    }
}

/// The columns of an array without names, as the user says.
fn said(
    sample: &Sample,
    kinds: &[Type],
    path: &Path,
    columns: &Columns,
) -> Result<Vec<Field>, PointsError> {
    let names: Vec<String> = (0..kinds.len()).map(numbered).collect();
    let columns = match columns.position(path)? {
        true => columns.clone(),
        // The position is where it would be without.
        false => columns.with_position(&guess::by_place(sample, Some(kinds), None).fields),
    };
    named(&names, kinds, sample, path, &columns)
}

/// An array as points.
struct Rows {
    points: u64,
    /// Names of the numbers of a point; without meaning where the array has no named fields.
    names: Vec<String>,
    /// Where they are in a row, or, if they are `apart`, each in its own column.
    places: Vec<Place>,
    /// Whether all points' first numbers come first, then all second ones.
    apart: bool,
    /// Whether that is for the shape being (3, n).
    transposed: bool,
}

impl Rows {
    /// Fails if the shape is none of points.
    fn of(header: &Header) -> Result<Self, Trouble> {
        let record = &header.record;
        let too_many = || Trouble::header(format!("the shape {}", header.shape_in_words()), "less");
        let product = |lengths: &[u64]| -> Result<u64, Trouble> {
            let count = lengths.iter().try_fold(1u64, |all, &length| all.checked_mul(length));
            count.ok_or_else(too_many)
        };
        if record.numbers.is_empty() {
            return Err(Trouble::header("elements that are no numbers", "numbers"));
        }
        if record.has_names {
            let (names, places) = (record.numbers.iter())
                .map(|(name, place)| (name.clone(), bits_of_colors(name, *place)))
                .unzip();
            let points = product(&header.shape)?;
            return Ok(Self { points, names, places, apart: false, transposed: false });
        }
        let transposed = matches!(*header.shape, [3, n] if n > MOST_ROWS_OF_THREE);
        let (points, width) = match *header.shape {
            [_, n] if transposed => (n, 3),
            [ref before @ .., width] if !before.is_empty() => (product(before)?, width),
            [n] => (n, 1),
            _ => (1, 1),
        };
        let width = usize::try_from(width).ok().filter(|&width| width <= MAX_COLUMNS);
        let width = width.ok_or_else(|| {
            let found = format!("the shape {}", header.shape_in_words());
            Trouble::header(found, format!("at most {MAX_COLUMNS} columns"))
        })?;
        let place = record.numbers[0].1;
        let places = (0..width).map(|i| Place { offset: i * record.size, ..place }).collect();
        let names = vec![String::new(); width];
        // Two wrongs make a right: of (3, n) in Fortran's order, points come one after the other.
        Ok(Self { points, names, places, apart: transposed != header.fortran, transposed })
    }

    fn kinds(&self) -> Vec<Type> {
        self.places.iter().map(|place| place.coding.kind()).collect()
    }

    /// Bytes of a point.
    fn point_size(&self, header: &Header) -> u64 {
        let elements = if header.record.has_names { 1 } else { self.places.len() };
        (elements * header.record.size) as u64
    }

    /// What reads the numbers of all points. `open` gives the array from a place on.
    fn arrays<'f>(
        &self,
        header: &Header,
        name: &str,
        open: &dyn Fn(u64) -> io::Result<Box<dyn Read + 'f>>,
    ) -> io::Result<Vec<Array<'f>>> {
        let name = name.to_owned();
        if !self.apart {
            let size = self.point_size(header) as usize;
            let records = Records::new(open(header.length)?, size, self.places.clone());
            return Ok(vec![Array { name, width: self.places.len(), numbers: Box::new(records) }]);
        }
        let column_size = self.points.saturating_mul(header.record.size as u64);
        let columns = (0..).zip(&self.places).map(|(column, place)| {
            let skip = header.length.saturating_add(column_size.saturating_mul(column));
            let records = Records::of(open(skip)?, place.coding, place.big, 1);
            Ok(Array { name: name.clone(), width: 1, numbers: Box::new(records) })
        });
        columns.collect()
    }
}

/// A packed colour in a float is read as the bits that it is.
fn bits_of_colors(name: &str, place: Place) -> Place {
    match place.coding {
        Coding::Number(kind) => {
            Place { coding: Coding::Number(color::kind_in_binary(name, kind)), ..place }
        }
        Coding::Half => place,
    }
}

/// The fields of arrays that are read by their names, some of which the user may have changed.
fn named(
    names: &[String],
    kinds: &[Type],
    sample: &Sample,
    path: &Path,
    columns: &Columns,
) -> Result<Vec<Field>, PointsError> {
    let renamed = columns.renamed(names, path)?;
    let known: Vec<String> = renamed.iter().map(|name| name.clone().unwrap_or_default()).collect();
    let fields = meaning::by_names(&known, Some(kinds), sample).into_iter().zip(renamed).zip(names);
    let fields = fields.map(|((field, name), in_file)| match name {
        Some(_) => field.called(in_file),
        None => Field::left_out(field.kind),
    });
    Ok(fields.collect())
}

#[cfg(test)]
mod tests;
