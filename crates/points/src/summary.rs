//! What `pointillist info` tells about a point file.

use crate::set::PointSet;
use serde_json::{Map, Value, json};
use std::fmt;

/// Counts, ranges and the box of a point set, in the file's own coordinates and units.
#[derive(Debug, Clone, PartialEq)]
pub struct PointSummary {
    /// The file format in words.
    pub format: String,
    /// Points that a render would use: those with a finite position, duplicates included.
    pub points: u64,
    /// Points that were dropped.
    pub dropped: Dropped,
    /// Points with a finite position that a filter left out.
    pub filtered_out: u64,
    /// Smallest coordinate along each axis.
    pub min: [f64; 3],
    /// Largest coordinate along each axis.
    pub max: [f64; 3],
    /// Name and range of everything else a point has: normals as `nx`, `ny`, `nz`, colours as
    /// `red`, `green`, `blue` in the file's units, then the attributes in the order of the file.
    pub attributes: Vec<(String, Range, Histogram)>,
    /// Median distance to the nearest other point; 0 for duplicates, `None` for a single point.
    pub spacing: Option<f64>,
    /// What the reader assumed or left out ([`PointSet::notes`]).
    pub notes: Vec<String>,
}

/// How many points were dropped, and why.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dropped {
    /// For a coordinate that is infinite or not a number.
    pub non_finite: u64,
    /// Because the file itself calls them invalid.
    pub invalid: u64,
}

impl Dropped {
    /// In all.
    pub fn count(self) -> u64 {
        self.non_finite + self.invalid
    }
}

/// Smallest and largest of some values, of those that are numbers; `None` if none is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range(pub Option<(f64, f64)>);

impl PointSummary {
    /// Summarises a point set. `spacing` is the median distance to the nearest other point, which
    /// takes a search that is not done here.
    pub fn new(set: &PointSet, spacing: Option<f64>) -> Self {
        let (min, max) = set.bounds().unwrap_or(([f64::NAN; 3], [f64::NAN; 3]));
        let mut attributes = Vec::new();
        if let Some(normals) = &set.normals {
            for (axis, name) in ["nx", "ny", "nz"].into_iter().enumerate() {
                let values = normals.iter().map(|normal| f64::from(normal[axis]));
                attributes.push(described(name, values));
            }
        }
        if let (Some(colors), Some(encoding)) = (&set.colors, set.color_encoding) {
            for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
                let stored = colors.iter().map(|color| encoding.encode(color[channel]));
                attributes.push(described(name, stored));
            }
        }
        for attribute in &set.attributes {
            attributes.push(described(&attribute.name, attribute.values.iter()));
        }
        Self {
            format: set.format.clone(),
            points: set.len() as u64,
            dropped: Dropped { non_finite: set.non_finite, invalid: set.invalid },
            filtered_out: set.filtered_out,
            min,
            max,
            attributes,
            spacing,
            notes: set.notes.clone(),
        }
    }

    /// The middle of the box, which a render of these points alone subtracts from them before it goes
    /// on in 32 bits.
    pub fn origin(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| 0.5 * self.min[axis] + 0.5 * self.max[axis])
    }

    /// The summary as `pointillist info --json` prints it. What JSON has no number for is `null`.
    pub fn to_json(&self) -> Value {
        let Dropped { non_finite, invalid } = self.dropped;
        let reasons: Map<String, Value> =
            [("non-finite position", non_finite), ("invalid", invalid)]
                .into_iter()
                .filter(|&(_, count)| count > 0)
                .map(|(reason, count)| (reason.to_owned(), json!(count)))
                .collect();
        let attributes: Map<String, Value> = self
            .attributes
            .iter()
            .map(|(name, range, Histogram { low, high, counts })| {
                let (min, max) = range.0.unzip();
                let histogram = json!({ "low": low, "high": high, "counts": counts });
                (name.clone(), json!({ "min": min, "max": max, "histogram": histogram }))
            })
            .collect();
        json!({
            "format": self.format,
            "points": self.points,
            "filtered_out": self.filtered_out,
            "dropped": { "count": self.dropped.count(), "reasons": reasons },
            "bounds": { "min": self.min, "max": self.max },
            "origin": self.origin(),
            "attributes": attributes,
            "spacing": self.spacing,
            "notes": self.notes,
        })
    }
}

