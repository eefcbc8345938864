//! As much of XML as VTK files have: tags, their attributes, and where the text between them is.
//!
//! The text is passed over, not held: arrays in it may be of any length.

use crate::columns::{Part, Shared};
use crate::error::{PointsError, Quoted};
use crate::lines::wrong_line;
use std::io::{self, BufRead, BufReader};
use std::path::Path;

/// Longest tag.
const MAX_TAG: usize = 1 << 16;

/// The tags of a file, one by one.
pub(super) struct Markup<'f, 'a> {
    reader: BufReader<Part<'f, 'a>>,
    pub(super) path: &'f Path,
    /// Place in the file.
    pub(super) at: u64,
    /// Lines that ended before it.
    line_ends: u64,
}

/// A tag.
#[derive(Debug, PartialEq)]
pub(super) struct Tag {
    pub(super) name: String,
    pub(super) kind: TagKind,
    attributes: Vec<(String, String)>,
    /// Where in the file it begins.
    pub(super) start: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TagKind {
    Open,
    Close,
    /// Opened and closed at once.
    Empty,
}

impl Tag {
    /// The value of an attribute, without entities.
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        let found = self.attributes.iter().find(|(other, _)| other == name);
        found.map(|(_, value)| value.as_str())
    }
}

impl<'f, 'a> Markup<'f, 'a> {
    pub(super) fn new(file: &'f Shared<'a>, path: &'f Path) -> Self {
        let reader = Part::new(file, 0, u64::MAX).buffered();
        Self { reader, path, at: 0, line_ends: 0 }
    }

