//! What `compare` found, as a table and as JSON.

use crate::args::CompareArgs;
use compare::{AttributeDifference, Flip, Measures, PERCENTILES, PIXELS_PER_DEGREE, Rect};
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// Everything that is said of two pictures.
pub struct Report {
    /// The files as typed.
    pub names: [String; 2],
    /// Width and height of both display windows.
    pub size: [u32; 2],
    /// Whether values are integers in sRGB, over their largest.
    pub srgb: bool,
    /// Each channel that was compared.
    pub channels: Vec<Measured>,
    /// Each layer that has several of them.
    pub layers: Vec<Measured>,
    /// FLIP of the colours, where they were compared and FLIP was not left out.
    pub flip: Option<SeenFlip>,
    /// Why there is no FLIP, and how to have it, where there is none.
    pub flip_why: Option<String>,
    /// Channels that only the first, and only the second has.
    pub unmatched: [Vec<String>; 2],
    /// What differs in the headers.
    pub differing: Vec<AttributeDifference>,
    /// Whether that was asked for.
    pub list_headers: bool,
    /// What is over which limit.
    pub over: Vec<String>,
}

/// A channel or layer.
pub struct Measured {
    pub name: String,
    /// The pixels that were compared.
    pub region: Rect,
    pub measures: Measures,
}

/// FLIP of three channels.
pub struct SeenFlip {
    pub colors: [String; 3],
    pub region: Rect,
    /// Of the pictures' own range.
    pub flip: Flip,
    /// As a screen shows them, where that is another.
    pub on_screen: Option<Flip>,
}

/// Longest text of an attribute in the table, in characters.
const LONGEST: usize = 60;

