//! Tables of text: XYZ, PTS, CSV, TXT, ASC, with or without names above the columns.
//!
//! What separates columns, which line has their names, and what columns without names are is found
//! by [`layout`] from the first megabyte; everything after it must be of the same shape, and a line
//! that is not is an error that says which. Lines are read one at a time: what is held is the
//! points, not the text.

mod layout;
mod number;
mod split;

use crate::collect::Collector;
use crate::error::{PointsError, Quoted};
use crate::options::ReadOptions;
use crate::set::PointSet;
use crate::source::{Line, Source};
use crate::text::layout::Layout;
use crate::text::number::number;
use crate::text::split::{Separator, blanks, is_comment, quoted};
use std::path::Path;

/// How much of a file is looked at before it is read.
const SAMPLE: usize = 1 << 20;
/// Longest line.
const MAX_LINE: usize = 1 << 20;
/// A table of more columns is taken for something else.
const MAX_COLUMNS: usize = 1000;

const HELP: &str = "correct the line or export the file again";

/// Whether a file that begins so is a table: its first line that is no comment has three numbers
/// or more, or the line after it has and it could be their names.
pub(crate) fn sniff(start: &[u8]) -> bool {
    layout::looks_like_table(start)
}

/// Reads one point a line.
pub(crate) fn read(
    mut source: Source<'_>,
    path: &Path,
    options: &ReadOptions,
) -> Result<PointSet, PointsError> {
    let io_error = |source| PointsError::Io { path: path.into(), source };
    let start = source.fill(SAMPLE).map_err(io_error)?;
    let layout = layout::find(start, start.len() < SAMPLE, path)?;
    source.consume(layout.mark);

    let mut collector = Collector::new(&layout.fields, path, options)?;
    // A line of the sample's average length, less a tenth.
    let least = (layout.bytes_per_row * 9 / 10).max(2 * layout.fields.len() as u64);
    collector.expect(source.records(u64::MAX, least).min(u32::MAX.into()))?;
    let mut table = Table { layout: &layout, path, line: 0, rows: 0, declared: layout.declared };
    table.rows(&mut source, &mut collector)?;
    if table.declared.is_some_and(|declared| table.rows < declared) {
        return Err(PointsError::CutOff {
            path: path.into(),
            what: "points".to_owned(),
            declared: table.declared.unwrap_or(0),
            found: table.rows,
            bytes_declared: None,
            bytes_found: None,
        });
    }
    collector.finish(&layout.in_words)
}

struct Table<'a> {
    layout: &'a Layout,
    path: &'a Path,
    /// Lines read so far.
    line: u64,
    /// Points read so far.
    rows: u64,
    /// How many points the lines that count them declare, all together.
    declared: Option<u64>,
}

impl Table<'_> {
    fn rows(
        &mut self,
        source: &mut Source<'_>,
        collector: &mut Collector<'_>,
    ) -> Result<(), PointsError> {
        let path = self.path;
        let columns = self.layout.columns.len();
        let mut row = Vec::with_capacity(self.layout.fields.len());
        loop {
            self.line += 1;
            let line = match source.line(self.layout.line_end, MAX_LINE) {
                Ok(Line::Whole(line)) => line,
                Ok(Line::End) => return Ok(()),
                Ok(Line::TooLong) => {
                    let found = format!("more than {MAX_LINE} bytes");
                    return Err(self.wrong(found, format!("{columns} values")));
                }
                Err(source) => return Err(PointsError::Io { path: path.into(), source }),
            };
            // Names and counts above the first point were understood already.
            if self.line < self.layout.first_row || is_comment(line) {
                continue;
            }
            let read = match self.layout.separator {
                Separator::Blanks => row_of(blanks(line), self.layout, &mut row),
                Separator::Byte(byte) if line.contains(&b'"') => {
                    let words = quoted(line, |other| other == byte);
                    row_of(words.into_iter(), self.layout, &mut row)
                }
                Separator::Byte(byte) => {
                    let words = line.split(move |&other| other == byte).map(<[u8]>::trim_ascii);
                    row_of(words, self.layout, &mut row)
                }
            };
            if let Err(wrong) = read {
                // Several scans in one file, each with its count above.
                if let (Some(declared), Some(count)) = (self.declared, layout::count_of(line)) {
                    self.declared = Some(declared.saturating_add(count));
                    continue;
                }
                let (found, expected) = self.describe(&wrong);
                return Err(self.wrong(found, expected));
            }
            collector.push(&row)?;
            self.rows += 1;
        }
    }

    fn describe(&self, wrong: &Wrong) -> (String, String) {
        let shape = || {
            let first = self.layout.shape_line;
            format!("{} as in line {first}", values(self.layout.columns.len()))
        };
        match wrong {
            Wrong::Count(found) => (values(*found), shape()),
            Wrong::Word { word, column } => {
                let name = self.layout.name_of(*column);
                (Quoted(word).to_string(), format!("a number for '{name}', column {}", column + 1))
            }
        }
    }

    fn wrong(&self, found: String, expected: String) -> PointsError {
        PointsError::Line { path: self.path.into(), line: self.line, found, expected, help: HELP }
    }
}

fn values(count: usize) -> String {
    if count == 1 { "1 value".to_owned() } else { format!("{count} values") }
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
        // A separator at the end of each line.
        Some(b"") if words.next().is_none() => Ok(()),
        Some(_) => Err(Wrong::Count(layout.columns.len() + 1 + words.count())),
    }
}

#[cfg(test)]
mod tests;
