//! The shape of a table, from its first lines.

use crate::assign::Columns;
use crate::error::{PointsError, Quoted};
use crate::field::{Field, Type};
use crate::guess::{self, numbered};
use crate::lines::{HELP, values};
use crate::meaning::{self, Sample};
use crate::number::number;
use crate::text::MAX_COLUMNS;
use crate::text::head::{Head, Kind, Numbered, columns_of, is_text, lines, mark_of};
use crate::text::named::Names;
use crate::text::split::Separator;
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
    /// Which lines there are besides rows.
    pub(super) kind: Kind,
    /// Whether rows may go on after the columns.
    pub(super) open: bool,
    pub(super) in_words: String,
    /// What was assumed, or passed over.
    pub(super) notes: Vec<String>,
}

impl Layout {
    /// The name of the column at this place, counting those that are not read.
    pub(super) fn name_of(&self, column: usize) -> &str {
        let field = self.columns[..column].iter().filter(|&&read| read).count();
        self.fields.get(field).map_or("", Field::original_name)
    }
}

/// Whether a line above no rows names x, y and z, whatever separates the names.
fn names_position(line: &[u8]) -> bool {
    let line = String::from_utf8_lossy(line);
    let names = line.split([',', ';', '|', '\t', ' ']).map(|name| name.trim().trim_matches('"'));
    meaning::positions_among(&names.filter(|name| !name.is_empty()).collect::<Vec<_>>()).is_some()
}

/// Finds the layout of a table that begins so; `whole` tells that nothing follows.
pub(super) fn find(
    start: &[u8],
    whole: bool,
    path: &Path,
    columns: &Columns,
) -> Result<Layout, PointsError> {
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
        let (line, found) = match (head.names_line, head.declared) {
            (Some(names), _) if names_position(names.text) => {
                return Err(PointsError::WithoutPoints { path: path.into() });
            }
            (None, Some(0)) => return Err(PointsError::WithoutPoints { path: path.into() }),
            (Some(names), _) => (names.line, "only names of columns"),
            (None, Some(_)) => (1, "only a count"),
            (None, None) => (1, "no line of numbers"),
        };
        let expected = "lines with x y z".to_owned();
        return Err(wrong(line, found.to_owned(), expected, "export the points again"));
    };

    let few = head.rows.iter().take(20);
    let separator = Separator::of(few.map(|row| row.text));
    let comma = separator.allows_decimal_comma()
        && head.rows.iter().any(|row| separator.words(row.text).iter().any(|w| w.contains(&b',')));
    let mut in_first = columns_of(separator, first.text);
    // A separator at the end of the first line may have a value after it that is missing.
    let with_last = in_first.len() + 1;
    let may_lack_last = separator.words(first.text).len() == with_last;
    if may_lack_last
        && head.rows.iter().any(|row| columns_of(separator, row.text).len() == with_last)
    {
        in_first.push(String::new());
    }
    let names = head.names(separator, &in_first);
    let in_first = match &names {
        Some(names) if names.open => names.names.len(),
        Some(names) if may_lack_last && names.names.len() == with_last => with_last,
        _ => in_first.len(),
    };
    if let Some(names) = names.as_ref().filter(|names| names.names.len() != in_first) {
        let found = format!("{} names", names.names.len());
        let expected = format!("{in_first}, as line {} has {}", first.line, values(in_first));
        return Err(wrong(names.line, found, expected, "name every column"));
    }
    if in_first > MAX_COLUMNS {
        let expected = format!("at most {MAX_COLUMNS}");
        return Err(wrong(first.line, format!("{in_first} columns"), expected, "leave some out"));
    }

    let mut has_numbers = match names.as_ref().and_then(|names| names.numbers.clone()) {
        Some(stated) => stated,
        None => number_columns(&head.rows, separator, comma, in_first, names.is_some()),
    };
    let mut notes = Vec::new();
    let find = Find { head: &head, separator, comma, path };
    let fields = match columns.is_empty() {
        true => find.fields(names.as_ref(), &has_numbers, &mut notes)?,
        false => find.said(columns, names.as_ref(), &mut has_numbers, &mut notes)?,
    };
    let left_out: Vec<String> = (names.iter().flat_map(|names| &names.names).zip(&has_numbers))
        .filter(|(_, read)| !**read)
        .map(|(name, _)| meaning::printable(name))
        .collect();
    let how = How { separator, comma, names: names.as_ref(), said: !columns.is_empty() };
    let in_words = how.in_words(&fields, &left_out, head.rows.len());
    if let Some(last) = head.passed_over.last() {
        let lines = match head.passed_over.len() {
            1 => format!("line {} is", last.line),
            _ => format!("the lines up to {} are", last.line),
        };
        notes.insert(0, format!("{lines} not part of the table, and passed over"));
    }
    let bytes: usize = head.rows.iter().map(|row| row.text.len() + 1).sum();
    Ok(Layout {
        separator,
        comma,
        mark,
        kind: head.kind,
        open: names.as_ref().is_some_and(|names| names.open),
        first_row: first.line,
        shape_line: names.as_ref().map_or(first.line, |names| names.line),
        declared: head.declared,
        bytes_per_row: (bytes / head.rows.len()) as u64,
        in_words,
        notes,
        columns: has_numbers,
        fields,
    })
}

