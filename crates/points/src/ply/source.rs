//! A file read in blocks, as bytes and as lines.

use std::io::{self, Read};

/// How much is asked of the file at once.
const BLOCK: usize = 1 << 20;

/// A buffered file that tells how far it is.
pub(super) struct Source<'a, R> {
    file: R,
    /// The file's length where it is known.
    length: Option<u64>,
    progress: &'a mut dyn FnMut(u64, u64),
    buffer: Vec<u8>,
    /// The part of the buffer that was read from the file and not yet consumed.
    start: usize,
    end: usize,
    /// Bytes read from the file so far.
    read: u64,
}

/// What stands in the file up to the next line end.
pub(super) enum Line<'a> {
    /// A line without its end, which may be the file's end.
    Whole(&'a [u8]),
    /// It is longer than was asked for.
    TooLong,
    /// Nothing is left in the file.
    End,
}

impl<'a, R: Read> Source<'a, R> {
    pub(super) fn new(file: R, length: Option<u64>, progress: &'a mut dyn FnMut(u64, u64)) -> Self {
        // A small file needs no large buffer; one byte more, to meet the end at once.
        let known = length.and_then(|length| usize::try_from(length).ok()).unwrap_or(BLOCK);
        let buffer = vec![0; known.clamp(63, BLOCK - 1) + 1];
        Self { file, length, progress, buffer, start: 0, end: 0, read: 0 }
    }

    /// Bytes of the file that are not consumed, where its length is known.
    pub(super) fn left(&self) -> Option<u64> {
        let consumed = self.read - (self.end - self.start) as u64;
        self.length.map(|length| length.saturating_sub(consumed))
    }

    /// What is not yet consumed: at least `wanted` bytes, unless the file ends before.
    pub(super) fn fill(&mut self, wanted: usize) -> io::Result<&[u8]> {
        if self.end - self.start < wanted {
            self.buffer.copy_within(self.start..self.end, 0);
            self.end -= self.start;
            self.start = 0;
            if self.buffer.len() < wanted {
                self.buffer.resize(wanted.next_power_of_two(), 0);
            }
            while self.end < wanted {
                match self.file.read(&mut self.buffer[self.end..]) {
                    Ok(0) => break,
                    Ok(count) => {
                        self.end += count;
                        self.read += count as u64;
                        (self.progress)(self.read, self.length.unwrap_or(0));
                    }
                    Err(error) if error.kind() == io::ErrorKind::Interrupted => (),
                    Err(error) => return Err(error),
                }
            }
        }
        Ok(&self.buffer[self.start..self.end])
    }

    /// Passes over bytes that [`fill`](Self::fill) has shown.
    pub(super) fn consume(&mut self, count: usize) {
        self.start += count;
        debug_assert!(self.start <= self.end, "source: consumed what was not filled");
    }

    /// Passes over bytes, and says how many there were.
    pub(super) fn skip(&mut self, count: u64) -> io::Result<u64> {
        let mut skipped = 0;
        while skipped < count {
            let there = self.fill(1)?.len();
            if there == 0 {
                break;
            }
            let step = there.min(usize::try_from(count - skipped).unwrap_or(usize::MAX));
            self.consume(step);
            skipped += step as u64;
        }
        Ok(skipped)
    }

    /// The next line, which ends with the byte `line_end`. A carriage return before that belongs
    /// to the line's end.
    pub(super) fn line(&mut self, line_end: u8, longest: usize) -> io::Result<Line<'_>> {
        let mut searched = 0;
        let (length, end) = loop {
            let there = self.fill(searched + 1)?;
            if there.len() == searched {
                break (searched, 0); // the file ends
            }
            let found = there[searched..].iter().position(|&byte| byte == line_end);
            if let Some(found) = found {
                break (searched + found, 1);
            }
            searched = there.len();
            if searched > longest {
                return Ok(Line::TooLong);
            }
        };
        if length > longest {
            return Ok(Line::TooLong);
        }
        if length + end == 0 {
            return Ok(Line::End);
        }
        let start = self.start;
        self.consume(length + end);
        let line = &self.buffer[start..start + length];
        Ok(Line::Whole(line.strip_suffix(b"\r").unwrap_or(line)))
    }
}
