//! A place in a legacy VTK file, from line to line and over data.

use crate::columns::{Part, Shared, fill};
use crate::error::{PointsError, Quoted};
use crate::lines::HELP as LINE_HELP;
use crate::meaning::printable;
use crate::vtk::HELP;
use crate::vtk::ascii::next_word;
use crate::vtk::legacy::Encoding;
use std::io::{self, BufRead, BufReader, Read, Seek};
use std::path::Path;

/// Longest line between data.
const MAX_LINE: u64 = 1 << 16;

pub(super) struct Cursor<'f, 'a> {
    file: &'f Shared<'a>,
    reader: BufReader<Part<'f, 'a>>,
    pub(super) path: &'f Path,
    pub(super) binary: bool,
    /// Place in the file.
    pub(super) at: u64,
    length: u64,
    /// Lines so far; without meaning behind binary data.
    line: u64,
    behind_binary: bool,
}

impl<'f, 'a> Cursor<'f, 'a> {
    pub(super) fn new(file: &'f Shared<'a>, path: &'f Path) -> Self {
        let length = file.borrow().length();
        let reader = Part::new(file, 0, length).buffered();
        Self { file, reader, path, binary: false, at: 0, length, line: 0, behind_binary: false }
    }

    pub(super) fn io_error(&self, source: io::Error) -> PointsError {
        PointsError::Io { path: self.path.into(), source }
    }

    /// What the last line says, and what it should say.
    pub(super) fn wrong(&self, found: &str, expected: &str) -> PointsError {
        let found = Quoted(found.as_bytes()).to_string();
        if self.behind_binary {
            let place = format!("the line that ends at byte {}", self.at);
            return PointsError::wrong(self.path, &place, found, expected, HELP);
        }
        let expected = expected.to_owned();
        let (path, line) = (self.path.into(), self.line);
        PointsError::Line { path, line, found, expected, help: LINE_HELP }
    }

    /// The next line; `None` at the end of the file.
    pub(super) fn line(&mut self) -> Result<Option<String>, PointsError> {
        let mut bytes = Vec::new();
        let read = self.reader.by_ref().take(MAX_LINE).read_until(b'\n', &mut bytes);
        let count = read.map_err(|source| self.io_error(source))? as u64;
        if count == 0 {
            return Ok(None);
        }
        self.at += count;
        self.line += 1;
        if count == MAX_LINE && bytes.last() != Some(&b'\n') {
            return Err(self.wrong(&String::from_utf8_lossy(&bytes), "a shorter line"));
        }
        Ok(Some(String::from_utf8_lossy(bytes.trim_ascii_end()).into_owned()))
    }

    /// The next line that has words.
    pub(super) fn next_line(&mut self) -> Result<Option<String>, PointsError> {
        while let Some(line) = self.line()? {
            if !line.trim().is_empty() {
                return Ok(Some(line));
            }
        }
        Ok(None)
    }

    /// The next line that has words, where there must be one.
    pub(super) fn required(&mut self, expected: &str) -> Result<String, PointsError> {
        let line = self.next_line()?;
        line.ok_or_else(|| PointsError::Line {
            path: self.path.into(),
            line: self.line + 1,
            found: "the end of the file".to_owned(),
            expected: expected.to_owned(),
            help: LINE_HELP,
        })
    }

    /// The next line that has words, if it begins with this one; else the place stays.
    pub(super) fn line_if(&mut self, word: &str) -> Result<Option<String>, PointsError> {
        // Binary data may have no line end for long, so only the beginning is looked at.
        let mut begin = [0; 64];
        let read = fill(&mut Part::new(self.file, self.at, self.length), &mut begin);
        let read = read.map_err(|source| self.io_error(source))?;
        let begin = begin[..read].trim_ascii_start().get(..word.len());
        match begin.is_some_and(|begin| begin.eq_ignore_ascii_case(word.as_bytes())) {
            true => self.next_line(),
            false => Ok(None),
        }
    }