/// What is known of a table when its columns are asked for.
struct Find<'a> {
    head: &'a Head<'a>,
    separator: Separator,
    comma: bool,
    path: &'a Path,
}

impl Find<'_> {
    /// The columns by their names, or else by what stands in them.
    fn fields(
        &self,
        names: Option<&Names>,
        has_numbers: &[bool],
        notes: &mut Vec<String>,
    ) -> Result<Vec<Field>, PointsError> {
        let numbers = places_of(has_numbers);
        let sample = self.sample(&numbers);
        match names {
            Some(names) if !numbers.is_empty() => {
                notes.extend(names.note.clone());
                let names: Vec<_> =
                    numbers.iter().map(|&place| names.names[place].clone()).collect();
                Ok(meaning::by_names(&names, None, &sample))
            }
            None if numbers.len() >= 3 => {
                self.is_of_points(has_numbers)?;
                let guess = guess::by_place(&sample, None, Some(&numbers));
                let position = positions_of(&guess.fields);
                // Between the coordinates of a point stands nothing else.
                if position.is_some_and(|places| {
                    places.iter().map(|&place| numbers[place]).max().unwrap_or(0)
                        - places.iter().map(|&place| numbers[place]).min().unwrap_or(0)
                        > 2
                }) {
                    return Err(self.no_table());
                }
                notes.extend(guess.note);
                Ok(guess.fields)
            }
            _ => Err(self.no_table()),
        }
    }

    /// The columns as the user says. Those that are left out are not read, whatever stands in them.
    fn said(
        &self,
        columns: &Columns,
        names: Option<&Names>,
        has_numbers: &mut [bool],
        notes: &mut Vec<String>,
    ) -> Result<Vec<Field>, PointsError> {
        let all: Vec<String> = match names {
            Some(names) => names.names.clone(),
            None => (0..has_numbers.len()).map(numbered).collect(),
        };
        let columns = match names.is_some() || columns.position(self.path)? {
            true => columns.clone(),
            // The position is where it would be without.
            false => {
                let numbers = places_of(has_numbers);
                if numbers.len() < 3 {
                    return Err(self.no_table());
                }
                let guess = guess::by_place(&self.sample(&numbers), None, Some(&numbers));
                let mut fields: Vec<Field> =
                    all.iter().map(|name| Field::new(name, Type::F64)).collect();
                for (place, field) in numbers.into_iter().zip(guess.fields) {
                    fields[place] = field;
                }
                columns.with_position(&fields)
            }
        };
        let renamed = columns.renamed(&all, self.path)?;
        let before = places_of(has_numbers);
        if names.is_none() && before.len() >= 6 {
            let guess = guess::by_place(&self.sample(&before), None, Some(&before));
            let names: Vec<&str> =
                before.iter().map(|&place| renamed[place].as_deref().unwrap_or("")).collect();
            notes.extend(guess::unnamed_color(&guess.fields, &names));
        }
        for (place, name) in renamed.iter().enumerate() {
            match name {
                None => has_numbers[place] = false,
                Some(name) if *name != all[place] && !has_numbers[place] => {
                    return Err(PointsError::wrong(
                        self.path,
                        &format!("the column of '{}'", meaning::printable(name)),
                        format!("text in column {}", place + 1),
                        "numbers",
                        "choose another column",
                    ));
                }
                Some(_) => (),
            }
        }
        let numbers = places_of(has_numbers);
        let sample = self.sample(&numbers);
        let named: Vec<String> =
            numbers.iter().map(|&place| renamed[place].clone().unwrap_or_default()).collect();
        let fields = meaning::by_names(&named, None, &sample).into_iter();
        Ok(fields.zip(numbers).map(|(field, place)| field.called(all[place].trim())).collect())
    }

    /// Fails if columns of text show that the lines are something else than points: settings, a log.
    fn is_of_points(&self, has_numbers: &[bool]) -> Result<(), PointsError> {
        let is_text = |place: usize| !has_numbers[place];
        let texts = (0..has_numbers.len()).filter(|&place| is_text(place)).count();
        let is_odd = |word: &[u8]| word.iter().any(|byte| b"=:([{<".contains(byte));
        let odd = self.head.rows.iter().any(|row| {
            let words = self.separator.words(row.text);
            words.iter().zip(0..has_numbers.len()).any(|(word, at)| is_text(at) && is_odd(word))
        });
        let alone = self.head.rows.len() == 1 && self.head.kind != Kind::Molecule;
        if odd || texts > 2 || (texts > 0 && alone) { Err(self.no_table()) } else { Ok(()) }
    }

    fn no_table(&self) -> PointsError {
        let first = self.head.passed_over.first().or(self.head.rows.first());
        PointsError::Line {
            path: self.path.into(),
            line: first.map_or(1, |first| first.line),
            found: first.map_or_else(String::new, |first| Quoted(first.text).to_string()),
            expected: "3 numbers or more: x y z".to_owned(),
            help: HELP,
        }
    }

    fn sample(&self, numbers: &[usize]) -> Sample {
        sample_of(&self.head.rows, self.separator, self.comma, numbers)
    }
}

