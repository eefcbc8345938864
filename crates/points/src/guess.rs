//! What the columns of a table without names mean, judged by the numbers in its first rows.
//!
//! The rules are those of docs/point-files.md: the position first, then what follows it from left to
//! right. Whatever is not certain goes into a note, with the doubt: a wrong guess must not be a
//! silent one.

mod evidence;
mod triples;

use crate::field::{Field, Type};
use crate::guess::evidence::Evidence;
use crate::guess::triples::{ColorTriple, Triples};
use crate::meaning::{self, NX, RED, Sample};

/// The name of a column that counts the points.
pub(crate) const POINT_NUMBER: &str = "point_number";
/// The name of a column of a few small whole numbers.
const LABEL: &str = "label";

/// What the columns are taken for.
pub(crate) struct Guess {
    pub(crate) fields: Vec<Field>,
    /// What of it may be doubted.
    pub(crate) note: Option<String>,
}

/// Judges the columns, of which there are three or more. `kinds` are their types where the file
/// states them; `places` are those that they have in the file, where others stand between them, such
/// as text.
pub(crate) fn by_place(sample: &Sample, kinds: Option<&[Type]>, places: Option<&[usize]>) -> Guess {
    let evidence = Evidence::of(sample, places);
    let mut guess =
        Guesser { evidence: &evidence, names: vec![None; sample.columns], doubts: vec![] };
    let first = guess.position();
    let triples = Triples::find(&evidence, first);
    guess.triples(&triples);
    guess.singles(&triples, first);
    let Guesser { names, doubts, .. } = guess;

    let color = triples.color.map(|color| color.kind);
    let fields: Vec<Field> = (names.into_iter().enumerate())
        .map(|(place, name)| {
            let stated = kinds.map_or(Type::F64, |kinds| kinds[place]);
            match name {
                Some(name) if RED.contains(&name) => Field::new(name, color.unwrap_or(stated)),
                Some(name) if NX.contains(&name) => Field::new(name, Type::F32),
                Some(name) => Field::new(name, stated),
                None => Field::new(numbered(evidence.place(place)), stated),
            }
        })
        .collect();
    let note = note(&fields, &doubts, &evidence, triples.are_certain(&evidence));
    Guess { fields, note }
}

/// The name of a column that nothing is known of.
pub(crate) fn numbered(place: usize) -> String {
    format!("column_{}", place + 1)
}

struct Guesser<'a> {
    evidence: &'a Evidence,
    names: Vec<Option<&'static str>>,
    doubts: Vec<String>,
}

