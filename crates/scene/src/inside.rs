//! `camera.inside`: the glass that the eye is said to be inside.

use crate::document::{Node, Value};
use crate::error::Problem;
use crate::{Object, Scene};

/// The names that a checked value holds.
pub(crate) fn names(written: &Node) -> Vec<String> {
    let name = |node: &Node| match &node.value {
        Value::Text(name) => Some(name.clone()),
        _ => None,
    };
    name(written).map_or_else(|| written.items().iter().filter_map(name).collect(), |one| vec![one])
}

/// What is wrong with it, if a name is not that of an object of glass.
pub(crate) fn problem(document: &Node, scene: &Scene) -> Option<Problem> {
    let is_glass = |object: &&Object| object.material.kind.has_inside();
    let known: Vec<&str> =
        scene.objects.iter().filter(is_glass).map(|object| object.name.as_str()).collect();
    let strange = scene.inside.iter().flatten().find(|name| !known.contains(&name.as_str()))?;
    let node = document.get("camera").and_then(|camera| camera.get("inside"));
    let expected = match known.as_slice() {
        [] => "none, since no object of the scene is of glass; remove the key".to_owned(),
        known => {
            format!("the name of an object of glass; the scene has '{}'", known.join("', '"))
        }
    };
    Some(Problem {
        origin: node.map_or(document.origin, |node| node.origin),
        path: "camera.inside".into(),
        message: format!("found '{strange}', expected {expected}"),
    })
}
