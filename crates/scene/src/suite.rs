//! Suites of benchmarks: which scenes are timed, under which names, and what is varied.

use crate::SceneError;
use crate::check::check_as;
use crate::document::{Node, Value};
use crate::error::Source;
use crate::load::{document_of, read_text};
use crate::read::Reader;
use crate::suite_keys::{ROWS, SUITE};
use std::path::{Path, PathBuf};

/// Names of [`Shape`]s, in their order.
pub(crate) const SHAPES: [&str; 4] = ["sphere", "torus", "hills", "cube"];

/// Names of [`SimulatedScan`]s, in their order.
pub(crate) const SCANS: [&str; 5] = ["depth", "tls1", "tls3", "tls10", "photo"];

/// A file of benchmarks, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Suite {
    /// What it measures.
    pub about: String,
    /// At least one, each with a name of its own.
    pub rows: Vec<SuiteRow>,
}

/// A scene to be timed.
#[derive(Debug, Clone, PartialEq)]
pub struct SuiteRow {
    /// In tables.
    pub name: String,
    /// Scene file or point file.
    pub scene: PathBuf,
    /// `PATH=VALUE`, as [`Scene::load`](crate::Scene::load) takes them.
    pub set: Vec<String>,
    /// A row for each; empty: as the scene has it.
    pub cells_per_pass: Vec<u32>,
    /// Points to be made instead of those of the first object.
    pub generate: Option<Shape>,
    /// How many: a row for each. Empty where none are made.
    pub point_counts: Vec<u32>,
    /// A scan to be made instead of the points of the first object.
    pub scan: Option<SimulatedScan>,
    /// Points of a surface that are filled where the first object's are missing: where they are, if anywhere.
    pub fill: Option<PathBuf>,
    /// An earlier row, over whose planning and building that of this one is stated.
    pub over: Option<String>,
    /// Milliseconds a frame that the paper states.
    pub paper_ms: Option<f64>,
    /// What to do where a model is missing.
    pub if_missing: Option<String>,
}

/// A surface to spread points over, or a body to fill with them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Of radius 1 about the origin.
    Sphere,
    /// About the y axis, with radii 1 and 0.4.
    Torus,
    /// Over a square of side 1 in the plane y = 0, level where they meet the origin.
    Hills,
    /// At random in the cube of side 2 about the origin, with a scalar `density`.
    Cube,
}

/// A simulated scan of a room.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SimulatedScan {
    /// By a depth camera.
    Depth,
    /// By a laser scanner with noise of 1 ‰ of the distance.
    Tls1,
    /// The same with 3 ‰.
    Tls3,
    /// The same with 10 ‰.
    Tls10,
    /// By photogrammetry.
    Photo,
}

impl Suite {
    /// Reads and checks a suite. Opens none of its scenes.
    ///
    /// # Errors
    /// All that is wrong, by line.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        Self::from_toml(&read_text(path)?, path)
    }

    /// Checks a suite's text as if it were read from `file`, from whose folder its paths start.
    ///
    /// # Errors
    /// All that is wrong, by line.
    pub fn from_toml(text: &str, file: &Path) -> Result<Self, SceneError> {
        let document = document_of(text, file)?;
        let problems = check_as(&document, &SUITE);
        if !problems.is_empty() {
            return Err(SceneError::problems(problems, &Source { file, text, overrides: &[] }));
        }
        let suite = Reader::new(&SUITE, Some(&document));
        let folder = file.parent().unwrap_or(Path::new(""));
        Ok(Self {
            about: suite.text("about"),
            rows: suite.tables("rows", &ROWS).iter().map(|row| row_of(row, folder)).collect(),
        })
    }

    /// Whether a TOML file is a suite rather than a scene: it has rows.
    ///
    /// # Errors
    /// A file that cannot be read, or is no TOML.
    pub fn is_one(path: &Path) -> Result<bool, SceneError> {
        Ok(document_of(&read_text(path)?, path)?.get("rows").is_some())
    }
}

fn row_of(row: &Reader<'_>, folder: &Path) -> SuiteRow {
    let text = |name: &str| row.written(name).map(|_| row.text(name));
    SuiteRow {
        name: row.text("name"),
        scene: folder.join(row.text("scene")),
        set: list(row, "set", |value| match value {
            Value::Text(text) => Some(text.clone()),
            _ => None,
        }),
        cells_per_pass: list(row, "cells_per_pass", count),
        generate: text("generate").map(|name| match name.as_str() {
            "sphere" => Shape::Sphere,
            "torus" => Shape::Torus,
            "hills" => Shape::Hills,
            _ => Shape::Cube,
        }),
        point_counts: list(row, "point_counts", count),
        scan: text("scan").map(|name| match name.as_str() {
            "depth" => SimulatedScan::Depth,
            "tls1" => SimulatedScan::Tls1,
            "tls3" => SimulatedScan::Tls3,
            "tls10" => SimulatedScan::Tls10,
            _ => SimulatedScan::Photo,
        }),
        fill: text("fill").and_then(|written| crate::models::model(folder, &written)),
        over: text("over"),
        paper_ms: row.written("paper_ms").map(|_| row.number("paper_ms")),
        if_missing: text("if_missing"),
    }
}

/// The values of a checked list; none where it is left out.
fn list<T>(row: &Reader<'_>, name: &str, read: impl Fn(&Value) -> Option<T>) -> Vec<T> {
    row.written(name)
        .map_or(&[][..], Node::items)
        .iter()
        .filter_map(|item| read(&item.value))
        .collect()
}

