//! Which column of a file is what, as the user says it: over what names and numbers suggest.

use crate::error::PointsError;
use crate::field::Field;
use crate::guess::numbered;
use crate::meaning::{plain, printable};
use std::fmt;
use std::path::Path;

/// What leaves a column out in a list of columns.
const LEFT_OUT: &str = "_";
const AXES: [&str; 3] = ["x", "y", "z"];
/// Names that are listed in a message.
const MOST_LISTED: usize = 20;

/// Which column of a file is what. The default says nothing.
///
/// Columns that are not mentioned keep the names that the file gives them; without any, they are
/// `column_4` and so on.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Columns {
    /// What columns are called: `x`, `y`, `z`, `red`, …, or any name for an attribute.
    pub named: Vec<(String, Column)>,
    /// Columns that are passed over, counted from 1.
    pub left_out: Vec<u32>,
}

/// A column of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Column {
    /// The one that the file calls so. Letter case, units in brackets, and blanks, dots, colons and
    /// hyphens for `_` make no difference where no name is the same.
    Name(String),
    /// The one in this place, counted from 1.
    Number(u32),
}

/// What happens to a column.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Assigned {
    /// Nothing was said of it.
    Kept,
    Named(String),
    LeftOut,
}

impl Columns {
    /// Reads a list such as `x,y,z,_,red,green,blue`: what the columns are from the first on, with `_`
    /// for those that are passed over.
    ///
    /// # Errors
    /// What is wrong with the list, where a name is missing or comes twice.
    pub fn in_order(list: &str) -> Result<Self, String> {
        let mut columns = Self::default();
        for (name, number) in list.split(',').map(str::trim).zip(1..) {
            match name {
                "" => {
                    return Err(format!(
                        "found no name in place {number} of the list, expected one, or _ for a \
                         column that is passed over"
                    ));
                }
                LEFT_OUT => columns.left_out.push(number),
                name if columns.has(name) => {
                    return Err(format!("found '{name}' twice, expected each name once"));
                }
                name => columns.named.push((name.to_owned(), Column::Number(number))),
            }
        }
        match AXES.into_iter().find(|axis| !columns.has(axis)) {
            Some(axis) => Err(format!(
                "found no '{axis}' in the list, expected x, y and z among its names, e.g. \
                 x,y,z,_,red,green,blue"
            )),
            None => Ok(columns),
        }
    }