/// How often values lie where, between the lowest finite one and the highest.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// Lower end of the first part; 0 where no value is finite.
    pub low: f64,
    /// Upper end of the last part.
    pub high: f64,
    /// Values in each of the even parts; an end between two counts for the upper one.
    pub counts: [u64; BINS],
}

/// Parts of a histogram.
const BINS: usize = 16;
/// Characters of its longest bar.
const BAR: u64 = 40;

/// What is told about some values.
fn described(name: &str, values: impl Iterator<Item = f64> + Clone) -> (String, Range, Histogram) {
    (name.to_owned(), Range::of(values.clone()), Histogram::of(values))
}

impl Histogram {
    /// The histogram of some values. Those that are not finite are passed over.
    pub fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let finite = values.filter(|value| value.is_finite());
        let (low, high) = Range::of(finite.clone()).0.unwrap_or_default();
        let mut counts = [0; BINS];
        // Halves, so that no difference of two numbers overflows.
        let span = 0.5 * high - 0.5 * low;
        for value in finite {
            let part = if span > 0.0 { (0.5 * value - 0.5 * low) / span } else { 0.0 };
            // The highest value is in the last part.
            counts[((part * BINS as f64) as usize).min(BINS - 1)] += 1;
        }
        Self { low, high, counts }
    }
}

impl fmt::Display for Histogram {
    /// One line a part: its lower end, how many, and a bar.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let most = self.counts.iter().copied().max().unwrap_or(0).max(1);
        let width = most.to_string().len();
        for (bin, &count) in self.counts.iter().enumerate() {
            let part = bin as f64 / BINS as f64;
            let from = self.low * (1.0 - part) + self.high * part;
            // What is there at all shows.
            let bar = "#".repeat((count * BAR).div_ceil(most) as usize);
            let line = format!("{from:>12.5e}  {count:width$}  {bar}");
            write!(f, "\n      {}", line.trim_end())?;
        }
        Ok(())
    }
}

impl Range {
    /// The range of some values. NaN is passed over.
    pub fn of(values: impl Iterator<Item = f64>) -> Self {
        Self(values.filter(|value| !value.is_nan()).fold(None, |range, value| match range {
            None => Some((value, value)),
            Some((min, max)) => Some((value.min(min), value.max(max))),
        }))
    }
}