fn count(value: &Value) -> Option<u32> {
    match value {
        Value::Integer(integer) => u32::try_from(*integer).ok(),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "about = 'both kinds'
[[rows]]
name = 'ball'
scene = 'ball.toml'
set = ['lights=[]', 'image.size=[8, 8]']
cells_per_pass = [1, 0]
paper_ms = 36
if_missing = 'fetch it'
[[rows]]
name = 'tori'
scene = '../torus.toml'
generate = 'torus'
point_counts = [1000, 2000]
[[rows]]
name = 'scan'
scene = 'room.toml'
scan = 'tls10'
over = 'ball'
";

    fn error(text: &str) -> String {
        Suite::from_toml(text, "s.toml".as_ref()).unwrap_err().to_string()
    }

    #[test]
    fn every_key_is_read() {
        let suite = Suite::from_toml(TEXT, "a/s.toml".as_ref()).unwrap();
        let ball = SuiteRow {
            name: "ball".into(),
            scene: "a/ball.toml".into(),
            set: vec!["lights=[]".into(), "image.size=[8, 8]".into()],
            cells_per_pass: vec![1, 0],
            generate: None,
            point_counts: Vec::new(),
            scan: None,
            fill: None,
            over: None,
            paper_ms: Some(36.0),
            if_missing: Some("fetch it".into()),
        };
        let tori = SuiteRow {
            name: "tori".into(),
            scene: "a/../torus.toml".into(),
            set: Vec::new(),
            cells_per_pass: Vec::new(),
            generate: Some(Shape::Torus),
            point_counts: vec![1000, 2000],
            scan: None,
            fill: None,
            over: None,
            paper_ms: None,
            if_missing: None,
        };
        let scan = SuiteRow {
            name: "scan".into(),
            scene: "a/room.toml".into(),
            generate: None,
            point_counts: Vec::new(),
            scan: Some(SimulatedScan::Tls10),
            over: Some("ball".into()),
            ..tori.clone()
        };
        assert_eq!(suite, Suite { about: "both kinds".into(), rows: vec![ball, tori, scan] });
        assert_eq!(
            SHAPES,
            [Shape::Sphere, Shape::Torus, Shape::Hills, Shape::Cube]
                .map(|shape| format!("{shape:?}").to_lowercase())
        );
        for name in SCANS {
            let text = TEXT.replace("'tls10'", &format!("'{name}'"));
            let suite = Suite::from_toml(&text, "a/s.toml".as_ref()).unwrap();
            let scan = suite.rows.last().and_then(|row| row.scan).unwrap();
            assert_eq!(format!("{scan:?}").to_lowercase(), name);
        }
    }

    #[test]
    fn errors_name_line_key_and_what_to_do() {
        for (from, to, words) in [
            ("name = 'ball'", "nam = 'ball'", &["s.toml:3:1", "rows[0].nam", "'name'"][..]),
            ("about = 'both kinds'", "", &["about", "missing"]),
            ("[1, 0]", "[1, -2]", &["s.toml:6:22", "cells_per_pass[1]", "-2", "raise it"]),
            ("[1, 0]", "[]", &["s.toml:6:18", "a list of 1 to"]),
            ("[1, 0]", "1", &["s.toml:6:18", "a list of 1 to"]),
            ("[1000, 2000]", "[1000, 'many']", &["point_counts[1]", "an integer from 100"]),
            ("'torus'", "'tours'", &["s.toml:12:12", "did you mean \"torus\"?"]),
            ("generate = 'torus'", "", &["rows[1].generate", "missing", "point_counts"]),
            ("point_counts = [1000, 2000]", "", &["rows[1].point_counts", "missing"]),
            ("paper_ms = 36", "paper_ms = 0", &["s.toml:7:12", "raise it"]),
            ("name = 'tori'", "name = 'ball'", &["s.toml:2:1", "\"ball\" twice"]),
            ("scan = 'tls10'", "scan = 'tls2'", &["rows[2].scan", "did you mean"]),
            (
                "scan = 'tls10'",
                "scan = 'photo'\ngenerate = 'torus'\npoint_counts = [100]",
                &["rows[2].scan", "drop one"],
            ),
            ("over = 'ball'", "over = 'scan'", &["rows", "\"scan\"", "an earlier row"]),
            ("'lights=[]'", "7", &["rows[0].set[0]", "PATH=VALUE"]),
        ] {
            assert!(TEXT.contains(from), "{from}");
            let error = error(&TEXT.replacen(from, to, 1));
            for word in words {
                assert!(error.contains(word), "{to}: '{word}' is not in: {error}");
            }
        }
        assert!(error("about = 'x'").contains("rows: missing"), "{}", error("about = 'x'"));
    }

    /// As for scenes: whatever is lost from a file, reading it ends in an error or a suite.
    #[test]
    fn no_dropped_line_or_prefix_panics() {
        let lines: Vec<&str> = TEXT.lines().collect();
        for dropped in 0..lines.len() {
            let mut rest = lines.clone();
            rest.remove(dropped);
            let _ = Suite::from_toml(&rest.join("\n"), "s.toml".as_ref());
        }
        for end in (0..TEXT.len()).filter(|&end| TEXT.is_char_boundary(end)) {
            let _ = Suite::from_toml(&TEXT[..end], "s.toml".as_ref());
        }
    }
}
