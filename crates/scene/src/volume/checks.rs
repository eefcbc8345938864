//! What keys of a volume say together.

use super::keys::TRANSFER;
use crate::color_map::range_fits_scale;
use crate::document::Value;
use crate::keys::{Fault, plain};
use crate::read::Reader;

/// What a volume shows is stated once, and each kernel and mode has its keys.
pub(super) fn volume_says_it_once(volume: &Reader<'_>) -> Result<(), Fault> {
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
        (
            "anisotropy",
            volume.text("shading") == "scatter",
            "shading \"scatter\", but shading is another",
        ),
    ];
    isosurface_fits(volume)?;
    let smoothing = volume.written("smoothing").map(|node| &node.value);
    let is_number = matches!(smoothing, Some(Value::Integer(_) | Value::Float(_)));
    let is_adaptive = matches!(volume.value("radius"), Value::Text(text) if text == "adaptive");
    if is_adaptive && is_number {
        let message = "found a number beside radius = \"adaptive\", where each point has a smoothing of its own; remove it";
        return Err(("smoothing", message.into()));
    }
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

/// A stop without an emission has a colour and an extinction.
pub(super) fn stop_shows_something(stop: &Reader<'_>) -> Result<(), Fault> {
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
pub(super) fn stops_ascend(volume: &Reader<'_>) -> Result<(), Fault> {
    let values: Vec<f64> =
        (volume.tables("transfer", &TRANSFER).iter()).map(|stop| stop.number("value")).collect();
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
