//! Holds a document against the table of keys.
//!
//! Walks both together, so that every problem has its place in the file. It stops at nothing: one
//! run finds everything that is wrong, as far as it can be told apart.

use crate::document::{Node, Origin, Value, cut};
use crate::error::Problem;
use crate::keys::{Absent, DIRECTION, Key, Kind, LEFT_OUT, MOST_COLUMNS, Numbers, SCENE, Table};
use crate::not_built::not_built;
use crate::read::Reader;

/// More problems than anybody reads; keeps a hostile file from filling memory.
const MAX_PROBLEMS: usize = 1000;

/// Everything wrong with a document.
pub(crate) fn check(document: &Node) -> Vec<Problem> {
    check_as(document, &SCENE)
}

/// Everything wrong with a document that is to be this table.
pub(crate) fn check_as(document: &Node, table: &'static Table) -> Vec<Problem> {
    let mut checker = Checker { problems: Vec::new() };
    checker.table(document, table, "", "");
    checker.problems
}

struct Checker {
    problems: Vec<Problem>,
}

/// A key at one place in the document.
struct Spot<'a> {
    key: &'static Key,
    /// With indices, for messages.
    path: &'a str,
    /// Without, for the list of what is not built.
    plain_path: &'a str,
}

impl Checker {
    fn report(&mut self, origin: Origin, path: &str, message: String) {
        if self.problems.len() < MAX_PROBLEMS {
            self.problems.push(Problem { origin, path: path.into(), message });
        }
    }

    fn table(&mut self, node: &Node, table: &'static Table, path: &str, plain_path: &str) {
        let Value::Table(entries) = &node.value else {
            let next = format!("write {}", table.header);
            self.report(
                node.origin,
                path,
                format!("found {}, expected a table; {next}", node.shown),
            );
            return;
        };
        let before = self.problems.len();
        // A kind that is wrong itself says nothing about the other keys.
        let kind = node.get("kind").and_then(|kind| match &kind.value {
            Value::Text(kind) => table.keys.iter().filter_map(|key| key.only).find(|of| of == kind),
            _ => None,
        });
        let misplaced = |key: &Key| key.only.is_some() && key.only != kind;
        for entry in entries {
            let path = joined(path, &shown_name(&entry.name));
            let Some(key) = table.key(&entry.name) else {
                self.report(entry.origin, &path, unknown_key(&entry.name, table));
                continue;
            };
            let plain_path = joined(plain_path, key.name);
            self.value(
                &entry.node,
                &Spot { key, path: &path, plain_path: &plain_path },
                entry.origin,
            );
            if misplaced(key)
                && let (Some(only), Some(kind)) = (key.only, kind)
            {
                let message =
                    format!("belongs to kind \"{only}\", but kind is \"{kind}\"; remove one");
                self.report(entry.origin, &path, message);
            }
        }
        for key in table.keys {
            if let Absent::Required(example) = key.absent
                && !misplaced(key)
                && node.get(key.name).is_none()
            {
                let path = joined(path, key.name);
                let message = match key.kind {
                    Kind::Tables { table, .. } => format!(
                        "missing, expected at least one {}; add {} and its keys",
                        table.header, table.header
                    ),
                    _ => format!(
                        "missing, expected {}; add e.g. {} = {example}",
                        key.kind.expected(),
                        key.name
                    ),
                };
                self.report(node.origin, &path, message);
            }
        }
        if self.problems.len() == before
            && let Some(whole) = table.whole
            && let Err((name, message)) = whole(&Reader::new(table, Some(node)))
        {
            let origin = node.get(name).map_or(node.origin, |value| value.origin);
            self.report(origin, &joined(path, name), message);
        }
    }

    fn value(&mut self, node: &Node, spot: &Spot<'_>, key_origin: Origin) {
        if let Some(entry) = not_built(spot.plain_path) {
            let message = format!("known but not built yet; {}", entry.instead);
            return self.report(key_origin, spot.path, message);
        }
        match &spot.key.kind {
            Kind::Table(table) => self.table(node, table, spot.path, spot.plain_path),
            Kind::Tables { table, min, max, .. } => self.tables(node, spot, table, *min, *max),
            kind => {
                if let Err(Wrong { within, origin, message }) = scalar(node, kind, spot.key) {
                    self.report(origin, &format!("{}{within}", spot.path), message);
                }
            }
        }
    }

