//! Every key of a suite of benchmarks, stated as those of a scene are.

use crate::keys::Absent::{Required, Words};
use crate::keys::{Fault, Kind, Table, count, key, numbers};
use crate::read::Reader;
use crate::suite::{SCANS, SHAPES};

/// Rows of one suite, and values of one list.
const MOST: usize = 1000;

/// The whole file.
pub(crate) static SUITE: Table = Table {
    header: "the suite",
    doc: "",
    whole: Some(names_differ_and_are_known),
    keys: &[
        key(
            "about",
            Kind::Text("what the suite measures"),
            Required("\"the paper's table\""),
            "What it measures, in a line.",
        ),
        key(
            "rows",
            Kind::Tables { table: &ROWS, min: 1, max: MOST, in_file: false },
            Required("[{ name = \"ball\", scene = \"ball.toml\" }]"),
            ROWS.doc,
        ),
    ],
};

/// One measurement, or several that differ in what is varied.
pub(crate) static ROWS: Table = Table {
    header: "[[rows]]",
    doc: "A scene to be timed. Where values are listed, there is one row for each of them.",
    whole: Some(points_are_generated_with_their_counts),
    keys: &[
        key(
            "name",
            Kind::Text("a name"),
            Required("\"Bunny, shadows\""),
            "Name in tables and in JSON; each row has its own.",
        ),
        key(
            "scene",
            Kind::Text("the path of a scene file or point file"),
            Required("\"bunny.toml\""),
            "What is timed, relative to the suite's folder; rows may share it.",
        ),
        key(
            "set",
            Kind::List { of: &Kind::Text("PATH=VALUE"), max: MOST },
            Words("the scene as it is", "[\"render.primary=grid\"]"),
            "Values of the scene that this row changes, as `--set` does.",
        ),
        key(
            "cells_per_pass",
            Kind::List { of: &count(0, u32::MAX as i64, "cells"), max: MOST },
            Words("as the scene has it", "[1, 2, 4, 0]"),
            "Cells a ray may cross in one pass: a row for each number. 0 lets the device decide.",
        ),
        key(
            "generate",
            Kind::Choice(&SHAPES),
            Words("the scene's own points", "\"torus\""),
            "Even points to be made instead of the first object's: on a sphere of radius 1 about the \
             origin, on a torus about the y axis with radii 1 and 0.4, or on hills over a square of side 1 around the \
             origin, where they have no height. Or points at random in the cube of side 2 around the origin, with a \
             scalar `density` from 0 to 1.",
        ),
        key(
            "point_counts",
            Kind::List { of: &count(100, 1_000_000_000, "points"), max: MOST },
            Words("none", "[10000, 100000]"),
            "How many points to generate: a row for each number.",
        ),
        key(
            "scan",
            Kind::Choice(&SCANS),
            Words("the scene's own points", "\"tls3\""),
            "A simulated scan of the corner of a room of 4 × 4 × 3 m to be made instead of the first object's points: by a \
             depth camera, by a laser scanner with noise of 1, 3 or 10 ‰ of the distance, or by photogrammetry.",
        ),
        key(
            "fill",
            Kind::Text("the path of a point file"),
            Words("the scene's own points", "\"../models/bunny.ply\""),
            "The points of a surface, relative to the suite's folder: where the first object's points are missing, these \
             are filled instead, as `pointillist fill` does, and kept in the cache folder.",
        ),
        key(
            "over",
            Kind::Text("the name of an earlier row"),
            Words("none", "\"tls3, 16 neighbours\""),
            "An earlier row: the time to plan and build is stated over that of it.",
        ),
        key(
            "paper_ms",
            Kind::Number(numbers(1e-6, 1e9, "ms")),
            Words("none", "36"),
            "What the paper states for this, as milliseconds a frame.",
        ),
        key(
            "if_missing",
            Kind::Text("what to do"),
            Words("none", "\"tools/fetch-models bunny\""),
            "What to do where a model is missing; said beside the row, which is skipped.",
        ),
    ],
};

/// Rows are told apart by their names, and ask for earlier ones by them.
fn names_differ_and_are_known(suite: &Reader<'_>) -> Result<(), Fault> {
    let rows = suite.tables("rows", &ROWS);
    let names: Vec<String> = rows.iter().map(|row| row.text("name")).collect();
    let twice = (1..names.len()).find(|&at| names[..at].contains(&names[at]));
    if let Some(at) = twice {
        return Err((
            "rows",
            format!("found the name \"{}\" twice, expected one a row; rename one", names[at]),
        ));
    }
    let over = |at: &usize| rows[*at].written("over").map(|_| rows[*at].text("over"));
    let is_known = |at: &usize| over(at).is_none_or(|name| names[..*at].contains(&name));
    match (0..names.len()).find(|at| !is_known(at)) {
        Some(at) => Err((
            "rows",
            format!(
                "row \"{}\" is over \"{}\", expected the name of an earlier row; move or rename one",
                names[at],
                rows[at].text("over")
            ),
        )),
        None => Ok(()),
    }
}

fn points_are_generated_with_their_counts(row: &Reader<'_>) -> Result<(), Fault> {
    let missing = |name: &'static str, owner: &str, example: &str| {
        Err((name, format!("missing, expected beside {owner}; add e.g. {name} = {example}")))
    };
    if row.written("generate").is_some() && row.written("scan").is_some() {
        let both = "found beside generate, expected one of the two; drop one";
        return Err(("scan", both.to_owned()));
    }
    match (row.written("generate").is_some(), row.written("point_counts").is_some()) {
        (true, false) => missing("point_counts", "generate", "[10000, 100000]"),
        (false, true) => missing("generate", "point_counts", "\"torus\""),
        _ => Ok(()),
    }
}
