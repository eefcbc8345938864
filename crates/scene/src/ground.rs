//! `points = "@ground"`: an object that is no file, but a ground that lies below all others.
//!
//! It is a disc, which is exactly plane and costs one point; where it lies and how wide it is follows from the points of the other
//! objects, which the renderer knows (`plan/src/ground.rs`).

use crate::document::{Entry, Node, Origin, Value, parse_value};
use crate::error::Problem;
use crate::{Object, Scene};

/// In place of the path of a point file.
const GROUND: &str = "@ground";
/// Axes that may be up, after a colon.
const AXES: [(&str, [f64; 3]); 6] = [
    ("x", [1.0, 0.0, 0.0]),
    ("y", [0.0, 1.0, 0.0]),
    ("z", [0.0, 0.0, 1.0]),
    ("-x", [-1.0, 0.0, 0.0]),
    ("-y", [0.0, -1.0, 0.0]),
    ("-z", [0.0, 0.0, -1.0]),
];
/// What a ground gets that has not got it; as bright as the background of a point file rendered directly is at the horizon.
const SURFACE: &str = "{ kind = \"discs\", radius = \"attribute:radius\" }";
const MATERIAL: &str = "{ albedo = [0.25, 0.25, 0.25] }";

impl Object {
    /// Whether its points are no file, but those of a ground below the other objects.
    #[must_use]
    pub fn is_ground(&self) -> bool {
        is_ground(&self.points_as_written)
    }

    /// The axis that is up for a ground that says so, as a unit vector.
    #[must_use]
    pub fn ground_up(&self) -> Option<[f64; 3]> {
        let axis = self.points_as_written.strip_prefix(GROUND)?.strip_prefix(':')?;
        AXES.iter().find(|(name, _)| *name == axis).map(|(_, up)| *up)
    }

    /// The same object where a ground says which axis is up: the one nearest to this direction, if it has not got one.
    #[must_use]
    pub fn with_ground_up(&self, up: [f64; 3]) -> Self {
        let mut object = self.clone();
        if self.is_ground() && self.ground_up().is_none() {
            object.points_as_written = format!("{GROUND}:{}", nearest_axis(up).0);
        }
        object
    }

    /// The axis nearest to a direction, for grounds that do not say which is up.
    #[must_use]
    pub fn nearest_axis(up: [f64; 3]) -> [f64; 3] {
        nearest_axis(up).1
    }
}

fn nearest_axis(up: [f64; 3]) -> (&'static str, [f64; 3]) {
    let along = |axis: &[f64; 3]| (0..3).map(|i| axis[i] * up[i]).sum::<f64>();
    let nearer = |best: (&'static str, [f64; 3]), next: (&'static str, [f64; 3])| {
        if along(&next.1) > along(&best.1) { next } else { best }
    };
    AXES.into_iter().fold(AXES[1], nearer)
}

/// Whether this stands in place of a path.
pub(crate) fn is_ground(points: &str) -> bool {
    points.strip_prefix(GROUND).is_some_and(|rest| rest.is_empty() || rest.starts_with(':'))
}

/// Gives grounds name, surface and material, where these are not written.
pub(crate) fn apply(document: &mut Node) {
    let Some(Node { value: Value::List(objects), .. }) = document.get_mut("objects") else {
        return;
    };
    // `--ground` adds one to a scene that may have one.
    let mut has_ground = false;
    objects.retain(|object| match object.get("points").map(|node| &node.value) {
        Some(Value::Text(points)) if is_ground(points) => {
            !std::mem::replace(&mut has_ground, true) || points != GROUND
        }
        _ => true,
    });
    for object in objects {
        let points = object.get("points").map(|node| &node.value);
        if !matches!(points, Some(Value::Text(points)) if is_ground(points)) {
            continue;
        }
        let add = |table: &mut Node, name: &str, value: &str| {
            let Value::Table(entries) = &mut table.value else { return };
            if entries.iter().all(|entry| entry.name != name)
                && let Some(node) = parse_value(value, Origin::Given)
            {
                entries.push(Entry { name: name.into(), origin: Origin::Given, node });
            }
        };
        add(object, "name", "\"ground\"");
        add(object, "surface", SURFACE);
        add(object, "material", MATERIAL);
    }
}

/// What is wrong with a ground that names no axis, or has nothing to lie below.
pub(crate) fn problem(document: &Node, scene: &Scene) -> Option<Problem> {
    let nodes = document.get("objects").map_or(&[][..], Node::items);
    let has_others = scene.objects.iter().any(|object| !object.is_ground());
    let (index, object) = (scene.objects.iter().enumerate()).find(|(_, object)| {
        object.is_ground()
            && (!has_others || (object.points_as_written != GROUND && object.ground_up().is_none()))
    })?;
    let message = if has_others {
        format!(
            "found '{}', expected {GROUND}, or {GROUND}: with the axis that is up: x, y, z, -x, -y or -z",
            object.points_as_written
        )
    } else {
        format!("found only {GROUND}, expected another object that it lies below; add one")
    };
    let points = nodes.get(index).and_then(|node| node.get("points"));
    Some(Problem {
        origin: points.map_or(document.origin, |node| node.origin),
        path: format!("objects[{index}].points"),
        message,
    })
}
