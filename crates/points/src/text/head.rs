//! What stands above the rows of a table: counts, names, comments, a program's preamble.

use crate::error::PointsError;
use crate::lines::line_end_of;
use crate::meaning::{self, SAMPLE_ROWS};
use crate::number::number;
use crate::text::named::{self, Names};
use crate::text::split::{Separator, is_comment};
use crate::text::tecplot;
use std::path::Path;

/// Lines above a table among which its beginning is looked for.
const MOST_ABOVE: usize = 300;
/// After lines that are no table, so many rows and as many as those lines make one without names.
const LEAST_ROWS: usize = 8;

/// A line of the file.
#[derive(Clone, Copy)]
pub(super) struct Numbered<'a> {
    /// From 1.
    pub(super) line: u64,
    pub(super) text: &'a [u8],
}

/// Which lines a file has besides rows.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) enum Kind {
    /// Counts and comments.
    #[default]
    Plain,
    /// A count of atoms and a remark above the rows, and perhaps again after them.
    Molecule,
    /// Parts with their names in brackets, of which those called `[Data]` are tables.
    Sections,
    /// Zones of Tecplot; each has so many rows, where that is known.
    Zones(Option<u64>),
}

/// The beginning of a table, sorted.
#[derive(Default)]
pub(super) struct Head<'a> {
    pub(super) kind: Kind,
    pub(super) comments: Vec<Numbered<'a>>,
    /// What a line with a single number says.
    pub(super) declared: Option<u64>,
    /// The line with names.
    pub(super) names_line: Option<Numbered<'a>>,
    /// Names that do not stand as a row does.
    pub(super) given: Option<Names>,
    /// At most [`SAMPLE_ROWS`].
    pub(super) rows: Vec<Numbered<'a>>,
    /// Lines above, passed over.
    pub(super) passed_over: Vec<Numbered<'a>>,
}

/// What a line with a single whole number says.
pub(super) fn count_of(line: &[u8]) -> Option<u64> {
    std::str::from_utf8(line.trim_ascii()).ok()?.parse().ok()
}

/// Whether these bytes are text: no control characters but those between words and lines.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let between = |byte| matches!(byte, b'\t' | b'\n' | 0x0b | 0x0c | b'\r' | 0x1a);
    bytes.iter().all(|&byte| (byte >= b' ' && byte != 0x7f) || between(byte))
}

/// Bytes of a byte order mark.
pub(super) fn mark_of(start: &[u8]) -> usize {
    if start.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 }
}

/// The lines of these bytes; the last one only if `whole`, or if it is the only one.
pub(super) fn lines(start: &[u8], whole: bool) -> impl Iterator<Item = Numbered<'_>> {
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

/// Whether a line can be a point: three numbers or more, and nothing else between blanks.
pub(super) fn is_row(line: &[u8]) -> bool {
    let (words, numbers) = numbers_in(line);
    numbers >= 3 && (numbers == words || Separator::of_line(line) != Separator::Blanks)
}

/// Whether a line is the name of an element and a position.
fn is_atom(line: &[u8]) -> bool {
    let words = Separator::Blanks.words(line);
    let [element, x, y, z, ..] = words.as_slice() else { return false };
    element.first().is_some_and(u8::is_ascii_alphabetic)
        && [x, y, z].iter().all(|word| number(word, true).is_some())
}

/// Whether a line only says what separates columns, as spreadsheets have it.
fn is_separator_line(line: &[u8]) -> bool {
    let line = line.trim_ascii().trim_ascii_start();
    let line = line.strip_prefix(b"\"").and_then(|l| l.strip_suffix(b"\"")).unwrap_or(line);
    line.len() <= 5 && line.to_ascii_lowercase().starts_with(b"sep=")
}

/// The name of a section: `Data` of `[Data]`.
pub(super) fn section_of(line: &[u8]) -> Option<&[u8]> {
    let name = line.trim_ascii().strip_prefix(b"[")?.strip_suffix(b"]")?.trim_ascii();
    let is_name = |byte: &u8| byte.is_ascii_alphanumeric() || b" _-".contains(byte);
    (name.first()?.is_ascii_alphabetic() && name.iter().all(is_name)).then_some(name)
}

/// Whether a section of this name is a table.
pub(super) fn is_data(name: &[u8]) -> bool {
    name.eq_ignore_ascii_case(b"data")
}

