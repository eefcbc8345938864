//! What changed since an earlier report.
//!
//! Times vary, so a change counts only where the two ranges from least to largest time do not meet, and
//! lie further apart than a tolerance. Pictures do not vary: any other hash is a change.

use crate::bench::report::Report;
use crate::bench::table::{Table, short};
use crate::errors::Failure;
use crate::stats::{Row, Spread};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;

/// A time that was measured once is taken to vary by this part of it, up and down.
const VARIATION: f64 = 0.25;

/// The part of an earlier report that is compared.
#[derive(Debug, Deserialize)]
pub struct Earlier {
    #[serde(skip)]
    file: String,
    device: String,
    #[serde(default)]
    driver: String,
    rows: Vec<EarlierRow>,
}

#[derive(Debug, Deserialize)]
struct EarlierRow {
    name: String,
    #[serde(default)]
    suite: Option<String>,
    #[serde(default)]
    size: Option<[u32; 2]>,
    trace_ms: Spread,
    build_ms: Spread,
    pixels: String,
}

/// What changed.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Comparison {
    /// The earlier report's file, as given.
    pub with: String,
    /// The earlier device and driver, where it is another: its times say little then.
    pub other_device: Option<String>,
    /// Rows of this report, then those that only the earlier one has.
    pub rows: Vec<Change>,
    /// Whether no picture changed and no time got worse.
    pub pass: bool,
}

/// What changed of one row.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Change {
    /// The row.
    pub name: String,
    /// Whether both reports have it.
    pub row: Presence,
    /// Whether the pictures are the same, where both have one.
    pub same_picture: Option<bool>,
    /// The earlier picture's columns and rows, where they are others: a picture changed, but not the work alone.
    pub other_size: Option<[u32; 2]>,
    /// Time of a frame.
    pub trace: Option<Speed>,
    /// Time of a build.
    pub build: Option<Speed>,
}

/// Which report has a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Presence {
    /// Both.
    Both,
    /// This one alone.
    New,
    /// The earlier one alone.
    Missing,
    /// The earlier one; here it was skipped.
    Skipped,
}

/// How a time changed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Speed {
    /// Median over the earlier one.
    pub ratio: f64,
    /// What is made of it.
    pub verdict: Verdict,
}

/// Whether a time changed by more than it varies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// It got shorter.
    Faster,
    /// It may have stayed.
    Same,
    /// It got longer.
    Slower,
}

impl Earlier {
    /// Reads what `--json` wrote.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let file = path.display().to_string();
        let text = fs::read_to_string(path).map_err(|error| {
            Failure::usage(format!("{file}: cannot be read ({error}); check the path"))
        })?;
        let mut earlier: Self = serde_json::from_str(&text).map_err(|error| {
            Failure::usage(format!(
                "{file}:{}:{}: not a report of times: {error}; give a file that `bench --json` wrote",
                error.line(),
                error.column()
            ))
        })?;
        let times = |row: &EarlierRow| [row.trace_ms, row.build_ms];
        let wrong = |spread: &Spread| !(spread.min >= 0.0 && spread.min <= spread.max);
        if let Some(row) = earlier.rows.iter().find(|row| times(row).iter().any(wrong)) {
            return Err(Failure::usage(format!(
                "{file}: row '{}': found a least time that is negative or over the largest, expected \
                 what `bench --json` writes; write the report again",
                row.name
            )));
        }
        earlier.file = file;
        Ok(earlier)
    }

    /// Fails where it has none of these rows, by name and suite: nothing could be compared.
    pub fn require_any<'a>(
        &self,
        mut rows: impl Iterator<Item = (&'a str, Option<&'a str>)>,
    ) -> Result<(), Failure> {
        let known = |(name, suite): (&str, Option<&str>)| {
            self.rows.iter().any(|old| old.name == name && old.suite.as_deref() == suite)
        };
        if rows.any(known) {
            return Ok(());
        }
        let mut has: Vec<&str> = self.rows.iter().map(|old| old.name.as_str()).take(3).collect();
        if self.rows.len() > has.len() {
            has.push("...");
        }
        let has = if has.is_empty() { "none".to_owned() } else { has.join("; ") };
        Err(Failure::usage(format!(
            "{}: found none of the rows that are to be timed, but {has}; give a report of the same suite or \
             scene",
            self.file
        )))
    }

    /// Holds a report against it. `tolerance` is a part of the earlier time.
    pub fn compare(self, report: &Report, tolerance: f64) -> Comparison {
        let Self { file, device, driver, rows: mut earlier } = self;
        let mut rows = Vec::new();
        for row in &report.rows {
            let same = |old: &EarlierRow| old.name == row.name && old.suite == row.suite;
            rows.push(match earlier.iter().position(same) {
                // Taken, so that the second of two rows of one name meets the second.
                Some(at) => change(row, &earlier.remove(at), tolerance),
                None => without_times(&row.name, Presence::New),
            });
        }
        for old in &earlier {
            let skipped = report.skipped.iter().any(|skipped| skipped.name == old.name);
            let presence = if skipped { Presence::Skipped } else { Presence::Missing };
            rows.push(without_times(&old.name, presence));
        }
        let other = device != report.device || driver != report.driver;
        let comma = if driver.is_empty() { "" } else { ", " };
        Comparison {
            with: file,
            other_device: other.then(|| format!("{device}{comma}{driver}")),
            pass: rows.iter().all(Change::passes),
            rows,
        }
    }
}

