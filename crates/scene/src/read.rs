//! Values of a checked table, with the defaults of the table of keys.
//!
//! Asking for a key that the table of keys does not have, or as another type, is this crate's
//! mistake and asserted; the tests `every_built_key_is_read` and
//! `what_is_left_out_is_the_contracts_default` touch every read.

use crate::document::{Node, Origin, Value, parse_value};
use crate::keys::{Absent, Table};
use crate::{PointColumn, PointColumns};

/// A table of a document that passed the checks, or one that was left out.
pub(crate) struct Reader<'a> {
    table: &'static Table,
    node: Option<&'a Node>,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(table: &'static Table, node: Option<&'a Node>) -> Self {
        Self { table, node }
    }

    /// The table with nothing written in it.
    pub(crate) fn defaults(table: &'static Table) -> Self {
        Self { table, node: None }
    }

    /// A table inside this one.
    pub(crate) fn table(&self, name: &str, table: &'static Table) -> Reader<'a> {
        Reader { table, node: self.written(name) }
    }

    /// The tables of a list inside this one.
    pub(crate) fn tables(&self, name: &str, table: &'static Table) -> Vec<Reader<'a>> {
        let items = self.written(name).map_or(&[][..], Node::items);
        items.iter().map(|item| Reader { table, node: Some(item) }).collect()
    }

    /// The value that was written, without a default.
    pub(crate) fn written(&self, name: &str) -> Option<&'a Node> {
        self.node.and_then(|node| node.get(name))
    }

    pub(crate) fn flag(&self, name: &str) -> bool {
        match self.value(name) {
            Value::Bool(flag) => flag,
            other => self.unlike("a flag", name, &other),
        }
    }

    pub(crate) fn text(&self, name: &str) -> String {
        match self.value(name) {
            Value::Text(text) => text,
            other => self.unlike("a string", name, &other),
        }
    }

    pub(crate) fn count(&self, name: &str) -> u32 {
        match self.value(name) {
            Value::Integer(integer) if u32::try_from(integer).is_ok() => integer as u32,
            other => self.unlike("a count", name, &other),
        }
    }

    pub(crate) fn counts(&self, name: &str) -> [u32; 2] {
        match self.value(name) {
            Value::List(items) => [0, 1].map(|i| match items.get(i).map(|item| &item.value) {
                Some(Value::Integer(integer)) => u32::try_from(*integer).unwrap_or(u32::MAX),
                _ => self.unlike("two counts", name, &Value::Date),
            }),
            other => self.unlike("two counts", name, &other),
        }
    }

    pub(crate) fn number(&self, name: &str) -> f64 {
        let value = self.value(name);
        to_number(&value).unwrap_or_else(|| self.unlike("a number", name, &value))
    }

    pub(crate) fn vector(&self, name: &str) -> [f64; 3] {
        let value = self.value(name);
        to_vector(&value).unwrap_or_else(|| self.unlike("a vector", name, &value))
    }

    /// Two numbers, where they are written.
    pub(crate) fn written_range(&self, name: &str) -> Option<[f64; 2]> {
        let node = self.written(name)?;
        match node.items() {
            [low, high] => to_number(&low.value).zip(to_number(&high.value)).map(Into::into),
            _ => self.unlike("a range", name, &node.value),
        }
    }

    /// Names with two numbers each, those that are written.
    pub(crate) fn written_ranges(&self, name: &str) -> Vec<(String, [f64; 2])> {
        let Some(node) = self.written(name) else { return Vec::new() };
        let Value::Table(entries) = &node.value else {
            self.unlike("a table of ranges", name, &node.value)
        };
        let range = |node: &Node| match node.items() {
            [low, high] => to_number(&low.value).zip(to_number(&high.value)).map(Into::into),
            _ => None,
        };
        entries
            .iter()
            .map(|entry| match range(&entry.node) {
                Some(range) => (entry.name.clone(), range),
                None => self.unlike("a range", &entry.name, &entry.node.value),
            })
            .collect()
    }

    /// Columns by names or numbers, those that are written.
    pub(crate) fn written_columns(&self, name: &str) -> PointColumns {
        let mut columns = PointColumns::default();
        let Some(node) = self.written(name) else { return columns };
        let Value::Table(entries) = &node.value else {
            self.unlike("a table of columns", name, &node.value)
        };
        let number = |node: &Node| match node.value {
            Value::Integer(number) => u32::try_from(number).ok(),
            _ => None,
        };
        for entry in entries {
            let column = match (&entry.node.value, number(&entry.node)) {
                (Value::List(items), _) => {
                    columns.left_out.extend(items.iter().filter_map(number));
                    continue;
                }
                (Value::Text(text), _) => PointColumn::Name(text.clone()),
                (_, Some(number)) => PointColumn::Number(number),
                (other, None) => self.unlike("a column", &entry.name, other),
            };
            columns.named.push((entry.name.clone(), column));
        }
        columns
    }

    /// Counts, where they are written.
    pub(crate) fn written_counts(&self, name: &str) -> Option<Vec<u32>> {
        let node = self.written(name)?;
        let count = |item: &Node| match item.value {
            Value::Integer(integer) => u32::try_from(integer).ok(),
            _ => None,
        };
        let counts: Option<Vec<u32>> = node.items().iter().map(count).collect();
        Some(counts.unwrap_or_else(|| self.unlike("counts", name, &node.value)))
    }

    /// A number or two, twice the one.
    pub(crate) fn pair(&self, name: &str) -> [f64; 2] {
        let value = self.value(name);
        let ends = match &value {
            Value::List(items) => items.iter().map(|item| to_number(&item.value)).collect(),
            one => vec![to_number(one); 2],
        };
        match ends.as_slice() {
            [Some(low), Some(high)] => [*low, *high],
            _ => self.unlike("one or two numbers", name, &value),
        }
    }

    /// The value that was written, else the default.
    pub(crate) fn value(&self, name: &str) -> Value {
        if let Some(node) = self.written(name) {
            return node.value.clone();
        }
        match self.table.key(name).map(|key| key.absent) {
            Some(Absent::Value(text)) => parse_value(text, Origin::Given).map(|node| node.value),
            _ => None,
        }
        .unwrap_or_else(|| unreachable!("{} has no default for '{name}'", self.table.header))
    }

    /// Where a checked value is not what the reader asks for.
    pub(crate) fn unlike(&self, what: &str, name: &str, found: &Value) -> ! {
        unreachable!("'{name}' of {} is read as {what} but is {found:?}", self.table.header)
    }
}

/// An integer or a float.
pub(crate) fn to_number(value: &Value) -> Option<f64> {
    match value {
        Value::Integer(integer) => Some(*integer as f64),
        Value::Float(float) => Some(*float),
        _ => None,
    }
}

/// Three numbers.
pub(crate) fn to_vector(value: &Value) -> Option<[f64; 3]> {
    let Value::List(items) = value else { return None };
    let [x, y, z] = items.as_slice() else { return None };
    Some([to_number(&x.value)?, to_number(&y.value)?, to_number(&z.value)?])
}