/// See [`sniff`](super::sniff).
pub(super) fn looks_like_table(start: &[u8]) -> bool {
    if !is_text(start) {
        return false;
    }
    let contents: Vec<Numbered<'_>> = lines(&start[mark_of(start)..], true)
        .filter(|line| !is_comment(line.text) && !is_separator_line(line.text))
        .collect();
    if sections(&contents).is_some() || tecplot::variables(&contents).is_some() {
        return true;
    }
    let counts = contents.iter().take_while(|line| count_of(line.text).is_some()).count();
    match &contents[counts..] {
        [first, ..] if is_row(first.text) => true,
        [first, second, ..] if is_row(second.text) => {
            let words = Separator::of_line(second.text).words(first.text).len();
            words >= 3 && numbers_in(first.text).1 == 0
        }
        _ => false,
    }
}

/// The place of the names below the first `[Data]`.
fn sections(contents: &[Numbered<'_>]) -> Option<usize> {
    section_of(contents.first()?.text)?;
    let data = contents
        .iter()
        .take(MOST_ABOVE)
        .position(|line| section_of(line.text).is_some_and(is_data))?;
    let [names, row, ..] = contents.get(data + 1..)? else { return None };
    names_positions(names.text, row.text).then_some(data + 1)
}

impl<'a> Head<'a> {
    pub(super) fn of(start: &'a [u8], whole: bool, path: &Path) -> Result<Self, PointsError> {
        let mut head = Self::default();
        let mut contents = Vec::new();
        for line in lines(start, whole) {
            match is_comment(line.text) {
                false if contents.is_empty() && is_separator_line(line.text) => (),
                false => contents.push(line),
                true if contents.len() < 2 => head.comments.push(line),
                true => (),
            }
            if contents.len() == SAMPLE_ROWS + MOST_ABOVE {
                break;
            }
        }
        if let Some(names) = sections(&contents) {
            head.kind = Kind::Sections;
            head.names_line = Some(contents[names]);
            head.passed_over.extend(&contents[..names]);
            let rows = contents[names + 1..].iter();
            head.rows.extend(rows.take_while(|line| section_of(line.text).is_none()));
        } else if let Some(zones) = tecplot::variables(&contents) {
            head.kind = Kind::Zones(zones.nodes(path)?);
            head.given = Some(zones.names);
            let rows = contents[zones.first_row..].iter();
            head.rows.extend(rows.take_while(|line| is_row(line.text)));
        } else {
            head.plain(&contents, path)?;
        }
        head.rows.truncate(SAMPLE_ROWS);
        Ok(head)
    }

    /// Sorts what has a count, names or a remark above the rows, or a preamble.
    fn plain(&mut self, contents: &[Numbered<'a>], path: &Path) -> Result<(), PointsError> {
        let mut rest = contents;
        while let [line, below @ ..] = rest {
            let next = below.iter().find(|line| count_of(line.text).is_none());
            let next = next.map_or(&[][..], |next| next.text);
            if let Some(count) = count_of(line.text) {
                if self.declared.is_some() {
                    return Err(PointsError::Line {
                        path: path.into(),
                        line: line.line,
                        found: format!("a second line with a single number, {count}"),
                        expected: "points: x y z on each line".to_owned(),
                        help: "correct the line, or export the points as PTS or E57",
                    });
                }
                self.declared = Some(count);
            } else if let Some(given) = self.declared.and_then(|_| named::properties(*line)) {
                (self.given, self.kind) = (Some(given), Kind::Molecule);
            } else if self.names_line.is_none() && is_names(line.text, next) {
                // Between the count of atoms and the atoms of a molecule stands a remark.
                if self.declared.is_some() && !names_positions(line.text, next) {
                    self.kind = Kind::Molecule;
                } else {
                    self.names_line = Some(*line);
                }
            } else if self.is_remark(line.text, next) {
                self.kind = Kind::Molecule;
            } else {
                break;
            }
            rest = below;
        }
        if self.kind == Kind::Plain
            && !self.begins_a_table(rest)
            && let Some(first) = below_a_preamble(contents)
        {
            // A name that was taken from the preamble is none.
            (self.names_line, self.declared) = (None, None);
            let above = &contents[..first];
            let names = names_above(contents, first);
            self.names_line = names.map(|names| contents[names]);
            let passed_over = (0..).zip(above).filter(|&(place, _)| Some(place) != names);
            let passed_over = passed_over.map(|(_, line)| line);
            self.passed_over.extend(passed_over);
            rest = &contents[first..];
        }
        // Another frame may follow.
        let most = match (self.kind, self.declared) {
            (Kind::Molecule, Some(declared)) => usize::try_from(declared).unwrap_or(SAMPLE_ROWS),
            _ => SAMPLE_ROWS,
        };
        self.rows.extend(rest.iter().take(most.clamp(1, SAMPLE_ROWS)));
        Ok(())
    }

    /// Whether a line after a count is neither an atom nor a point, but the next one is.
    fn is_remark(&self, line: &[u8], next: &[u8]) -> bool {
        let is_point = |line: &[u8]| is_row(line) || is_atom(line);
        self.declared.is_some()
            && self.names_line.is_none()
            && self.kind == Kind::Plain
            && !is_point(line)
            && is_point(next)
    }

    /// Whether these lines are rows that fit the names above them.
    fn begins_a_table(&self, rows: &[Numbered<'_>]) -> bool {
        let [first, others @ ..] = rows else { return false };
        let names = self.names_line.is_none_or(|names| {
            has_as_many(names.text, first.text) || names_positions(names.text, first.text)
        });
        let second = others.first().is_none_or(|second| is_alike(first.text, second.text));
        names && second && is_row(first.text)
    }
}

/// Whether two lines have as many columns; the last may be empty.
fn is_alike(first: &[u8], second: &[u8]) -> bool {
    let separator = Separator::of_line(first);
    let [first, second] = [first, second].map(|line| separator.words(line));
    let without = |words: &[&[u8]]| words.len() - usize::from(words.last() == Some(&&b""[..]));
    first.len() == second.len()
        || without(&first) == second.len()
        || without(&second) == first.len()
}

/// Whether a line of names has as many as a row has values, or one less, for a first column of names
/// of rows.
fn has_as_many(names: &[u8], row: &[u8]) -> bool {
    let separator = Separator::of_line(row);
    let columns = columns_of(separator, row).len();
    // After a separator at the end, a value may be missing.
    let at_most = separator.words(row).len().max(columns);
    let names = columns_of(separator, names).len();
    (columns..=at_most).contains(&names) || (names >= 3 && names + 1 == columns)
}

/// The place of the line of names above a row, between which another line may have the units.
fn names_above(contents: &[Numbered<'_>], row: usize) -> Option<usize> {
    let row_text = contents[row].text;
    let fit = |place: &usize| {
        let line = contents[*place].text;
        is_names(line, row_text) && has_as_many(line, row_text)
    };
    let last = row.checked_sub(1).filter(fit)?;
    let positions = |place: &usize| names_positions(contents[*place].text, row_text);
    let above_units = || last.checked_sub(1).filter(fit).filter(positions);
    if positions(&last) { Some(last) } else { above_units().or(Some(last)) }
}

/// The first row of a table that begins after other lines: below names of x, y and z, or one that
/// goes on to the end.
fn below_a_preamble(contents: &[Numbered<'_>]) -> Option<usize> {
    let row = |place: usize| contents.get(place).filter(|line| is_row(line.text));
    let below_names = (1..contents.len().min(MOST_ABOVE)).find(|&place| {
        row(place).is_some_and(|row| {
            names_above(contents, place)
                .is_some_and(|names| names_positions(contents[names].text, row.text))
        })
    });
    below_names.or_else(|| {
        let first = (1..contents.len().min(MOST_ABOVE)).find(|&place| {
            let alike = |next: usize| {
                row(place).zip(row(next)).is_some_and(|(a, b)| is_alike(a.text, b.text))
            };
            (1..LEAST_ROWS).all(|step| alike(place + step))
        })?;
        let rows = &contents[first..];
        let goes_on = rows.iter().all(|line| is_row(line.text));
        (goes_on && rows.len() >= first).then_some(first)
    })
}

/// Whether a line can be the names of the columns of the next one: it has no number, or the names
/// of x, y and z.
fn is_names(line: &[u8], next: &[u8]) -> bool {
    numbers_in(line).1 == 0 || names_positions(line, next)
}

pub(super) fn names_positions(line: &[u8], next: &[u8]) -> bool {
    let names = columns_of(Separator::of_line(next), line);
    meaning::name_positions(names.iter().map(String::as_str))
}

/// The words of a line that is the first of its kind. A separator at its end separates nothing.
pub(super) fn columns_of(separator: Separator, line: &[u8]) -> Vec<String> {
    let mut words = separator.words(line);
    words.pop_if(|word| word.is_empty());
    words.into_iter().map(|word| String::from_utf8_lossy(word).into_owned()).collect()
}
