//! The table of keys as JSON Schema.

use crate::document::{Origin, Value, parse_value};
use crate::keys::{Absent, DIRECTION, Key, Kind, LEFT_OUT, MOST_COLUMNS, Numbers, SCENE, Table};
use crate::not_built::not_built;
use crate::suite_keys::SUITE;
use serde_json::{Map, Value as Json, json};

/// The JSON Schema (draft 2020-12) of scene files: every key, built or not; the descriptions say
/// what is not built yet.
pub fn json_schema() -> Json {
    schema_of(&SCENE, "pointillist scene")
}

/// The JSON Schema (draft 2020-12) of suites of benchmarks.
pub fn suite_json_schema() -> Json {
    schema_of(&SUITE, "pointillist benchmark suite")
}

fn schema_of(root: &Table, title: &str) -> Json {
    let mut schema = table(root, "");
    schema.insert("$schema".into(), json!("https://json-schema.org/draft/2020-12/schema"));
    schema.insert("title".into(), json!(title));
    Json::Object(schema)
}

fn table(table: &Table, path: &str) -> Map<String, Json> {
    let mut properties = Map::new();
    for key in table.keys {
        let path = crate::check::joined(path, key.name);
        properties.insert(key.name.into(), property(key, &path));
    }
    let required = |only: Option<&str>| -> Vec<&str> {
        (table.keys.iter())
            .filter(|key| matches!(key.absent, Absent::Required(_)) && key.only == only)
            .map(|key| key.name)
            .collect()
    };
    let mut object = as_map(json!({
        "type": "object",
        "additionalProperties": false,
        "properties": properties,
        "required": required(None),
    }));
    if !table.doc.is_empty() {
        object.insert("description".into(), json!(table.doc));
    }
    let mut kinds: Vec<&str> = table.keys.iter().filter_map(|key| key.only).collect();
    kinds.dedup();
    if !kinds.is_empty() {
        let cases = kinds.iter().map(|kind| {
            let others: Map<String, Json> = (table.keys.iter())
                .filter(|key| key.only.is_some_and(|only| only != *kind))
                .map(|key| (key.name.to_owned(), json!(false)))
                .collect();
            json!({
                "if": { "properties": { "kind": { "const": kind } } },
                "then": { "required": required(Some(kind)), "properties": others },
            })
        });
        object.insert("allOf".into(), cases.collect());
    }
    object
}

fn property(key: &Key, path: &str) -> Json {
    let mut schema = kind(&key.kind, path);
    let mut description = key.doc.to_owned();
    if let Some(unit) = key.kind.unit() {
        description += &format!(" Unit: {unit}.");
    }
    if let Absent::Words(words, _) = key.absent {
        description += &format!(" Default: {words}.");
    }
    if not_built(path).is_some() {
        description += " Known, not built yet.";
    }
    schema.insert("description".into(), json!(description));
    if let Absent::Value(text) = key.absent {
        schema.insert("default".into(), literal(text));
    }
    Json::Object(schema)
}

fn kind(of: &Kind, path: &str) -> Map<String, Json> {
    match of {
        Kind::Table(inner) => table(inner, path),
        Kind::Tables { table: inner, min, max, in_file } => {
            let list = json!({
                "type": "array", "items": table(inner, path), "minItems": min, "maxItems": max,
            });
            let file = json!({ "type": "string", "minLength": 1 });
            as_map(if *in_file { json!({ "anyOf": [list, file] }) } else { list })
        }
        Kind::Ranges(range) => as_map(json!({
            "type": "object",
            "additionalProperties": {
                "type": "array", "items": number(range), "minItems": 2, "maxItems": 2,
            },
        })),
        Kind::Columns => {
            let number = json!({ "type": "integer", "minimum": 1, "maximum": MOST_COLUMNS });
            as_map(json!({
                "type": "object",
                "properties": { LEFT_OUT: { "type": "array", "items": number } },
                "additionalProperties": {
                    "anyOf": [{ "type": "string", "minLength": 1 }, number],
                },
            }))
        }
        Kind::Bool => as_map(json!({ "type": "boolean" })),
        Kind::Integer { min, max, .. } => {
            as_map(json!({ "type": "integer", "minimum": min, "maximum": max }))
        }
        Kind::Number(range) => as_map(number(range)),
        Kind::Vector(range) => as_map(json!({
            "type": "array", "items": number(range), "minItems": 3, "maxItems": 3,
        })),
        Kind::Vectors(range) => as_map(json!({
            "type": "array", "items": kind(&Kind::Vector(*range), path), "minItems": 2, "maxItems": 2,
        })),
        Kind::Direction => as_map(json!({
            "type": "array", "items": number(&DIRECTION), "minItems": 3, "maxItems": 3,
            "not": { "items": { "const": 0 } },
        })),
        Kind::Size { max } => as_map(json!({
            "type": "array", "items": { "type": "integer", "minimum": 1, "maximum": max },
            "minItems": 2, "maxItems": 2,
        })),
        Kind::Range(range) | Kind::Pair(range) => as_map(json!({
            "type": "array", "items": number(range), "minItems": 2, "maxItems": 2,
        })),
        Kind::List { of, max } => as_map(json!({
            "type": "array", "items": kind(of, path), "minItems": 1, "maxItems": max,
        })),
        Kind::Names(_) => {
            let name = json!({ "type": "string", "minLength": 1 });
            as_map(json!({ "anyOf": [name, { "type": "array", "items": name }] }))
        }
        Kind::Prefixed(before, _) => as_map(json!({
            "type": "string", "pattern": format!("^{before}."),
        })),
        Kind::Choice(names) => as_map(json!({ "enum": names })),
        Kind::Text(_) => as_map(json!({ "type": "string", "minLength": 1 })),
        Kind::Either(kinds) => {
            let any: Vec<_> = kinds.iter().map(|inner| kind(inner, path)).collect();
            as_map(json!({ "anyOf": any }))
        }
    }
}

impl Kind {
    /// The unit of its numbers, if they have one.
    fn unit(&self) -> Option<&'static str> {
        match self {
            Kind::Integer { unit, .. } => Some(*unit),
            Kind::Number(range)
            | Kind::Vector(range)
            | Kind::Vectors(range)
            | Kind::Pair(range) => Some(range.unit),
            Kind::Size { .. } => Some("pixels"),
            Kind::Either(kinds) => kinds.iter().find_map(Kind::unit),
            _ => None,
        }
        .filter(|unit| !unit.is_empty())
    }
}

fn number(range: &Numbers) -> Json {
    json!({ "type": "number", "minimum": range.min, "maximum": range.max })
}

/// A TOML value as JSON.
fn literal(text: &str) -> Json {
    fn convert(value: &Value) -> Json {
        match value {
            Value::Bool(flag) => json!(flag),
            Value::Integer(integer) => json!(i64::try_from(*integer).unwrap_or(i64::MAX)),
            Value::Float(float) => json!(float),
            Value::Text(text) => json!(text),
            Value::List(items) => items.iter().map(|item| convert(&item.value)).collect(),
            Value::Date | Value::Table(_) => Json::Null,
        }
    }
    parse_value(text, Origin::Given).map_or(Json::Null, |node| convert(&node.value))
}

fn as_map(json: Json) -> Map<String, Json> {
    if let Json::Object(map) = json { map } else { Map::new() }
}
