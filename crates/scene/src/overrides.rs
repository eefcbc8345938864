//! `--set PATH=VALUE`: single values put into the document before it is checked.

use crate::document::{Node, Origin, Value, parse_value};
use crate::error::Problem;
use crate::keys::{Absent, Kind, SCENE, Table};

/// More parts than any key has; what bounds the depth of the tree.
const MAX_PARTS: usize = 16;

/// Puts override `index` into the document.
pub(crate) fn apply(document: &mut Node, index: usize, text: &str) -> Result<(), Problem> {
    let origin = Origin::Set(index);
    let malformed = |what: &str| {
        let next = "expected PATH=VALUE, e.g. objects.0.surface.trust=0.7";
        Problem { origin, path: String::new(), message: format!("{what}, {next}") }
    };
    let (path, value) = text.split_once('=').ok_or_else(|| malformed("found no '='"))?;
    let parts: Vec<&str> = path.split('.').map(str::trim).collect();
    if parts.iter().any(|part| part.is_empty()) {
        return Err(malformed("found an empty part in the path"));
    }
    if parts.len() > MAX_PARTS {
        return Err(malformed(&format!("found a path of {} parts", parts.len())));
    }
    let value = parse_value(value.trim(), origin).unwrap_or_else(|| Node::text(value, origin));
    put(document, Some(&SCENE), &parts, String::new(), value).map_err(|(path, message)| Problem {
        origin,
        path,
        message,
    })
}

/// Follows `parts` from `node`, which `done` names, making tables where there are none.
fn put(
    node: &mut Node,
    table: Option<&'static Table>,
    parts: &[&str],
    done: String,
    value: Node,
) -> Result<(), (String, String)> {
    let Some((part, rest)) = parts.split_first() else {
        *node = value;
        return Ok(());
    };
    let Node { value: inside, shown, .. } = node;
    match inside {
        Value::List(items) if *part == "+" && rest.is_empty() => {
            items.push(value);
            Ok(())
        }
        Value::List(items) => {
            let count = items.len();
            let item = part.parse::<usize>().ok().and_then(|index| items.get_mut(index));
            let Some(item) = item else { return Err((done, no_such_index(part, count))) };
            put(item, table, rest, format!("{done}[{part}]"), value)
        }
        Value::Table(entries) => {
            let key = table.and_then(|table| table.key(part));
            let inner = key.and_then(|key| match key.kind {
                Kind::Table(table) | Kind::Tables { table, .. } => Some(table),
                _ => None,
            });
            let path = crate::check::joined(&done, part);
            if let Some(entry) = entries.iter_mut().find(|entry| entry.name == *part) {
                return put(&mut entry.node, inner, rest, path, value);
            }
            let origin = value.origin;
            let mut child = match key.map(|key| (&key.kind, key.absent)) {
                Some((Kind::Tables { .. }, _)) if !rest.is_empty() => {
                    return Err((path, no_such_index(rest[0], 0)));
                }
                Some((_, Absent::Value(default))) => parse_value(default, origin),
                _ => None,
            }
            .unwrap_or_else(|| Node::empty_table(origin));
            put(&mut child, inner, rest, path, value)?;
            entries.push(crate::document::Entry { name: (*part).into(), origin, node: child });
            Ok(())
        }
        _ => Err((done, format!("found {shown}, which has no '{part}'; end the path here"))),
    }
}

fn no_such_index(part: &str, count: usize) -> String {
    let advice = match count {
        0 => "add it to the scene file first".to_owned(),
        1 => "use 0".to_owned(),
        _ => format!("use 0 to {}", count - 1),
    };
    format!("found index '{part}', but the list has {count}, counted from 0; {advice}")
}
