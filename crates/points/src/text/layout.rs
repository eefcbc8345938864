//! The shape of a table, from its first lines.

use crate::error::{PointsError, Quoted};
use crate::field::Field;
use crate::lines::{HELP, line_end_of, values};
use crate::meaning::{self, SAMPLE_ROWS, Sample};
use crate::number::number;
use crate::text::MAX_COLUMNS;
use crate::text::split::{Separator, is_comment};
use std::path::Path;

/// What the lines of a table look like.
pub(super) struct Layout {
    pub(super) separator: Separator,
    /// Whether the decimal point is a comma.
    pub(super) comma: bool,
    /// Bytes before the first line: a byte order mark.
    pub(super) mark: usize,
    /// Of each column, whether it is read. Columns of text are not.
    pub(super) columns: Vec<bool>,
    /// Those that are read.
    pub(super) fields: Vec<Field>,
    /// The line of the first point, from 1.
    pub(super) first_row: u64,
    /// The line that gives the number of columns.
    pub(super) shape_line: u64,
    /// What a line with a single number above the points says.
    pub(super) declared: Option<u64>,
    /// Average length of the first rows.
    pub(super) bytes_per_row: u64,
    pub(super) in_words: String,
}

/// A line of the file.
#[derive(Clone, Copy)]
struct Numbered<'a> {
    /// From 1.
    line: u64,
    text: &'a [u8],
}

/// The beginning of a table, sorted.
#[derive(Default)]
struct Head<'a> {
    comments: Vec<Numbered<'a>>,
    /// What a line with a single number says.
    declared: Option<u64>,
    /// The line with names.
    names: Option<Numbered<'a>>,
    /// At most [`SAMPLE_ROWS`].
    rows: Vec<Numbered<'a>>,
}

/// The columns' names.
struct Names {
    line: u64,
    names: Vec<String>,
}

impl Layout {
    /// The name of the column at this place, counting those that are not read.
    pub(super) fn name_of(&self, column: usize) -> &str {
        let field = self.columns[..column].iter().filter(|&&read| read).count();
        self.fields.get(field).map_or("", |field| &field.name)
    }
}

/// What a line with a single whole number says.
pub(super) fn count_of(line: &[u8]) -> Option<u64> {
    std::str::from_utf8(line.trim_ascii()).ok()?.parse().ok()
}

/// Whether these bytes are text: no control characters but those between words and lines.
fn is_text(bytes: &[u8]) -> bool {
    let between = |byte| matches!(byte, b'\t' | b'\n' | 0x0b | 0x0c | b'\r' | 0x1a);
    bytes.iter().all(|&byte| (byte >= b' ' && byte != 0x7f) || between(byte))
}

/// Bytes of a byte order mark.
fn mark_of(start: &[u8]) -> usize {
    if start.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 }
}

/// The lines of these bytes; the last one only if `whole`, or if it is the only one.
fn lines(start: &[u8], whole: bool) -> impl Iterator<Item = Numbered<'_>> {
    let end = line_end_of(start);
    let complete = match start.iter().rposition(|&byte| byte == end) {
        Some(last) if !whole => &start[..last],
        _ => start,
    };
    let texts = complete.split(move |&byte| byte == end);
    (1..)
        .zip(texts)
        .map(|(line, text)| Numbered { line, text: text.strip_suffix(b"\r").unwrap_or(text) })
}

/// Words of a line, and how many of them are numbers.
fn numbers_in(line: &[u8]) -> (usize, usize) {
    let separator = Separator::of_line(line);
    let comma = separator.allows_decimal_comma();
    let words = separator.words(line);
    let numbers = words.iter().filter(|word| !word.is_empty() && number(word, comma).is_some());
    (words.len(), numbers.count())
}

/// See [`sniff`](super::sniff).
pub(super) fn looks_like_table(start: &[u8]) -> bool {
    if !is_text(start) {
        return false;
    }
    let contents: Vec<&[u8]> = lines(&start[mark_of(start)..], true)
        .map(|line| line.text)
        .filter(|line| !is_comment(line))
        .skip_while(|line| count_of(line).is_some())
        .take(2)
        .collect();
    let is_row = |line: &[u8]| {
        let (words, numbers) = numbers_in(line);
        numbers >= 3 && (numbers == words || Separator::of_line(line) != Separator::Blanks)
    };
    match contents.as_slice() {
        [first, ..] if is_row(first) => true,
        [first, second] if is_row(second) => {
            let words = Separator::of_line(second).words(first).len();
            words >= 3 && numbers_in(first).1 == 0
        }
        _ => false,
    }
}

