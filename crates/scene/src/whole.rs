//! What no key of a table can say alone: checks that need several.

use crate::document::{Origin, Value};
use crate::keys::{Fault, SHORT, plain};
use crate::load::key_of_points_as_they_are;
use crate::read::{Reader, to_vector};

/// The sine of the smallest angle between `up` and the line of sight.
const MIN_SINE: f64 = 1e-6;

/// A camera looks along a line, and `up` is not along it: as far as both are given.
pub(crate) fn camera_has_a_view(camera: &Reader<'_>) -> Result<(), Fault> {
    let given = |name: &str| camera.written(name).is_some();
    let up = camera.vector("up");
    long_enough("up", up)?;
    let focus = match (given("eye"), given("target")) {
        (true, true) => {
            let [eye, target] = ["eye", "target"].map(|name| camera.vector(name));
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
            if given("view") {
                let message = "belongs to a camera without eye or target, but both are given; remove one of the three";
                return Err(("view", message.into()));
            }
            lies_across(view, up, "from camera.eye to camera.target")?;
            Some(distance)
        }
        _ => None,
    };
    if let Some(view) = camera.written("view").and_then(|node| to_vector(&node.value)) {
        long_enough("view", view)?;
        if given("up") {
            lies_across(view, up, "along camera.view")?;
        }
    }
    projection_has_its_keys(camera)?;
    let focus = camera.written("focus").map(|_| camera.number("focus")).or(focus);
    focus.map_or(Ok(()), |focus| lens_is_no_wider_than_rays_can_bear(camera, focus))
}

/// `up` is not parallel to the line of sight.
fn lies_across(view: [f64; 3], up: [f64; 3], line: &str) -> Result<(), Fault> {
    let (v, u) = (view.map(|x| x / length(view)), up.map(|x| x / length(up)));
    let cross = [v[1] * u[2] - v[2] * u[1], v[2] * u[0] - v[0] * u[2], v[0] * u[1] - v[1] * u[0]];
    if length(cross) < MIN_SINE {
        let message = format!(
            "found a direction parallel to the line of sight {line}, expected one across it; turn it"
        );
        return Err(("up", message));
    }
    Ok(())
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
    Ok(())
}

/// Widest lens over the distance in focus.
const MAX_APERTURE: f64 = 1000.0;

/// Rays from its rim still go forward.
fn lens_is_no_wider_than_rays_can_bear(camera: &Reader<'_>, focus: f64) -> Result<(), Fault> {
    let aperture = camera.number("aperture");
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

/// No corner of a box is beyond the other.
pub(crate) fn box_has_an_inside(table: &Reader<'_>) -> Result<(), Fault> {
    let (min, max) = (table.vector("min"), table.vector("max"));
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        if max[axis] < min[axis] {
            let message = format!(
                "found {} along {name}, expected at least min's, {}; raise it",
                plain(max[axis]),
                plain(min[axis])
            );
            return Err(("max", message));
        }
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
        (_, None) if background.vector("rotate") != [0.0; 3] => Err((
            "rotate",
            "found angles, expected none without environment, which they turn; add environment, or remove rotate"
                .into(),
        )),
        _ => Ok(()),
    }
}