    fn tables(
        &mut self,
        node: &Node,
        spot: &Spot<'_>,
        table: &'static Table,
        min: usize,
        max: usize,
    ) {
        let Value::List(items) = &node.value else {
            let expected = spot.key.kind.expected();
            let message =
                format!("found {}, expected {expected}; write {}", node.shown, table.header);
            return self.report(node.origin, spot.path, message);
        };
        if items.len() < min || items.len() > max {
            let next = if items.len() < min { "add one" } else { "remove some" };
            let expected = spot.key.kind.expected();
            let message = format!("found {}, expected {expected}; {next}", node.shown);
            self.report(node.origin, spot.path, message);
        }
        for (index, item) in items.iter().enumerate() {
            self.table(item, table, &format!("{}[{index}]", spot.path), spot.plain_path);
        }
    }
}

/// What is wrong with a value, or with the element of it that `within` names.
struct Wrong {
    within: String,
    origin: Origin,
    message: String,
}

/// Checks a value that is no table.
fn scalar(node: &Node, kind: &Kind, key: &Key) -> Result<(), Wrong> {
    let wrong = |advice: String| Wrong {
        within: String::new(),
        origin: node.origin,
        message: format!("found {}, expected {}; {advice}", node.shown, key.kind.expected()),
    };
    let by_example = || wrong(format!("write e.g. {} = {}", key.name, key.example()));
    let elements = |count: usize, check: &dyn Fn(&Node) -> Result<(), String>| {
        let Value::List(items) = &node.value else { return Err(by_example()) };
        if items.len() != count {
            return Err(by_example());
        }
        for (index, item) in items.iter().enumerate() {
            check(item).map_err(|message| Wrong {
                within: format!("[{index}]"),
                origin: item.origin,
                message,
            })?;
        }
        Ok(())
    };
    match (kind, &node.value) {
        (Kind::Bool, Value::Bool(_)) => Ok(()),
        (Kind::Integer { min, max, .. }, Value::Integer(found)) => {
            within(*found as f64, *min as f64, *max as f64)
                .map_err(|advice| wrong(format!("{advice}{}", or_default(key))))
        }
        (Kind::Number(range), Value::Integer(_) | Value::Float(_)) => {
            number(node, range).map_err(|advice| wrong(format!("{advice}{}", or_default(key))))
        }
        (Kind::Vector(range), _) => elements(3, &|item| element(item, range)),
        (Kind::Vectors(range), Value::List(items)) if items.len() == 2 => {
            for (index, item) in items.iter().enumerate() {
                scalar(item, &Kind::Vector(*range), key).map_err(|wrong| Wrong {
                    within: format!("[{index}]{}", wrong.within),
                    ..wrong
                })?;
            }
            Ok(())
        }
        (Kind::Direction, _) => {
            elements(3, &|item| element(item, &DIRECTION))?;
            let zero = node.items().iter().all(|item| as_number(item) == Some(0.0));
            if zero { Err(by_example()) } else { Ok(()) }
        }
        (Kind::Size { max }, _) => elements(2, &|item| {
            let range = format!("an integer from 1 to {max} pixels");
            let Value::Integer(found) = item.value else {
                return Err(format!("found {}, expected {range}", item.shown));
            };
            within(found as f64, 1.0, *max as f64)
                .map_err(|advice| format!("found {}, expected {range}; {advice}", item.shown))
        }),
        (Kind::Pair(range), _) => elements(2, &|item| element(item, range)),
        (Kind::Range(range), _) => {
            elements(2, &|item| element(item, range))?;
            let ends: Vec<Option<f64>> = node.items().iter().map(as_number).collect();
            if ends[0] < ends[1] { Ok(()) } else { Err(wrong("raise the second".into())) }
        }
        (Kind::Ranges(range), Value::Table(entries)) => {
            for entry in entries {
                let within = |inner: &str| format!(".{}{inner}", shown_name(&entry.name));
                let items = entry.node.items();
                let wrong = |message: String, origin: Origin, inner: &str| Wrong {
                    within: within(inner),
                    origin,
                    message,
                };
                let two = || {
                    let found = &entry.node.shown;
                    let message = format!(
                        "found {found}, expected two numbers {range}, the second no less than the \
                         first; write e.g. [0, 100]"
                    );
                    wrong(message, entry.node.origin, "")
                };
                if items.len() != 2 {
                    return Err(two());
                }
                for (index, item) in items.iter().enumerate() {
                    element(item, range)
                        .map_err(|message| wrong(message, item.origin, &format!("[{index}]")))?;
                }
                if as_number(&items[0]) > as_number(&items[1]) {
                    return Err(two());
                }
            }
            Ok(())
        }
        (Kind::Columns, Value::Table(entries)) => {
            for entry in entries {
                column(&entry.name, &entry.node).map_err(|message| Wrong {
                    within: format!(".{}", shown_name(&entry.name)),
                    origin: entry.node.origin,
                    message,
                })?;
            }
            Ok(())
        }
        (Kind::Prefixed(before, _), Value::Text(found)) => {
            match found.strip_prefix(before).map(str::trim) {
                Some(name) if !name.is_empty() => Ok(()),
                _ => Err(by_example()),
            }
        }
        (Kind::Choice(names), Value::Text(found)) => {
            if names.contains(&found.as_str()) {
                return Ok(());
            }
            Err(match nearest(found, names.iter().copied()) {
                Some(name) => wrong(format!("did you mean \"{name}\"?")),
                None => by_example(),
            })
        }
        (Kind::Text(_), Value::Text(found)) => {
            if found.trim().is_empty() {
                Err(by_example())
            } else {
                Ok(())
            }
        }
        (Kind::Names(_), Value::Text(found)) if !found.trim().is_empty() => Ok(()),
        (Kind::Names(_), Value::List(items)) => {
            let is_name =
                |item: &&Node| matches!(&item.value, Value::Text(name) if !name.trim().is_empty());
            match items.iter().find(|item| !is_name(item)) {
                Some(item) => Err(Wrong { origin: item.origin, ..by_example() }),
                None => Ok(()),
            }
        }
        (Kind::List { of, max }, Value::List(items)) => {
            if items.is_empty() || items.len() > *max {
                return Err(by_example());
            }
            for (index, item) in items.iter().enumerate() {
                list_item(item, of).map_err(|message| Wrong {
                    within: format!("[{index}]"),
                    origin: item.origin,
                    message,
                })?;
            }
            Ok(())
        }
        (Kind::Either(kinds), value) => {
            let same_type = |kind: &&Kind| {
                matches!(
                    (kind, value),
                    (Kind::Choice(_) | Kind::Text(_), Value::Text(_))
                        | (Kind::Number(_), Value::Integer(_) | Value::Float(_))
                        | (Kind::Integer { .. }, Value::Integer(_))
                        | (
                            Kind::Vector(_) | Kind::Pair(_) | Kind::Range(_) | Kind::Direction,
                            Value::List(_)
                        )
                )
            };
            let prefixed = |kind: &&Kind| match (kind, value) {
                (Kind::Prefixed(before, _), Value::Text(found)) => found.starts_with(before),
                _ => false,
            };
            kinds
                .iter()
                .find(prefixed)
                .or_else(|| kinds.iter().find(same_type))
                .map_or_else(|| Err(by_example()), |kind| scalar(node, kind, key))
        }
        _ => Err(by_example()),
    }
}

