//! PLY files: ascii, binary little-endian and binary big-endian.
//!
//! The reader is our own. With `ply-rs-bw` 4.0.1, a header of a hundred bytes that declares 10^9
//! records without properties runs the process out of memory, which aborts it. That crate also
//! refuses blank lines and `-nan(ind)`, needs a list on the heap for each point whose attributes
//! are not known beforehand, and took two to three times as long for 5 million binary points of 19
//! bytes (best of two runs 0.87 s against 0.26 s).
//!
//! A header is not believed: memory is asked for no more points than the file has bytes for.
//! `files_cut_at_any_byte_do_not_panic` and `hostile_counts_before_the_vertices_end_quickly` hold
//! what follows from it. Elements behind the vertices, faces for example, are not read at all.

mod header;
mod splat;
mod write;

pub use write::{PlyPoints, encode_ply};

use crate::collect::Collector;
use crate::color;
use crate::error::{PointsError, Quoted};
use crate::field::{Field, Type};
use crate::options::ReadOptions;
use crate::ply::header::{Element, Encoding, Header, Kind, Property, type_name};
use crate::ply::splat::Gaussians;
use crate::set::PointSet;
use crate::source::{Line, Source};
use crate::upright::Upwards;
use std::path::Path;

/// Longest line of a text file. Only lists come near it.
const MAX_LINE: usize = 1 << 24;

const VERTEX: &str = "vertex";

/// Whether a file that begins with these bytes says that it is PLY.
pub(crate) fn sniff(start: &[u8]) -> bool {
    start.strip_prefix(b"ply").is_some_and(|rest| rest.first().is_none_or(u8::is_ascii_whitespace))
}

/// Reads the vertices.
pub(crate) fn read(
    mut source: Source<'_>,
    path: &Path,
    options: &ReadOptions,
) -> Result<PointSet, PointsError> {
    let mut header = header::read(&mut source, path)?;
    let vertex = header.elements.iter().position(|element| element.name == VERTEX);
    let Some(vertex) = vertex else {
        return Err(no_vertices(&header, path));
    };
    if header.encoding != Encoding::Ascii {
        for property in &mut header.elements[vertex].properties {
            if let Kind::Number(kind) = &mut property.kind {
                *kind = color::kind_in_binary(&property.name, *kind);
            }
        }
    }
    let mut body = Body { source, path, line: header.lines, line_end: header.line_end };
    for element in &header.elements[..vertex] {
        body.element(header.encoding, element, &mut |_| Ok(()))?;
    }

    let vertices = &header.elements[vertex];
    let fields: Vec<Field> = (vertices.properties.iter())
        .filter_map(|property| match property.kind {
            Kind::Number(kind) => Some(Field::new(&property.name, kind)),
            Kind::List { .. } => None,
        })
        .collect();
    let count = body.check_count(header.encoding, vertices)?;
    let Some(gaussians) = Gaussians::of(&fields) else {
        let mut collector = Collector::new(&fields, path, options)?;
        collector.expect(count)?;
        body.element(header.encoding, vertices, &mut |row| collector.push(row))?;
        return collector.finish(header.encoding.in_words());
    };
    let mut collector = Collector::new(&gaussians.fields, path, options)?;
    collector.expect(count)?;
    let mut row = Vec::new();
    body.element(header.encoding, vertices, &mut |vertex| {
        gaussians.fill(vertex, &mut row);
        collector.push(&row)
    })?;
    let mut set = collector.finish(&format!("{}, 3D Gaussians", header.encoding.in_words()))?;
    set.up =
        Some((Upwards::MinusY, "as 3D Gaussians have it, which are made from cameras' pictures"));
    Ok(set)
}

fn no_vertices(header: &Header, path: &Path) -> PointsError {
    let names: Vec<_> = header.elements.iter().map(|e| format!("'{}'", e.name)).collect();
    let among = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
    PointsError::Missing {
        path: path.into(),
        missing: format!("element '{VERTEX}'"),
        place: format!("among the header's elements ({among})"),
        help: "export the points as vertices",
    }
}

/// Takes the values of one record, one for each property that is no list.
type Take<'a> = dyn FnMut(&[f64]) -> Result<(), PointsError> + 'a;

