//! Numbers in text.

use crate::columns::Numbers;
use crate::error::Quoted;
use crate::number::number;
use std::io::{self, BufRead};

/// Longest number.
const LONGEST: usize = 256;

/// Numbers between blanks.
pub(super) struct Words<R> {
    reader: R,
    word: Vec<u8>,
    /// What they are multiplied by.
    scale: f64,
}

impl<R: BufRead> Words<R> {
    pub(super) fn new(reader: R) -> Self {
        Self { reader, word: Vec::new(), scale: 1.0 }
    }

    pub(super) fn scaled(self, scale: f64) -> Self {
        Self { scale, ..self }
    }
}

impl<R: BufRead> Numbers for Words<R> {
    fn next(&mut self, out: &mut [f64]) -> io::Result<usize> {
        let mut found = 0;
        for value in &mut *out {
            if !next_word(&mut self.reader, &mut self.word, &mut 0)? {
                break;
            }
            let Some(read) = number(&self.word, false) else {
                let message = Quoted(&self.word).to_string();
                return Err(io::Error::new(io::ErrorKind::InvalidData, message));
            };
            *value = read * self.scale;
            found += 1;
        }
        Ok(found)
    }
}

/// Reads the next word, and counts the line ends before it. Tells whether there was one; of one
/// that is too long to be a number, the beginning is read.
pub(super) fn next_word(
    reader: &mut impl BufRead,
    word: &mut Vec<u8>,
    line_ends: &mut u64,
) -> io::Result<bool> {
    word.clear();
    loop {
        let there = match reader.fill_buf() {
            Ok(there) => there,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        if there.is_empty() {
            return Ok(!word.is_empty());
        }
        let mut start = 0;
        if word.is_empty() {
            let blanks = there.iter().take_while(|byte| byte.is_ascii_whitespace());
            start = blanks.inspect(|&&byte| *line_ends += u64::from(byte == b'\n')).count();
        }
        let end = there[start..].iter().position(u8::is_ascii_whitespace);
        let stop = end.map_or(there.len(), |end| start + end);
        word.extend_from_slice(&there[start..stop]);
        reader.consume(stop);
        if end.is_some() && !word.is_empty() || word.len() > LONGEST {
            return Ok(true);
        }
    }
}