    pub(super) fn wrong(
        &self,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> PointsError {
        wrong_line(self.path, self.line_ends + 1, found, expected)
    }

    /// As [`wrong`](Self::wrong), of what others may read.
    pub(super) fn unread(
        &self,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> PointsError {
        PointsError::Line {
            path: self.path.into(),
            line: self.line_ends + 1,
            found: found.into(),
            expected: expected.into(),
            help: "open it in ParaView and save the data as VTU or VTP with another choice",
        }
    }

    /// The next tag; `None` at the end of the file.
    pub(super) fn next(&mut self) -> Result<Option<Tag>, PointsError> {
        loop {
            if !self.skip_to(b'<')? {
                return Ok(None);
            }
            let start = self.at;
            let text = self.tag()?;
            match text.as_bytes() {
                [b'!' | b'?', ..] => continue,
                _ => {
                    let tag = parse(&text, start);
                    let found = || Quoted(text.as_bytes()).to_string();
                    return tag.map(Some).ok_or_else(|| self.wrong(found(), "a tag of XML"));
                }
            }
        }
    }

    /// Passes over the text up to a sign, and over that. Tells whether it was there.
    pub(super) fn skip_to(&mut self, sign: u8) -> Result<bool, PointsError> {
        loop {
            let there = self.there()?;
            if there.is_empty() {
                return Ok(false);
            }
            let place = there.iter().position(|&byte| byte == sign);
            let count = there.len();
            match place {
                Some(place) => {
                    self.consume(place);
                    if sign == b'<' {
                        return Ok(true); // it belongs to the tag
                    }
                    self.consume(1);
                    return Ok(true);
                }
                None => self.consume(count),
            }
        }
    }

    /// The text of a tag or comment, without its brackets.
    fn tag(&mut self) -> Result<String, PointsError> {
        let mut text: Vec<u8> = Vec::new();
        let mut quote = None;
        let end = |text: &[u8]| match text {
            [_, b'!', b'-', b'-', .., b'-', b'-'] => text.len() >= 6,
            [_, b'!', b'-', b'-', ..] => false,
            [_, b'!', b'[', b'C', b'D', b'A', b'T', b'A', b'[', .., b']', b']'] => true,
            [_, b'!', b'[', b'C', b'D', b'A', b'T', b'A', b'[', ..] => false,
            _ => true,
        };
        loop {
            let there = self.there()?;
            if there.is_empty() {
                return Err(self.wrong("the end of the file", "'>'"));
            }
            let mut closed = false;
            let mut count = 0;
            for &byte in there {
                count += 1;
                let is_plain = !text.starts_with(b"<!") && !text.starts_with(b"<?");
                match quote {
                    _ if !is_plain => (),
                    Some(open) if byte == open => quote = None,
                    Some(_) => (),
                    None if matches!(byte, b'"' | b'\'') => quote = Some(byte),
                    None => (),
                }
                if byte == b'>' && quote.is_none() && end(&text) {
                    closed = true;
                    break;
                }
                text.push(byte);
                if text.len() > MAX_TAG {
                    break;
                }
            }
            self.consume(count);
            if closed {
                return Ok(String::from_utf8_lossy(&text[1..]).into_owned());
            }
            if text.len() > MAX_TAG {
                let found = Quoted(&text).to_string();
                return Err(self.wrong(found, format!("'>' within {MAX_TAG} bytes")));
            }
        }
    }

    fn there(&mut self) -> Result<&[u8], PointsError> {
        loop {
            match self.reader.fill_buf() {
                Ok(_) => break,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => (),
                Err(source) => return Err(PointsError::Io { path: self.path.into(), source }),
            }
        }
        Ok(self.reader.buffer())
    }

    fn consume(&mut self, count: usize) {
        let passed = &self.reader.buffer()[..count];
        self.line_ends += passed.iter().filter(|&&byte| byte == b'\n').count() as u64;
        self.reader.consume(count);
        self.at += count as u64;
    }
}

/// A tag from the text between its brackets.
fn parse(text: &str, start: u64) -> Option<Tag> {
    let text = text.trim();
    let (kind, text) = match (text.strip_prefix('/'), text.strip_suffix('/')) {
        (Some(rest), _) => (TagKind::Close, rest),
        (None, Some(rest)) => (TagKind::Empty, rest),
        (None, None) => (TagKind::Open, text),
    };
    let end = text.find(|c: char| c.is_ascii_whitespace()).unwrap_or(text.len());
    let (name, mut rest) = text.split_at(end);
    let mut attributes = Vec::new();
    loop {
        rest = rest.trim_start();
        if rest.is_empty() {
            break;
        }
        let (attribute, value) = rest.split_once('=')?;
        let value = value.trim_start();
        let quote = value.chars().next().filter(|quote| matches!(quote, '"' | '\''))?;
        let (value, after) = value[1..].split_once(quote)?;
        attributes.push((attribute.trim().to_owned(), without_entities(value)));
        rest = after;
    }
    let is_name = !name.is_empty() && !name.contains(['<', '"', '\'', '=']);
    is_name.then(|| Tag { name: name.to_owned(), kind, attributes, start })
}

fn without_entities(value: &str) -> String {
    let mut text = String::new();
    let mut rest = value;
    while let Some((before, after)) = rest.split_once('&') {
        text += before;
        let entity = after.split_once(';').and_then(|(name, after)| {
            let sign = match name {
                "amp" => '&',
                "lt" => '<',
                "gt" => '>',
                "quot" => '"',
                "apos" => '\'',
                _ => {
                    let code = name.strip_prefix('#')?;
                    let code = match code.strip_prefix(['x', 'X']) {
                        Some(digits) => u32::from_str_radix(digits, 16).ok()?,
                        None => code.parse().ok()?,
                    };
                    char::from_u32(code)?
                }
            };
            Some((sign, after))
        });
        let (sign, after) = entity.unwrap_or(('&', after));
        text.push(sign);
        rest = after;
    }
    text + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;
    use std::cell::RefCell;
    use std::io::Cursor;

    fn tags(text: &str) -> Result<Vec<Tag>, String> {
        let mut progress = |_, _| ();
        let bytes = Cursor::new(text.as_bytes());
        let source = Source::of_file(bytes, text.len() as u64, &mut progress);
        let file = RefCell::new(source.seekable().unwrap());
        let mut markup = Markup::new(&file, Path::new("a"));
        let mut tags = Vec::new();
        while let Some(tag) = markup.next().map_err(|error| error.to_string())? {
            tags.push(tag);
        }
        Ok(tags)
    }

    #[test]
    fn tags_and_attributes_are_found() {
        let text = "\u{feff}<?xml version='1.0'?>\n<!-- <a> -- b > -->\n<![CDATA[<x>]]><a b = 'c>d' \n\
                    e=\"&lt;&#65;&#x42;&amp;&none;\"> 1 < /a ><f/></a>";
        let tags = tags(text).unwrap();
        let names: Vec<_> = tags.iter().map(|tag| (tag.name.as_str(), tag.kind)).collect();
        // What is no XML is taken as it comes.
        assert_eq!(names[0], ("a", TagKind::Open));
        assert_eq!(tags[0].get("b"), Some("c>d"));
        assert_eq!(tags[0].get("e"), Some("<AB&&none;"));
        assert_eq!(names.last(), Some(&("a", TagKind::Close)));
        assert_eq!(names[names.len() - 2], ("f", TagKind::Empty));
    }

    #[test]
    fn what_is_no_tag_is_an_error() {
        for (text, expected) in [
            ("<a\n<b>", "a:2: found 'a\\n<b', expected a tag of XML"),
            ("\n<a b>", "a:2: found 'a b', expected a tag of XML"),
            ("<a b=c>", "found 'a b=c', expected a tag"),
            ("<>", "found '', expected a tag"),
            ("<a b='>", "a:1: found the end of the file, expected '>'"),
            ("<!-- ", "a:1: found the end of the file, expected '>'"),
        ] {
            let found = tags(text).unwrap_err();
            assert!(found.contains(expected), "{text}: {found}");
        }
        let long = tags(&"<".repeat(100_000)).unwrap_err();
        assert!(long.contains("expected '>' within 65536 bytes"), "{long}");
    }
}
