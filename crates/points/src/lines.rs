//! A text file line by line, with the line's number for messages.

use crate::error::PointsError;
use crate::source::{Line, Source};
use std::path::Path;

/// How much of a file is looked at before it is read.
pub(crate) const SAMPLE: usize = 1 << 20;
/// Longest line.
const MAX_LINE: usize = 1 << 20;

pub(crate) const HELP: &str = "correct the line or export the file again";

/// The lines that are left of a file.
pub(crate) struct Lines<'s, 'a> {
    pub(crate) source: &'s mut Source<'a>,
    path: &'s Path,
    /// Lines read so far.
    pub(crate) number: u64,
    line_end: u8,
}

impl<'s, 'a> Lines<'s, 'a> {
    /// From where the file is read next, which is the beginning of a line.
    pub(crate) fn new(source: &'s mut Source<'a>, path: &'s Path) -> Result<Self, PointsError> {
        let io_error = |source| PointsError::Io { path: path.into(), source };
        let line_end = line_end_of(source.fill(SAMPLE).map_err(io_error)?);
        Ok(Self { source, path, number: 0, line_end })
    }

    /// The next line, without its end; `None` at the file's end.
    pub(crate) fn next(&mut self) -> Result<Option<&[u8]>, PointsError> {
        self.number += 1;
        match self.source.line(self.line_end, MAX_LINE) {
            Ok(Line::Whole(line)) => Ok(Some(line)),
            Ok(Line::End) => Ok(None),
            Ok(Line::TooLong) => Err(wrong_line(
                self.path,
                self.number,
                format!("more than {MAX_LINE} bytes"),
                "a shorter line",
            )),
            Err(source) => Err(PointsError::Io { path: self.path.into(), source }),
        }
    }

    /// What the last line says, and what it should say.
    pub(crate) fn wrong(
        &self,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> PointsError {
        wrong_line(self.path, self.number, found, expected)
    }
}

/// What a line says, and what it should say.
pub(crate) fn wrong_line(
    path: &Path,
    line: u64,
    found: impl Into<String>,
    expected: impl Into<String>,
) -> PointsError {
    let (found, expected) = (found.into(), expected.into());
    PointsError::Line { path: path.into(), line, found, expected, help: HELP }
}

/// The byte that ends the lines of a text that begins so.
pub(crate) fn line_end_of(start: &[u8]) -> u8 {
    if !start.contains(&b'\n') && start.contains(&b'\r') { b'\r' } else { b'\n' }
}

/// Words between blanks.
pub(crate) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> + Clone {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

pub(crate) fn values(count: usize) -> String {
    if count == 1 { "1 value".to_owned() } else { format!("{count} values") }
}
