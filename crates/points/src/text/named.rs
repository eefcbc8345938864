//! Names of columns: in a line of their own, in a comment, in the remark of an extended XYZ file.

use crate::meaning;
use crate::text::head::{Head, Numbered, columns_of};
use crate::text::split::{Separator, quoted};

/// The columns' names.
#[derive(Clone, Debug)]
pub(super) struct Names {
    pub(super) line: u64,
    pub(super) names: Vec<String>,
    /// Whether rows may go on after the columns that have names.
    pub(super) open: bool,
    /// Of each column, whether it has numbers, where the file says so.
    pub(super) numbers: Option<Vec<bool>>,
    /// What was assumed.
    pub(super) note: Option<String>,
}

impl Names {
    pub(super) fn new(line: u64, names: Vec<String>) -> Self {
        Self { line, names, open: false, numbers: None, note: None }
    }
}

impl Head<'_> {
    /// The names of the columns: from a line of their own, or from a comment that names columns, x, y
    /// and z among them. `first` is the first row.
    pub(super) fn names(&self, separator: Separator, first: &[String]) -> Option<Names> {
        if let Some(given) = &self.given {
            return Some(given.clone());
        }
        if let Some(line) = self.names_line {
            let mut names = Names::new(line.line, columns_of(separator, line.text));
            // Some programs name the rows, and not the column with those names.
            if names.names.len() + 1 == first.len()
                && meaning::name_positions(names.names.iter().map(String::as_str))
                && self.counts_rows(separator)
            {
                names.names.insert(0, "row".to_owned());
                names.note = Some(format!(
                    "line {} names all columns but the first, which was taken for the rows' own names",
                    line.line
                ));
            }
            return Some(names);
        }
        let comments = || self.comments.iter().rev();
        let exact = comments().find_map(|&comment| in_comment(comment, separator, first.len()));
        exact.or_else(|| comments().find_map(|&comment| of_some(comment, separator, first.len())))
    }

    /// Whether the first column is text, or counts up by one.
    fn counts_rows(&self, separator: Separator) -> bool {
        let firsts: Vec<Option<i64>> = (self.rows.iter().take(100))
            .map(|row| {
                let words = separator.words(row.text);
                std::str::from_utf8(words.first()?).ok()?.parse().ok()
            })
            .collect();
        firsts.len() > 1
            && (firsts.iter().all(Option::is_none)
                || firsts
                    .windows(2)
                    .all(|pair| pair[0].zip(pair[1]).is_some_and(|(a, b)| b == a + 1)))
    }
}

/// The names in a comment that names as many columns as there are, or the first of them and says that
/// there are more, in a list that is not always as long.
fn in_comment(comment: Numbered<'_>, separator: Separator, columns: usize) -> Option<Names> {
    lists(comment, separator).into_iter().find_map(|(names, open)| {
        let fit = names.len() == columns || open;
        fit.then(|| Names { open, ..Names::new(comment.line, names) })
    })
}

/// The names in a comment that names only the first columns.
fn of_some(comment: Numbered<'_>, separator: Separator, columns: usize) -> Option<Names> {
    lists(comment, separator).into_iter().find_map(|(mut names, _)| {
        // Names of x, y and z say nothing but what is assumed without.
        let known = names.len();
        if known <= 3 || known >= columns {
            return None;
        }
        names.resize(columns, String::new());
        let note = format!("line {} names {known} of the {columns} columns", comment.line);
        Some(Names { note: Some(note), ..Names::new(comment.line, names) })
    })
}

/// What can be lists of names in a comment, x, y and z among them, and whether more columns follow.
fn lists(comment: Numbered<'_>, separator: Separator) -> Vec<(Vec<String>, bool)> {
    let signs = |byte: &u8| matches!(byte, b'#' | b'%' | b'/') || byte.is_ascii_whitespace();
    let start = comment.text.iter().position(|byte| !signs(byte)).unwrap_or(comment.text.len());
    let text = &comment.text[start..];
    let others = [b',', b';', b'\t'].map(Separator::Byte);
    let separators = std::iter::once(separator).chain(others).chain([Separator::Blanks]);
    let without_title = match text.iter().position(|&byte| byte == b':') {
        Some(colon) if text.get(colon + 1) == Some(&b' ') => Some(&text[colon + 1..]),
        _ => None,
    };
    let texts: Vec<&[u8]> = std::iter::once(text).chain(without_title).collect();
    let mut lists = Vec::new();
    let by_separators =
        separators.flat_map(|separator| texts.iter().map(move |text| columns_of(separator, text)));
    let by_blanks = texts.iter().flat_map(|text| [by_wide_gaps(text), with_units(text)]);
    for mut names in by_separators.chain(by_blanks) {
        let end = names.iter().position(|name| name.contains("[]") || name.ends_with("..."));
        names.truncate(end.unwrap_or(names.len()));
        if meaning::name_positions(names.iter().map(String::as_str)) {
            lists.push((names, end.is_some()));
        }
    }
    lists
}

/// Names between two blanks or more, or tabs; in each may be one blank.
fn by_wide_gaps(text: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(text).replace('\t', "  ");
    let names = text.split("  ").map(str::trim).filter(|name| !name.is_empty());
    names.map(str::to_owned).collect()
}

/// Names between blanks, each with its unit: `x y z T (K)`.
fn with_units(text: &[u8]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for word in String::from_utf8_lossy(text).split_ascii_whitespace() {
        match names.last_mut() {
            Some(name) if word.starts_with(['(', '[']) && word.ends_with([')', ']']) => {
                name.push(' ');
                name.push_str(word);
            }
            _ => names.push(word.to_owned()),
        }
    }
    names
}

/// The columns of an extended XYZ file, whose remark states them as
/// `Properties=species:S:1:pos:R:3:charge:R:1`; those of any where it only states a `Lattice`.
pub(super) fn properties(remark: Numbered<'_>) -> Option<Names> {
    const USUAL: &str = "species:S:1:pos:R:3";
    let value = |key: &str| {
        let words = quoted(remark.text, |byte| byte.is_ascii_whitespace());
        words.into_iter().find_map(|word| {
            let word = String::from_utf8_lossy(word);
            let (name, value) = word.split_once('=')?;
            name.trim().eq_ignore_ascii_case(key).then(|| value.trim().trim_matches('"').to_owned())
        })
    };
    let stated = match (value("Properties"), value("Lattice")) {
        (Some(stated), _) => stated,
        (None, Some(_)) => USUAL.to_owned(),
        (None, None) => return None,
    };
    let mut names = Vec::new();
    let mut numbers = Vec::new();
    let parts: Vec<&str> = stated.split(':').collect();
    for part in parts.chunks(3) {
        let &[name, kind, width] = part else { return None };
        let width: usize = width.trim().parse().ok().filter(|width| (1..=1000).contains(width))?;
        names.extend(meaning::spread(name, width));
        let is_number = matches!(kind.trim(), "R" | "I" | "r" | "i");
        numbers.resize(names.len(), is_number);
    }
    Some(Names { numbers: Some(numbers), ..Names::new(remark.line, names) })
}