/// A column, or the list of those that are passed over.
fn column(name: &str, node: &Node) -> Result<(), String> {
    let is_number = |node: &Node| match node.value {
        Value::Integer(number) => (1..=i128::from(MOST_COLUMNS)).contains(&number),
        _ => false,
    };
    let expected = match (name, &node.value) {
        (LEFT_OUT, Value::List(items)) if items.iter().all(is_number) => return Ok(()),
        (LEFT_OUT, _) => "a list of columns' numbers from 1; write e.g. [4, 7]",
        ("", _) => "a name before it; name what the column holds",
        (_, Value::Text(text)) if !text.trim().is_empty() => return Ok(()),
        _ if is_number(node) => return Ok(()),
        _ => "a column's name or its number from 1; write e.g. \"E\" or 4",
    };
    Err(format!("found {}, expected {expected}", node.shown))
}

/// One value of a list.
fn list_item(item: &Node, of: &Kind) -> Result<(), String> {
    let advice = match (of, &item.value) {
        (Kind::Integer { min, max, .. }, Value::Integer(found)) => {
            match within(*found as f64, *min as f64, *max as f64) {
                Ok(()) => return Ok(()),
                Err(advice) => advice,
            }
        }
        (Kind::Text(_), Value::Text(found)) if !found.trim().is_empty() => return Ok(()),
        _ => "replace it",
    };
    Err(format!("found {}, expected {}; {advice}", item.shown, of.expected()))
}