impl Change {
    fn passes(&self) -> bool {
        let slower = |speed: &Option<Speed>| speed.is_some_and(|s| s.verdict == Verdict::Slower);
        self.same_picture != Some(false) && !slower(&self.trace) && !slower(&self.build)
    }
}

impl Comparison {
    /// What is compared with what, and how it ended.
    pub fn heading(&self) -> String {
        let other = self.other_device.as_ref().map_or_else(String::new, |device| {
            format!(" (measured on another device, so its times say little: {device})")
        });
        let found = match self.pass {
            true if self.rows.iter().all(|change| change.row != Presence::Both) => {
                "nothing, since no row was measured in both"
            }
            true => "no picture changed, and nothing got slower beyond its spread",
            false => "a picture changed, or something got slower beyond its spread",
        };
        format!("Compared with {}{other}: {found}", self.with)
    }

    /// A line a row.
    pub fn table(&self) -> Table {
        let cells = |change: &Change| {
            let picture = match (change.row, change.same_picture, change.other_size) {
                (Presence::Both, _, Some([width, height])) => {
                    format!("changed, was {width}x{height}")
                }
                (Presence::Both, Some(true), None) => "same".to_owned(),
                (Presence::Both, _, None) => "changed".to_owned(),
                (Presence::New, ..) => "new row".to_owned(),
                (Presence::Missing, ..) => "missing row".to_owned(),
                (Presence::Skipped, ..) => "skipped now".to_owned(),
            };
            let speed = |speed: Option<Speed>| {
                speed.map_or_else(String::new, |Speed { ratio, verdict }| match verdict {
                    Verdict::Faster => format!("faster, {}x", short(ratio)),
                    Verdict::Same => format!("same, {}x", short(ratio)),
                    Verdict::Slower => format!("slower, {}x", short(ratio)),
                })
            };
            vec![change.name.clone(), picture, speed(change.trace), speed(change.build)]
        };
        Table::new(
            vec!["scene", "picture", "trace", "build"],
            self.rows.iter().map(cells).collect(),
        )
    }
}

fn change(row: &Row, old: &EarlierRow, tolerance: f64) -> Change {
    Change {
        name: row.name.clone(),
        row: Presence::Both,
        same_picture: Some(row.pixels == old.pixels),
        other_size: old.size.filter(|size| *size != row.size),
        trace: Some(speed(row.trace_ms, old.trace_ms, tolerance)),
        build: Some(speed(row.build_ms, old.build_ms, tolerance)),
    }
}

fn without_times(name: &str, row: Presence) -> Change {
    Change {
        name: name.to_owned(),
        row,
        same_picture: None,
        other_size: None,
        trace: None,
        build: None,
    }
}

fn speed(new: Spread, old: Spread, tolerance: f64) -> Speed {
    let ([least, most], [old_least, old_most]) = (range(new), range(old));
    let verdict = if least > old_most * (1.0 + tolerance) {
        Verdict::Slower
    } else if most * (1.0 + tolerance) < old_least {
        Verdict::Faster
    } else {
        Verdict::Same
    };
    Speed { ratio: new.median / old.median.max(f64::MIN_POSITIVE), verdict }
}

/// From the least to the largest time.
fn range(spread: Spread) -> [f64; 2] {
    if spread.min < spread.max {
        return [spread.min, spread.max];
    }
    [spread.min * (1.0 - VARIATION), spread.max * (1.0 + VARIATION)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(new: [f64; 3], old: [f64; 3]) -> Verdict {
        let spread = |[min, median, max]: [f64; 3]| Spread { median, min, max };
        speed(spread(new), spread(old), 0.05).verdict
    }

    #[test]
    fn a_time_changed_where_ranges_do_not_meet() {
        let old = [10.0, 11.0, 14.0];
        assert_eq!(verdict(old, old), Verdict::Same);
        assert_eq!(verdict([13.0, 20.0, 30.0], old), Verdict::Same);
        assert_eq!(verdict([15.0, 16.0, 17.0], old), Verdict::Slower);
        assert_eq!(verdict([1.0, 2.0, 9.0], old), Verdict::Faster);
        assert_eq!(verdict([1.0, 2.0, 10.1], old), Verdict::Same);
    }

    /// 14.5 is less than 14 and a twentieth of it.
    #[test]
    fn ranges_that_lie_within_the_tolerance_are_the_same() {
        assert_eq!(verdict([14.5, 15.0, 16.0], [10.0, 11.0, 14.0]), Verdict::Same);
        assert_eq!(verdict([8.0, 9.0, 9.6], [10.0, 11.0, 14.0]), Verdict::Same);
    }

    #[test]
    fn what_was_measured_once_has_to_change_by_more_than_it_may_vary() {
        let once = |ms: f64| [ms; 3];
        assert_eq!(verdict(once(10.0), once(9.0)), Verdict::Same);
        assert_eq!(verdict(once(20.0), once(10.0)), Verdict::Slower);
        assert_eq!(verdict(once(5.0), once(10.0)), Verdict::Faster);
        assert_eq!(verdict(once(10.0), once(0.0)), Verdict::Slower);
    }
}
