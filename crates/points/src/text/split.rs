//! Lines into words.

use crate::number::number;
use std::ops::Range;

/// What stands between the values of a line.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Separator {
    /// Any number of blanks and tabs.
    Blanks,
    /// This byte, with blanks around it or none.
    Byte(u8),
}

/// Those that are tried; of two that fit equally well, the first is taken.
const SEPARATORS: [Separator; 5] = [
    Separator::Byte(b';'),
    Separator::Byte(b'|'),
    Separator::Byte(b','),
    Separator::Byte(b'\t'),
    Separator::Blanks,
];

impl Separator {
    /// That which divides lines into the most numbers.
    pub(super) fn of<'a>(lines: impl Iterator<Item = &'a [u8]> + Clone) -> Self {
        let numbers = |separator: &Self| {
            let decimal_comma = separator.allows_decimal_comma();
            let words = lines.clone().flat_map(|line| separator.words(line));
            words.filter(|word| !word.is_empty() && number(word, decimal_comma).is_some()).count()
        };
        // Of equal ones, `max_by_key` takes the last.
        SEPARATORS.into_iter().rev().max_by_key(numbers).unwrap_or(Self::Blanks)
    }

    /// The same of one line.
    pub(super) fn of_line(line: &[u8]) -> Self {
        Self::of(std::iter::once(line))
    }

    /// Whether commas in words can be decimal points.
    pub(super) fn allows_decimal_comma(self) -> bool {
        self != Self::Byte(b',')
    }

    /// The words of a line without the quotes around them.
    pub(super) fn words(self, line: &[u8]) -> Vec<&[u8]> {
        match self {
            Self::Blanks if line.contains(&b'"') => quoted(line, |byte| byte.is_ascii_whitespace())
                .into_iter()
                .filter(|word| !word.is_empty())
                .collect(),
            Self::Blanks => blanks(line).collect(),
            Self::Byte(separator) => quoted(line, |byte| byte == separator),
        }
    }

    pub(super) fn in_words(self) -> &'static str {
        match self {
            Self::Byte(b',') => "commas",
            Self::Byte(b';') => "semicolons",
            Self::Byte(b'\t') => "tabs",
            Self::Byte(_) => "bars",
            Self::Blanks => "blanks",
        }
    }
}

/// Words between blanks, up to a comment.
pub(super) fn blanks(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
        .take_while(|word| !is_comment(word))
}

/// Words between separators, without the quotes around them. A separator between quotes does not
/// count.
pub(super) fn quoted(line: &[u8], is_separator: impl Fn(u8) -> bool) -> Vec<&[u8]> {
    let unquoted = |range: Range<usize>| {
        let word = line[range].trim_ascii();
        word.strip_prefix(b"\"").and_then(|word| word.strip_suffix(b"\"")).unwrap_or(word)
    };
    let mut words = Vec::new();
    let (mut start, mut inside) = (0, false);
    for (place, &byte) in line.iter().enumerate() {
        if byte == b'"' {
            inside = !inside;
        } else if !inside && is_separator(byte) {
            words.push(unquoted(start..place));
            start = place + 1;
        }
    }
    words.push(unquoted(start..line.len()));
    words
}

/// Whether a line has nothing but blanks or a comment.
pub(super) fn is_comment(line: &[u8]) -> bool {
    let line = match line.first() {
        Some(first) if first.is_ascii_whitespace() => line.trim_ascii_start(),
        _ => line,
    };
    matches!(line, [] | [b'#' | b'%', ..] | [b'/', b'/', ..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separators_are_told_by_the_numbers_between() {
        let (comma, semicolon, tab) =
            (Separator::Byte(b','), Separator::Byte(b';'), Separator::Byte(b'\t'));
        for (line, expected, words) in [
            ("1 2 3", Separator::Blanks, 3),
            ("  1\t2  3 # a", Separator::Blanks, 3),
            ("1,2,3", comma, 3),
            ("1, 2, 3", comma, 3),
            ("1.5 , 2 , 3,", comma, 4),
            ("1,5 2,5 3,5", Separator::Blanks, 3),
            ("1,5;2,5;3,5", semicolon, 3),
            ("1;2;3", semicolon, 3),
            ("1|2|3", Separator::Byte(b'|'), 3),
            ("1\t2\t3", tab, 3),
            ("1\t2\t\t3", tab, 4),
            ("1,5\t2,5\t3,5", tab, 3),
            ("1,2,3,\"a;b\"", comma, 4),
            ("\"1\" \"2\" \"3\"", Separator::Blanks, 3),
            ("", Separator::Byte(b';'), 1),
        ] {
            let found = Separator::of_line(line.as_bytes());
            assert_eq!(found, expected, "{line}");
            assert_eq!(found.words(line.as_bytes()).len(), words, "{line}");
        }
    }

    #[test]
    fn separators_between_quotes_do_not_count() {
        let words = quoted(br#""a, b",1, " c ","d"#, |byte| byte == b',');
        assert_eq!(words, [&b"a, b"[..], b"1", b" c ", b"\"d"]);
    }
}
