//! Transfer functions in files of their own, which scenes share.

use crate::SceneError;
use crate::check::check_as;
use crate::document::{Node, Value, parse_value};
use crate::error::{Problem, Source};
use crate::load::{document_of, read_text, what_is_missing};
use crate::root;
use crate::volume::keys::TRANSFER_FILE;
use std::path::Path;

/// Stand in the place of those that are missing, so that the rest of the scene is checked.
const STAND_IN: &str = "[{ value = 0.0, color = [0.0, 0.0, 0.0], extinction = 0.0 }]";

/// Puts the stops of every file that a volume names as its `transfer` in the name's place. Fails at the
/// first file that is no transfer function; says which are missing, whose place has other stops then.
pub(crate) fn insert(
    document: &mut Node,
    folder: &Path,
    root: Option<&Path>,
) -> Result<Vec<Problem>, SceneError> {
    let mut problems = Vec::new();
    let Some(Value::List(objects)) = document.get_mut("objects").map(|node| &mut node.value) else {
        return Ok(problems);
    };
    for (index, object) in objects.iter_mut().enumerate() {
        let written = object.get_mut("volume").and_then(|volume| volume.get_mut("transfer"));
        let Some(node) = written else { continue };
        let Value::Text(name) = &node.value else { continue };
        let file = root::located(root, name).unwrap_or_else(|| folder.join(name));
        let advice = root::advice(root, name, false);
        if let Some(message) = what_is_missing(&file, "a file of a transfer function", advice) {
            let path = format!("objects[{index}].volume.transfer");
            let origin = node.origin;
            problems.push(Problem { origin, path, message });
            if let Some(stand_in) = parse_value(STAND_IN, origin) {
                *node = stand_in;
            }
        } else {
            *node = stops_of(&file)?.moved(node.origin);
        }
    }
    Ok(problems)
}

/// The list of stops in a file.
fn stops_of(file: &Path) -> Result<Node, SceneError> {
    let text = read_text(file)?;
    let mut document = document_of(&text, file)?;
    let problems = check_as(&document, &TRANSFER_FILE);
    match document.get_mut("transfer") {
        Some(stops) if problems.is_empty() => Ok(stops.clone()),
        _ => Err(SceneError::problems(problems, &Source { file, text: &text, overrides: &[] })),
    }
}