impl fmt::Display for PointSummary {
    /// As `pointillist info` prints it: one line a fact, without a newline at the end.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let corner = |[x, y, z]: [f64; 3]| format!("{x} {y} {z}");
        writeln!(f, "format   {}", self.format)?;
        for note in &self.notes {
            writeln!(f, "note     {note}")?;
        }
        match self.filtered_out {
            0 => writeln!(f, "points   {}", self.points)?,
            out => writeln!(f, "points   {} of {}", self.points, self.points + out)?,
        }
        let Dropped { non_finite, invalid } = self.dropped;
        if non_finite > 0 {
            writeln!(f, "dropped  {non_finite} (position infinite or not a number)")?;
        }
        if invalid > 0 {
            writeln!(f, "dropped  {invalid} (marked invalid in the file)")?;
        }
        writeln!(f, "min      {}", corner(self.min))?;
        writeln!(f, "max      {}", corner(self.max))?;
        writeln!(f, "origin   {} (subtracted by a render)", corner(self.origin()))?;
        match self.spacing {
            Some(spacing) => write!(f, "spacing  {spacing} (median to the nearest other point)")?,
            None => write!(f, "spacing  none (a single point)")?,
        }
        if self.attributes.is_empty() {
            return Ok(());
        }
        write!(f, "\nattributes")?;
        let width =
            self.attributes.iter().map(|(name, ..)| name.chars().count()).max().unwrap_or(0);
        for (name, range, histogram) in &self.attributes {
            match range.0 {
                Some((min, max)) => write!(f, "\n  {name:width$}  {min} .. {max}")?,
                None => write!(f, "\n  {name:width$}  not a number")?,
            }
            // One value has no distribution.
            if histogram.low < histogram.high {
                write!(f, "{histogram}")?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::set::{Attribute, ColorEncoding, Values};

    fn set() -> PointSet {
        let encoding = ColorEncoding::Srgb8;
        PointSet {
            positions: vec![[1.0, -2.0, 0.1], [0.5, 4.0, 636_001.76]],
            file_index: vec![0, 2],
            colors: Some(vec![
                [3.0, 20.0, 255.0].map(|stored| encoding.decode(stored)),
                [17.0, 20.0, 0.0].map(|stored| encoding.decode(stored)),
            ]),
            color_encoding: Some(encoding),
            normals: Some(vec![[0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
            attributes: vec![
                Attribute { name: "h".to_owned(), values: Values::F32(vec![f32::NAN, 2.5]) },
                Attribute { name: "none".to_owned(), values: Values::F64(vec![f64::NAN; 2]) },
            ],
            non_finite: 1,
            format: "PLY 1.0, ascii".to_owned(),
            ..PointSet::default()
        }
    }

    #[test]
    fn json_has_what_was_promised() {
        let json = PointSummary::new(&set(), Some(0.25)).to_json();
        let expected = json!({
            "format": "PLY 1.0, ascii",
            "points": 2,
            "filtered_out": 0,
            "dropped": { "count": 1, "reasons": { "non-finite position": 1 } },
            "bounds": { "min": [0.5, -2.0, 0.1], "max": [1.0, 4.0, 636_001.76] },
            "origin": [0.75, 1.0, 318_000.93],
            "spacing": 0.25,
            "notes": [],
        });
        let mut others = json.clone();
        let attributes = others.as_object_mut().unwrap().remove("attributes").unwrap();
        assert_eq!(others, expected);
        let ends: Vec<(&str, Value, Value)> = (attributes.as_object().unwrap().iter())
            .map(|(name, of)| (name.as_str(), of["min"].clone(), of["max"].clone()))
            .collect();
        let of = |name, min: f64, max: f64| (name, json!(min), json!(max));
        let expected = [
            of("blue", 0.0, 255.0),
            of("green", 20.0, 20.0),
            of("h", 2.5, 2.5),
            ("none", Value::Null, Value::Null),
            of("nx", 0.0, 0.0),
            of("ny", -1.0, 0.0),
            of("nz", 0.0, 1.0),
            of("red", 3.0, 17.0),
        ];
        let mut ends = ends;
        ends.sort_by_key(|(name, ..)| *name);
        assert_eq!(ends, expected);
        let blue = &attributes["blue"]["histogram"];
        assert_eq!(
            *blue,
            json!({ "low": 0.0, "high": 255.0, "counts":
            [1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1] })
        );
        let none = &attributes["none"]["histogram"];
        assert_eq!(*none, json!({ "low": 0.0, "high": 0.0, "counts": vec![0; BINS] }));
    }

    /// 0 to 159 in sixteen parts of 9.9375: each has its tens but for what the ends round.
    #[test]
    fn a_histogram_counts_every_finite_value_once() {
        let values = (0..160).map(f64::from).chain([f64::NAN, f64::INFINITY]);
        let histogram = Histogram::of(values);
        assert_eq!((histogram.low, histogram.high), (0.0, 159.0));
        assert_eq!(histogram.counts, [10; BINS]);
        let text = histogram.to_string();
        assert_eq!(text.lines().count(), BINS + 1);
        assert!(text.contains("   9.93750e0  10  ####"), "{text}");
        let far = Histogram::of([-f64::MAX, f64::MAX].into_iter());
        assert_eq!((far.counts[0], far.counts[BINS - 1]), (1, 1));
    }

    #[test]
    fn nothing_dropped_has_no_reasons() {
        let set = PointSet { non_finite: 0, ..set() };
        let json = PointSummary::new(&set, None).to_json();
        assert_eq!(json["dropped"], json!({ "count": 0, "reasons": {} }));
        assert_eq!(json["spacing"], Value::Null);
    }

    #[test]
    fn text_names_every_attribute() {
        let text = PointSummary::new(&set(), Some(0.25)).to_string();
        for line in
            ["points   2", "min      0.5 -2 0.1", "  red    3 .. 17", "  none   not a number"]
        {
            assert!(text.lines().any(|found| found == line), "no '{line}' in\n{text}");
        }
    }
}