/// The part of a file behind its header.
struct Body<'a, 's> {
    source: Source<'s>,
    path: &'a Path,
    /// Lines read so far, for messages; counts in text files alone.
    line: u64,
    line_end: u8,
}

impl Body<'_, '_> {
    /// Reads one element, record by record.
    fn element(
        &mut self,
        encoding: Encoding,
        element: &Element,
        take: &mut Take<'_>,
    ) -> Result<(), PointsError> {
        if element.properties.is_empty() {
            return Ok(()); // takes no bytes; blank lines are skipped anyway
        }
        match (encoding, element.record_size()) {
            (Encoding::Ascii, _) => self.text(element, take),
            (Encoding::LittleEndian, Some(size)) => self.fixed::<false>(element, size, take),
            (Encoding::BigEndian, Some(size)) => self.fixed::<true>(element, size, take),
            (Encoding::LittleEndian, None) => self.varying::<false>(element, take),
            (Encoding::BigEndian, None) => self.varying::<true>(element, take),
        }
    }

    /// For how many vertices memory can be asked: as many as declared, but no more than the file
    /// has bytes for. Fails early where it is clear that there are too few or too many.
    fn check_count(&self, encoding: Encoding, element: &Element) -> Result<u64, PointsError> {
        let least = element.least_record_size(encoding);
        let fits = self.source.records(element.count, least);
        let fixed = encoding != Encoding::Ascii && element.record_size().is_some();
        let left = self.source.left();
        if fixed && left.is_some() && fits < element.count {
            return Err(cut_off(self.path, element, fits, left));
        }
        if left.is_none() && element.count > u64::from(u32::MAX) {
            return Err(PointsError::TooMany { path: self.path.into(), found: element.count });
        }
        Ok(fits)
    }

    /// Binary records that are all of one size.
    fn fixed<const BIG: bool>(
        &mut self,
        element: &Element,
        size: usize,
        take: &mut Take<'_>,
    ) -> Result<(), PointsError> {
        let path = self.path;
        let io_error = |source| PointsError::Io { path: path.into(), source };
        let mut places = Vec::with_capacity(element.properties.len());
        let mut offset = 0;
        for property in &element.properties {
            if let Kind::Number(kind) = property.kind {
                places.push((kind, offset));
                offset += kind.size();
            }
        }
        let mut row = vec![0.0; places.len()];
        let mut done = 0u64;
        while done < element.count {
            let there = self.source.fill(size).map_err(io_error)?;
            let wanted = usize::try_from(element.count - done).unwrap_or(usize::MAX);
            let records = (there.len() / size).min(wanted);
            if records == 0 {
                let bytes = done * size as u64 + there.len() as u64;
                return Err(cut_off(path, element, done, Some(bytes)));
            }
            for record in there[..records * size].chunks_exact(size) {
                for (value, &(kind, offset)) in row.iter_mut().zip(&places) {
                    *value = kind.read::<BIG>(&record[offset..]);
                }
                take(&row)?;
                done += 1;
            }
            self.source.consume(records * size);
        }
        Ok(())
    }

    /// Binary records with lists.
    fn varying<const BIG: bool>(
        &mut self,
        element: &Element,
        take: &mut Take<'_>,
    ) -> Result<(), PointsError> {
        let path = self.path;
        let io_error = |source| PointsError::Io { path: path.into(), source };
        let mut row = Vec::with_capacity(element.properties.len());
        for index in 0..element.count {
            row.clear();
            for property in &element.properties {
                let (kind, item) = match property.kind {
                    Kind::Number(kind) => (kind, None),
                    Kind::List { length, item } => (length, Some(item)),
                };
                let there = self.source.fill(kind.size()).map_err(io_error)?;
                if there.len() < kind.size() {
                    return Err(cut_off(path, element, index, None));
                }
                let value = kind.read::<BIG>(there);
                self.source.consume(kind.size());
                let Some(item) = item else {
                    row.push(value);
                    continue;
                };
                if value < 0.0 {
                    return Err(PointsError::ListLength {
                        path: self.path.into(),
                        element: element.name.clone(),
                        index,
                        property: property.name.clone(),
                        length: value,
                    });
                }
                // At most 2^32 items of 8 bytes.
                let bytes = value as u64 * item.size() as u64;
                if self.source.skip(bytes).map_err(io_error)? < bytes {
                    return Err(cut_off(path, element, index, None));
                }
            }
            take(&row)?;
        }
        Ok(())
    }