fn places_of(has_numbers: &[bool]) -> Vec<usize> {
    (0..has_numbers.len()).filter(|&column| has_numbers[column]).collect()
}

/// The places of x, y and z.
fn positions_of(fields: &[Field]) -> Option<[usize; 3]> {
    let place = |axis: &str| fields.iter().position(|field| field.name == axis);
    Some([place("x")?, place("y")?, place("z")?])
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

/// How the table is read.
struct How<'a> {
    separator: Separator,
    comma: bool,
    names: Option<&'a Names>,
    /// Whether the user says what columns are.
    said: bool,
}

impl How<'_> {
    /// For the set's `format`.
    fn in_words(&self, fields: &[Field], left_out: &[String], rows: usize) -> String {
        let separator = self.separator.in_words();
        let comma = if self.comma { ", decimal commas" } else { "" };
        let columns = match (self.names, self.said) {
            (_, true) => format!("columns as asked for: {}", meaning::listed(fields)),
            (Some(names), _) => format!("names in line {}", names.line),
            (None, _) => {
                let by =
                    if rows == 1 { "the first row".to_owned() } else { format!("{rows} rows") };
                format!("no names; taken for {}, judging by {by}", meaning::listed(fields))
            }
        };
        let text = match left_out {
            [] => String::new(),
            _ if self.said => String::new(),
            names if names.len() > 8 => {
                format!("; left out for being text: {} columns", names.len())
            }
            names => format!("; left out for being text: {}", names.join(" ")),
        };
        format!("text, separated by {separator}{comma}, {columns}{text}")
    }
}