    /// Whether it is empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.named.is_empty() && self.left_out.is_empty()
    }

    /// Whether a column gets this name, in any letter case.
    fn has(&self, name: &str) -> bool {
        self.named.iter().any(|(other, _)| plain(other) == plain(name))
    }

    /// Whether columns for x, y and z are named: all of them, or none.
    pub(crate) fn position(&self, path: &Path) -> Result<bool, PointsError> {
        self.are_different(path)?;
        let (there, missing): (Vec<&str>, Vec<&str>) =
            AXES.into_iter().partition(|axis| self.has(axis));
        if there.is_empty() || missing.is_empty() {
            return Ok(missing.is_empty());
        }
        Err(PointsError::wrong(
            path,
            "the columns of the position",
            format!("only {}", there.join(" and ")),
            "x, y and z, as the file has no names",
            "say the columns of all three",
        ))
    }

    /// Fails if two columns get one name, in any letter case.
    fn are_different(&self, path: &Path) -> Result<(), PointsError> {
        for (place, (name, column)) in self.named.iter().enumerate() {
            let earlier = &self.named[..place];
            if let Some((other, first)) =
                earlier.iter().find(|(other, _)| plain(other) == plain(name))
            {
                return Err(PointsError::wrong(
                    path,
                    &format!("the columns of '{}' and '{}'", printable(other), printable(name)),
                    format!("{} and {}", in_words(first), in_words(column)),
                    "names that differ by more than letter case",
                    "rename or remove one of them",
                ));
            }
        }
        Ok(())
    }

    /// The same with columns for x, y and z, where these fields have them.
    pub(crate) fn with_position(&self, fields: &[Field]) -> Self {
        let axes = AXES.into_iter().filter_map(|axis| {
            let place = fields.iter().position(|field| field.name == axis)?;
            Some((axis.to_owned(), Column::Number(place as u32 + 1)))
        });
        Self { named: axes.chain(self.named.iter().cloned()).collect(), ..self.clone() }
    }

    /// What happens to each column of a file. `names` are those that the file gives them.
    pub(crate) fn assign(
        &self,
        names: &[String],
        path: &Path,
    ) -> Result<Vec<Assigned>, PointsError> {
        self.are_different(path)?;
        let mut assigned = vec![Assigned::Kept; names.len()];
        for (name, column) in &self.named {
            let place = self.place(name, column, names, path)?;
            if let Assigned::Named(other) = &assigned[place] {
                let found = format!("{} of the file", in_words(column));
                let place = format!("the column of both '{other}' and '{name}'");
                let expected = "a column for each";
                return Err(PointsError::wrong(
                    path,
                    &place,
                    found,
                    expected,
                    "change one of them",
                ));
            }
            assigned[place] = Assigned::Named(name.clone());
        }
        for &number in &self.left_out {
            let place = self.place(LEFT_OUT, &Column::Number(number), names, path)?;
            if let Assigned::Named(name) = &assigned[place] {
                let found = format!("column {number}");
                let place = format!("the column of '{name}' and as one that is passed over");
                return Err(PointsError::wrong(
                    path,
                    &place,
                    found,
                    "one of both",
                    "leave one out",
                ));
            }
            assigned[place] = Assigned::LeftOut;
        }
        Ok(assigned)
    }

    fn place(
        &self,
        name: &str,
        column: &Column,
        names: &[String],
        path: &Path,
    ) -> Result<usize, PointsError> {
        let wrong = |found: String, expected: String, help: &'static str| {
            PointsError::wrong(path, &format!("the column of '{name}'"), found, &expected, help)
        };
        let text = match column {
            Column::Number(number) => {
                let place = (*number as usize).checked_sub(1).filter(|&place| place < names.len());
                return place.ok_or_else(|| {
                    let expected =
                        format!("a number from 1 to {}, as many as there are", names.len());
                    wrong(number.to_string(), expected, "correct the number")
                });
            }
            Column::Name(text) => text,
        };
        let places = |fits: &dyn Fn(&str) -> bool| -> Vec<usize> {
            (0..names.len()).filter(|&place| fits(&names[place])).collect()
        };
        let exact = places(&|other| other == text || printable(other.trim()) == *text);
        let found = match exact.is_empty() {
            true => places(&|other| !plain(other).is_empty() && plain(other) == plain(text)),
            false => exact,
        };
        match found.as_slice() {
            [place] => Ok(*place),
            [] => {
                let expected = format!("one of {}", listed(names));
                Err(wrong(format!("'{}'", printable(text)), expected, "correct the name"))
            }
            several => {
                let numbers: Vec<_> = several.iter().map(|place| (place + 1).to_string()).collect();
                let found = format!("'{}', the name of {} columns", printable(text), several.len());
                let expected = format!("one column; they are the numbers {}", numbers.join(", "));
                Err(wrong(found, expected, "give a number instead"))
            }
        }
    }

    /// The names of the columns, with those that the user gives in their places. A name that is given to one column
    /// is taken from any other.
    pub(crate) fn renamed(
        &self,
        names: &[String],
        path: &Path,
    ) -> Result<Vec<Option<String>>, PointsError> {
        let given = |name: &str| self.named.iter().any(|(other, _)| plain(other) == plain(name));
        let assigned = self.assign(names, path)?;
        let names =
            names.iter().zip(assigned).enumerate().map(
                |(place, (name, assigned))| match assigned {
                    Assigned::LeftOut => None,
                    Assigned::Named(name) => Some(name),
                    Assigned::Kept if given(name) => Some(numbered(place)),
                    Assigned::Kept => Some(name.clone()),
                },
            );
        Ok(names.collect())
    }

    /// The fields of a format in which each has a name of its own.
    pub(crate) fn applied(&self, fields: &[Field], path: &Path) -> Result<Vec<Field>, PointsError> {
        let names: Vec<String> = fields.iter().map(|field| field.name.clone()).collect();
        let renamed = self.renamed(&names, path)?;
        let fields = fields.iter().zip(renamed).map(|(field, name)| match name {
            Some(name) => Field::new(name, field.kind).called(&field.name),
            None => Field::left_out(field.kind),
        });
        Ok(fields.collect())
    }
}