/// Finds the layout of a table that begins so; `whole` tells that nothing follows.
pub(super) fn find(start: &[u8], whole: bool, path: &Path) -> Result<Layout, PointsError> {
    let wrong = |line: u64, found: String, expected: String, help: &'static str| {
        PointsError::Line { path: path.into(), line, found, expected, help }
    };
    if start.starts_with(b"\xff\xfe") || start.starts_with(b"\xfe\xff") {
        let expected = "text of 8-bit characters".to_owned();
        return Err(wrong(1, "UTF-16".to_owned(), expected, "save it as UTF-8"));
    }
    let mark = mark_of(start);
    let start = &start[mark..];
    if let Some(line) = lines(start, true).find(|line| !is_text(line.text)) {
        let expected = "a line of text with x y z".to_owned();
        let help = "if this is no table of text, give the file the extension of what it is";
        return Err(wrong(line.line, Quoted(line.text).to_string(), expected, help));
    }
    let head = Head::of(start, whole, path)?;
    let Some(&first) = head.rows.first() else {
        let (line, found) = match (head.names, head.declared) {
            (Some(names), _) => (names.line, "names of columns alone"),
            (None, Some(_)) => (1, "a count alone"),
            (None, None) => (1, "no line of numbers"),
        };
        let expected = "lines with x y z".to_owned();
        return Err(wrong(line, found.to_owned(), expected, "export the points again"));
    };

    let few = head.rows.iter().take(20);
    let separator = Separator::of(few.map(|row| row.text));
    let comma = separator.allows_decimal_comma()
        && head.rows.iter().any(|row| separator.words(row.text).iter().any(|w| w.contains(&b',')));
    let in_first = columns_of(separator, first.text).len();
    let names = head.names(separator, in_first);
    if let Some(names) = names.as_ref().filter(|names| names.names.len() != in_first) {
        let found = format!("{} names", names.names.len());
        let expected = format!("{in_first}, as line {} has {}", first.line, values(in_first));
        return Err(wrong(names.line, found, expected, "name every column"));
    }
    if in_first > MAX_COLUMNS {
        let expected = format!("at most {MAX_COLUMNS}");
        return Err(wrong(first.line, format!("{in_first} columns"), expected, "leave some out"));
    }

    let columns = number_columns(&head.rows, separator, comma, in_first, names.is_some());
    let numbers: Vec<usize> = (0..in_first).filter(|&column| columns[column]).collect();
    let sample = sample_of(&head.rows, separator, comma, &numbers);
    let fields = match &names {
        Some(names) if !numbers.is_empty() => {
            let names: Vec<_> = numbers.iter().map(|&place| names.names[place].clone()).collect();
            meaning::by_names(&names, None, &sample)
        }
        None if numbers.len() >= 3 => meaning::by_place(&sample, None),
        _ => {
            let expected = "3 numbers or more: x y z".to_owned();
            return Err(wrong(first.line, Quoted(first.text).to_string(), expected, HELP));
        }
    };
    let bytes: usize = head.rows.iter().map(|row| row.text.len() + 1).sum();
    let left_out: Vec<String> = (names.iter().flat_map(|names| &names.names).zip(&columns))
        .filter(|(_, read)| !**read)
        .map(|(name, _)| meaning::printable(name))
        .collect();
    Ok(Layout {
        separator,
        comma,
        mark,
        first_row: first.line,
        shape_line: names.as_ref().map_or(first.line, |names| names.line),
        declared: head.declared,
        bytes_per_row: (bytes / head.rows.len()) as u64,
        in_words: in_words(separator, comma, names.as_ref(), &fields, &left_out, head.rows.len()),
        columns,
        fields,
    })
}

impl<'a> Head<'a> {
    fn of(start: &'a [u8], whole: bool, path: &Path) -> Result<Self, PointsError> {
        let mut head = Self::default();
        let mut contents = Vec::new();
        for line in lines(start, whole) {
            match is_comment(line.text) {
                false => contents.push(line),
                true if contents.len() < 2 => head.comments.push(line),
                true => (),
            }
            // Above the rows: a count, names, a remark.
            if contents.len() == SAMPLE_ROWS + 3 {
                break;
            }
        }
        let mut contents = contents.as_slice();
        while let [line, rest @ ..] = contents {
            let next = rest.iter().find(|line| count_of(line.text).is_none());
            let next = next.map_or(&[][..], |next| next.text);
            if let Some(count) = count_of(line.text) {
                if head.declared.is_some() {
                    return Err(PointsError::Line {
                        path: path.into(),
                        line: line.line,
                        found: format!("a second line with a single number, {count}"),
                        expected: "points: x y z on each line".to_owned(),
                        help: "if this is a PTX file, export it as PTS or E57",
                    });
                }
                head.declared = Some(count);
            } else if head.names.is_none() && is_names(line.text, next) {
                // Between the count of atoms and the atoms of a molecule stands a remark.
                let remark = head.declared.is_some() && !names_positions(line.text, next);
                if !remark {
                    head.names = Some(*line);
                }
            } else {
                break;
            }
            contents = rest;
        }
        head.rows.extend(contents.iter().take(SAMPLE_ROWS));
        Ok(head)
    }