/// What a volume shows is stated once, and each kernel and mode has its keys.
pub(crate) fn volume_says_it_once(volume: &Reader<'_>) -> Result<(), Fault> {
    let has = |name: &str| volume.written(name).is_some();
    let surface = volume.text("mode") == "isosurface";
    match (has("transfer"), has("color_map")) {
        (true, true) => {
            let message = "found both transfer and color_map, expected one of them; remove one";
            return Err(("color_map", message.into()));
        }
        (false, false) if !surface => {
            let message = "missing, and so is color_map, expected one of them; add e.g. color_map = \
                           \"viridis\" and extinction = [0.0, 5.0]";
            return Err(("transfer", message.into()));
        }
        (false, true) if !surface && volume.text("mode") != "integral" && !has("extinction") => {
            let message = "missing, expected the extinction of what color_map shows; add e.g. extinction = \
                           [0.0, 5.0]";
            return Err(("extinction", message.into()));
        }
        _ => {}
    }
    let owned = [
        ("value_range", has("color_map"), "color_map, but there is none"),
        (
            "extinction",
            has("color_map") || has("transfer"),
            "color_map or transfer, but there is neither",
        ),
        ("scale", has("color_map"), "color_map, but there is none"),
        (
            "smoothing_length",
            volume.text("kernel") == "sph",
            "kernel \"sph\", but kernel is another",
        ),
        ("mass", volume.text("kernel") == "sph", "kernel \"sph\", but kernel is another"),
        ("density", has("mass"), "mass, but there is none"),
        ("radius", volume.text("kernel") != "sph", "other kernels than \"sph\""),
        ("smoothing", volume.text("kernel") != "sph", "other kernels than \"sph\""),
        ("iso", surface, "mode \"isosurface\", but mode is another"),
        ("shading", volume.text("mode") == "emission", "mode \"emission\", but mode is another"),
    ];
    isosurface_fits(volume)?;
    let extinction = volume.written("extinction").map(|node| &node.value);
    if has("transfer") && matches!(extinction, Some(Value::List(_))) {
        let message = "found two numbers beside transfer, expected a factor on the extinctions of its stops; \
                       write one number, or \"auto\"";
        return Err(("extinction", message.into()));
    }
    if matches!(extinction, Some(Value::Text(_))) && volume.text("mode") != "emission" {
        let message = "\"auto\" belongs to mode \"emission\", but mode is another; write a number";
        return Err(("extinction", message.into()));
    }
    range_fits_scale(volume)?;
    let range = volume.written("value_range").map(|node| &node.value);
    if volume.text("mode") == "integral"
        && volume.text("scale") == "log"
        && matches!(range, Some(Value::Text(_)))
    {
        let message = "found \"auto\", which begins at 0, beside scale = \"log\", expected two numbers over 0; write \
                       e.g. [0.01, 100.0]";
        return Err(("value_range", message.into()));
    }
    for (name, fits, owner) in owned {
        if has(name) && !fits {
            return Err((name, format!("belongs to {owner}; remove one")));
        }
    }
    let required = [
        ("smoothing_length", volume.text("kernel") == "sph", "kernel \"sph\"", "\"h\""),
        ("iso", surface, "mode \"isosurface\"", "0.5"),
        (
            "value_range",
            volume.text("mode") == "integral" && has("color_map"),
            "the colours of mode \"integral\"",
            "\"auto\"",
        ),
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

/// An isosurface is the object's only surface; that of a sum lies where there are points.
fn isosurface_fits(volume: &Reader<'_>) -> Result<(), Fault> {
    if volume.text("mode") != "isosurface" || volume.written("iso").is_none() {
        return Ok(());
    }
    let boundary = volume.text("boundary");
    if boundary != "none" {
        let message = format!(
            "found \"{boundary}\", expected \"none\" with mode \"isosurface\", which is the object's only \
             surface; remove it"
        );
        return Err(("boundary", message));
    }
    let (iso, kernel) = (volume.number("iso"), volume.text("kernel"));
    if kernel != "shepard" && iso <= 0.0 {
        let message = format!(
            "found {}, expected more than 0 with kernel \"{kernel}\", whose sum is 0 wherever no point is; \
             raise it",
            plain(iso)
        );
        return Err(("iso", message));
    }
    Ok(())
}

/// Only spheres and discs have a radius, only a surface leaves points over, and only noise is smoothed.
pub(crate) fn surface_has_no_key_in_vain(surface: &Reader<'_>) -> Result<(), Fault> {
    let kind = surface.text("kind");
    let of_shapes = kind != "points";
    let owned = [
        ("radius", of_shapes, "kind \"spheres\" or \"discs\""),
        ("radius_scale", of_shapes, "kind \"spheres\" or \"discs\""),
        ("scatter", !of_shapes, "kind \"points\""),
    ];
    for (name, fits, owner) in owned {
        if surface.written(name).is_some() && !fits {
            let message = format!("belongs to {owner}, but kind is \"{kind}\"; remove one");
            return Err((name, message));
        }
    }
    if let (Some(_), Some(key)) = (surface.written("accuracy"), key_of_points_as_they_are(surface))
    {
        let found = if key == "neighbors" { "is a number" } else { "is given" };
        let message = format!(
            "belongs to neighbors \"auto\", but {key} {found}, by which points are taken as they are; remove one"
        );
        return Err(("accuracy", message));
    }
    Ok(())
}

/// A stop without an emission has a colour and an extinction.
pub(crate) fn stop_shows_something(stop: &Reader<'_>) -> Result<(), Fault> {
    let has = |name: &str| stop.written(name).is_some();
    for (name, what, example) in [
        ("color", "three numbers from 0 to 1e15", "[0.0, 0.0, 1.0]"),
        ("extinction", "a number from 0 to 1e15", "0.0"),
    ] {
        if !has("emission") && !has(name) {
            let message = format!(
                "missing, expected {what}, or an emission without it; add e.g. {name} = {example}"
            );
            return Err((name, message));
        }
    }
    Ok(())
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

/// A logarithmic scale has positive ends.
fn range_fits_scale(table: &Reader<'_>) -> Result<(), Fault> {
    let is_auto =
        matches!(table.written("value_range").map(|node| &node.value), Some(Value::Text(_)));
    if table.text("scale") != "log" || is_auto {
        return Ok(());
    }
    let range = table.written_range("value_range");
    match range.and_then(|range| range.into_iter().find(|end| *end <= 0.0)) {
        Some(end) => Err((
            "value_range",
            format!(
                "found {} beside scale = \"log\", expected numbers over 0; raise it, or leave scale out",
                plain(end)
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
    range_fits_scale(material)?;
    for name in ["color_map", "value_range", "scale"] {
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

#[cfg(test)]
mod tests {
    use super::length;

    #[test]
    fn length_neither_overflows_nor_vanishes() {
        for (v, expected) in [([3e200, 0.0, -4e200], 5e200), ([0.0, 3e-200, 4e-200], 5e-200)] {
            // A division, a root and a product round once each.
            assert!((length(v) / expected - 1.0).abs() < 1e-15, "{v:?}");
        }
        assert_eq!(length([0.0, -0.0, 0.0]), 0.0);
    }
}
