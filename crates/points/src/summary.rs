//! What `pointillist info` tells about a point file.

mod bulk;
mod columns;
mod histogram;
mod passes;

pub use histogram::{Histogram, Range};
pub use passes::summarize;

use crate::cloud::origin_of;
use crate::denoise::NoiseReport;
use crate::dimension::Dimension;
use crate::sensor::Sensor;
use crate::strays::Apart;
use crate::units::Units;
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
    /// The box around all points but strays, by its lowest and highest corner: what a render frames.
    pub bulk: [[f64; 3]; 2],
    /// The strays, if there are any.
    pub apart: Option<Apart>,
    /// Name and range of everything else a point has: normals as `nx`, `ny`, `nz`, colours as
    /// `red`, `green`, `blue` in the file's units, then the attributes in the order of the file.
    pub attributes: Vec<(String, Range, Histogram)>,
    /// Points at the place of an earlier one.
    pub coincident: u64,
    /// Whether these were counted. In files of over four million positions they are estimated.
    pub coincident_counted: bool,
    /// Median distance of positions to the nearest other one, coincident points being one position; `None`
    /// where there is a single position.
    pub spacing: Option<f64>,
    /// How many positions it is the median of, if not of all.
    pub spacing_sample: Option<u64>,
    /// What the reader assumed or left out ([`PointSet::notes`]).
    pub notes: Vec<String>,
    /// What x and y are.
    pub units: Units,
    /// What the points fill; `None` where nobody has [looked](Dimension::of), which takes all points at once.
    pub dimension: Option<Dimension>,
    /// The noise of points on surfaces; `None` where nobody has looked, or there are too few.
    pub noise: Option<NoiseReport>,
    /// Where the scans were taken from, as far as that is known.
    pub sensors: Vec<Sensor>,
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

/// Sensors that are shown in text.
const SHOWN_SENSORS: usize = 8;

impl PointSummary {
    /// The middle of the bulk's box, which a render of only these points subtracts from them before it goes
    /// on in 32 bits.
    pub fn origin(&self) -> [f64; 3] {
        origin_of(self.bulk)
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
            "bulk": { "min": self.bulk[0], "max": self.bulk[1] },
            "strays": self.apart.as_ref().map(|apart| json!({
                "count": apart.count,
                "counted": apart.is_counted,
                "farthest": apart.farthest,
            })),
            "origin": self.origin(),
            "attributes": attributes,
            "coincident": self.coincident,
            "coincident_counted": self.coincident_counted,
            "spacing": self.spacing,
            "spacing_sample": self.spacing_sample,
            "notes": self.notes,
            "units": match self.units {
                Units::Degrees(_) => "degrees",
                Units::Lengths | Units::LikeDegrees => "lengths",
            },
            "noise": self.noise.map(|noise| noise.to_json()),
            "shape": self.dimension.map(|dimension| json!({
                "volume": dimension.is_volume(),
                "sign": match dimension {
                    Dimension::Surface => None,
                    Dimension::Volume(sign) => Some(sign.to_string()),
                },
            })),
            "sensors": self.sensors.iter().map(|sensor| json!({
                "position": sensor.position,
                "right": sensor.axes[0],
                "up": sensor.axes[1],
                "ahead": sensor.axes[2],
                "first_point": sensor.points.start,
                "points": sensor.points.len(),
                "columns": sensor.image.map(|[columns, _]| columns),
                "rows": sensor.image.map(|[_, rows]| rows),
            })).collect::<Vec<_>>(),
        })
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
        if self.coincident > 0 {
            let about = if self.coincident_counted { "" } else { "about " };
            writeln!(
                f,
                "coincide {about}{} (points at the place of an earlier one)",
                self.coincident
            )?;
        }
        writeln!(f, "min      {}", corner(self.min))?;
        writeln!(f, "max      {}", corner(self.max))?;
        if let Some(apart) = &self.apart {
            writeln!(f, "bulk     {} to {}", corner(self.bulk[0]), corner(self.bulk[1]))?;
            writeln!(f, "strays   {apart}")?;
        }
        writeln!(f, "origin   {} (subtracted by a render)", corner(self.origin()))?;
        match (self.spacing, self.spacing_sample) {
            (None, _) => write!(f, "spacing  none (a single position)")?,
            (Some(spacing), None) => {
                write!(f, "spacing  {spacing} (median to the nearest other position)")?
            }
            (Some(spacing), Some(sample)) => write!(
                f,
                "spacing  {spacing} (median to the nearest other position, of {sample} positions)"
            )?,
        }
        if let Units::Degrees(reason) = &self.units {
            write!(f, "\nunits    longitude and latitude in degrees, since {reason}")?;
        }
        if let Some(dimension) = &self.dimension {
            write!(f, "\nshape    {dimension}")?;
        }
        if let Some(noise) = &self.noise {
            write!(f, "\nnoise    {noise}")?;
        }
        for Sensor { position, points, image, .. } in self.sensors.iter().take(SHOWN_SENSORS) {
            write!(f, "\nsensor   at {}, {} points", corner(*position), points.len())?;
            if let Some([columns, rows]) = image {
                write!(f, " in {columns} columns and {rows} rows")?;
            }
        }
        if self.sensors.len() > SHOWN_SENSORS {
            let others = self.sensors.len() - SHOWN_SENSORS;
            write!(f, "\n         and {others} others, which --json lists")?;
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
    use crate::sensor::CAMERA;
    use crate::set::{Attribute, ColorEncoding, PointSet, Values};
    use histogram::BINS;

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
            sensors: vec![Sensor {
                position: [7.0, 8.0, 9.0],
                axes: CAMERA,
                points: 0..3,
                image: Some([3, 1]),
            }],
            ..PointSet::default()
        }
    }

    #[test]
    fn json_has_what_was_promised() {
        let json = PointSummary::of(&set()).to_json();
        let expected = json!({
            "format": "PLY 1.0, ascii",
            "points": 2,
            "filtered_out": 0,
            "dropped": { "count": 1, "reasons": { "non-finite position": 1 } },
            "bounds": { "min": [0.5, -2.0, 0.1], "max": [1.0, 4.0, 636_001.76] },
            "bulk": { "min": [0.5, -2.0, 0.1], "max": [1.0, 4.0, 636_001.76] },
            "strays": null,
            "origin": [0.75, 1.0, 318_000.93],
            "coincident": 0,
            "coincident_counted": true,
            "spacing": (0.25f64 + 36.0 + 636_001.66 * 636_001.66).sqrt(),
            "spacing_sample": null,
            "notes": [],
            "units": "lengths",
            "noise": null,
            "shape": null,
            "sensors": [{
                "position": [7.0, 8.0, 9.0],
                "right": [1.0, 0.0, 0.0],
                "up": [0.0, -1.0, 0.0],
                "ahead": [0.0, 0.0, 1.0],
                "first_point": 0,
                "points": 3,
                "columns": 3,
                "rows": 1,
            }],
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

    #[test]
    fn nothing_dropped_has_no_reasons() {
        let set = PointSet { non_finite: 0, ..set() };
        let json = PointSummary::of(&set).to_json();
        assert_eq!(json["dropped"], json!({ "count": 0, "reasons": {} }));
    }

    #[test]
    fn text_names_every_attribute() {
        let text = PointSummary::of(&set()).to_string();
        for line in [
            "points   2",
            "sensor   at 7 8 9, 3 points in 3 columns and 1 rows",
            "min      0.5 -2 0.1",
            "  red    3 .. 17",
            "  none   not a number",
        ] {
            assert!(text.lines().any(|found| found == line), "no '{line}' in\n{text}");
        }
    }
}