impl Report {
    /// For readers.
    pub fn text(&self, args: &CompareArgs) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write(&mut text, args);
        text
    }

    fn write(&self, out: &mut String, args: &CompareArgs) -> std::fmt::Result {
        let [width, height] = self.size;
        writeln!(out, "a        {}\nb        {}", self.names[0], self.names[1])?;
        let unit = if self.srgb { "sRGB, 1 at full intensity" } else { "linear" };
        writeln!(out, "size     {width}x{height}, colours {unit}")?;
        // Parts of a file may have data windows of their own; mostly one line says it, or none.
        let mut told = Rect { x: 0, y: 0, width: width.into(), height: height.into() };
        for Measured { name, region, .. } in &self.channels {
            if *region != told {
                told = *region;
                let Rect { x, y, width, height } = region;
                writeln!(out, "compared {width}x{height} at {x},{y} from channel {name} on")?;
            }
        }
        writeln!(out)?;
        out.push_str(&self.table());
        writeln!(out)?;
        match (&self.flip, &self.flip_why) {
            (Some(seen), _) => writeln!(out, "{}", flip_line(seen))?,
            (None, why) => writeln!(out, "FLIP     {}", why.as_deref().unwrap_or("none"))?,
        }
        for (names, which) in self.unmatched.iter().zip(["a", "b"]) {
            if !names.is_empty() {
                writeln!(out, "only {which}   {}: not compared", names.join(", "))?;
            }
        }
        self.write_headers(out)?;
        for line in &self.over {
            writeln!(out, "over     {line}")?;
        }
        let limits = [args.max_abs, args.rmse, args.flip_limit()].iter().any(Option::is_some)
            || args.headers;
        let verdict = match (self.over.is_empty(), limits) {
            (false, _) => "fail",
            (true, true) => "pass",
            (true, false) => "pass, since no limit was given",
        };
        writeln!(out, "result   {verdict}")
    }

    /// One row a channel, then one a layer.
    fn table(&self) -> String {
        let mut rows =
            vec![["channel", "max abs", "mean", "RMSE", "PSNR dB"].map(str::to_owned).to_vec()];
        rows[0].extend(PERCENTILES.map(|percent| format!("{percent} %")));
        rows[0].extend(["differ", "worst at", "a", "b"].map(str::to_owned));
        let layers = self.layers.iter().map(|layer| (format!("({})", layer.name), layer));
        let channels = self.channels.iter().map(|channel| (channel.name.clone(), channel));
        for (name, Measured { measures: m, .. }) in channels.chain(layers) {
            let mut row = vec![name, short(m.max_abs), short(m.mean), short(m.rmse)];
            row.push(if m.psnr.is_finite() { format!("{:.2}", m.psnr) } else { short(m.psnr) });
            row.extend(m.percentiles.map(short));
            let place = format!("{},{}", m.worst.x, m.worst.y);
            row.extend([m.differing.to_string(), place, exact(m.worst.a), exact(m.worst.b)]);
            rows.push(row);
        }
        let widths: Vec<usize> = (0..rows[0].len())
            .map(|column| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0))
            .collect();
        let line = |row: &Vec<String>| {
            let cells = row.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| {
                if column == 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
            });
            cells.collect::<Vec<_>>().join("  ") + "\n"
        };
        rows.iter().map(line).collect()
    }

    fn write_headers(&self, out: &mut String) -> std::fmt::Result {
        if !self.list_headers {
            return match self.differing.len() {
                0 => Ok(()),
                1 => writeln!(out, "headers  1 attribute differs, see --headers"),
                count => writeln!(out, "headers  {count} attributes differ, see --headers"),
            };
        }
        for difference in &self.differing {
            let AttributeDifference { part, name, a, b } = difference;
            let part = if *part > 0 { format!(" of part {part}") } else { String::new() };
            let [a, b] = changed_line(a.as_deref(), b.as_deref());
            writeln!(out, "header   {name}{part}: {a} against {b}")?;
        }
        Ok(())
    }

    /// For programs. Numbers that JSON has not are the strings "Infinity", "-Infinity" and "NaN".
    pub fn json(&self, args: &CompareArgs) -> String {
        let named = |list: &[Measured]| -> Map<String, Value> {
            list.iter().map(|measured| (measured.name.clone(), measured_json(measured))).collect()
        };
        let mut layers = named(&self.layers);
        for layer in &self.layers {
            if let Some(fields) = layers.get_mut(&layer.name) {
                fields["worst_channel"] = json!(layer.measures.worst.channel);
            }
        }
        let mut object = json!({
            "pass": self.over.is_empty(),
            "a": self.names[0],
            "b": self.names[1],
            "size": self.size,
            "encoding": if self.srgb { "srgb" } else { "linear" },
            "channels": named(&self.channels),
            "layers": layers,
            "flip": self.flip.as_ref().map(|seen| number(seen.flip.mean)),
            "flip_why": self.flip_why,
            "flip_details": self.flip.as_ref().map(flip_json),
            "only_a": self.unmatched[0],
            "only_b": self.unmatched[1],
            "limits": { "max_abs": args.max_abs, "rmse": args.rmse, "flip": args.flip_limit() },
            "over": self.over,
        });
        if self.list_headers {
            let attribute = |d: &AttributeDifference| json!({ "part": d.part, "name": d.name, "a": d.a, "b": d.b });
            object["headers"] = self.differing.iter().map(attribute).collect();
        }
        format!("{object:#}\n")
    }
}

fn measured_json(Measured { region, measures: m, .. }: &Measured) -> Value {
    json!({
        "max_abs": number(m.max_abs),
        "mean": number(m.mean),
        "rmse": number(m.rmse),
        "psnr": number(m.psnr),
        "peak": number(m.peak),
        "percentiles": percentiles_json(&m.percentiles),
        "values": m.values,
        "differing": m.differing,
        "nan": m.nan,
        "worst": [json!(m.worst.x), json!(m.worst.y), number(m.worst.a), number(m.worst.b)],
        "region": [region.x, region.y, region.width, region.height],
    })
}

fn flip_json(seen: &SeenFlip) -> Value {
    let of = |flip: &Flip| {
        let exposures = flip
            .exposures
            .map(|([first, last], count)| json!({ "first": first, "last": last, "count": count }));
        json!({
            "mean": number(flip.mean),
            "max": number(flip.max),
            "percentiles": percentiles_json(&flip.percentiles),
            "exposures": exposures,
        })
    };
    let mut details = of(&seen.flip);
    details["kind"] = json!(if seen.flip.exposures.is_some() { "hdr" } else { "ldr" });
    details["channels"] = json!(seen.colors);
    details["pixels_per_degree"] = json!(PIXELS_PER_DEGREE);
    details["ldr"] = seen.on_screen.as_ref().map_or(Value::Null, of);
    details
}