    /// Passes over lines up to an empty one.
    pub(super) fn skip_paragraph(&mut self) -> Result<(), PointsError> {
        while self.line()?.is_some_and(|line| !line.trim().is_empty()) {}
        Ok(())
    }

    /// Passes over an array. Fails if the file ends before.
    pub(super) fn skip(
        &mut self,
        encoding: Encoding,
        name: &str,
        count: u64,
        values: u64,
    ) -> Result<(), PointsError> {
        let bytes = match encoding {
            Encoding::Binary(kind) => u128::from(values) * kind.size() as u128,
            Encoding::Bits => u128::from(values.div_ceil(8)),
            Encoding::Text | Encoding::Fractions => return self.skip_words(name, count, values),
            Encoding::Strings if self.binary => return self.skip_strings(values),
            Encoding::Strings => {
                for found in 0..values {
                    if self.line()?.is_none() {
                        return Err(self.cut_off(name, values, found, None, None));
                    }
                }
                return Ok(());
            }
        };
        self.behind_binary = true;
        let left = self.length.saturating_sub(self.at);
        if bytes > left.into() {
            let whole = u128::from(count) * u128::from(left) / bytes.max(1);
            return Err(self.cut_off(name, count, whole as u64, Some(bytes), Some(left)));
        }
        self.go_to(self.at + bytes as u64)
    }

    fn go_to(&mut self, place: u64) -> Result<(), PointsError> {
        let step = place as i64 - self.at as i64;
        self.reader.seek_relative(step).map_err(|source| self.io_error(source))?;
        self.at = place;
        Ok(())
    }

    /// Passes over numbers in text.
    fn skip_words(&mut self, name: &str, count: u64, values: u64) -> Result<(), PointsError> {
        let mut word = Vec::new();
        let mut line_ends = 0;
        for found in 0..values {
            let there = next_word(&mut self.reader, &mut word, &mut line_ends);
            if !there.map_err(|source| self.io_error(source))? {
                let whole = u128::from(count) * u128::from(found) / u128::from(values);
                return Err(self.cut_off(name, count, whole as u64, None, None));
            }
            let is_number = word.first().is_some_and(|byte| {
                matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'n' | b'i' | b'I')
            });
            // A keyword where a number should be; NaN is the only one in capitals.
            if !is_number && !word.eq_ignore_ascii_case(b"nan") {
                self.line += line_ends + 1;
                let expected = format!("the {values} values of '{}'", printable(name));
                return Err(self.wrong(&String::from_utf8_lossy(&word), &expected));
            }
        }
        self.line += line_ends;
        self.at = self.reader.stream_position().map_err(|source| self.io_error(source))?;
        Ok(())
    }

    /// Passes over strings, each behind its length: in the two highest bits of the first byte
    /// stands how many bytes the length takes.
    fn skip_strings(&mut self, values: u64) -> Result<(), PointsError> {
        self.behind_binary = true;
        for found in 0..values {
            let mut bytes = [0; 8];
            let mut rest = self.reader.read_exact(&mut bytes[..1]);
            let more = [7, 3, 1, 0][usize::from(bytes[0] >> 6)];
            rest = rest.and_then(|()| self.reader.read_exact(&mut bytes[1..=more]));
            bytes[0] &= 0x3f;
            let length = bytes[..=more].iter().fold(0, |all, &byte| all << 8 | u64::from(byte));
            let end = self.at.checked_add(1 + more as u64 + length);
            let Some(end) = end.filter(|&end| rest.is_ok() && end <= self.length) else {
                return Err(self.cut_off("strings", values, found, None, None));
            };
            self.at += 1 + more as u64;
            self.go_to(end)?;
        }
        Ok(())
    }

    fn cut_off(
        &self,
        name: &str,
        declared: u64,
        found: u64,
        bytes_declared: Option<u128>,
        bytes_found: Option<u64>,
    ) -> PointsError {
        let what = match name {
            "points" => "points".to_owned(),
            name => format!("values of '{}'", printable(name)),
        };
        let path = self.path.into();
        PointsError::CutOff { path, what, declared, found, bytes_declared, bytes_found }
    }
}