fn or_default(key: &Key) -> String {
    match key.absent {
        Absent::Value(value) => format!(" or leave it out (default {value})"),
        _ => String::new(),
    }
}

fn as_number(node: &Node) -> Option<f64> {
    match node.value {
        Value::Integer(integer) => Some(integer as f64),
        Value::Float(float) => Some(float),
        _ => None,
    }
}

/// One number of a vector.
fn element(node: &Node, range: &Numbers) -> Result<(), String> {
    number(node, range)
        .map_err(|advice| format!("found {}, expected a number {range}; {advice}", node.shown))
}

/// Says what to do about a value that is no number of the range.
fn number(node: &Node, range: &Numbers) -> Result<(), &'static str> {
    as_number(node).ok_or("write a number").and_then(|found| within(found, range.min, range.max))
}

fn within(found: f64, min: f64, max: f64) -> Result<(), &'static str> {
    if !found.is_finite() {
        Err("write a finite number")
    } else if found < min {
        Err("raise it")
    } else if found > max {
        Err("lower it")
    } else {
        Ok(())
    }
}

/// A key after its tables.
pub(crate) fn joined(path: &str, name: &str) -> String {
    if path.is_empty() { name.into() } else { format!("{path}.{name}") }
}

/// A key as TOML would have it written.
fn shown_name(name: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !name.is_empty() && name.chars().all(bare) { cut(name) } else { cut(&format!("{name:?}")) }
}

fn unknown_key(name: &str, table: &'static Table) -> String {
    if let Some(near) = nearest(name, table.keys.iter().map(|key| key.name)) {
        return format!("unknown key; did you mean '{near}'?");
    }
    let names: Vec<&str> = table.keys.iter().map(|key| key.name).collect();
    let known = format!("{} has {}", table.header, names.join(", "));
    match elsewhere(name, &SCENE) {
        Some(other) => format!("unknown key; it belongs to {}, while {known}", other.header),
        None => format!("unknown key; {known}"),
    }
}

/// The first table that has a key of this name.
fn elsewhere(name: &str, table: &'static Table) -> Option<&'static Table> {
    if table.key(name).is_some() {
        return Some(table);
    }
    table.keys.iter().find_map(|key| match key.kind {
        Kind::Table(inner) | Kind::Tables { table: inner, .. } => elsewhere(name, inner),
        _ => None,
    })
}

/// The known name that was probably meant: a few typing errors away, or one that contains it.
fn nearest(found: &str, known: impl Iterator<Item = &'static str>) -> Option<&'static str> {
    let length = found.chars().count();
    if length > 40 {
        return None;
    }
    let lower = found.to_lowercase();
    let score = |name: &'static str| {
        let distance = strsim::damerau_levenshtein(&lower, name);
        let contains = length >= 3 && (name.contains(&lower) || lower.contains(name));
        (distance <= (length / 3).max(1) || contains).then_some((distance, name))
    };
    known.filter_map(score).min_by_key(|(distance, _)| *distance).map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::parse_value;

    /// Defaults and examples are TOML text in the table of keys.
    #[test]
    fn every_default_and_example_passes_the_check_of_its_key() {
        fn visit(table: &'static Table) {
            for key in table.keys {
                match key.kind {
                    Kind::Table(inner) | Kind::Tables { table: inner, .. } => visit(inner),
                    _ => {
                        let node = parse_value(key.example(), Origin::Given).unwrap();
                        if let Err(wrong) = scalar(&node, &key.kind, key) {
                            panic!("{} of {}: {}", key.name, table.header, wrong.message);
                        }
                    }
                }
            }
        }
        visit(&SCENE);
        visit(&crate::suite_keys::SUITE);
    }
}