    /// Text: one record a line. Blank lines are skipped.
    fn text(&mut self, element: &Element, take: &mut Take<'_>) -> Result<(), PointsError> {
        let path = self.path;
        let io_error = |source| PointsError::Io { path: path.into(), source };
        let mut row = Vec::with_capacity(element.properties.len());
        let mut index = 0;
        while index < element.count {
            self.line += 1;
            let line_error = |found: String, expected: String| PointsError::Line {
                path: path.into(),
                line: self.line,
                found,
                expected,
                help: "correct the line or export the file again",
            };
            let line = match self.source.line(self.line_end, MAX_LINE) {
                Ok(Line::Whole(line)) => line,
                Ok(Line::End) => return Err(cut_off(path, element, index, None)),
                Ok(Line::TooLong) => {
                    let expected = format!("values of {} {index}", element.name);
                    return Err(line_error(format!("more than {MAX_LINE} bytes"), expected));
                }
                Err(error) => return Err(io_error(error)),
            };
            let words =
                || line.split(|byte| byte.is_ascii_whitespace()).filter(|word| !word.is_empty());
            if words().next().is_none() {
                continue;
            }
            if let Err(wrong) = text_record(&element.properties, words(), &mut row) {
                let (found, expected) = wrong.describe(words().count());
                return Err(line_error(found, format!("{expected} of {} {index}", element.name)));
            }
            take(&row)?;
            index += 1;
        }
        Ok(())
    }
}

/// The file ends after `found` records. `bytes` are those left for the element.
fn cut_off(path: &Path, element: &Element, found: u64, bytes: Option<u64>) -> PointsError {
    let size = element.record_size().filter(|_| bytes.is_some());
    PointsError::CutOff {
        path: path.into(),
        what: format!("of element '{}'", element.name),
        declared: element.count,
        found,
        bytes_declared: size.map(|size| u128::from(element.count) * size as u128),
        bytes_found: bytes,
    }
}

/// What is wrong with a record of text.
enum Wrong<'a> {
    /// The line ends before this property, or within it.
    Short { property: &'a str },
    /// The line goes on behind the last property.
    Long { values: usize },
    /// A word is no number of the property's type.
    Word { word: &'a [u8], property: &'a str, kind: Type },
}

impl Wrong<'_> {
    /// What was found in a line of `words`, and what was expected.
    fn describe(&self, words: usize) -> (String, String) {
        match self {
            Self::Short { property } => {
                (format!("only {words} values"), format!("a value for property '{property}'"))
            }
            Self::Long { values } => (format!("{words} values"), format!("the {values} values")),
            Self::Word { word, property, kind } => (
                Quoted(word).to_string(),
                format!("a number of type {} for property '{property}'", type_name(*kind)),
            ),
        }
    }
}

/// Reads the values of one line into `row`.
fn text_record<'a>(
    properties: &'a [Property],
    mut words: impl Iterator<Item = &'a [u8]>,
    row: &mut Vec<f64>,
) -> Result<(), Wrong<'a>> {
    row.clear();
    let mut values = 0;
    let mut next = |property: &'a Property, kind: Type, least: f64| {
        let name = property.name.as_str();
        let word = words.next().ok_or(Wrong::Short { property: name })?;
        values += 1;
        kind.parse(word).filter(|&value| value >= least || kind.is_float()).ok_or(Wrong::Word {
            word,
            property: name,
            kind,
        })
    };
    for property in properties {
        match property.kind {
            Kind::Number(kind) => row.push(next(property, kind, f64::NEG_INFINITY)?),
            Kind::List { length, item } => {
                for _ in 0..next(property, length, 0.0)? as u64 {
                    next(property, item, f64::NEG_INFINITY)?;
                }
            }
        }
    }
    match words.next() {
        Some(_) => Err(Wrong::Long { values }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
