//! The list of what is timed, each scene of it checked.

use crate::args::{BenchArgs, Overrides, ViewArgs};
use crate::bench::filled::Filled;
use crate::bench::generated::Made;
use crate::bench::report::Skipped;
use crate::bench::suites::{Asked, Suites};
use crate::errors::Failure;
use crate::input::{Input, SceneValues};
use crate::progress::Progress;
use scene::{Scene, SuiteRow};
use std::path::PathBuf;

/// One row to be.
pub struct Case {
    /// In tables.
    pub name: String,
    /// The suite it is of.
    pub suite: Option<String>,
    /// What is timed, with its own points.
    pub input: Input,
    /// Points to be made instead of the first object's.
    pub made: Option<Made>,
    /// The row of the same suite over which planning and building are stated.
    pub over: Option<String>,
    /// Milliseconds a frame that the paper states.
    pub paper_ms: Option<f64>,
    /// Whether it is the case before with a preset, beside which it is shown.
    pub beside: bool,
}

/// What is to be done, and what cannot be.
#[derive(Default)]
pub struct Cases {
    /// In the order of tables.
    pub cases: Vec<Case>,
    /// Rows whose models are missing, or that are over `--max-points`.
    pub skipped: Vec<Skipped>,
    /// Files of suites, which are inputs too.
    pub suites: Vec<PathBuf>,
    /// Holds filled models while cases need them.
    filled: Filled,
}

impl Cases {
    /// All that the command line asks for. What is wrong with any of it is found here; models that are
    /// missing are no fault of a suite's.
    pub fn new(
        args: &BenchArgs,
        suites: &mut Suites,
        progress: &Progress,
    ) -> Result<Self, Failure> {
        let mut cases = Self::default();
        for asked in args.asked() {
            match suites.find(&asked)? {
                Asked::Scene(path) => cases.add_scene(path, &args.overrides)?,
                Asked::Suite(name, suite) => {
                    cases.suites.push(asked);
                    for row in &suite.rows {
                        cases.add_row(&name, row, args, suites, progress)?;
                    }
                }
            }
        }
        Ok(cases)
    }

    /// Name and suite of each, skipped ones too.
    pub fn names(&self) -> impl Iterator<Item = (&str, Option<&str>)> {
        let cases = self.cases.iter().map(|case| (case.name.as_str(), case.suite.as_deref()));
        let skipped = self.skipped.iter().map(|row| (row.name.as_str(), Some(row.suite.as_str())));
        cases.chain(skipped)
    }

    fn add_scene(&mut self, path: PathBuf, overrides: &Overrides) -> Result<(), Failure> {
        for beside in each_preset(overrides) {
            // As measured ever since.
            let values = SceneValues::new(&of_preset(overrides, beside)).in_draft();
            let input = Input::load(&path, &values, &ViewArgs::default())?;
            let name = named(input.name(), overrides, beside);
            let (suite, made, over, paper_ms) = (None, None, None, None);
            self.cases.push(Case { name, suite, input, made, over, paper_ms, beside });
        }
        Ok(())
    }

    /// A case for each of the row's point counts and numbers of cells.
    fn add_row(
        &mut self,
        suite: &str,
        row: &SuiteRow,
        args: &BenchArgs,
        suites: &Suites,
        progress: &Progress,
    ) -> Result<(), Failure> {
        for count in each(&row.point_counts) {
            for (cells, beside) in each(&row.cells_per_pass).into_iter().flat_map(|cells| {
                each_preset(&args.overrides).into_iter().map(move |it| (cells, it))
            }) {
                let mut name = row.name.clone();
                let mut values = SceneValues::set(&row.set).in_draft();
                if let Some(count) = count {
                    name += &format!(", {count} points");
                }
                if let Some(cells) = cells {
                    name += &match cells {
                        0 => ", K = all".to_owned(),
                        cells => format!(", K = {cells}"),
                    };
                    values.add(
                        "render.cells_per_pass",
                        &cells.to_string(),
                        &format!("cells_per_pass = {cells}"),
                    );
                }
                values.append(&of_preset(&args.overrides, beside));
                name = named(name, &args.overrides, beside);
                let skipped = |reason| Skipped { name: name.clone(), suite: suite.into(), reason };
                if let (Some(count), Some(most)) = (count, args.max_points)
                    && count > most
                {
                    let reason = format!("more than the {most} points of --max-points");
                    self.skipped.push(skipped(reason));
                    continue;
                }
                if let Some(reason) = missing_model(row, &values, suites) {
                    let Some(model) = &row.fill else {
                        self.skipped.push(skipped(reason));
                        continue;
                    };
                    let points = self.filled.of(model, progress)?;
                    let written = serde_json::json!(points.to_string_lossy()).to_string();
                    values.add("objects.0.points", &written, "the points that fill them");
                }
                let input =
                    Input::load(&row.scene, &values, &ViewArgs::default()).map_err(|failure| {
                        suites.failure(failure.of(&format!("{suite}: row '{}'", row.name)))
                    })?;
                self.cases.push(Case {
                    name,
                    suite: Some(suite.to_owned()),
                    input,
                    made: match row.scan {
                        Some(scan) => Some(Made::Scan(scan)),
                        None => {
                            row.generate.zip(count).map(|(shape, count)| Made::Even(shape, count))
                        }
                    },
                    over: row.over.clone(),
                    paper_ms: row.paper_ms,
                    beside,
                });
            }
        }
        Ok(())
    }
}

/// Without a preset that is asked for, then with it: whether it is with it.
fn each_preset(overrides: &Overrides) -> Vec<bool> {
    if overrides.preset.is_some() { vec![false, true] } else { vec![false] }
}

/// The same with the preset, or without.
fn of_preset(overrides: &Overrides, with: bool) -> Overrides {
    let preset = overrides.preset.clone().filter(|_| with);
    Overrides { preset, ..overrides.clone() }
}

fn named(name: String, overrides: &Overrides, with: bool) -> String {
    match overrides.preset.as_ref().filter(|_| with) {
        Some(preset) => format!("{name}, preset {preset}"),
        None => name,
    }
}

/// Each value, or once none.
fn each(values: &[u32]) -> Vec<Option<u32>> {
    match values {
        [] => vec![None],
        values => values.iter().copied().map(Some).collect(),
    }
}

/// Why the scene of a row lacks its models, and what to do, if that is all that is wrong with it.
fn missing_model(row: &SuiteRow, values: &SceneValues, suites: &Suites) -> Option<String> {
    let error = Scene::load(&row.scene, &values.as_set()).err()?;
    if !error.lacks_models_alone() {
        return None;
    }
    let reason = suites.as_written(&error.lines().join("; "));
    Some(match &row.if_missing {
        Some(advice) => format!("{reason}; {advice}"),
        None => reason,
    })
}