impl Guesser<'_> {
    /// Names the position, and returns the first column after it.
    fn position(&mut self) -> usize {
        let evidence = self.evidence;
        let number = evidence.counts_points();
        let first = usize::from(number.is_some());
        let mut axes = ["x", "y", "z"];
        let northing_first = evidence.northing_before_easting(first);
        let [one, two] = [first, first + 1].map(|place| evidence.columns_in_words(place, 1));
        if let Some(number) = number {
            self.names[0] = Some(POINT_NUMBER);
            self.doubts.push(format!("column 1 {number}"));
        }
        if number.is_some() || evidence.are_named() {
            if northing_first {
                axes.swap(0, 1);
                self.doubts.push(format!("{one} is like a northing and {two} like an easting"));
            } else if evidence.is_large(first) && evidence.is_large(first + 1) {
                self.doubts.push(
                    "if the northing comes before the easting, x and y are exchanged".to_owned(),
                );
            }
        } else if northing_first {
            self.doubts.push(format!(
                "{one} is like a northing and {two} like an easting, which would be y and x"
            ));
        } else if let Some(oddity) = evidence.oddity_of_first() {
            self.doubts.push(format!("column 1 {oddity}"));
        }
        for (place, axis) in axes.into_iter().enumerate() {
            self.names[first + place] = Some(axis);
        }
        first + 3
    }

    fn triples(&mut self, triples: &Triples) {
        if let Some(normal) = triples.normal {
            for (place, name) in NX.into_iter().enumerate() {
                self.names[normal + place] = Some(name);
            }
        }
        if let Some(color) = triples.color {
            for (place, name) in RED.into_iter().enumerate() {
                self.names[color.first + place] = Some(name);
            }
        }
        self.doubts.extend(triples.doubts(self.evidence));
    }

    /// Names single columns: alpha, labels, intensities.
    fn singles(&mut self, triples: &Triples, after_position: usize) {
        let evidence = self.evidence;
        let columns = self.names.len();
        if let Some(color) = triples.color
            && self.is_free(color.end())
            && evidence.is_opaque(color.end(), color.kind)
        {
            self.names[color.end()] = Some("alpha");
            self.doubts.push(format!(
                "{} is the same throughout",
                evidence.columns_in_words(color.end(), 1)
            ));
        }
        let last_triple = triples.end().unwrap_or(after_position);
        let trailing = last_triple..columns;
        let label = match triples.color.or(triples.normal.map(ColorTriple::not_one)) {
            // With few rows, a small number is not much of a sign.
            _ if evidence.few_rows() && triples.color.is_none() => None,
            Some(_) => {
                trailing.clone().find(|&place| self.is_free(place) && evidence.is_label(place))
            }
            None => trailing.clone().last().filter(|&place| evidence.is_label(place)),
        };
        if let Some(place) = label {
            self.names[place] = Some(LABEL);
            let column = evidence.columns_in_words(place, 1);
            self.doubts.push(format!("{column} has few, small whole numbers"));
        }
        let before = triples.start().unwrap_or(columns);
        let mut leading = (after_position..before).filter(|&place| self.is_free(place));
        let one = leading.next().filter(|_| leading.next().is_none());
        let none = (after_position..before).all(|place| !self.is_free(place));
        let intensity = match triples.end() {
            _ if one.is_some() => one.filter(|&place| place == after_position),
            Some(_) if none => {
                let next = trailing.into_iter().find(|&place| self.names[place] != Some("alpha"));
                next.filter(|&place| self.is_free(place))
            }
            _ => None,
        };
        if let Some(place) = intensity {
            self.names[place] = Some("intensity");
        }
    }

    fn is_free(&self, place: usize) -> bool {
        self.names.get(place).is_some_and(Option::is_none)
    }
}

/// What to note where columns that would be taken for a colour keep no name, for the user names others.
/// `fields` are those of the guess, and `names` those that the same columns get.
pub(crate) fn unnamed_color(fields: &[Field], names: &[&str]) -> Option<String> {
    let is_red = |field: &Field| field.name == RED[0];
    let nameless = |name: &&str| name.starts_with("column_");
    let first = fields.iter().position(is_red)?;
    let three = names.get(first..first + 3)?;
    if !three.iter().all(nameless) {
        return None;
    }
    Some(format!(
        "{} are like a colour, but have no names in the list of columns; name them red, green and blue, \
         or _ to pass them over",
        three.join(", ")
    ))
}

/// The note of a guess; none for a plain position, and none for a position with a colour or a normal
/// that is certain.
fn note(fields: &[Field], doubts: &[String], evidence: &Evidence, certain: bool) -> Option<String> {
    let is_plain = fields.len() == 3 || (fields.len() == 6 && certain);
    if is_plain && doubts.is_empty() {
        return None;
    }
    let rows = match evidence.rows {
        1 => "the first row".to_owned(),
        rows => format!("{rows} rows"),
    };
    let taken = meaning::listed(fields);
    let doubts = match doubts {
        [] => String::new(),
        doubts => format!(" ({})", doubts.join("; ")),
    };
    Some(format!(
        "the columns have no names and were taken for {taken}, judging by {rows}{doubts}; --columns \
         or [objects.columns] says otherwise"
    ))
}

#[cfg(test)]
mod tests;