    /// The names of the columns: from a line of their own, or from a comment that names as many
    /// columns as there are, x, y and z among them.
    fn names(&self, separator: Separator, columns: usize) -> Option<Names> {
        if let Some(line) = self.names {
            return Some(Names { line: line.line, names: columns_of(separator, line.text) });
        }
        self.comments.iter().rev().find_map(|comment| {
            let text = comment.text.trim_ascii_start();
            let text = text.strip_prefix(b"//").or_else(|| text.get(1..))?;
            let names = columns_of(separator, text);
            let fit =
                names.len() == columns && meaning::name_positions(names.iter().map(String::as_str));
            fit.then_some(Names { line: comment.line, names })
        })
    }
}

/// Whether a line can be the names of the columns of the next one: it has no number, or the names
/// of x, y and z.
fn is_names(line: &[u8], next: &[u8]) -> bool {
    numbers_in(line).1 == 0 || names_positions(line, next)
}

fn names_positions(line: &[u8], next: &[u8]) -> bool {
    let names = columns_of(Separator::of_line(next), line);
    meaning::name_positions(names.iter().map(String::as_str))
}

/// The words of a line that is the first of its kind. A separator at its end separates nothing.
fn columns_of(separator: Separator, line: &[u8]) -> Vec<String> {
    let mut words = separator.words(line);
    words.pop_if(|word| word.is_empty());
    words.into_iter().map(|word| String::from_utf8_lossy(word).into_owned()).collect()
}

/// Of each column, whether it has numbers. One without a single number in the first rows is text,
/// such as the name of a class; without names above the columns, it must begin with a letter.
fn number_columns(
    rows: &[Numbered<'_>],
    separator: Separator,
    comma: bool,
    columns: usize,
    named: bool,
) -> Vec<bool> {
    let mut has_number = vec![false; columns];
    let mut has_text = vec![false; columns];
    for row in rows {
        for (column, word) in separator.words(row.text).iter().enumerate().take(columns) {
            match number(word, comma) {
                Some(_) => has_number[column] |= !word.is_empty(),
                None => {
                    has_text[column] |= named || word.first().is_some_and(u8::is_ascii_alphabetic);
                }
            }
        }
    }
    has_number.into_iter().zip(has_text).map(|(number, text)| number || !text).collect()
}

/// The numbers of those of the first rows that have enough words.
fn sample_of(
    rows: &[Numbered<'_>],
    separator: Separator,
    comma: bool,
    numbers: &[usize],
) -> Sample {
    let columns = numbers.len();
    let mut sample = Sample { columns, values: Vec::new(), floats: vec![false; columns] };
    for row in rows {
        let words = separator.words(row.text);
        let words: Option<Vec<&[u8]>> =
            numbers.iter().map(|&column| words.get(column).copied()).collect();
        for (word, float) in words.iter().flatten().zip(&mut sample.floats) {
            sample.values.push(number(word, comma).unwrap_or(f64::NAN));
            *float |= word.iter().any(|byte| matches!(byte, b'.' | b',' | b'e' | b'E'));
        }
    }
    sample
}

/// How the table is read, for the set's `format`.
fn in_words(
    separator: Separator,
    comma: bool,
    names: Option<&Names>,
    fields: &[Field],
    left_out: &[String],
    rows: usize,
) -> String {
    let separator = separator.in_words();
    let comma = if comma { ", decimal commas" } else { "" };
    let columns = match names {
        Some(names) => format!("names in line {}", names.line),
        None => {
            let by = if rows == 1 { "the first row".to_owned() } else { format!("{rows} rows") };
            format!("no names; taken for {}, judging by {by}", meaning::listed(fields))
        }
    };
    let text = match left_out {
        [] => String::new(),
        names if names.len() > 8 => format!("; left out for being text: {} columns", names.len()),
        names => format!("; left out for being text: {}", names.join(" ")),
    };
    format!("text, separated by {separator}{comma}, {columns}{text}")
}