fn in_words(column: &Column) -> String {
    match column {
        Column::Name(name) => format!("'{}'", printable(name)),
        Column::Number(number) => format!("column {number}"),
    }
}

fn listed(names: &[String]) -> String {
    let listed: Vec<_> =
        names.iter().take(MOST_LISTED).map(|name| format!("'{}'", printable(name))).collect();
    let more = if names.len() > MOST_LISTED { ", …" } else { "" };
    listed.join(", ") + more
}

impl fmt::Display for Columns {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named =
            self.named.iter().map(|(name, column)| format!("{name} = {}", in_words(column)));
        let left_out = self.left_out.iter().map(|number| format!("_ = column {number}"));
        f.write_str(&named.chain(left_out).collect::<Vec<_>>().join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(columns: &Columns, names: &[&str]) -> String {
        let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
        columns.renamed(&names, Path::new("a")).unwrap_err().to_string()
    }

    fn named(name: &str, column: &str) -> (String, Column) {
        (name.to_owned(), Column::Name(column.to_owned()))
    }

    #[test]
    fn lists_name_columns_from_the_first_on() {
        let columns = Columns::in_order("y, x,z,_,red").unwrap();
        let number = |name: &str, number| (name.to_owned(), Column::Number(number));
        assert_eq!(
            columns.named,
            [number("y", 1), number("x", 2), number("z", 3), number("red", 5)]
        );
        assert_eq!(columns.left_out, [4]);
        for (list, expected) in [
            ("x,y", "found no 'z' in the list"),
            ("x,y,,z", "found no name in place 3 of the list"),
            ("", "found no name in place 1"),
            ("x,y,z,X", "found 'X' twice"),
        ] {
            let found = Columns::in_order(list).unwrap_err();
            assert!(found.contains(expected), "{list}: {found}");
        }
    }

    #[test]
    fn columns_are_found_by_name_or_number() {
        let names = ["E [m]", "N", "H", "red", "q"].map(str::to_owned);
        let columns = Columns {
            named: vec![
                named("x", "e"),
                named("y", "N"),
                ("z".to_owned(), Column::Number(3)),
                named("red", "q"),
            ],
            left_out: vec![],
        };
        let renamed = columns.renamed(&names, Path::new("a")).unwrap();
        // What was called red is so no more.
        let expected = ["x", "y", "z", "column_4", "red"].map(|name| Some(name.to_owned()));
        assert_eq!(renamed, expected);
        let left_out = Columns { left_out: vec![2], ..Columns::default() };
        assert_eq!(left_out.renamed(&names, Path::new("a")).unwrap()[1], None);
    }

    #[test]
    fn what_does_not_fit_the_file_is_named() {
        let number = |number| Columns {
            named: vec![("x".to_owned(), Column::Number(number))],
            left_out: vec![],
        };
        let of = |named: Vec<(String, Column)>| Columns { named, left_out: vec![] };
        for (columns, expected) in [
            (
                of(vec![named("x", "E")]),
                "a: found 'E' as the column of 'x', expected one of 'a', 'b', 'b'; correct the name",
            ),
            (
                of(vec![named("x", "b")]),
                "found 'b', the name of 2 columns as the column of 'x', expected one column; they are \
                 the numbers 2, 3; give a number instead",
            ),
            (number(4), "found 4 as the column of 'x', expected a number from 1 to 3"),
            (number(0), "found 0 as the column of 'x', expected a number from 1 to 3"),
            (
                of(vec![named("x", "a"), named("red", "A")]),
                "found 'A' of the file as the column of both 'x' and 'red', expected a column for \
                 each; change one of them",
            ),
            (
                of(vec![named("x", "a"), ("X".to_owned(), Column::Number(2))]),
                "found 'a' and column 2 as the columns of 'x' and 'X', expected names that differ by \
                 more than letter case; rename or remove one of them",
            ),
            (
                Columns { left_out: vec![1], ..of(vec![named("x", "a")]) },
                "found column 1 as the column of 'x' and as one that is passed over",
            ),
        ] {
            let found = message(&columns, &["a", "b", "b"]);
            assert!(found.contains(expected), "{found}");
        }
    }
}
