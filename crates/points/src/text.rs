//! Tables of text: XYZ, PTS, CSV, TXT, ASC, with or without names above the columns.
//!
//! What separates columns, which line has their names, and what columns without names are is found
//! by [`layout`] from the first megabyte; everything after it must be of the same shape, and a line
//! that is not is an error that says which. Lines are read one at a time: what is held is the
//! points, not the text.

mod head;
mod layout;
mod named;
mod sections;
mod split;
mod tecplot;

use crate::collect::Collector;
use crate::error::{PointsError, Quoted};
use crate::lines::{Lines, SAMPLE, values};
use crate::meaning::printable;
use crate::number::number;
use crate::options::ReadOptions;
use crate::set::PointSet;
use crate::source::Source;
use crate::text::layout::Layout;
use crate::text::sections::Between;
use crate::text::split::{Separator, blanks, is_comment, quoted};
use std::path::Path;

/// A table of more columns is taken for something else.
const MAX_COLUMNS: usize = 1000;

/// Whether a file that begins so is a table: its first line that is no comment has three numbers
/// or more, or the line after it has and it could be their names.
pub(crate) fn sniff(start: &[u8]) -> bool {
    head::looks_like_table(start)
}

/// Reads one point a line.
pub(crate) fn read(
    mut source: Source<'_>,
    path: &Path,
    options: &ReadOptions,
) -> Result<PointSet, PointsError> {
    let io_error = |source| PointsError::Io { path: path.into(), source };
    let start = source.fill(SAMPLE).map_err(io_error)?;
    let layout = layout::find(start, start.len() < SAMPLE, path, &options.columns)?;
    source.consume(layout.mark);

    let mut collector = Collector::of_named(&layout.fields, path, options)?;
    // A line of the sample's average length, less a tenth.
    let least = (layout.bytes_per_row * 9 / 10).max(2 * layout.fields.len() as u64);
    // An estimate: where there is no memory for it, there may be for the points.
    let _ = collector.expect(source.records(u64::MAX, least).min(u32::MAX.into()));
    let between = Between::new(layout.kind);
    let mut rows = Rows { layout: &layout, found: 0, declared: layout.declared, between };
    rows.read(Lines::new(&mut source, path)?, &mut collector)?;
    if let Some(declared) = rows.declared.filter(|&declared| rows.found < declared) {
        return Err(PointsError::CutOff {
            path: path.into(),
            what: "points".to_owned(),
            declared,
            found: rows.found,
            bytes_declared: None,
            bytes_found: None,
        });
    }
    let mut set = collector.finish(&layout.in_words)?;
    set.notes.extend(layout.notes.iter().cloned().chain(rows.between.note()));
    Ok(set)
}

struct Rows<'a> {
    layout: &'a Layout,
    /// Points read so far.
    found: u64,
    /// How many points the lines that count them declare, all together.
    declared: Option<u64>,
    /// What follows a line that is no row.
    between: Between,
}

impl Rows<'_> {
    fn read(
        &mut self,
        mut lines: Lines<'_, '_>,
        collector: &mut Collector<'_>,
    ) -> Result<(), PointsError> {
        let layout = self.layout;
        let mut row = Vec::with_capacity(layout.fields.len());
        let mut number = 0;
        while let Some(line) = lines.next()? {
            number += 1;
            // Names and counts above the first point were understood already.
            if number < layout.first_row || is_comment(line) || self.between.passes_over(line) {
                continue;
            }
            let read = match layout.separator {
                Separator::Blanks if line.contains(&b'"') => {
                    row_of(layout.separator.words(line).into_iter(), layout, &mut row)
                }
                Separator::Blanks => row_of(blanks(line), layout, &mut row),
                Separator::Byte(byte) if line.contains(&b'"') => {
                    let words = quoted(line, |other| other == byte);
                    row_of(words.into_iter(), layout, &mut row)
                }
                Separator::Byte(byte) => {
                    let words = line.split(move |&other| other == byte).map(<[u8]>::trim_ascii);
                    row_of(words, layout, &mut row)
                }
            };
            if let Err(wrong) = read {
                if self.between.is_end(line, self.found, self.declared) {
                    break;
                }
                // Several scans in one file, each with its count above.
                if let Some((declared, count)) = self.declared.zip(head::count_of(line)) {
                    self.declared = Some(declared.saturating_add(count));
                    continue;
                }
                let (found, expected) = wrong.describe(layout);
                return Err(lines.wrong(found, expected));
            }
            collector.push(&row)?;
            self.found += 1;
            self.between.saw_row();
        }
        Ok(())
    }
}

/// What is wrong with a line.
enum Wrong {
    /// It has this many values.
    Count(usize),
    Word {
        word: Vec<u8>,
        column: usize,
    },
}

impl Wrong {
    /// What was found, and what was expected.
    fn describe(&self, layout: &Layout) -> (String, String) {
        match self {
            Self::Count(found) => {
                let columns = values(layout.columns.len());
                (values(*found), format!("{columns} as in line {}", layout.shape_line))
            }
            Self::Word { word, column } => {
                let name = printable(layout.name_of(*column));
                (Quoted(word).to_string(), format!("a number for '{name}', column {}", column + 1))
            }
        }
    }
}

/// The numbers of one line.
fn row_of<'a>(
    mut words: impl Iterator<Item = &'a [u8]>,
    layout: &Layout,
    row: &mut Vec<f64>,
) -> Result<(), Wrong> {
    row.clear();
    for (column, &is_number) in layout.columns.iter().enumerate() {
        let word = words.next().ok_or(Wrong::Count(column))?;
        if is_number {
            let value = number(word, layout.comma);
            row.push(value.ok_or_else(|| Wrong::Word { word: word.to_vec(), column })?);
        }
    }
    match words.next() {
        None => Ok(()),
        Some(_) if layout.open => Ok(()),
        // A separator at the end of each line.
        Some(b"") if words.next().is_none() => Ok(()),
        Some(_) => Err(Wrong::Count(layout.columns.len() + 1 + words.count())),
    }
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_programs;
