//! Tecplot's text format: names after `VARIABLES =`, rows after each `ZONE`.

use crate::error::PointsError;
use crate::text::head::{Numbered, is_row};
use crate::text::named::Names;
use crate::text::split::quoted;
use std::path::Path;

/// Words that begin a record.
const RECORDS: [&[u8]; 9] = [
    b"TITLE",
    b"VARIABLES",
    b"ZONE",
    b"FILETYPE",
    b"TEXT",
    b"GEOMETRY",
    b"DATASETAUXDATA",
    b"VARAUXDATA",
    b"CUSTOMLABELS",
];

/// What stands above the first row.
pub(super) struct Zones {
    pub(super) names: Names,
    pub(super) first_row: usize,
    /// The record of the first zone, in upper case.
    zone: String,
    zone_line: u64,
}

/// Whether a line begins a record.
fn record_of(line: &[u8]) -> Option<&'static [u8]> {
    let line = line.trim_ascii_start();
    RECORDS.into_iter().find(|record| {
        line.len() >= record.len()
            && line[..record.len()].eq_ignore_ascii_case(record)
            && line.get(record.len()).is_none_or(|next| !next.is_ascii_alphanumeric())
    })
}

/// Whether a line begins a zone.
pub(super) fn is_zone(line: &[u8]) -> bool {
    record_of(line) == Some(b"ZONE")
}

/// What stands above the rows of a file of Tecplot, if these lines are one's.
pub(super) fn variables(contents: &[Numbered<'_>]) -> Option<Zones> {
    record_of(contents.first()?.text)?;
    let start = contents
        .iter()
        .take(100)
        .position(|line| record_of(line.text) == Some(b"VARIABLES") && line.text.contains(&b'='))?;
    let first_row = start + contents[start..].iter().position(|line| is_row(line.text))?;
    let above = &contents[start..first_row];
    let record = above[1..].iter().position(|line| record_of(line.text).is_some());
    let (variables, zone) = above.split_at(record.map_or(above.len(), |record| record + 1));
    let names = variables.iter().flat_map(|line| {
        let text = match record_of(line.text) {
            Some(_) => line.text.split(|&byte| byte == b'=').nth(1).unwrap_or(&[]),
            None => line.text,
        };
        quoted(text, |byte| byte == b',' || byte.is_ascii_whitespace())
    });
    let names = names.filter(|name| !name.is_empty());
    let names = names.map(|name| String::from_utf8_lossy(name).into_owned()).collect();
    let zone_line = zone.first().map_or(contents[start].line, |line| line.line);
    let zone: Vec<String> =
        zone.iter().map(|line| String::from_utf8_lossy(line.text).to_uppercase()).collect();
    let names = Names::new(contents[start].line, names);
    Some(Zones { names, first_row, zone: zone.join(" "), zone_line })
}

impl Zones {
    /// How many rows a zone of cells has, after which its cells are listed. Fails where numbers are
    /// not stored row by row.
    pub(super) fn nodes(&self, path: &Path) -> Result<Option<u64>, PointsError> {
        if self.value(&["F", "DATAPACKING"]).is_some_and(|packing| packing.ends_with("BLOCK")) {
            return Err(PointsError::Line {
                path: path.into(),
                line: self.zone_line,
                found: "a zone that stores one variable after the other".to_owned(),
                expected: "all variables of a point in a line (DATAPACKING=POINT)".to_owned(),
                help: "export it so, or as VTK or CSV",
            });
        }
        Ok(nodes_of(&self.zone))
    }

    fn value(&self, keys: &[&str]) -> Option<&str> {
        value_of(&self.zone, keys)
    }
}

/// How many nodes a zone of cells has.
pub(super) fn nodes_of(zone: &str) -> Option<u64> {
    value_of(zone, &["E", "ELEMENTS"])?;
    value_of(zone, &["N", "NODES"])?.parse().ok()
}

/// The value of one of these keys in a record in upper case.
fn value_of<'a>(record: &'a str, keys: &[&str]) -> Option<&'a str> {
    let mut words = record.split([' ', ',', '\t', '=']).filter(|word| !word.is_empty());
    words.find(|word| keys.contains(word))?;
    words.next()
}
