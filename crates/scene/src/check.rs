//! Holds a document against the table of keys.
//!
//! Walks both together, so that every problem has its place in the file. It stops at nothing: one
//! run finds everything that is wrong, as far as it can be told apart.

use crate::document::{Node, Origin, Value, cut};
use crate::error::Problem;
use crate::keys::{Absent, DIRECTION, Fault, Key, Kind, Numbers, SCENE, SHORT, Table, plain};
use crate::not_built::{When, not_built};
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
        let missing = not_built(spot.plain_path);
        if let Some(entry) = missing
            && matches!(entry.when, When::Present)
        {
            let message = format!("known but not built yet; {}", entry.instead);
            return self.report(key_origin, spot.path, message);
        }
        match &spot.key.kind {
            Kind::Table(table) => self.table(node, table, spot.path, spot.plain_path),
            Kind::Tables { table, min, max, .. } => self.tables(node, spot, table, *min, *max),
            kind => {
                if let Err(Wrong { within, origin, message }) = scalar(node, kind, spot.key) {
                    self.report(origin, &format!("{}{within}", spot.path), message);
                } else if let Some(entry) = missing
                    && entry.when.covers(&node.value)
                {
                    let message =
                        format!("found {}, known but not built yet; {}", node.shown, entry.instead);
                    self.report(node.origin, spot.path, message);
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

impl When {
    fn covers(&self, value: &Value) -> bool {
        match (self, value) {
            (When::Present, _) => true,
            (When::Is(names), Value::Text(text)) => names.contains(&text.as_str()),
            _ => false,
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
        (Kind::Announced, _) | (Kind::Bool, Value::Bool(_)) => Ok(()),
        (Kind::Integer { min, max, .. }, Value::Integer(found)) => {
            within(*found as f64, *min as f64, *max as f64)
                .map_err(|advice| wrong(format!("{advice}{}", or_default(key))))
        }
        (Kind::Number(range), Value::Integer(_) | Value::Float(_)) => {
            number(node, range).map_err(|advice| wrong(format!("{advice}{}", or_default(key))))
        }
        (Kind::Vector(range), _) => elements(3, &|item| element(item, range)),
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
        (Kind::Either(kinds), value) => {
            let same_type = |kind: &&Kind| {
                matches!(
                    (kind, value),
                    (Kind::Choice(_) | Kind::Text(_), Value::Text(_))
                        | (Kind::Number(_), Value::Integer(_) | Value::Float(_))
                        | (Kind::Vector(_) | Kind::Pair(_), Value::List(_))
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

/// The sine of the smallest angle between `up` and the line of sight.
const MIN_SINE: f64 = 1e-6;

/// A camera looks along a line, and `up` is not along it.
pub(crate) fn camera_has_a_view(camera: &Reader<'_>) -> Result<(), Fault> {
    let [eye, target, up] = ["eye", "target", "up"].map(|name| camera.vector(name));
    let view = [target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]];
    let distance = length(view);
    if distance < SHORT {
        let message = format!(
            "found {} scene units from camera.eye, expected at least {}; move it apart",
            plain(distance),
            plain(SHORT)
        );
        return Err(("target", message));
    }
    long_enough("up", up)?;
    let (v, u) = (view.map(|x| x / distance), up.map(|x| x / length(up)));
    let cross = [v[1] * u[2] - v[2] * u[1], v[2] * u[0] - v[0] * u[2], v[0] * u[1] - v[1] * u[0]];
    if length(cross) < MIN_SINE {
        let message = "found a direction parallel to the line of sight from camera.eye to \
                       camera.target, expected one across it; turn it";
        return Err(("up", message.into()));
    }
    projection_has_its_keys(camera)?;
    lens_is_no_wider_than_rays_can_bear(camera, distance)
}

/// Each projection has one key that says how much it shows.
fn projection_has_its_keys(camera: &Reader<'_>) -> Result<(), Fault> {
    let projection = camera.text("projection");
    let foreign = if projection == "orthographic" { "vertical_fov" } else { "height" };
    if camera.written(foreign).is_some() {
        let owner = if foreign == "height" { "orthographic" } else { "perspective" };
        let message = format!(
            "belongs to projection \"{owner}\", but projection is \"{projection}\"; remove one"
        );
        return Err((foreign, message));
    }
    if projection == "orthographic" && camera.written("height").is_none() {
        let message = "missing, expected the height of what an orthographic picture shows; add e.g. \
                       height = 2.0";
        return Err(("height", message.into()));
    }
    Ok(())
}

/// Widest lens over the distance in focus.
const MAX_APERTURE: f64 = 1000.0;

/// Rays from its rim still go forward.
fn lens_is_no_wider_than_rays_can_bear(camera: &Reader<'_>, target: f64) -> Result<(), Fault> {
    let aperture = camera.number("aperture");
    let focus = camera.written("focus").map_or(target, |_| camera.number("focus"));
    if aperture > MAX_APERTURE * focus {
        let message = format!(
            "found {} scene units with a focus at {}, expected at most {MAX_APERTURE} times as much; \
             lower it",
            plain(aperture),
            plain(focus)
        );
        return Err(("aperture", message));
    }
    Ok(())
}

/// The direction of a directional light is long enough to be normalised.
pub(crate) fn direction_has_a_length(light: &Reader<'_>) -> Result<(), Fault> {
    match light.text("kind").as_str() {
        "directional" => long_enough("direction", light.vector("direction")),
        _ => Ok(()),
    }
}

/// An Abbe number goes with one index, not with one a channel.
fn dispersion_is_stated_once(material: &Reader<'_>) -> Result<(), Fault> {
    let several = material.written("ior").is_some_and(|ior| matches!(ior.value, Value::List(_)));
    if material.written("abbe").is_some() && several {
        let message = "found beside an ior of three numbers, expected one number there; remove \
                       this or give one ior";
        return Err(("abbe", message.into()));
    }
    Ok(())
}

/// The background is a colour or an image. The colour that a point file rendered directly gets gives way.
pub(crate) fn background_is_one(background: &Reader<'_>) -> Result<(), Fault> {
    let color = background.written("color").filter(|node| node.origin != Origin::Given);
    match (color, background.written("environment")) {
        (Some(_), Some(_)) => Err((
            "environment",
            "found both color and environment, expected one of them; remove one".into(),
        )),
        _ => Ok(()),
    }
}

/// What a volume shows is stated once, and each kernel and mode has its keys.
pub(crate) fn volume_says_it_once(volume: &Reader<'_>) -> Result<(), Fault> {
    let has = |name: &str| volume.written(name).is_some();
    match (has("transfer"), has("color_map")) {
        (true, true) => {
            let message = "found both transfer and color_map, expected one of them; remove one";
            return Err(("color_map", message.into()));
        }
        (false, false) => {
            let message = "missing, and so is color_map, expected one of them; add e.g. color_map = \
                           \"viridis\" and extinction = [0.0, 5.0]";
            return Err(("transfer", message.into()));
        }
        (false, true) if !has("extinction") => {
            let message = "missing, expected the extinction of what color_map shows; add e.g. extinction = \
                           [0.0, 5.0]";
            return Err(("extinction", message.into()));
        }
        _ => {}
    }
    let owned = [
        ("value_range", has("color_map"), "color_map, but there is none"),
        ("extinction", has("color_map"), "color_map, but there is none"),
        (
            "smoothing_length",
            volume.text("kernel") == "sph",
            "kernel \"sph\", but kernel is another",
        ),
        ("mass", volume.text("kernel") == "sph", "kernel \"sph\", but kernel is another"),
        ("density", has("mass"), "mass, but there is none"),
        ("radius", volume.text("kernel") != "sph", "other kernels than \"sph\""),
        ("smoothing", volume.text("kernel") != "sph", "other kernels than \"sph\""),
        ("iso", volume.text("mode") == "isosurface", "mode \"isosurface\", but mode is another"),
    ];
    for (name, fits, owner) in owned {
        if has(name) && !fits {
            return Err((name, format!("belongs to {owner}; remove one")));
        }
    }
    let required = [
        ("smoothing_length", volume.text("kernel") == "sph", "kernel \"sph\"", "\"h\""),
        ("iso", volume.text("mode") == "isosurface", "mode \"isosurface\"", "0.5"),
    ];
    for (name, needed, owner, example) in required {
        if needed && !has(name) {
            return Err((
                name,
                format!("missing, expected for {owner}; add e.g. {name} = {example}"),
            ));
        }
    }
    stops_ascend(volume)
}

/// A transfer function's stops ascend in value.
pub(crate) fn stops_ascend(volume: &Reader<'_>) -> Result<(), Fault> {
    let values: Vec<f64> = (volume.tables("transfer", &crate::keys::TRANSFER).iter())
        .map(|stop| stop.number("value"))
        .collect();
    match values.windows(2).find(|pair| pair[0] > pair[1]) {
        Some(pair) => Err((
            "transfer",
            format!(
                "found the value {} behind {}, expected stops that ascend; sort them",
                plain(pair[1]),
                plain(pair[0])
            ),
        )),
        None => Ok(()),
    }
}

/// A material has an albedo or a texture, and what belongs to one of them only with that.
pub(crate) fn material_has_one_color(material: &Reader<'_>) -> Result<(), Fault> {
    let has = |name: &str| material.written(name).is_some();
    if has("albedo") && has("texture") && material.text("kind") == "diffuse" {
        let message = "found both albedo and texture, expected one of them; remove one";
        return Err(("texture", message.into()));
    }
    if has("texture_axis") && !has("texture") {
        let message = "belongs to a texture, but there is none; add texture, or remove it";
        return Err(("texture_axis", message.into()));
    }
    let albedo = material.written("albedo").map(|node| &node.value);
    let of_attribute = matches!(albedo, Some(Value::Text(text)) if text != "points");
    for name in ["color_map", "value_range"] {
        if has(name) && !of_attribute {
            let message = "belongs to the albedo of an attribute, but there is none; write albedo = \
                           \"attribute:NAME\", or remove it";
            return Err((name, message.into()));
        }
    }
    dispersion_is_stated_once(material)
}

fn long_enough(name: &'static str, v: [f64; 3]) -> Result<(), Fault> {
    let length = length(v);
    if length >= SHORT {
        return Ok(());
    }
    let [found, shortest] = [length, SHORT].map(plain);
    Err((name, format!("found a length of {found}, expected at least {shortest}; lengthen it")))
}

/// Scaled by the largest component, so that squares neither overflow nor vanish.
fn length(v: [f64; 3]) -> f64 {
    let largest = v.iter().fold(0.0_f64, |max, x| max.max(x.abs()));
    if largest == 0.0 {
        return 0.0;
    }
    largest * v.iter().map(|x| (x / largest) * (x / largest)).sum::<f64>().sqrt()
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
    }

    #[test]
    fn length_neither_overflows_nor_vanishes() {
        for (v, expected) in [([3e200, 0.0, -4e200], 5e200), ([0.0, 3e-200, 4e-200], 5e-200)] {
            // A division, a root and a product round once each.
            assert!((length(v) / expected - 1.0).abs() < 1e-15, "{v:?}");
        }
        assert_eq!(length([0.0, -0.0, 0.0]), 0.0);
    }
}
