//! `info` of a picture: windows, channels with their ranges, attributes, and where it comes from.

use crate::commands::compare_report::{exact, number};
use crate::errors::Failure;
use crate::memory;
use film::{ExrAttribute, ExrFile, ExrHeader, ExrPart, Raster, Samples};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::path::Path;

/// What provenance begins with.
const PREFIX: &str = "pointillist/";
/// Attributes that are told apart from the others.
const SHOWN_APART: [&str; 7] =
    ["channels", "compression", "dataWindow", "displayWindow", "lineOrder", "name", "tiles"];

/// Whether a file is for this command by its first bytes, or by its name where it is no EXR.
pub fn is_picture(path: &Path) -> bool {
    let named = |extension: &std::ffi::OsStr| {
        ["exr", "hdr", "jpeg", "jpg", "png"]
            .iter()
            .any(|known| extension.eq_ignore_ascii_case(known))
    };
    path.extension().is_some_and(named) || film::is_exr(path).unwrap_or(false)
}

/// The text or JSON of a picture.
pub fn of(path: &Path, as_json: bool) -> Result<String, Failure> {
    let named_exr = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"));
    if !film::is_exr(path)? && !named_exr {
        let raster = film::read_raster(path)?;
        return Ok(if as_json { pretty(&raster_json(&raster)) } else { raster_text(&raster) });
    }
    memory::require_pictures(&[path])?;
    let file = film::read_exr_file(path)?;
    let mut text = String::new();
    if as_json {
        return Ok(pretty(&exr_json(&file)));
    }
    // Writing to a string cannot fail.
    let _ = write_exr(&mut text, &file);
    Ok(text)
}

/// The values of one channel in short.
struct Range {
    /// Smallest and largest finite value, where there is one.
    finite: Option<[f64; 2]>,
    infinite: usize,
    nan: usize,
}

impl Range {
    fn of(samples: &Samples) -> Self {
        let mut range = Self { finite: None, infinite: 0, nan: 0 };
        for value in samples.iter() {
            if value.is_nan() {
                range.nan += 1;
            } else if value.is_infinite() {
                range.infinite += 1;
            } else {
                let [low, high] = range.finite.unwrap_or([value; 2]);
                range.finite = Some([low.min(value), high.max(value)]);
            }
        }
        range
    }

    fn shown(&self) -> String {
        let mut shown = match self.finite {
            Some([low, high]) => format!("{} to {}", exact(low), exact(high)),
            None => "no finite value".to_owned(),
        };
        for (count, what) in [(self.infinite, "infinite"), (self.nan, "NaN")] {
            if count > 0 {
                let _ = write!(shown, ", {count} {what}");
            }
        }
        shown
    }
}

fn write_exr(out: &mut String, file: &ExrFile) -> std::fmt::Result {
    let window =
        |[x, y]: [i32; 2], [width, height]: [u32; 2]| format!("{width}x{height} at {x},{y}");
    match file.parts.len() {
        1 => writeln!(out, "format   OpenEXR")?,
        count => writeln!(out, "format   OpenEXR, {count} parts")?,
    }
    writeln!(out, "display  {}", window(file.display_origin, file.display_size))?;
    for (part, index) in file.parts.iter().zip(0..) {
        if file.parts.len() > 1 {
            writeln!(out, "\npart {index} '{}'", part.name.as_deref().unwrap_or(""))?;
        }
        writeln!(out, "data     {}", window(part.data_origin, part.data_size))?;
        let shown = |name: &str| part.header.get(name).map(ExrAttribute::shown).unwrap_or_default();
        let blocks = match part.header.get("tiles") {
            Some(tiles) => format!("tiles of {}", tiles.shown()),
            None => "scan lines".to_owned(),
        };
        writeln!(out, "stored   {}, {blocks}, {}", shown("compression"), shown("lineOrder"))?;
        writeln!(out, "channels")?;
        let widest = part.channels.keys().map(|name| name.chars().count()).max().unwrap_or(0);
        for (name, samples) in &part.channels {
            let range = Range::of(samples).shown();
            writeln!(out, "  {name:<widest$}  {:<5}  {range}", samples.kind())?;
        }
        write_attributes(out, &part.header)?;
    }
    Ok(())
}

fn write_attributes(out: &mut String, header: &ExrHeader) -> std::fmt::Result {
    let (own, others): (Vec<&ExrAttribute>, Vec<_>) =
        header.attributes.iter().partition(|attribute| attribute.name.starts_with(PREFIX));
    let others = others.into_iter().filter(|a| !SHOWN_APART.contains(&a.name.as_str()));
    for (title, attributes) in [("attributes", others.collect()), ("provenance", own)] {
        if attributes.is_empty() {
            continue;
        }
        writeln!(out, "{title}")?;
        for attribute in attributes {
            let name = attribute.name.strip_prefix(PREFIX).unwrap_or(&attribute.name);
            let value = attribute.shown();
            if value.contains('\n') {
                writeln!(out, "  {name}")?;
                for line in value.lines() {
                    writeln!(out, "    {line}")?;
                }
            } else {
                writeln!(out, "  {name}  {value}")?;
            }
        }
    }
    Ok(())
}

fn exr_json(file: &ExrFile) -> Value {
    let window = |origin: [i32; 2], size: [u32; 2]| json!({ "origin": origin, "size": size });
    let provenance: Map<String, Value> = (file.parts.first().iter())
        .flat_map(|part| &part.header.attributes)
        .filter_map(|a| Some((a.name.strip_prefix(PREFIX)?.to_owned(), json!(a.shown()))))
        .collect();
    let part = |part: &ExrPart| {
        let shown = |name: &str| part.header.get(name).map(ExrAttribute::shown);
        let channels: Map<String, Value> = (part.channels.iter())
            .map(|(name, samples)| (name.clone(), channel_json(samples)))
            .collect();
        let attributes: Map<String, Value> = (part.header.attributes.iter())
            .map(|a| (a.name.clone(), json!({ "type": a.kind, "value": a.shown() })))
            .collect();
        json!({
            "name": part.name,
            "data_window": window(part.data_origin, part.data_size),
            "compression": shown("compression"),
            "line_order": shown("lineOrder"),
            "tiles": shown("tiles"),
            "channels": channels,
            "attributes": attributes,
        })
    };
    json!({
        "format": "OpenEXR",
        "display_window": window(file.display_origin, file.display_size),
        "parts": file.parts.iter().map(part).collect::<Vec<_>>(),
        "provenance": provenance,
    })
}

fn channel_json(samples: &Samples) -> Value {
    let range = Range::of(samples);
    let [min, max] = [0, 1].map(|end| range.finite.map(|values| number(values[end])));
    json!({
        "type": samples.kind(),
        "min": min,
        "max": max,
        "infinite": range.infinite,
        "nan": range.nan,
    })
}

fn raster_json(raster: &Raster) -> Value {
    json!({
        "format": "raster",
        "size": raster.size,
        "bits": raster.bits,
        "linear": raster.linear,
        "alpha": raster.alpha,
    })
}

fn raster_text(raster: &Raster) -> String {
    let [width, height] = raster.size;
    let (bits, kind) = (raster.bits, if raster.linear { "float, linear" } else { "integer, sRGB" });
    let alpha = if raster.alpha { "with alpha" } else { "without alpha" };
    format!("size     {width}x{height}\nvalues   {bits}-bit {kind}, {alpha}\n")
}

fn pretty(value: &Value) -> String {
    format!("{value:#}\n")
}