fn percentiles_json(values: &[f64; PERCENTILES.len()]) -> Value {
    let named = PERCENTILES.iter().zip(values);
    named
        .map(|(percent, value)| (percent.to_string(), number(*value)))
        .collect::<Map<_, _>>()
        .into()
}

/// JSON has no infinities and no NaN: these become the strings that JavaScript, Python and others parse
/// as such.
pub fn number(value: f64) -> Value {
    match value {
        f64::INFINITY => json!("Infinity"),
        f64::NEG_INFINITY => json!("-Infinity"),
        value if value.is_nan() => json!("NaN"),
        value => json!(value),
    }
}

fn flip_line(seen: &SeenFlip) -> String {
    let of = |flip: &Flip| {
        let [half, most, nearly_all] = flip.percentiles.map(short);
        format!(
            "mean {}, 50 % {half}, 95 % {most}, 99 % {nearly_all}, max {}",
            short(flip.mean),
            short(flip.max)
        )
    };
    match (&seen.flip.exposures, &seen.on_screen) {
        (Some(([first, last], count)), Some(on_screen)) => format!(
            "HDR-FLIP {} ({count} exposures from {first:.2} to {last:.2} stops)\nLDR-FLIP {}",
            of(&seen.flip),
            of(on_screen)
        ),
        _ => format!("LDR-FLIP {}", of(&seen.flip)),
    }
}

/// Five digits, for tables.
fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if size.is_infinite() || value.is_nan() => exact(value),
        size if (1e-3..1e5).contains(&size) => {
            let decimals = 4 - size.log10().floor() as i32;
            format!("{value:.*}", decimals.max(0) as usize)
        }
        _ => format!("{value:.4e}"),
    }
}

/// The shortest decimal that parses back to the same number, of a file's f32 in particular.
pub fn exact(value: f64) -> String {
    let single = value as f32;
    if f64::from(single) == value { format!("{single:?}") } else { format!("{value:?}") }
}

/// Both values in one short line each: of texts with several lines, the first that differs.
fn changed_line(a: Option<&str>, b: Option<&str>) -> [String; 2] {
    let (Some(a), Some(b)) = (a, b) else {
        return [a, b].map(|value| value.map_or_else(|| "nothing".to_owned(), quoted));
    };
    let lines = || a.lines().map(Some).chain([None]).zip(b.lines().map(Some).chain([None]));
    let changed = lines().find(|(a, b)| a != b).unwrap_or((Some(a), Some(b)));
    let several = a.lines().count().max(b.lines().count()) > 1;
    match changed {
        (a, b) if several => [a, b].map(|line| line.map_or_else(|| "its end".to_owned(), quoted)),
        _ => [quoted(a), quoted(b)],
    }
}

fn quoted(text: &str) -> String {
    let mut line: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if let Some((cut, _)) = line.char_indices().nth(LONGEST) {
        line.truncate(cut);
        line.push_str(" ...");
    }
    format!("'{line}'")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_in_tables_and_exact_where_they_are_a_files() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1.0000"),
            (0.001_234_56, "0.0012346"),
            (99_999.4, "99999"),
            (123_456.0, "1.2346e5"),
            (1e-5, "1.0000e-5"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(short(value), expected);
        }
        assert_eq!(exact(f64::from(0.1f32)), "0.1");
        assert_eq!(exact(0.1), "0.1");
        assert_eq!(exact(4_294_967_295.0), "4294967295.0");
        assert_eq!(exact(f64::NAN), "NaN");
    }

    #[test]
    fn the_first_line_that_differs_is_shown() {
        let shown = |a, b| changed_line(a, b).join(" | ");
        assert_eq!(shown(Some("x"), Some("y")), "'x' | 'y'");
        assert_eq!(shown(Some("x"), None), "'x' | nothing");
        assert_eq!(shown(Some("a\nb\nc"), Some("a\nd\nc")), "'b' | 'd'");
        assert_eq!(shown(Some("a\nb"), Some("a")), "'b' | its end");
        assert_eq!(shown(Some("a\n"), Some("a")), "'a ' | 'a'");
        let long = "ü".repeat(100);
        assert!(shown(Some(&long), None).starts_with(&format!("'{} ...'", "ü".repeat(60))));
    }
}
