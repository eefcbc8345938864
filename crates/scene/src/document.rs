//! A TOML document as a tree in which every value knows where it came from.

use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Where a key or value was written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Origin {
    /// At this byte of the file.
    At(usize),
    /// In the override of this index.
    Set(usize),
    /// Nowhere: in the scene that stands for a point file.
    Given,
}

/// A value.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    pub(crate) value: Value,
    pub(crate) origin: Origin,
    /// The value in words for messages, as it was written where that is short.
    pub(crate) shown: String,
}

/// A key and its value.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub(crate) name: String,
    pub(crate) origin: Origin,
    pub(crate) node: Node,
}

/// What a value is. Integers beyond i128 are cut to it, which is beyond every range.
#[derive(Debug, Clone)]
pub(crate) enum Value {
    Bool(bool),
    Integer(i128),
    Float(f64),
    Text(String),
    Date,
    List(Vec<Node>),
    Table(Vec<Entry>),
}

/// What the parser made of a text that is not TOML.
pub(crate) struct SyntaxError {
    pub(crate) at: Option<usize>,
    pub(crate) message: String,
}

/// Parses a file. The parser limits nesting, so everything that recurses over the tree is safe.
pub(crate) fn parse_file(text: &str) -> Result<Node, SyntaxError> {
    let table = DeTable::parse(text).map_err(|error| SyntaxError {
        at: error.span().map(|span| span.start),
        message: error.message().replace('\n', ", "),
    })?;
    let place = |span: Range<usize>| Origin::At(span.start);
    Ok(table_node(table.get_ref(), Origin::At(0), text, &place))
}

/// Parses one value that was written in `origin`; `None` when it is not TOML.
pub(crate) fn parse_value(text: &str, origin: Origin) -> Option<Node> {
    let value = DeValue::parse(text).ok()?;
    Some(value_node(&value, text, &|_| origin))
}

impl Node {
    /// A string that is not a TOML value.
    pub(crate) fn text(text: &str, origin: Origin) -> Self {
        let shown = format!("the string {}", cut(&format!("{text:?}")));
        Self { value: Value::Text(text.into()), origin, shown }
    }

    /// A table without keys.
    pub(crate) fn empty_table(origin: Origin) -> Self {
        Self { value: Value::Table(Vec::new()), origin, shown: "a table".into() }
    }

    /// The value of a key, when this is a table that has it.
    pub(crate) fn get(&self, name: &str) -> Option<&Node> {
        let Value::Table(entries) = &self.value else { return None };
        entries.iter().find(|entry| entry.name == name).map(|entry| &entry.node)
    }

    /// The same, to be changed.
    pub(crate) fn get_mut(&mut self, name: &str) -> Option<&mut Node> {
        let Value::Table(entries) = &mut self.value else { return None };
        entries.iter_mut().find(|entry| entry.name == name).map(|entry| &mut entry.node)
    }

    /// The same node, as if all of it were written in `origin`.
    pub(crate) fn moved(self, origin: Origin) -> Self {
        let value = match self.value {
            Value::List(items) => {
                Value::List(items.into_iter().map(|item| item.moved(origin)).collect())
            }
            Value::Table(entries) => {
                let entry =
                    |entry: Entry| Entry { origin, node: entry.node.moved(origin), ..entry };
                Value::Table(entries.into_iter().map(entry).collect())
            }
            other => other,
        };
        Self { value, origin, shown: self.shown }
    }

    /// The elements of a list, or nothing.
    pub(crate) fn items(&self) -> &[Node] {
        if let Value::List(items) = &self.value { items } else { &[] }
    }
}

fn table_node(
    table: &DeTable<'_>,
    origin: Origin,
    text: &str,
    place: &dyn Fn(Range<usize>) -> Origin,
) -> Node {
    let entries = table.iter().map(|(key, value)| Entry {
        name: key.get_ref().to_string(),
        origin: place(key.span()),
        node: value_node(value, text, place),
    });
    Node { value: Value::Table(entries.collect()), origin, shown: "a table".into() }
}

fn value_node(
    spanned: &Spanned<DeValue<'_>>,
    text: &str,
    place: &dyn Fn(Range<usize>) -> Origin,
) -> Node {
    let origin = place(spanned.span());
    let written = || cut(text.get(spanned.span()).unwrap_or("a value"));
    let (value, shown) = match spanned.get_ref() {
        DeValue::Table(table) => return table_node(table, origin, text, place),
        DeValue::Array(items) => {
            let items: Vec<Node> = items.iter().map(|item| value_node(item, text, place)).collect();
            let shown = format!("a list of {}", items.len());
            (Value::List(items), shown)
        }
        DeValue::String(string) => return Node::text(string, origin),
        DeValue::Boolean(flag) => (Value::Bool(*flag), flag.to_string()),
        DeValue::Datetime(_) => (Value::Date, format!("the date {}", written())),
        DeValue::Integer(digits) => {
            let beyond = if digits.as_str().starts_with('-') { i128::MIN } else { i128::MAX };
            let integer = i128::from_str_radix(digits.as_str(), digits.radix()).unwrap_or(beyond);
            (Value::Integer(integer), written())
        }
        DeValue::Float(digits) => {
            (Value::Float(digits.as_str().parse().unwrap_or(f64::NAN)), written())
        }
    };
    Node { value, origin, shown }
}

/// At most 60 characters of a text, on one line.
pub(crate) fn cut(text: &str) -> String {
    let mut short: String = text.chars().take(60).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short.replace(|c: char| c.is_control(), " ")
}
